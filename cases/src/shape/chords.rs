//! Ordered, disjoint intervals and their set algebra.

/// Ordered, disjoint intervals `[low, high]` of r in metres.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Chords(Vec<[f64; 2]>);

impl Chords {
    /// Of the given intervals, which must be ordered and disjoint; empty ones are dropped.
    pub(super) fn of(intervals: impl IntoIterator<Item = [f64; 2]>) -> Self {
        Self(intervals.into_iter().filter(|[low, high]| low < high).collect())
    }

    /// The interval across a disc at `height` above its centre, widened by the factor `aspect`.
    pub(super) fn around(centre: f64, radius: f64, height: f64, aspect: f64) -> Self {
        let half = aspect * ((radius - height) * (radius + height)).max(0.0).sqrt();
        Self::of([[centre - half, centre + half]])
    }

    /// The interval `across` if z lies strictly between the heights.
    pub(super) fn between(z: f64, [bottom, top]: [f64; 2], across: [f64; 2]) -> Self {
        Self::of((bottom < z && z < top).then_some(across))
    }

    /// The part at r >= 0.
    pub(super) fn cut(&self) -> Self {
        self.intersection(&Self(vec![[0.0, f64::INFINITY]]))
    }

    /// The intervals in order.
    pub fn iter(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.0.iter().copied()
    }

    /// Sum of the lengths in metres.
    pub fn length(&self) -> f64 {
        self.iter().map(|[low, high]| high - low).sum()
    }

    /// What lies in either.
    pub fn union(&self, other: &Self) -> Self {
        self.select(other, |first, second| first || second)
    }

    /// What lies in both.
    pub fn intersection(&self, other: &Self) -> Self {
        self.select(other, |first, second| first && second)
    }

    /// What lies in this and not in the other.
    pub fn difference(&self, other: &Self) -> Self {
        self.select(other, |first, second| first && !second)
    }

    /// Walks the ends of both sets in order and keeps the stretches that `keep` wants.
    fn select(&self, other: &Self, keep: impl Fn(bool, bool) -> bool) -> Self {
        let mut ends: Vec<f64> = self.iter().chain(other.iter()).flatten().collect();
        ends.sort_by(f64::total_cmp);
        let mut kept: Vec<[f64; 2]> = Vec::new();
        for pair in ends.windows(2).filter(|pair| pair[0] < pair[1]) {
            if !keep(self.covers(pair), other.covers(pair)) {
                continue;
            }
            match kept.last_mut() {
                Some(last) if last[1] == pair[0] => last[1] = pair[1],
                _ => kept.push([pair[0], pair[1]]),
            }
        }
        Self(kept)
    }

    fn covers(&self, stretch: &[f64]) -> bool {
        self.iter().any(|[low, high]| low <= stretch[0] && stretch[1] <= high)
    }
}
