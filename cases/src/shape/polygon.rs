//! Regions bounded by straight edges.

use super::Chords;

/// A simple polygon in the (r, z) plane, in metres.
#[derive(Debug, Clone)]
pub struct Polygon {
    points: Vec<[f64; 2]>,
    cut: bool,
}

impl Polygon {
    /// From its corners in order, either way round, in a plane without an axis at r = 0.
    pub fn new(points: Vec<[f64; 2]>) -> Self {
        Self { points, cut: false }
    }

    /// From its corners in order, either way round, cut off at the axis r = 0. What then lies on
    /// the axis is no boundary.
    pub fn cut_at_axis(points: &[[f64; 2]]) -> Self {
        let mut kept = Vec::with_capacity(points.len() + 2);
        for (start, end) in edges(points) {
            if start[0] >= 0.0 {
                kept.push(start);
            }
            if (start[0] < 0.0) != (end[0] < 0.0) {
                let share = start[0] / (start[0] - end[0]);
                kept.push([0.0, start[1] + share * (end[1] - start[1])]);
            }
        }
        kept.dedup();
        Self { points: kept, cut: true }
    }

    /// The corners in order.
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// Two edges `[i, j]` that cross or overlap though they are no neighbours, if there are any.
    pub fn crossing(points: &[[f64; 2]]) -> Option<[usize; 2]> {
        let count = points.len();
        let edge = |index: usize| [points[index], points[(index + 1) % count]];
        (0..count)
            .flat_map(|first| (first + 2..count).map(move |second| [first, second]))
            .filter(|[first, second]| (second + 1) % count != *first)
            .find(|[first, second]| meet(edge(*first), edge(*second)))
    }

    pub(super) fn encloses_axis(&self) -> bool {
        self.cut && self.bounds()[0] <= 0.0
    }

    pub(super) fn bounds(&self) -> [f64; 4] {
        let start = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
        if self.points.is_empty() {
            return [0.0; 4];
        }
        self.points.iter().fold(start, |[r_min, r_max, z_min, z_max], [r, z]| {
            [r_min.min(*r), r_max.max(*r), z_min.min(*z), z_max.max(*z)]
        })
    }

    pub(super) fn chords(&self, z: f64) -> Chords {
        let mut crossings: Vec<f64> = edges(&self.points)
            .filter(|(start, end)| (start[1] > z) != (end[1] > z))
            .map(|(start, end)| start[0] + (z - start[1]) / (end[1] - start[1]) * (end[0] - start[0]))
            .collect();
        crossings.sort_by(f64::total_cmp);
        Chords::of(crossings.chunks_exact(2).map(|pair| [pair[0], pair[1]]))
    }

    pub(super) fn signed_distance(&self, r: f64, z: f64) -> f64 {
        let r = if self.cut { r.abs() } else { r };
        let distance = edges(&self.points)
            .filter(|(start, end)| !(self.cut && start[0] == 0.0 && end[0] == 0.0))
            .map(|(start, end)| segment_distance([r, z], start, end))
            .fold(f64::INFINITY, f64::min);
        // With z level on a corner the half-open rule of the chords still counts every edge once.
        let on_axis = self.cut && r == 0.0;
        let inside = self.chords(z).iter().any(|[low, high]| (low < r || (on_axis && low <= r)) && r < high);
        if inside { -distance } else { distance }
    }

    /// Area and first moment, by the sums over the corners' cross products.
    pub(super) fn moments(&self) -> [f64; 2] {
        // Relative to the first corner, so that a small polygon far away loses no digits.
        let Some([r_first, z_first]) = self.points.first().copied() else {
            return [0.0, 0.0];
        };
        let (mut area, mut moment) = (0.0, 0.0);
        for (start, end) in edges(&self.points) {
            let [r_start, z_start, r_end, z_end] =
                [start[0] - r_first, start[1] - z_first, end[0] - r_first, end[1] - z_first];
            let cross = r_start * z_end - r_end * z_start;
            area += 0.5 * cross;
            moment += cross * (r_start + r_end) / 6.0;
        }
        [area.abs(), (moment + r_first * area) * area.signum()]
    }
}

fn edges(points: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> + '_ {
    points.iter().copied().zip(points.iter().copied().cycle().skip(1))
}

fn segment_distance(point: [f64; 2], start: [f64; 2], end: [f64; 2]) -> f64 {
    let along = [end[0] - start[0], end[1] - start[1]];
    let to = [point[0] - start[0], point[1] - start[1]];
    let square = along[0] * along[0] + along[1] * along[1];
    let share =
        if square > 0.0 { ((to[0] * along[0] + to[1] * along[1]) / square).clamp(0.0, 1.0) } else { 0.0 };
    (to[0] - share * along[0]).hypot(to[1] - share * along[1])
}

fn meet(first: [[f64; 2]; 2], second: [[f64; 2]; 2]) -> bool {
    let side = |[start, end]: [[f64; 2]; 2], point: [f64; 2]| {
        let cross = (end[0] - start[0]) * (point[1] - start[1]) - (end[1] - start[1]) * (point[0] - start[0]);
        if cross == 0.0 { 0.0 } else { cross.signum() }
    };
    let boxes_meet = (0..2).all(|axis| {
        let span = |edge: [[f64; 2]; 2]| [edge[0][axis].min(edge[1][axis]), edge[0][axis].max(edge[1][axis])];
        let ([low, high], [other_low, other_high]) = (span(first), span(second));
        low <= other_high && other_low <= high
    });
    boxes_meet
        && side(first, second[0]) * side(first, second[1]) <= 0.0
        && side(second, first[0]) * side(second, first[1]) <= 0.0
}
