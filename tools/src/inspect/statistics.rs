//! Numbers that sum up one field.

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

impl Statistics {
    /// Walks over the values once, with Welford's update: it neither overflows nor cancels.
    pub fn of(values: impl Iterator<Item = f64>) -> Self {
        let (mut minimum, mut maximum) = (f64::INFINITY, f64::NEG_INFINITY);
        let (mut count, mut mean, mut squares) = (0.0, 0.0, 0.0);
        let mut non_finite = 0;
        for value in values {
            if !value.is_finite() {
                non_finite += 1;
                continue;
            }
            minimum = value.min(minimum);
            maximum = value.max(maximum);
            count += 1.0;
            let deviation = value - mean;
            mean += deviation / count;
            squares += deviation * (value - mean);
        }
        let some = |value: f64| (count > 0.0).then_some(value);
        Self {
            minimum: some(minimum),
            maximum: some(maximum),
            mean: some(mean),
            standard_deviation: some((squares / count).sqrt()),
            non_finite,
        }
    }
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
    /// Counts the finite values in bins of equal width; one bin where all values are equal.
    pub fn of(values: impl Iterator<Item = f64>, statistics: &Statistics) -> Self {
        let (Some(minimum), Some(maximum)) = (statistics.minimum, statistics.maximum) else {
            return Self { bins: Vec::new() };
        };
        let number = if maximum > minimum { BINS } else { 1 };
        // Halved, because the difference of two finite numbers may overflow.
        let half_span = maximum / 2.0 - minimum / 2.0;
        let edge = |bin: usize| {
            let share = bin as f64 / number as f64;
            minimum * (1.0 - share) + maximum * share
        };
        let mut bins: Vec<Bin> =
            (0..number).map(|bin| Bin { from: edge(bin), to: edge(bin + 1), count: 0 }).collect();
        for value in values.filter(|value| value.is_finite()) {
            let share = (value / 2.0 - minimum / 2.0) / half_span;
            // Where all values are equal the share is no number, which the cast turns to zero.
            let bin = (share * number as f64) as usize;
            bins[bin.min(number - 1)].count += 1;
        }
        Self { bins }
    }
}
