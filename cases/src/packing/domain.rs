//! The region in units of the particle size, with its symmetries: axis and period.

use super::{MOST_PARTICLES, PackingError, PackingOptions};
use crate::region::Region;

/// A point (r, z) in particle sizes.
pub(super) type Point = [f64; 2];

/// A particle, or fixed dust: where it is and its area, in particle sizes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Source {
    pub point: Point,
    pub area: f64,
}

pub(super) struct Domain<'a> {
    region: &'a dyn Region,
    size: f64,
    /// Height z in metres that is zero here.
    base: f64,
    /// `[r_min, r_max, z_min, z_max]` in particle sizes.
    pub bounds: [f64; 4],
    pub has_axis: bool,
    pub period: Option<f64>,
    /// A tile repeats in r, too.
    pub period_r: Option<f64>,
    pub count: usize,
}

/// The whole plane: it has no surface.
struct Plane;

impl Region for Plane {
    fn signed_distance(&self, _: f64, _: f64) -> f64 {
        f64::NEG_INFINITY
    }

    fn bounds(&self) -> [f64; 4] {
        [f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY]
    }

    fn volume(&self) -> f64 {
        f64::INFINITY
    }
}

impl<'a> Domain<'a> {
    pub fn new(region: &'a dyn Region, options: &PackingOptions) -> Result<Self, PackingError> {
        let size = options.particle_size;
        check("the particle size", "positive", size, size > 0.0)?;
        check("the origin", "zero or positive", options.origin, options.origin >= 0.0)?;
        match options.volume {
            Some(volume) => check("the volume", "positive", volume, volume > 0.0)?,
            None if options.origin > 0.0 => {
                return Err(PackingError::NoVolume { origin: options.origin });
            }
            None => {}
        }
        if let Some(period) = options.period {
            // One image on either side must cover the reach of the kernel.
            let enough = period >= 3.0 * size;
            check("the period", "at least three particle sizes", period, enough)?;
        }
        let [r_min, r_max, z_min, z_max] = region.bounds();
        let finite = region.bounds().iter().all(|bound| bound.is_finite());
        if !finite || r_min > r_max || z_min > z_max {
            return Err(PackingError::Region);
        }
        let top = options.period.unwrap_or(z_max - z_min) / size;
        let mut domain = Self {
            region,
            size,
            base: z_min,
            bounds: [r_min / size, r_max / size, 0.0, top],
            has_axis: options.origin == 0.0,
            period: options.period.map(|period| period / size),
            period_r: None,
            count: 0,
        };
        domain.count = domain.particle_count()?;
        Ok(domain)
    }

    /// A square of the plane, `side` particles wide, that repeats in both directions.
    pub fn tile(side: usize) -> Domain<'static> {
        let width = side as f64;
        Domain {
            region: &Plane,
            size: 1.0,
            base: 0.0,
            bounds: [0.0, width, 0.0, width],
            has_axis: false,
            period: Some(width),
            period_r: Some(width),
            count: side * side,
        }
    }

    /// Signed distance in particle sizes, negative inside.
    pub fn signed_distance(&self, [r, z]: Point) -> f64 {
        let r = if self.has_axis { r.abs() } else { r };
        let z = self.period.map_or(z, |period| z.rem_euclid(period));
        self.region.signed_distance(r * self.size, self.metres_z(z)) / self.size
    }

    /// Unit vector along the gradient of the signed distance, and the gradient's length.
    pub fn outward(&self, [r, z]: Point) -> Option<(Point, f64)> {
        const STEP: f64 = 1e-4;
        let slope = |above, below| (self.signed_distance(above) - self.signed_distance(below)) / (2.0 * STEP);
        let gradient = [slope([r + STEP, z], [r - STEP, z]), slope([r, z + STEP], [r, z - STEP])];
        let length = gradient[0].hypot(gradient[1]);
        (length > 0.01).then(|| ([gradient[0] / length, gradient[1] / length], length))
    }

    /// How far, at least, a point lies from the surface, the axis and the ends of the period.
    pub fn depth(&self, point: Point) -> f64 {
        let depth = -self.signed_distance(point);
        let from_axis = if self.has_axis { point[0] } else { f64::INFINITY };
        let from_ends = self.period.map_or(f64::INFINITY, |period| point[1].min(period - point[1]));
        depth.min(from_axis).min(from_ends)
    }

    /// Height in metres of `z` in particle sizes.
    pub fn metres_z(&self, z: f64) -> f64 {
        self.base + z * self.size
    }

    /// The part of the box around `centre` with half sides `half` that lies inside: its area and
    /// its first moments, by bisection down to boxes in which the boundary is a straight line.
    pub fn inside(&self, centre: Point, half: Point, smallest: f64) -> [f64; 3] {
        let distance = self.signed_distance(centre);
        let radius = half[0].hypot(half[1]);
        if distance >= radius {
            return [0.0; 3];
        }
        let full = 4.0 * half[0] * half[1];
        if distance <= -radius || radius <= smallest {
            let area = full * (0.5 - 0.5 * distance / radius).clamp(0.0, 1.0);
            let area = if distance <= -radius { full } else { area };
            return [area, area * centre[0], area * centre[1]];
        }
        let longest = usize::from(half[1] > half[0]);
        let (mut lower, mut upper, mut half) = (centre, centre, half);
        half[longest] /= 2.0;
        lower[longest] -= half[longest];
        upper[longest] += half[longest];
        let (first, second) = (self.inside(lower, half, smallest), self.inside(upper, half, smallest));
        [first[0] + second[0], first[1] + second[1], first[2] + second[2]]
    }

    fn particle_count(&self) -> Result<usize, PackingError> {
        let [r_min, r_max, z_min, z_max] = self.bounds;
        let most = (r_max - r_min) * (z_max - z_min);
        // The bounding box bounds the work of the measurement, too.
        if most > 10.0 * MOST_PARTICLES {
            return Err(PackingError::TooMany { count: most, limit: MOST_PARTICLES });
        }
        let centre = [(r_min + r_max) / 2.0, (z_min + z_max) / 2.0];
        let half = [(r_max - r_min) / 2.0, (z_max - z_min) / 2.0];
        let [area, ..] = self.inside(centre, half, 0.02);
        let count = area.round();
        if !area.is_finite() {
            Err(PackingError::Region)
        } else if count < 1.0 {
            Err(PackingError::Empty { particle_size: self.size })
        } else if count > MOST_PARTICLES {
            Err(PackingError::TooMany { count, limit: MOST_PARTICLES })
        } else {
            Ok(count as usize)
        }
    }
}

fn check(name: &'static str, expected: &'static str, value: f64, valid: bool) -> Result<(), PackingError> {
    if valid && value.is_finite() { Ok(()) } else { Err(PackingError::Option { name, expected, value }) }
}
