//! Shapes to fill.

use crate::region::Region;
use std::f64::consts::PI;

/// A sphere on the axis, or away from it the section of a torus. Lengths in metres.
pub(super) struct Disc {
    pub centre: f64,
    pub radius: f64,
}

impl Region for Disc {
    fn signed_distance(&self, r: f64, z: f64) -> f64 {
        (r - self.centre).hypot(z) - self.radius
    }

    fn bounds(&self) -> [f64; 4] {
        let (centre, radius) = (self.centre, self.radius);
        [(centre - radius).max(0.0), centre + radius, -radius, radius]
    }

    fn volume(&self) -> f64 {
        if self.centre == 0.0 {
            4.0 / 3.0 * PI * self.radius.powi(3)
        } else {
            2.0 * PI * self.centre * PI * self.radius.powi(2)
        }
    }
}

/// A cylinder about the axis, without ends or with.
pub(super) struct Cylinder {
    pub radius: f64,
    pub height: f64,
    pub endless: bool,
}

impl Region for Cylinder {
    fn signed_distance(&self, r: f64, z: f64) -> f64 {
        let side = r.abs() - self.radius;
        if self.endless {
            return side;
        }
        let end = (z - self.height / 2.0).abs() - self.height / 2.0;
        side.max(0.0).hypot(end.max(0.0)) + side.max(end).min(0.0)
    }

    fn bounds(&self) -> [f64; 4] {
        [0.0, self.radius, 0.0, self.height]
    }

    fn volume(&self) -> f64 {
        PI * self.radius.powi(2) * self.height
    }
}
