//! Curves (times, values) of exact flows, cut where a run is fitted.

/// Values at so many times stand for an exact curve where it is fitted.
const SAMPLES: usize = 200;

/// The same curve (times, values) at equal steps in time, like that of a run, so that a fit to both weighs alike:
/// the part between the first crossings of two values, `from` and then `to`. `None` if it does not come that far.
pub(super) fn evenly([times, values]: &[Vec<f64>; 2], from: f64, to: f64) -> Option<[Vec<f64>; 2]> {
    let [start, end] = [from, to].map(|value| crossing(times, values, value));
    let (start, end) = (start?, end?);
    let time = |k: usize| start + (end - start) * k as f64 / SAMPLES as f64;
    let even: Vec<f64> = (0..=SAMPLES).map(time).collect();
    let values = even.iter().map(|time| at(times, values, *time)).collect();
    Some([even, values])
}

/// When values at ever later times first reach one that lies on the way from the first on.
pub(super) fn crossing(times: &[f64], values: &[f64], value: f64) -> Option<f64> {
    let rising = values.first()? < &value;
    let after = values.iter().position(|v| (*v >= value) == rising)?;
    let before = after.checked_sub(1)?;
    let part = (value - values[before]) / (values[after] - values[before]);
    Some(times[before] + part * (times[after] - times[before]))
}

/// The straight line between values at ever later times.
pub(super) fn at(times: &[f64], values: &[f64], time: f64) -> f64 {
    let after = times.partition_point(|before| *before <= time).clamp(1, times.len() - 1);
    let part = (time - times[after - 1]) / (times[after] - times[after - 1]);
    values[after - 1] + part * (values[after] - values[after - 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_is_cut_where_it_crosses() {
        let times: Vec<f64> = (0..50).map(|k| 0.01 * f64::from(k) * f64::from(k)).collect();
        let falling: Vec<f64> = times.iter().map(|time| 3.0 - 2.0 * time).collect();
        let [even, values] = evenly(&[times.clone(), falling], 2.5, 1.0).unwrap();
        assert!((even[0] - 0.25).abs() < 1e-12 && (even[SAMPLES] - 1.0).abs() < 1e-12, "{even:?}");
        assert!(even.iter().zip(&values).all(|(time, value)| (value - 3.0 + 2.0 * time).abs() < 1e-12));
        let rising: Vec<f64> = times.iter().map(|time| 0.1 * time).collect();
        assert!(evenly(&[times.clone(), rising.clone()], 0.5, 9.0).is_none());
        assert!((crossing(&times, &rising, 0.77).unwrap() - 7.7).abs() < 1e-12);
    }
}
