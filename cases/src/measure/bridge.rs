//! The bridge between two drops that become one.

use super::boundary_integral::{Flow, Surface};
use super::curve::{crossing, evenly};
use super::energy::largest_rise;
use super::evaluate::Outcome;
use super::exact::Drop;
use super::growth::slope;
use super::history::History;
use super::observe::Particles;
use crate::scene::Liquid;

/// Radius of the bridge between two drops.
pub(super) const COLUMNS: [(&str, &str); 1] = [("bridge radius", "m")];

/// Radii of the bridge, over the drops' effective one, between which its growth is fitted: wider than where
/// particles of both drops see each other at the start, still narrow beside the drops.
const RANGE: [f64; 2] = [0.25, 0.5];
/// Starts of the growth that are tried, before the first value, from 10^-3 to 10 times the series' length.
const STARTS: usize = 400;
/// Radius of the bridge from which the exact flow starts, over the drops' effective one. From starts between .08 and
/// .14 the prefactor comes out within .5 %.
const BRIDGE: f64 = 0.12;
/// Distance of the exact flow's nodes over the smaller radius of curvature.
const FINENESS: f64 = 0.4;

/// Two drops that touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bridge {
    /// Radius of one in m.
    pub radius: f64,
    /// Of the other.
    pub other: f64,
}

impl Bridge {
    /// R = 2 R_1 R_2/(R_1 + R_2) in m: small bridges grow as between two drops of this radius.
    pub fn effective_radius(&self) -> f64 {
        2.0 * self.radius * self.other / (self.radius + self.other)
    }

    /// Times in s since the bridge had a small radius, and its radii in m up to half of the effective one, if the
    /// liquid has no viscosity and is incompressible; takes some seconds to compute.
    pub fn exact(&self, liquid: &Liquid) -> [Vec<f64>; 2] {
        let Bridge { radius, other } = *self;
        let effective = self.effective_radius() / radius;
        let flow = Flow::bridge(other / radius, BRIDGE * effective, FINENESS);
        let [mut times, mut radii] =
            flow.observed(Surface::narrowest, |narrowest| narrowest > RANGE[1] * effective);
        let unit = radius / Drop::of(liquid, radius).capillary_velocity();
        times.iter_mut().for_each(|time| *time *= unit);
        radii.iter_mut().for_each(|narrowest| *narrowest *= radius);
        [times, radii]
    }

    /// How much later in s measured radii (times, radii) reach the range that is fitted than exact ones.
    pub fn delay(&self, measured: [&[f64]; 2], exact: [&[f64]; 2]) -> Option<f64> {
        let least = RANGE[0] * self.effective_radius();
        let [measured, exact] = [measured, exact].map(|[times, radii]| crossing(times, radii, least));
        Some(measured? - exact?)
    }
}

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

/// How a bridge grows. For small bridges inertia alone resists: r^2 grows like the time (Eggers, Lister and
/// Stone 1999; Duchemin, Eggers and Josserand 2003), r = C (sigma R/rho)^(1/4) t^(1/2) with the effective radius. A
/// wider one is slower, so the exact values are those of the exact flow in the same range of r.
pub(super) fn evaluate(history: &History, column: &str, liquid: &Liquid, bridge: Bridge) -> Vec<Outcome> {
    let range = RANGE.map(|part| part * bridge.effective_radius());
    let (times, values) = (history.of("time"), history.of(column));
    let end = values.iter().position(|value| *value > range[1]).unwrap_or(values.len());
    let wide = values[..end].iter().rposition(|value| *value < range[0]);
    let start = wide.map_or(0, |last| last + 1);
    // A bridge that is wider than the range from the start tells of the particles' size, not of its growth.
    let (times, fitted) =
        if start > 0 { (&times[start..end], &values[start..end]) } else { (&[][..], &[][..]) };
    let exponent = growth_exponent(times, fitted);
    let rate = exponent.and_then(|_| prefactor(times, fitted, liquid, bridge));
    // While the bridge opens, surface only disappears.
    let surface = history.of("surface energy");
    let rise = surface.get(..end).and_then(largest_rise).zip(surface.first());
    let why = if values.iter().any(|value| value.is_nan()) {
        "with this scene's curvature nothing tells where the surface lies"
    } else if start == 0 {
        "the bridge is wider than a quarter of the drops' radius from the start; use finer particles"
    } else if end == values.len() {
        "the run ends before the bridge has grown to half of the drops' radius"
    } else {
        "the bridge is observed fewer than 8 times while it grows from a quarter to half of the drops' radius; \
         choose a smaller `series_every`, or finer particles"
    };
    let outcome = |name: &str, value| Outcome::of(name.to_owned(), value, "1").lacking(why);
    let mut outcomes = vec![
        outcome("bridge-exponent", exponent),
        outcome("surface-rise", rise.map(|(rise, start)| rise / start)).against(0.0),
        outcome("bridge-prefactor", rate),
    ];
    if exponent.is_some()
        && let Some([times, radii]) = evenly(&bridge.exact(liquid), range[0], range[1])
    {
        outcomes[0].reference = growth_exponent(&times, &radii);
        outcomes[2].reference = prefactor(&times, &radii, liquid, bridge);
    }
    outcomes
}

/// C from the slope of r^2, which needs no start.
fn prefactor(times: &[f64], radii: &[f64], liquid: &Liquid, bridge: Bridge) -> Option<f64> {
    let squares: Vec<f64> = radii.iter().map(|radius| radius * radius).collect();
    let unit = (liquid.surface_tension * bridge.effective_radius() / liquid.density).sqrt();
    slope(times, &squares).map(|rate| (rate / unit).max(0.0).sqrt())
}

/// p of values a (t - t_0)^p at times t, by least squares of the logarithms with the best t_0; `None` for fewer
/// than 8 values.
fn growth_exponent(times: &[f64], values: &[f64]) -> Option<f64> {
    let [first, .., last] = times else { return None };
    if times.len() < 8 || values.iter().any(|value| *value <= 0.0) {
        return None;
    }
    let logarithms: Vec<f64> = values.iter().map(|value| value.ln()).collect();
    let fit = |k: usize| {
        let before = (last - first) * 10f64.powf(4.0 * k as f64 / STARTS as f64 - 3.0);
        let places: Vec<f64> = times.iter().map(|t| (t - first + before).ln()).collect();
        let exponent = slope(&places, &logarithms)?;
        let rests = places.iter().zip(&logarithms).map(|(x, y)| y - exponent * x);
        let (sum, squares) =
            rests.fold((0.0, 0.0), |(sum, squares), rest| (sum + rest, squares + rest * rest));
        Some((squares - sum * sum / times.len() as f64, exponent))
    };
    let best = (0..=STARTS).filter_map(fit).min_by(|one, other| one.0.total_cmp(&other.0));
    best.map(|(_, exponent)| exponent)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::Quantity;
    use crate::scene::EquationOfState;

    const WATER: Liquid = Liquid {
        density: 1000.0,
        surface_tension: 0.074,
        viscosity: 0.0,
        sound_speed: None,
        equation_of_state: EquationOfState::Linear,
    };

    /// Time, radius and energy of the surface.
    fn history(rows: impl Iterator<Item = [f64; 3]>) -> History {
        let quantity = |name: &str| Quantity { name: name.to_owned(), unit: "1" };
        let mut history = History::new(["time", "radius", "surface energy"].map(quantity).to_vec());
        rows.for_each(|row| history.push(row.to_vec()));
        history
    }

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
    fn the_growth_of_a_bridge_is_recovered() {
        for exponent in [0.4, 0.5, 0.6, 1.0] {
            let times: Vec<f64> = (0..200).map(|k| 1e-9 * f64::from(k)).collect();
            let values: Vec<f64> = times.iter().map(|t| 3.0 * (t + 7e-9f64).powf(exponent)).collect();
            let found = growth_exponent(&times, &values).unwrap();
            assert!((found - exponent).abs() < 0.01, "{exponent}: {found}");
        }
        assert!(growth_exponent(&[0.0; 3], &[1.0; 3]).is_none());
        let bridge = Bridge { radius: 1e-6, other: 0.5e-6 };
        let rate = 1.3f64.powi(2) * (0.074 * 2.0 / 3.0 * 1e-6 / 1000.0f64).sqrt();
        // The bridge is as wide as the range at row 77; later surface may come back.
        let surface = |k: i32| match k {
            ..20 => 2.0,
            20..40 => 1.0,
            40..77 => 1.1,
            _ => 9.0,
        };
        let row = |k: i32| {
            let time = 1e-10 * f64::from(k);
            [time, (2e-14 + rate * time).sqrt(), surface(k)]
        };
        let outcomes = evaluate(&history((0..400).map(row)), "radius", &WATER, bridge);
        assert!((outcomes[0].value - 0.5).abs() < 0.005, "{outcomes:?}");
        assert!((outcomes[1].value - 0.05).abs() < 1e-12, "{outcomes:?}");
        assert!((outcomes[2].value - 1.3).abs() < 1e-6, "{outcomes:?}");
        let coarse = evaluate(&history((20..400).map(row)), "radius", &WATER, bridge);
        for outcome in [&coarse[0], &coarse[2]] {
            assert!(outcome.value.is_nan() && outcome.doubt.as_ref().unwrap().contains("finer particles"));
        }
        let short = evaluate(&history((0..10).map(row)), "radius", &WATER, bridge);
        let sparse = evaluate(&history((0..400).step_by(20).map(row)), "radius", &WATER, bridge);
        let unseen = |k: i32| [1e-10 * f64::from(k), f64::NAN, 1.0];
        let unseen = evaluate(&history((0..400).map(unseen)), "radius", &WATER, bridge);
        for (outcomes, reason) in [
            (short, "the run ends before"),
            (sparse, "fewer than 8 times"),
            (unseen, "nothing tells where the surface lies"),
        ] {
            for outcome in [&outcomes[0], &outcomes[2]] {
                let doubt = outcome.doubt.as_ref().unwrap();
                assert!(doubt.contains(reason) && !doubt.contains("; use finer particles"), "{doubt}");
            }
        }
    }

    #[test]
    fn the_exact_bridge_has_no_error() {
        let bridge = Bridge { radius: 1e-6, other: 1e-6 };
        let [times, radii] = evenly(&bridge.exact(&WATER), 0.2e-6, 0.499e-6).unwrap();
        let rows = times.iter().zip(&radii).map(|(time, radius)| [*time, *radius, 1.0]);
        let outcomes = evaluate(&history(rows), "radius", &WATER, bridge);
        for outcome in [&outcomes[0], &outcomes[2]] {
            assert!(outcome.relative_error().unwrap().abs() < 0.01, "{outcome:?}");
        }
    }
}
