//! Shapes: what a scene's bodies look like in the half plane (r, z), with distances and volumes.
//!
//! A shape is plain data. Every shape can cut itself at a height z into *chords*, the intervals of r
//! inside it; booleans combine chords exactly, and every volume without a closed form is the
//! integral of its chords over z.

mod chords;
mod distance;
mod endless;
mod level_set;
mod polygon;
mod quadrature;
mod spheroid;
#[cfg(test)]
mod tests;

pub use chords::Chords;
pub use endless::Endless;
pub use level_set::{Field, LevelSet};
pub use polygon::Polygon;

use crate::region::Region;

/// A region of the half plane. All lengths in metres; r is measured from the scene's r = 0.
///
/// Spheres, spheroids and cylinders sit on the axis, which is none of their boundary. An annulus or
/// a torus is bounded all round and may reach r < 0 only in a scene whose origin lies off the axis.
#[derive(Debug, Clone)]
pub enum Shape {
    /// A sphere around the point `centre` of the axis.
    Sphere {
        /// Radius.
        radius: f64,
        /// Height z of the centre.
        centre: f64,
    },
    /// An ellipsoid of revolution around the point `centre` of the axis.
    Spheroid {
        /// Semi-axis in r.
        radial: f64,
        /// Semi-axis in z.
        axial: f64,
        /// Height z of the centre.
        centre: f64,
    },
    /// A solid cylinder around the axis.
    Cylinder {
        /// Radius.
        radius: f64,
        /// Lowest z.
        bottom: f64,
        /// Highest z.
        top: f64,
    },
    /// A hollow cylinder; its section is a rectangle (a film, when thin).
    Annulus {
        /// Lowest r.
        inner: f64,
        /// Highest r.
        outer: f64,
        /// Lowest z.
        bottom: f64,
        /// Highest z.
        top: f64,
    },
    /// A torus; its section is a disc.
    Torus {
        /// Distance r of the disc's centre.
        major: f64,
        /// Radius of the disc.
        minor: f64,
        /// Height z of the disc's centre.
        centre: f64,
    },
    /// A region bounded by straight edges.
    Polygon(Polygon),
    /// Where an expression in r and z is negative.
    Expression(LevelSet),
    /// Everything inside any of the shapes.
    Union(Vec<Shape>),
    /// Everything inside all of the shapes.
    Intersection(Vec<Shape>),
    /// Everything inside the first shape and none of the others.
    Difference(Vec<Shape>),
}

impl Shape {
    /// Intervals of r inside the shape at height `z`, ordered and disjoint. Exact but for an
    /// expression, whose chords thinner than 1/400 of its bounds can be missed.
    pub fn chords(&self, z: f64) -> Chords {
        match self {
            Shape::Sphere { radius, centre } => Chords::around(0.0, *radius, z - centre, 1.0).cut(),
            Shape::Spheroid { radial, axial, centre } => {
                Chords::around(0.0, *axial, z - centre, radial / axial).cut()
            }
            Shape::Cylinder { radius, bottom, top } => Chords::between(z, [*bottom, *top], [0.0, *radius]),
            Shape::Annulus { inner, outer, bottom, top } => {
                Chords::between(z, [*bottom, *top], [*inner, *outer])
            }
            Shape::Torus { major, minor, centre } => Chords::around(*major, *minor, z - centre, 1.0),
            Shape::Polygon(polygon) => polygon.chords(z),
            Shape::Expression(level_set) => level_set.chords(z),
            Shape::Union(shapes) => combine(shapes, z, Chords::union),
            Shape::Intersection(shapes) => combine(shapes, z, Chords::intersection),
            Shape::Difference(shapes) => combine(shapes, z, Chords::difference),
        }
    }

    /// Area of the section in m² and its first moment, the integral of r, in m³. Closed forms for
    /// the primitives; adaptive quadrature over z, to a relative 1e-10, for booleans and expressions.
    pub fn moments(&self) -> [f64; 2] {
        use std::f64::consts::PI;
        match self {
            Shape::Sphere { radius, .. } => [0.5 * PI * radius * radius, 2.0 / 3.0 * radius.powi(3)],
            Shape::Spheroid { radial, axial, .. } => {
                [0.5 * PI * radial * axial, 2.0 / 3.0 * radial * radial * axial]
            }
            Shape::Cylinder { radius, bottom, top } => {
                let area = radius * (top - bottom);
                [area, 0.5 * radius * area]
            }
            Shape::Annulus { inner, outer, bottom, top } => {
                let area = (outer - inner) * (top - bottom);
                [area, 0.5 * (inner + outer) * area]
            }
            Shape::Torus { major, minor, .. } => {
                let area = PI * minor * minor;
                [area, major * area]
            }
            Shape::Polygon(polygon) => polygon.moments(),
            Shape::Expression(_) | Shape::Union(_) | Shape::Intersection(_) | Shape::Difference(_) => {
                quadrature::moments(self)
            }
        }
    }

    /// Volume in m³, per full turn, when the scene's r = 0 lies at the radius `origin` in metres.
    pub fn volume_about(&self, origin: f64) -> f64 {
        let [area, moment] = self.moments();
        std::f64::consts::TAU * (origin * area + moment)
    }

    /// Smallest extent of the body in metres: the full width for a body around the axis. For
    /// polygons, expressions and booleans that of the bounding box.
    pub fn smallest_extent(&self) -> f64 {
        let [r_min, r_max, z_min, z_max] = self.bounds();
        let width = if self.encloses_axis() { 2.0 * r_max } else { r_max - r_min };
        width.min(z_max - z_min)
    }

    /// Whether the axis runs through the body (as far as its bounding box tells).
    pub fn encloses_axis(&self) -> bool {
        match self {
            Shape::Sphere { .. } | Shape::Spheroid { .. } | Shape::Cylinder { .. } => true,
            Shape::Annulus { .. } | Shape::Torus { .. } => false,
            Shape::Polygon(polygon) => polygon.encloses_axis(),
            Shape::Expression(level_set) => level_set.encloses_axis(),
            Shape::Union(shapes) => shapes.iter().any(Shape::encloses_axis),
            Shape::Intersection(_) => self.bounds()[0] <= 0.0 && self.covers_axis(),
            Shape::Difference(shapes) => {
                shapes.first().is_some_and(Shape::encloses_axis) && self.covers_axis()
            }
        }
    }

    /// Points `[r, z]` well inside the shape: the cell centres of `count` chords cut into `count`
    /// pieces each.
    pub fn interior_points(&self, count: usize) -> impl Iterator<Item = [f64; 2]> + '_ {
        let [_, _, z_min, z_max] = self.bounds();
        let part = move |index: usize| (index as f64 + 0.5) / count as f64;
        (0..count).flat_map(move |row| {
            let z = z_min + (z_max - z_min) * part(row);
            let chords: Vec<[f64; 2]> = self.chords(z).iter().collect();
            chords.into_iter().flat_map(move |[low, high]| {
                (0..count).map(move |column| [low + (high - low) * part(column), z])
            })
        })
    }

    /// Heights where the chords may jump or turn: the ends of every part.
    fn heights(&self, heights: &mut Vec<f64>) {
        match self {
            Shape::Union(shapes) | Shape::Intersection(shapes) | Shape::Difference(shapes) => {
                shapes.iter().for_each(|shape| shape.heights(heights));
            }
            Shape::Polygon(polygon) => heights.extend(polygon.points().iter().map(|point| point[1])),
            _ => heights.extend_from_slice(&self.bounds()[2..]),
        }
    }

    fn covers_axis(&self) -> bool {
        let [_, _, z_min, z_max] = self.bounds();
        (0..64).any(|row| {
            let z = z_min + (z_max - z_min) * (row as f64 + 0.5) / 64.0;
            self.chords(z).iter().any(|[low, _]| low <= 0.0)
        })
    }
}

fn combine(shapes: &[Shape], z: f64, operation: fn(&Chords, &Chords) -> Chords) -> Chords {
    let mut chords = shapes.iter().map(|shape| shape.chords(z));
    let first = chords.next().unwrap_or_default();
    chords.fold(first, |total, next| operation(&total, &next))
}
