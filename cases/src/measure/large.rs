//! The oscillation of a drop at an amplitude that is not small.

use super::evaluate::{Outcome, oscillation_fit};
use super::exact::Drop;
use super::fit;
use super::history::History;
use super::motion::mass_sum;
use super::observe::Particles;
use super::potential::PotentialDrop;
use crate::scene::Liquid;
use meniscus_engine::lanes::Lanes;
use std::f64::consts::PI;
use std::ops::Range;

/// Mean of s^2 P_2(cos theta) over the mass, over the square of the equal sphere's radius.
pub(super) const COLUMNS: [(&str, &str); 1] = [("elongation", "1")];

/// A spheroid with a flow (-r, 2 z) v/(2 R), where R is the radius of the sphere of the same volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// Across the axis of symmetry.
    pub radial: f64,
    /// Along it.
    pub axial: f64,
    /// v in m/s.
    pub speed: f64,
}

impl Start {
    /// Radius in m of the sphere of the same volume.
    pub fn radius(&self) -> f64 {
        (self.radial * self.radial * self.axial).cbrt()
    }

    /// The exact elongations of a drop of an inviscid liquid at ever later times in s.
    pub fn elongations(&self, liquid: &Liquid, times: &[f64]) -> Vec<f64> {
        let drop = Drop::of(liquid, self.radius());
        let unit = drop.radius / drop.capillary_velocity();
        let times: Vec<f64> = times.iter().map(|time| time / unit).collect();
        PotentialDrop::default()
            .moments((self.axial / self.radial, self.speed / drop.capillary_velocity()), &times)
    }
}

/// About the centre of mass.
pub(super) fn observe(particles: &Particles, start: Start) -> Vec<f64> {
    let load = |column: &[f64], eight: &Range<usize>| Lanes::load_or(&column[eight.clone()], 0.0);
    let len = particles.r.len();
    let (sum, mass) = mass_sum(len, |eight| [load(particles.z, &eight), load(particles.mass, &eight)]);
    let centre = Lanes::splat(sum / mass);
    let (moment, _) = mass_sum(len, |eight| {
        let (r, z) = (load(particles.r, &eight), load(particles.z, &eight) - centre);
        [z * z - Lanes::HALF * r * r, load(particles.mass, &eight)]
    });
    vec![moment / mass / start.radius().powi(2)]
}

/// The frequency of a damped oscillation that is fitted alike to the run and to the potential flow (their own
/// is no harmonic), what that is below Rayleigh's, and how far apart both motions are.
pub(super) fn evaluate(history: &History, column: &str, liquid: &Liquid, start: Start) -> Vec<Outcome> {
    let drop = Drop { viscosity: 0.0, ..Drop::of(liquid, start.radius()) };
    let times = history.of("time");
    let exact = start.elongations(liquid, &times);
    let measured = history.of(column);
    let rayleigh = drop.mode(2);
    let found = rayleigh.and_then(|mode| oscillation_fit(history, column, mode, 0.0));
    let expected = rayleigh.and_then(|mode| fit::oscillation(&times, &exact, mode));
    let slowdown = |frequency: f64| 2.0 * PI * frequency / drop.angular_frequency(2) - 1.0;
    let squares = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>();
    let apart = squares(&mut measured.iter().zip(&exact).map(|(a, b)| a - b));
    let scale = squares(&mut exact.iter().copied());
    let apart = found.map(|_| (apart / scale).sqrt()).filter(|apart| apart.is_finite());
    let mut outcomes = vec![
        Outcome::of("large-frequency".to_owned(), found.map(|fit| fit.frequency()), "Hz"),
        Outcome::of("frequency-shift".to_owned(), found.map(|fit| slowdown(fit.frequency())), "1"),
        Outcome::of("motion-error".to_owned(), apart, "1").against(0.0),
    ];
    if let Some(expected) = expected {
        outcomes[0].reference = Some(expected.frequency());
        outcomes[1].reference = Some(slowdown(expected.frequency()));
    }
    outcomes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::Quantity;
    use crate::scene::EquationOfState;

    #[test]
    fn the_exact_motion_has_no_error() {
        let liquid = Liquid {
            density: 1000.0,
            surface_tension: 0.074,
            viscosity: 0.0,
            sound_speed: None,
            equation_of_state: EquationOfState::Linear,
        };
        let start = Start { radial: 1e-6, axial: 1.5e-6, speed: 0.0 };
        let unit = (1000.0 * start.radius().powi(3) / 0.074).sqrt();
        let times: Vec<f64> = (0..400).map(|k| 0.02 * unit * f64::from(k)).collect();
        let quantity = |name: &str| Quantity { name: name.to_owned(), unit: "1" };
        let outcomes_of = |factor: f64| {
            let mut history = History::new(vec![quantity("time"), quantity("elongation")]);
            let faster: Vec<f64> = times.iter().map(|time| factor * time).collect();
            let values = start.elongations(&liquid, &faster);
            times.iter().zip(values).for_each(|(time, value)| history.push(vec![*time, value]));
            evaluate(&history, "elongation", &liquid, start)
        };
        let outcomes = outcomes_of(1.0);
        assert!(outcomes[0].relative_error().unwrap().abs() < 1e-9, "{outcomes:?}");
        assert!((outcomes[1].value + 0.039).abs() < 0.001, "{outcomes:?}");
        assert!(outcomes[2].value < 1e-9, "{outcomes:?}");
        let outcomes = outcomes_of(1.01);
        assert!((outcomes[0].relative_error().unwrap() - 0.01).abs() < 1e-3, "{outcomes:?}");
        assert!(outcomes[2].value > 0.1, "{outcomes:?}");
    }
}
