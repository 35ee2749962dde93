//! An axis: what part of it a value lies at, and its labelled ticks.

use super::units::{decimal_exponent, ticks};

/// Part of the range that stays free beyond the outermost values.
const MARGIN: f64 = 0.04;

/// A range of values along a line.
pub(super) struct Axis {
    low: f64,
    high: f64,
    logarithmic: bool,
}

impl Axis {
    /// From `low` to `high`; widened where they coincide.
    pub(super) fn linear(low: f64, high: f64) -> Self {
        let (low, high) = widened(low, high);
        Self { low, high, logarithmic: false }
    }

    /// Around all values (finite, and positive if logarithmic), with a margin.
    pub(super) fn around(values: impl Iterator<Item = f64>, logarithmic: bool) -> Self {
        let (low, high) = values
            .map(|value| if logarithmic { value.log10() } else { value })
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        let (low, high) = widened(low, high);
        let margin = MARGIN * (high - low);
        let (low, high) = (low - margin, high + margin);
        let back = |value: f64| {
            if logarithmic { 10f64.powf(value) } else { value }
        };
        Self { low: back(low), high: back(high), logarithmic }
    }

    /// Where a value lies: 0 at the low end, 1 at the high one.
    pub(super) fn fraction(&self, value: f64) -> f64 {
        if self.logarithmic {
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    /// About `count` round values with their labels.
    pub(super) fn ticks(&self, count: usize) -> Vec<(f64, String)> {
        if self.logarithmic {
            return self.logarithmic_ticks(count);
        }
        let values = ticks(self.low, self.high, count);
        let step = match values[..] {
            [first, second, ..] => second - first,
            _ => self.high - self.low,
        };
        let largest = values.iter().fold(step, |largest, value| largest.max(value.abs()));
        let labels = values.iter().map(|value| linear_label(*value, step, largest));
        values.iter().copied().zip(labels).collect()
    }

    /// Powers of ten; over less than three decades also 2 and 5 times them.
    fn logarithmic_ticks(&self, count: usize) -> Vec<(f64, String)> {
        let (low, high) = (self.low.log10(), self.high.log10());
        let powers = low.floor() as i32..=high.ceil() as i32;
        let every = ((high - low) / count as f64).ceil().max(1.0) as i32;
        let multiples: &[i32] = if high - low < 3.0 { &[1, 2, 5] } else { &[1] };
        powers
            .filter(|power| power.rem_euclid(every) == 0)
            .flat_map(|power| multiples.iter().map(move |multiple| (*multiple, power)))
            .map(|(multiple, power)| {
                let value = f64::from(multiple) * 10f64.powi(power);
                (value, logarithmic_label(multiple, power))
            })
            .filter(|(value, _)| (self.low..=self.high).contains(value))
            .collect()
    }
}

fn widened(low: f64, high: f64) -> (f64, f64) {
    if !(low.is_finite() && high.is_finite()) {
        return (0.0, 1.0);
    }
    // Below that the ticks would differ by rounding only.
    let least = 1e-9 * low.abs().max(high.abs());
    if high - low > least {
        return (low, high);
    }
    let half = if low == 0.0 { 0.5 } else { 0.05 * low.abs() };
    (low - half, high + half)
}

fn linear_label(value: f64, step: f64, largest: f64) -> String {
    // A sum of steps may miss zero by a rounding.
    let value = if value.abs() < 1e-9 * step { 0.0 } else { value };
    let (step, largest) = (decimal_exponent(step, 2), decimal_exponent(largest, 2));
    if !(-4..6).contains(&largest) {
        if value == 0.0 {
            return "0".to_owned();
        }
        let digits = (decimal_exponent(value, 2) - step).max(0) as usize;
        return format!("{value:.digits$e}");
    }
    format!("{value:.*}", (-step).max(0) as usize)
}

fn logarithmic_label(multiple: i32, power: i32) -> String {
    if (-3..5).contains(&power) {
        let value = f64::from(multiple) * 10f64.powi(power);
        return format!("{value:.*}", (-power).max(0) as usize);
    }
    let raised: String = power
        .to_string()
        .chars()
        .map(|letter| match letter.to_digit(10) {
            Some(digit) => ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'][digit as usize],
            None => '⁻',
        })
        .collect();
    match multiple {
        1 => format!("10{raised}"),
        _ => format!("{multiple}·10{raised}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(axis: &Axis, count: usize) -> Vec<String> {
        axis.ticks(count).into_iter().map(|(_, label)| label).collect()
    }

    #[test]
    fn linear_labels_have_the_digits_that_the_step_needs() {
        assert_eq!(labels(&Axis::linear(0.0, 1.0), 5), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(&Axis::linear(-50.0, 50.0), 2), ["-50", "0", "50"]);
        assert_eq!(labels(&Axis::linear(0.0, 3e-7), 3), ["0", "1e-7", "2e-7", "3e-7"]);
        assert_eq!(labels(&Axis::linear(1e7, 1.2e7), 2), ["1.0e7", "1.1e7", "1.2e7"]);
        assert!(labels(&Axis::linear(998.0, 998.0), 5).len() > 2);
    }

    #[test]
    fn logarithmic_labels_are_powers_of_ten() {
        let axis = Axis::around([1e-6, 1.0].into_iter(), true);
        assert_eq!(labels(&axis, 8)[..4], ["10⁻⁶", "10⁻⁵", "10⁻⁴", "0.001"]);
        assert!((axis.fraction(1e-3) - 0.5).abs() < 1e-12);
        let axis = Axis::around([0.15, 3.0].into_iter(), true);
        assert_eq!(labels(&axis, 8), ["0.2", "0.5", "1", "2"]);
        let axis = Axis::around([1e-30, 1e30].into_iter(), true);
        assert!(axis.ticks(8).len() < 10);
    }
}
