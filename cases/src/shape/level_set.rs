//! Regions where a function of r and z is negative.

use super::Chords;
use super::distance::box_distance;
use std::fmt;
use std::sync::Arc;

/// A function of r and z in metres, negative inside.
pub type Field = Arc<dyn Fn(f64, f64) -> f64 + Send + Sync>;

/// Samples along r (and z) in which sign changes are looked for.
const SAMPLES: usize = 400;

/// Where a function is negative within a bounding box.
#[derive(Clone)]
pub struct LevelSet {
    inside: Field,
    bounds: [f64; 4],
    cut: bool,
}

impl LevelSet {
    /// The region within the box `[r_min, r_max, z_min, z_max]`, in metres, where `inside` is
    /// negative. With `cut` the box ends at the axis r = 0, which then is no boundary, and the
    /// function is only ever asked at r >= 0. The box shrinks to what lies inside, to within 1/400 of
    /// its size; parts that no sample meets are lost.
    pub fn new(inside: Field, bounds: [f64; 4], cut: bool) -> Self {
        let [r_min, r_max, z_min, z_max] = bounds;
        let r_min = if cut { r_min.max(0.0) } else { r_min };
        let mut level_set = Self { inside, bounds: [r_min, r_max, z_min, z_max], cut };
        level_set.bounds = level_set.shrunk();
        level_set
    }

    fn shrunk(&self) -> [f64; 4] {
        let [r_min, r_max, z_min, z_max] = self.bounds;
        let (r_step, z_step) = ((r_max - r_min) / SAMPLES as f64, (z_max - z_min) / SAMPLES as f64);
        let mut tight = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
        for row in 0..SAMPLES {
            let z = z_min + z_step * (row as f64 + 0.5);
            for [low, high] in self.chords(z).iter() {
                tight = [tight[0].min(low), tight[1].max(high), tight[2].min(z), tight[3].max(z)];
            }
        }
        if tight[0] > tight[1] {
            return [r_min, r_min, z_min, z_min];
        }
        [
            r_min.max(tight[0] - r_step),
            r_max.min(tight[1] + r_step),
            z_min.max(tight[2] - z_step),
            z_max.min(tight[3] + z_step),
        ]
    }

    /// The same between other ends.
    pub(super) fn between(&self, bottom: f64, top: f64) -> Self {
        let [r_min, r_max, ..] = self.bounds;
        Self { bounds: [r_min, r_max, bottom, top], ..self.clone() }
    }

    pub(super) fn bounds(&self) -> [f64; 4] {
        self.bounds
    }

    pub(super) fn encloses_axis(&self) -> bool {
        self.cut && self.bounds[0] <= 0.0
    }

    pub(super) fn chords(&self, z: f64) -> Chords {
        let [r_min, r_max, z_min, z_max] = self.bounds;
        if !(z_min..=z_max).contains(&z) {
            return Chords::default();
        }
        let position = |index: usize| r_min + (r_max - r_min) * index as f64 / SAMPLES as f64;
        let mut intervals: Vec<[f64; 2]> = Vec::new();
        let mut start = self.is_inside(r_min, z).then_some(r_min);
        for index in 1..=SAMPLES {
            let (before, here) = (position(index - 1), position(index));
            match (start, self.is_inside(here, z)) {
                (None, true) => start = Some(self.boundary(here, before, z)),
                (Some(low), false) => {
                    intervals.push([low, self.boundary(before, here, z)]);
                    start = None;
                }
                _ => {}
            }
        }
        intervals.extend(start.map(|low| [low, r_max]));
        Chords::of(intervals)
    }

    /// Bisects between a point inside and one outside to the last digit.
    fn boundary(&self, mut inside: f64, mut outside: f64, z: f64) -> f64 {
        loop {
            let middle = 0.5 * (inside + outside);
            if middle == inside || middle == outside {
                return middle;
            }
            if self.is_inside(middle, z) {
                inside = middle;
            } else {
                outside = middle;
            }
        }
    }

    fn is_inside(&self, r: f64, z: f64) -> bool {
        self.value(r, z) < 0.0
    }

    fn value(&self, r: f64, z: f64) -> f64 {
        (self.inside)(if self.cut { r.abs() } else { r }, z)
    }

    /// Distance to the nearest point of the zero line, found by steps along the gradient with a
    /// slide towards the asking point; value over gradient where that does not settle.
    pub(super) fn signed_distance(&self, r: f64, z: f64) -> f64 {
        let mut rectangle = self.bounds;
        if self.cut && rectangle[0] <= 0.0 {
            rectangle[0] = f64::NEG_INFINITY;
        }
        let limit = box_distance([r, z], rectangle);
        let value = self.value(r, z);
        let distance = self.nearest([r, z]).map_or_else(
            || {
                let slope = self.gradient([r, z]);
                value.abs() / slope[0].hypot(slope[1])
            },
            |nearest| (r - nearest[0]).hypot(z - nearest[1]),
        );
        let signed = if value < 0.0 { -distance } else { distance };
        if signed.is_nan() { limit.max(0.0) } else { signed.max(limit) }
    }

    fn nearest(&self, point: [f64; 2]) -> Option<[f64; 2]> {
        let [r_min, r_max, z_min, z_max] = self.bounds;
        let size = (r_max - r_min).max(z_max - z_min);
        let mut guess = point;
        for _ in 0..40 {
            let value = self.value(guess[0], guess[1]);
            let slope = self.gradient(guess);
            let square = slope[0] * slope[0] + slope[1] * slope[1];
            let away = [point[0] - guess[0], point[1] - guess[1]];
            let normal = (away[0] * slope[0] + away[1] * slope[1]) / square;
            let slide = [away[0] - normal * slope[0], away[1] - normal * slope[1]];
            let step = [slide[0] - value / square * slope[0], slide[1] - value / square * slope[1]];
            let length = step[0].hypot(step[1]);
            if length.is_nan() || length > 2.0 * size {
                return None;
            }
            // Half the slide where it is long: the zero line bends away under it.
            let share = if slide[0].hypot(slide[1]) > 0.1 * size { 0.5 } else { 1.0 };
            guess = [guess[0] + share * step[0], guess[1] + share * step[1]];
            if length < 1e-10 * size {
                return Some(guess);
            }
        }
        None
    }

    fn gradient(&self, [r, z]: [f64; 2]) -> [f64; 2] {
        let [r_min, r_max, z_min, z_max] = self.bounds;
        let step = 1e-6 * (r_max - r_min).max(z_max - z_min);
        [
            (self.value(r + step, z) - self.value(r - step, z)) / (2.0 * step),
            (self.value(r, z + step) - self.value(r, z - step)) / (2.0 * step),
        ]
    }
}

impl fmt::Debug for LevelSet {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.debug_struct("LevelSet").field("bounds", &self.bounds).finish_non_exhaustive()
    }
}
