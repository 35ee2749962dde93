//! Numbers for people, and numbers that sum up a field.

use super::super::print::{self, number};
use super::super::statistics::{Gathering, Histogram};

#[test]
fn numbers_are_short() {
    for (value, text) in [
        (0.0, "0"),
        (-12.0, "-12"),
        (0.5, "0.5"),
        (1.0 / 3.0, "0.333333"),
        (999.999_999_9, "1000"),
        (123_456.7, "123457"),
        (2.5e-6, "2.5e-6"),
        (-1e300, "-1e300"),
        (f64::NAN, "NaN"),
        (f64::NEG_INFINITY, "-inf"),
    ] {
        assert_eq!(number(value), text);
    }
}

fn gathered(values: &[f64], piece: usize) -> Gathering {
    let mut gathering = Gathering::default();
    values.chunks(piece).for_each(|piece| gathering.add(piece));
    gathering
}

#[test]
fn statistics_survive_awkward_values() {
    let huge = [f64::MAX, -f64::MAX, f64::INFINITY, f64::NAN];
    let statistics = gathered(&huge, 4).statistics();
    assert_eq!(statistics.non_finite, 2);
    let mut histogram = Histogram::between(&statistics);
    histogram.add(&huge);
    assert_eq!(histogram.bins.first().unwrap().count, 1);
    assert_eq!(histogram.bins.last().unwrap().count, 1);
    let equal = gathered(&[3.0; 5], 2).statistics();
    assert_eq!(equal.standard_deviation, Some(0.0));
    let mut histogram = Histogram::between(&equal);
    histogram.add(&[3.0; 5]);
    assert_eq!(histogram.bins.len(), 1);
    assert_eq!(histogram.bins[0].count, 5);
    let none = gathered(&[f64::NAN], 1).statistics();
    assert_eq!(none.mean, None);
    assert!(Histogram::between(&none).bins.is_empty());
}

#[test]
fn the_edges_of_bars_can_be_told_apart() {
    let values = [999.9990, 999.9995, 1000.0, 1000.0008];
    let mut histogram = Histogram::between(&gathered(&values, 4).statistics());
    histogram.add(&values);
    let mut text = Vec::new();
    print::histogram(&histogram, &mut text).unwrap();
    let text = String::from_utf8(text).unwrap();
    for line in text.lines() {
        let mut edges = line.split_whitespace();
        assert_ne!(edges.next(), edges.next(), "{text}");
    }
    assert!(text.contains("999.99918"), "{text}");
}

#[test]
fn pieces_make_no_difference() {
    let values: Vec<f64> = (0..1000).map(|i| 1e9 + f64::from(i * 7919 % 1000)).collect();
    for piece in [1, 7, 64, 1000] {
        let gathering = gathered(&values, piece);
        let statistics = gathering.statistics();
        assert!((statistics.mean.unwrap() - (1e9 + 499.5)).abs() < 1e-6);
        // (n^2 - 1)/12 of n equally spaced values.
        let exact = ((1000.0_f64 * 1000.0 - 1.0) / 12.0).sqrt();
        assert!((statistics.standard_deviation.unwrap() / exact - 1.0).abs() < 1e-9);
        let [least, greatest] = gathering.places().unwrap();
        assert_eq!([values[least], values[greatest]], [1e9, 1e9 + 999.0]);
    }
}
