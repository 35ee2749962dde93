//! The narrowest place of a surface: the bridge between drops that merge, the thread of a jet that tears.

use super::observe::Particles;

/// Values at so many times stand for an exact curve where it is fitted.
const SAMPLES: usize = 200;

/// The smallest radius of the surface between two heights z in m, 0 where there is none. Of points closer in z
/// than a distance `near` in m the outermost counts: there may be voids inside.
pub(super) fn observe(particles: &Particles, heights: [f64; 2], near: f64) -> Vec<f64> {
    let surface = particles.surface.as_ref();
    vec![surface.map_or(f64::NAN, |(r, z)| narrowest(r, z, heights, near))]
}

fn narrowest(r: &[f64], z: &[f64], [low, high]: [f64; 2], near: f64) -> f64 {
    let between = z.iter().zip(r).filter(|(z, _)| (low..=high).contains(*z));
    let mut points: Vec<(f64, f64)> = between.map(|(z, r)| (*z, *r)).collect();
    points.sort_by(|one, other| one.0.total_cmp(&other.0));
    let outermost = |(z, _): &(f64, f64)| {
        let first = points.partition_point(|point| point.0 < z - near);
        let neighbours = points[first..].iter().take_while(|point| point.0 <= z + near);
        neighbours.fold(0.0, |most: f64, point| most.max(point.1))
    };
    points.iter().map(outermost).min_by(f64::total_cmp).unwrap_or(0.0)
}

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
fn at(times: &[f64], values: &[f64], time: f64) -> f64 {
    let after = times.partition_point(|before| *before <= time).clamp(1, times.len() - 1);
    let part = (time - times[after - 1]) / (times[after] - times[after - 1]);
    values[after - 1] + part * (values[after] - values[after - 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A waist of radius 1 + z^2 with a void in it.
    #[test]
    fn the_waist_is_found_despite_a_void() {
        let z: Vec<f64> = (-100..=100).map(|k| 0.01 * f64::from(k)).collect();
        let mut r: Vec<f64> = z.iter().map(|z| 1.0 + z * z).collect();
        let found = narrowest(&r, &z, [-0.5, 0.5], 0.025);
        assert!((found - 1.0).abs() < 0.04 * 0.04, "{found}");
        (95..105).step_by(2).for_each(|k| r[k] = 0.3);
        let found = narrowest(&r, &z, [-0.5, 0.5], 0.025);
        assert!((found - 1.0).abs() < 0.04 * 0.04, "{found}");
        assert_eq!(narrowest(&r, &z, [2.0, 3.0], 0.05), 0.0);
        assert_eq!(narrowest(&r, &z, [f64::NEG_INFINITY, -0.995], 0.05), 2.0);
    }

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
