//! Shapes that go on from one period to the next.

use super::Shape;
use crate::region::Region;

/// A shape in a periodic scene. What spans a whole period goes on in the next one: its ends are no surface, and
/// are moved away. Bounds and volume stay those of one period.
pub struct Endless<'a> {
    shape: &'a Shape,
    continued: Shape,
}

impl<'a> Endless<'a> {
    /// `period` in metres.
    pub fn new(shape: &'a Shape, period: f64) -> Self {
        Endless { shape, continued: shape.continued(period) }
    }
}

impl Region for Endless<'_> {
    fn signed_distance(&self, r: f64, z: f64) -> f64 {
        self.continued.signed_distance(r, z)
    }

    fn bounds(&self) -> [f64; 4] {
        self.shape.bounds()
    }

    fn volume(&self) -> f64 {
        self.shape.volume()
    }
}

impl Shape {
    /// The same with flat ends a period apart moved away from each other. A polygon keeps its ends.
    fn continued(&self, period: f64) -> Shape {
        let [r_min, r_max, z_min, z_max] = self.bounds();
        let far = 4.0 * (period + r_max - r_min);
        let (bottom, top) = (z_min - far, z_max + far);
        let spans = z_max - z_min >= period * (1.0 - 1e-9);
        let all = |shapes: &[Shape]| shapes.iter().map(|shape| shape.continued(period)).collect();
        match self {
            Shape::Cylinder { radius, .. } if spans => Shape::Cylinder { radius: *radius, bottom, top },
            Shape::Annulus { inner, outer, .. } if spans => {
                Shape::Annulus { inner: *inner, outer: *outer, bottom, top }
            }
            Shape::Expression(level_set) if spans => Shape::Expression(level_set.between(bottom, top)),
            Shape::Union(shapes) => Shape::Union(all(shapes)),
            Shape::Intersection(shapes) => Shape::Intersection(all(shapes)),
            Shape::Difference(shapes) => Shape::Difference(all(shapes)),
            _ => self.clone(),
        }
    }
}
