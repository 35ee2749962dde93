//! The thread of a jet that tears.

use super::boundary_integral::Flow;
use super::evaluate::Outcome;
use super::exact::Drop;
use super::growth::slope;
use super::history::History;
use super::neck::{crossing, evenly};
use crate::scene::Liquid;

/// Least radius of a thread.
pub(super) const COLUMNS: [(&str, &str); 1] = [("thread radius", "m")];

/// Least radius of a thread that is fitted, in particle sizes.
const FINEST: f64 = 2.0;
/// Largest one, in radii of the jet.
const WIDEST: f64 = 0.25;
/// Distance of the exact flow's nodes over the smaller radius of curvature: h(t) is good to 1e-3 of its length, the
/// prefactor of h to .5 %.
const FINENESS: f64 = 0.25;
/// The exact flow goes on to this radius of its thread, in radii of the jet.
const THINNEST: f64 = 0.02;

/// A jet along z with the velocity v sin(k z/R).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet {
    /// R in m.
    pub radius: f64,
    /// k, over the radius.
    pub wavenumber: f64,
    /// v in m/s.
    pub speed: f64,
}

impl Jet {
    /// Times in s and least radii in m of the jet if its liquid has no viscosity and is incompressible; takes about a
    /// second to compute.
    pub fn exact(&self, liquid: &Liquid) -> [Vec<f64>; 2] {
        let Jet { radius, wavenumber, speed } = *self;
        let velocity = Drop::of(liquid, radius).capillary_velocity();
        let flow = Flow::jet(wavenumber, speed / velocity, FINENESS);
        let [mut times, mut radii] = flow.narrowest_until(|narrowest| narrowest < THINNEST);
        times.iter_mut().for_each(|time| *time *= radius / velocity);
        radii.iter_mut().for_each(|narrowest| *narrowest *= radius);
        [times, radii]
    }
}

/// How a thread tears: h = c (sigma (t_0 - t)^2/rho)^(1/3), in the end with c = .7 (Day, Hinch and Lister 1998). A thread
/// that still feels the jet is slower, so the exact value is that of the exact flow in the same range of h; and when it comes
/// to that range.
pub(super) fn evaluate(
    history: &History,
    column: &str,
    liquid: &Liquid,
    (jet, particle_size): (Jet, f64),
) -> Vec<Outcome> {
    let (times, values) = (history.of("time"), history.of(column));
    let [finest, widest] = [FINEST * particle_size, WIDEST * jet.radius];
    let end = values.iter().position(|value| *value < finest);
    let end_or_all = end.unwrap_or(values.len());
    let wide = values[..end_or_all].iter().rposition(|value| *value > widest);
    let start = wide.map_or(0, |last| last + 1);
    let torn = end.is_some() && end_or_all >= start + 8;
    let exact = if torn { jet.exact(liquid) } else { Default::default() };
    let measured = torn.then(|| prefactor(&times[start..end_or_all], &values[start..end_or_all], liquid));
    let in_range = evenly(&exact, widest, finest);
    let mut outcomes = vec![
        Outcome::of("pinch-off-prefactor".to_owned(), measured.flatten(), "1"),
        Outcome::of("thread-time".to_owned(), torn.then(|| times[start]), "s"),
    ];
    outcomes[0].reference = in_range.and_then(|[times, values]| prefactor(&times, &values, liquid));
    outcomes[1].reference = crossing(&exact[0], &exact[1], widest);
    if !torn {
        let least = "the run ends before the jet tears, or it is observed fewer than 8 times on its way";
        for outcome in &mut outcomes {
            outcome.doubt = Some(format!("there is no `{}`: {least}", outcome.name));
        }
    }
    outcomes
}

/// c from the slope of h^(3/2), which needs no t_0.
fn prefactor(times: &[f64], values: &[f64], liquid: &Liquid) -> Option<f64> {
    let powers: Vec<f64> = values.iter().map(|value| value.powf(1.5)).collect();
    let unit = (liquid.surface_tension / liquid.density).sqrt();
    slope(times, &powers).map(|rate| (-rate / unit).max(0.0).powf(2.0 / 3.0))
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
    const JET: Jet = Jet { radius: 1e-6, wavenumber: 0.628, speed: 1.0 };

    fn history(rows: impl Iterator<Item = [f64; 2]>) -> History {
        let quantity = |name: &str| Quantity { name: name.to_owned(), unit: "1" };
        let mut history = History::new(["time", "radius"].map(quantity).to_vec());
        rows.for_each(|row| history.push(row.to_vec()));
        history
    }

    #[test]
    fn the_tear_of_a_thread_is_recovered() {
        let tear = 1e-7;
        let thread = |t: f64| 0.65 * (0.074 / 1000.0 * (tear - t).powi(2)).cbrt();
        let rows = (0..1000).map(|k| 1e-10 * f64::from(k)).map(|t| [t, thread(t)]);
        let outcomes = evaluate(&history(rows), "radius", &WATER, (JET, 2e-8));
        assert!((outcomes[0].value - 0.65).abs() < 1e-9, "{outcomes:?}");
        let short = (0..300).map(|k| 1e-10 * f64::from(k)).map(|t| [t, thread(t)]);
        let outcomes = evaluate(&history(short), "radius", &WATER, (JET, 2e-8));
        assert!(outcomes[0].value.is_nan() && outcomes[0].doubt.as_ref().unwrap().contains("before the jet"));
    }

    #[test]
    fn the_exact_thread_has_no_error() {
        let [times, radii] = JET.exact(&WATER);
        let rows = (0..9900).map(|k| 1e-10 * f64::from(k));
        let rows = rows.filter_map(|t| {
            let after = times.iter().position(|time| *time > t)?;
            let part = (t - times[after - 1]) / (times[after] - times[after - 1]);
            Some([t, radii[after - 1] + part * (radii[after] - radii[after - 1])])
        });
        for outcome in evaluate(&history(rows), "radius", &WATER, (JET, 2e-8)) {
            assert!(outcome.relative_error().unwrap().abs() < 2e-3, "{outcome:?}");
        }
    }
}
