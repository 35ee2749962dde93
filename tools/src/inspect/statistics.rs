//! Numbers that sum up one field, gathered piece by piece.

use serde::Serialize;

/// Number of a histogram's bins.
const BINS: usize = 20;

/// Extremes, mean and spread over the finite values of a field; none where there are none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Statistics {
    pub minimum: Option<f64>,
    pub maximum: Option<f64>,
    pub mean: Option<f64>,
    /// Of the values given, not estimated for a larger population.
    pub standard_deviation: Option<f64>,
    pub non_finite: usize,
}

/// Statistics under way.
#[derive(Clone, Debug)]
pub struct Gathering {
    seen: usize,
    count: f64,
    mean: f64,
    squares: f64,
    non_finite: usize,
    /// The least and the greatest value so far with the first particles that have them.
    least: (f64, usize),
    greatest: (f64, usize),
    finite: Vec<f64>,
}

impl Default for Gathering {
    fn default() -> Self {
        Self {
            seen: 0,
            count: 0.0,
            mean: 0.0,
            squares: 0.0,
            non_finite: 0,
            least: (f64::INFINITY, 0),
            greatest: (f64::NEG_INFINITY, 0),
            finite: Vec::new(),
        }
    }
}

impl Gathering {
    /// Takes the next values.
    pub fn add(&mut self, values: &[f64]) {
        let all = Sweep::over(values);
        // A sum that is finite shows that every value is: most pieces need no closer look.
        if all.sum.is_finite() {
            self.merge(values, &all);
            self.note_extremes(values, &all);
        } else {
            let mut finite = std::mem::take(&mut self.finite);
            finite.clear();
            finite.extend(values.iter().copied().filter(|value| value.is_finite()));
            self.non_finite += values.len() - finite.len();
            let sweep = Sweep::over(&finite);
            self.merge(&finite, &sweep);
            self.note_extremes(values, &sweep);
            self.finite = finite;
        }
        self.seen += values.len();
    }

    /// Joins the moments of finite values with those so far: differences from means don't cancel.
    fn merge(&mut self, values: &[f64], sweep: &Sweep) {
        if values.is_empty() {
            return;
        }
        let count = values.len() as f64;
        let mean = sweep.sum / count;
        let squares = squares(values, mean);
        let (total, apart) = (self.count + count, mean - self.mean);
        self.mean += apart * count / total;
        self.squares += squares + apart * apart * self.count * count / total;
        self.count = total;
    }

    fn note_extremes(&mut self, values: &[f64], sweep: &Sweep) {
        let place = |extreme: f64| values.iter().position(|value| *value == extreme).unwrap_or(0);
        if sweep.least < self.least.0 {
            self.least = (sweep.least, self.seen + place(sweep.least));
        }
        if sweep.greatest > self.greatest.0 {
            self.greatest = (sweep.greatest, self.seen + place(sweep.greatest));
        }
    }

    /// What the values so far amount to.
    pub fn statistics(&self) -> Statistics {
        let some = |value: f64| (self.count > 0.0).then_some(value);
        Statistics {
            minimum: some(self.least.0),
            maximum: some(self.greatest.0),
            mean: some(self.mean),
            standard_deviation: some((self.squares / self.count).sqrt()),
            non_finite: self.non_finite,
        }
    }

    /// The first particles that have the least and the greatest value.
    pub fn places(&self) -> Option<[usize; 2]> {
        (self.count > 0.0).then_some([self.least.1, self.greatest.1])
    }
}

/// What one pass over values finds. Eight lanes side by side go as fast as memory, in a fixed order.
struct Sweep {
    sum: f64,
    least: f64,
    greatest: f64,
}

impl Sweep {
    fn over(values: &[f64]) -> Self {
        let (mut sum, mut least, mut greatest) = ([0.0; 8], [f64::INFINITY; 8], [f64::NEG_INFINITY; 8]);
        let mut take = |lane: usize, value: f64| {
            sum[lane] += value;
            least[lane] = if value < least[lane] { value } else { least[lane] };
            greatest[lane] = if value > greatest[lane] { value } else { greatest[lane] };
        };
        let (eights, rest) = values.as_chunks::<8>();
        for eight in eights {
            (0..8).for_each(|lane| take(lane, eight[lane]));
        }
        rest.iter().enumerate().for_each(|(lane, value)| take(lane, *value));
        Self {
            sum: sum.iter().sum(),
            least: least.into_iter().fold(f64::INFINITY, f64::min),
            greatest: greatest.into_iter().fold(f64::NEG_INFINITY, f64::max),
        }
    }
}

/// Sum of the squared distances from a value.
fn squares(values: &[f64], mean: f64) -> f64 {
    let mut lanes = [0.0; 8];
    let (eights, rest) = values.as_chunks::<8>();
    for eight in eights {
        (0..8).for_each(|lane| lanes[lane] += (eight[lane] - mean) * (eight[lane] - mean));
    }
    let rest: f64 = rest.iter().map(|value| (value - mean) * (value - mean)).sum();
    lanes.iter().sum::<f64>() + rest
}

/// How many values lie where between the extremes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Histogram {
    pub bins: Vec<Bin>,
}

/// One bar of a histogram: values from `from` up to `to`, the last bin with its upper end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bin {
    pub from: f64,
    pub to: f64,
    pub count: usize,
}

impl Histogram {
    /// Empty bins of equal width between the extremes; one where all values are equal.
    pub fn between(statistics: &Statistics) -> Self {
        let (Some(minimum), Some(maximum)) = (statistics.minimum, statistics.maximum) else {
            return Self { bins: Vec::new() };
        };
        let number = if maximum > minimum { BINS } else { 1 };
        let edge = |bin: usize| {
            let share = bin as f64 / number as f64;
            minimum * (1.0 - share) + maximum * share
        };
        Self { bins: (0..number).map(|bin| Bin { from: edge(bin), to: edge(bin + 1), count: 0 }).collect() }
    }

    /// Counts the finite ones among the next values.
    pub fn add(&mut self, values: &[f64]) {
        let (Some(first), Some(last)) = (self.bins.first(), self.bins.last()) else {
            return;
        };
        let (minimum, number) = (first.from, self.bins.len());
        // Halved, because the difference of two finite numbers may overflow.
        let half_span = last.to / 2.0 - minimum / 2.0;
        for value in values.iter().filter(|value| value.is_finite()) {
            let share = (value / 2.0 - minimum / 2.0) / half_span;
            // Where all values are equal the share is no number, which the cast turns to zero.
            let bin = (share * number as f64) as usize;
            self.bins[bin.min(number - 1)].count += 1;
        }
    }
}
