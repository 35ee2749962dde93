//! Distances to shapes, and their bounds.

use super::{Shape, spheroid};
use crate::region::Region;

impl Region for Shape {
    fn signed_distance(&self, r: f64, z: f64) -> f64 {
        match self {
            Shape::Sphere { radius, centre } => r.hypot(z - centre) - radius,
            Shape::Spheroid { radial, axial, centre } => {
                spheroid::signed_distance([*radial, *axial], [r.abs(), (z - centre).abs()])
            }
            Shape::Cylinder { radius, bottom, top } => {
                box_distance([r.abs(), z], [-radius, *radius, *bottom, *top])
            }
            Shape::Annulus { inner, outer, bottom, top } => {
                box_distance([r, z], [*inner, *outer, *bottom, *top])
            }
            Shape::Torus { major, minor, centre } => (r - major).hypot(z - centre) - minor,
            Shape::Polygon(polygon) => polygon.signed_distance(r, z),
            Shape::Expression(level_set) => level_set.signed_distance(r, z),
            Shape::Union(shapes) => distances(shapes, r, z).fold(f64::INFINITY, f64::min),
            Shape::Intersection(shapes) => distances(shapes, r, z).fold(f64::NEG_INFINITY, f64::max),
            Shape::Difference(shapes) => {
                let mut distances = distances(shapes, r, z);
                let first = distances.next().unwrap_or(f64::INFINITY);
                distances.fold(first, |distance, other| distance.max(-other))
            }
        }
    }

    fn bounds(&self) -> [f64; 4] {
        match self {
            Shape::Sphere { radius, centre } => [0.0, *radius, centre - radius, centre + radius],
            Shape::Spheroid { radial, axial, centre } => [0.0, *radial, centre - axial, centre + axial],
            Shape::Cylinder { radius, bottom, top } => [0.0, *radius, *bottom, *top],
            Shape::Annulus { inner, outer, bottom, top } => [*inner, *outer, *bottom, *top],
            Shape::Torus { major, minor, centre } => {
                [major - minor, major + minor, centre - minor, centre + minor]
            }
            Shape::Polygon(polygon) => polygon.bounds(),
            Shape::Expression(level_set) => level_set.bounds(),
            Shape::Union(shapes) => merge_bounds(shapes, f64::min, f64::max),
            Shape::Intersection(shapes) => merge_bounds(shapes, f64::max, f64::min),
            Shape::Difference(shapes) => merge_bounds(shapes.get(..1).unwrap_or(&[]), f64::min, f64::max),
        }
    }

    fn volume(&self) -> f64 {
        self.volume_about(0.0)
    }
}

fn distances(shapes: &[Shape], r: f64, z: f64) -> impl Iterator<Item = f64> + '_ {
    shapes.iter().map(move |shape| shape.signed_distance(r, z))
}

fn merge_bounds(shapes: &[Shape], low: fn(f64, f64) -> f64, high: fn(f64, f64) -> f64) -> [f64; 4] {
    let merge =
        |a: [f64; 4], b: [f64; 4]| [low(a[0], b[0]), high(a[1], b[1]), low(a[2], b[2]), high(a[3], b[3])];
    shapes.iter().map(Shape::bounds).reduce(merge).unwrap_or_default()
}

/// Signed distance to an axis-parallel rectangle `[r_min, r_max, z_min, z_max]`.
pub(super) fn box_distance([r, z]: [f64; 2], [r_min, r_max, z_min, z_max]: [f64; 4]) -> f64 {
    let radial = (r_min - r).max(r - r_max);
    let axial = (z_min - z).max(z - z_max);
    if radial > 0.0 && axial > 0.0 { radial.hypot(axial) } else { radial.max(axial) }
}
