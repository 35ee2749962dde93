//! The thread of a jet that tears.

use super::boundary_integral::{Flow, Surface, weight};
use super::curve::{crossing, evenly};
use super::evaluate::Outcome;
use super::exact::Drop;
use super::growth::slope;
use super::history::History;
use super::observe::Particles;
use crate::assemble::Physics;
use crate::scene::Liquid;
use std::f64::consts::PI;

/// Least radius of a thread.
pub(super) const COLUMNS: [(&str, &str); 1] = [("thread radius", "m")];

/// Least radius of a thread that is fitted, in particle sizes.
const FINEST: f64 = 2.0;
/// Largest one, in radii of the jet.
const WIDEST: f64 = 0.25;
/// Distance of the exact flow's nodes over the smaller radius of curvature: times are good to 2e-4, the prefactor
/// to 1 %.
const FINENESS: f64 = 0.25;
/// The exact flow goes on until the thread is as thin as this part of the reach.
const THINNEST: f64 = 0.6;
/// Heights, in particle sizes to either side, over which the thread's radius is a mean; the exact one's alike.
const REACH: f64 = 3.0;
/// Distance of the heights that are looked at, in particle sizes.
const STEP: f64 = 0.25;

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
    /// Times in s and radii in m of the thread, by the mean over heights within `reach` m, of the jet if its liquid
    /// has no viscosity and is incompressible; takes about a second to compute.
    pub fn exact(&self, liquid: &Liquid, reach: f64) -> [Vec<f64>; 2] {
        let Jet { radius, wavenumber, speed } = *self;
        let velocity = Drop::of(liquid, radius).capillary_velocity();
        let flow = Flow::jet(wavenumber, speed / velocity, FINENESS);
        let thinnest = |surface: &Surface| Some(surface.least_mean_square(reach / radius).sqrt());
        let [mut times, mut radii] = flow.observed(thinnest, |thinnest| thinnest < THINNEST * reach / radius);
        times.iter_mut().for_each(|time| *time *= radius / velocity);
        radii.iter_mut().for_each(|thinnest| *thinnest *= radius);
        [times, radii]
    }
}

/// The least radius of a thread that is fitted, and the reach of the mean, in m.
pub fn limits(particle_size: f64) -> [f64; 2] {
    [FINEST * particle_size, REACH * particle_size]
}

/// The radius of the cylinder that has the least volume to a length: a mean over heights near one, for particles
/// are too few to tell where the surface of a thin thread lies. NaN where the domain has no period.
pub(super) fn observe(particles: &Particles, physics: &Physics) -> Vec<f64> {
    let Some((bottom, length)) = physics.domain.period else { return vec![f64::NAN] };
    let reach = REACH * physics.particle_size;
    let places = (length / (STEP * physics.particle_size)).ceil();
    let distance = length / places;
    let mut areas = vec![0.0; places as usize];
    for (k, z) in particles.z.iter().enumerate() {
        let volume = particles.mass[k] / particles.density[k];
        let (first, last) =
            (((z - bottom - reach) / distance).ceil(), ((z - bottom + reach) / distance).floor());
        for place in first as i64..=last as i64 {
            let away = z - bottom - place as f64 * distance;
            areas[place.rem_euclid(places as i64) as usize] += volume * weight(away / reach) / reach;
        }
    }
    vec![(areas.into_iter().fold(f64::INFINITY, f64::min) / PI).sqrt()]
}

/// How a thread tears: h = c (sigma (t_0 - t)^2/rho)^(1/3), in the end with c = .7 (Day, Hinch and Lister 1998). A
/// thread that still feels the jet is slower, so the exact value is that of the exact flow in the same range of h;
/// and when it comes to that range.
pub(super) fn evaluate(
    history: &History,
    column: &str,
    liquid: &Liquid,
    (jet, particle_size): (Jet, f64),
) -> Vec<Outcome> {
    let (times, values) = (history.of("time"), history.of(column));
    let ([finest, reach], widest) = (limits(particle_size), WIDEST * jet.radius);
    let end = values.iter().position(|value| *value < finest);
    let end_or_all = end.unwrap_or(values.len());
    let wide = values[..end_or_all].iter().rposition(|value| *value > widest);
    let start = wide.map_or(0, |last| last + 1);
    let torn = end.is_some() && end_or_all >= start + 8;
    let exact = if torn { jet.exact(liquid, reach) } else { Default::default() };
    let measured = torn.then(|| prefactor(&times[start..end_or_all], &values[start..end_or_all], liquid));
    let in_range = evenly(&exact, widest, finest);
    let outcome = |name: &str, value, unit| {
        let why = "the run ends before the jet tears, or it is observed fewer than 8 times on its way";
        Outcome::of(name.to_owned(), value, unit).lacking(why)
    };
    let mut outcomes = vec![
        outcome("pinch-off-prefactor", measured.flatten(), "1"),
        outcome("thread-time", torn.then(|| times[start]), "s"),
    ];
    outcomes[0].reference = in_range.and_then(|[times, values]| prefactor(&times, &values, liquid));
    outcomes[1].reference = crossing(&exact[0], &exact[1], widest);
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
    use crate::measure::curve::at;
    use crate::measure::{Observer, Quantity};
    use crate::scene::{EquationOfState, parse};
    use crate::simulation::{Simulation, to_the_end};

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

    /// A cylinder with a belt of a third of its radius less, longer than the reach of the mean.
    #[test]
    fn the_radius_of_a_thread_is_found_by_its_volume() {
        let cylinder = |radius: &str, half: &str| {
            let ends = format!("bottom = \"-{half} um\", top = \"{half} um\"");
            format!("{{ cylinder = {{ radius = \"{radius} um\", {ends} }} }}")
        };
        let [jet, belt, core] =
            [("1.2", "3"), ("1.5", "0.5"), ("0.8", "0.5")].map(|(r, half)| cylinder(r, half));
        let thread = format!("{{ union = [{{ difference = [{jet}, {belt}] }}, {core}] }}");
        let scene = format!(
            "format = 1\n[liquid]\ndensity = \"1000 kg/m3\"\nsurface_tension = \"0.074 N/m\"\n\
             [domain]\nperiod = \"6 um\"\n[[body]]\nshape = {thread}\n\
             [particles]\nsize = \"50 nm\"\n[run]\nuntil = \"1 us\"\n\
             [[measure]]\npinch-off = {{ radius = \"1 um\", wavenumber = 0.6, speed = \"1 m/s\" }}\n"
        );
        let scene = parse("thread.toml", &scene, &[]).unwrap();
        let simulation = Simulation::new(&scene, &mut to_the_end).unwrap();
        let row = Observer::new(&scene, &simulation).observe(&simulation);
        let found = row[row.len() - 1] / 0.8e-6;
        assert!((0.98..1.005).contains(&found), "{found}");
    }

    #[test]
    fn the_exact_thread_has_no_error() {
        let [times, radii] = JET.exact(&WATER, 6e-8);
        let until = *times.last().unwrap();
        let rows = (0..9900).map(|k| 1e-10 * f64::from(k)).filter(|t| *t < until);
        let rows = rows.map(|t| [t, at(&times, &radii, t)]);
        for outcome in evaluate(&history(rows), "radius", &WATER, (JET, 2e-8)) {
            assert!(outcome.relative_error().unwrap().abs() < 2e-3, "{outcome:?}");
        }
    }
}
