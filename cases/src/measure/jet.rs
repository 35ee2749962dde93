//! A wave that grows on a jet until it breaks.

use super::evaluate::Outcome;
use super::growth;
use super::history::History;
use super::motion::mass_sums;
use super::observe::Particles;
use super::viscous::jet_growth_rate;
use crate::assemble::Physics;
use crate::scene::Liquid;
use meniscus_engine::lanes::Lanes;
use std::f64::consts::PI;

/// Both parts of the wave's amplitude over the radius, the smallest radius of the surface, and the radius
/// of the smallest drop.
pub(super) const COLUMNS: [(&str, &str); 4] =
    [("jet cosine", "1"), ("jet sine", "1"), ("neck radius", "m"), ("smallest drop", "m")];

/// Amplitudes over the radius between which the growth counts as linear: at .1 the square's part of it would slow
/// the fitted growth by .3 %.
const LINEAR: [f64; 2] = [0.005, 0.05];
/// A jet is torn where its surface comes nearer to the axis than this, in particle sizes.
const TORN: f64 = 1.5;
/// Part of the liquid below which a piece is no drop.
const SPLINTER: f64 = 0.002;

/// One row. The amplitude is the mean of cos(k z) over the mass: epsilon for a surface R (1 + epsilon
/// cos(k z)).
pub(super) fn observe(particles: &Particles, physics: &Physics, wavenumber: f64, radius: f64) -> Vec<f64> {
    let (sums, mass) = mass_sums(particles.z.len(), |eight| {
        let phase = Lanes::splat(wavenumber / radius) * Lanes::load_or(&particles.z[eight.clone()], 0.0);
        let (sine, cosine) = phase.sin_cos();
        ([cosine, sine], Lanes::load_or(&particles.mass[eight], 0.0))
    });
    let [cosine, sine] = sums.map(|sum| sum / mass);
    let slices = Slices::of(particles, physics);
    let surface = slices.surface(particles);
    let neck = surface.iter().fold(f64::INFINITY, |least, r| least.min(*r));
    let is_torn = surface.contains(&0.0);
    let smallest = if is_torn { slices.smallest_drop(&slices.volumes(particles)) } else { 0.0 };
    vec![cosine, sine, neck, smallest]
}

/// Slices of two particle sizes across the axis.
struct Slices {
    bottom: f64,
    inverse_length: f64,
    count: usize,
    is_periodic: bool,
}

impl Slices {
    fn of(particles: &Particles, physics: &Physics) -> Self {
        let (bottom, length) = physics.domain.period.unwrap_or_else(|| {
            let low = particles.z.iter().fold(f64::INFINITY, |a, z| a.min(*z));
            let high = particles.z.iter().fold(f64::NEG_INFINITY, |a, z| a.max(*z));
            (low, (high - low).max(physics.particle_size))
        });
        Slices {
            bottom,
            inverse_length: 1.0 / length,
            count: ((length / (2.0 * physics.particle_size)) as usize).max(1),
            is_periodic: physics.domain.period.is_some(),
        }
    }

    /// The slice in which a z (m) lies.
    fn number(&self, z: f64) -> usize {
        let place = (z - self.bottom) * self.inverse_length;
        (((place - place.floor()) * self.count as f64) as usize).min(self.count - 1)
    }

    /// Largest distances from the axis, m; zero in empty slices.
    fn surface(&self, particles: &Particles) -> Vec<f64> {
        let mut surface = vec![0.0f64; self.count];
        for (r, z) in particles.r.iter().zip(particles.z) {
            let largest = &mut surface[self.number(*z)];
            *largest = largest.max(*r);
        }
        surface
    }

    /// Volumes of the liquid, m3.
    fn volumes(&self, particles: &Particles) -> Vec<f64> {
        let mut volumes = vec![0.0; self.count];
        for (i, z) in particles.z.iter().enumerate() {
            volumes[self.number(*z)] += particles.mass[i] / particles.density[i];
        }
        volumes
    }

    /// Radius of the smallest of several pieces between empty slices; 0 while there is one.
    fn smallest_drop(&self, volumes: &[f64]) -> f64 {
        let Some(gap) = volumes.iter().position(|v| *v == 0.0) else {
            return 0.0;
        };
        let first = if self.is_periodic { gap } else { 0 };
        let whole: f64 = volumes.iter().sum();
        let (mut pieces, mut piece) = (Vec::new(), 0.0);
        for k in 0..=self.count {
            let volume = if k == self.count { 0.0 } else { volumes[(first + k) % self.count] };
            if volume > 0.0 {
                piece += volume;
            } else if piece > SPLINTER * whole {
                pieces.push(piece);
                piece = 0.0;
            } else {
                piece = 0.0;
            }
        }
        let smallest = pieces.iter().fold(f64::INFINITY, |least, v| least.min(*v));
        if pieces.len() < 2 { 0.0 } else { (0.75 * smallest / PI).cbrt() }
    }
}

/// The rate of growth in 1/s of a wave with k = k R, and of the decay of its other half over that: of the two,
/// the product is q0^2, exact without viscosity and for long waves. q0 is Rayleigh's rate without viscosity,
/// q0^2 = sigma/(rho R^3) k I1(k)/I0(k) (1 - k^2). `None` for waves too short to grow.
pub fn growth_of_wave(liquid: &Liquid, wavenumber: f64, radius: f64) -> Option<(f64, f64)> {
    let square = growth_square(liquid, (wavenumber, wavenumber), radius);
    (square > 0.0).then(|| {
        let rate = jet_growth_rate(wavenumber, square.sqrt(), radius, liquid.viscosity / liquid.density);
        (rate, square / (rate * rate))
    })
}

/// q^2 in 1/s2 of a wave with k = k R, whose potential inside is I0(kappa r/R).
fn growth_square(liquid: &Liquid, (wavenumber, kappa): (f64, f64), radius: f64) -> f64 {
    let [zeroth, first] = bessel(kappa);
    let scale = liquid.surface_tension / (liquid.density * radius.powi(3));
    scale * kappa * first / zeroth * (1.0 - wavenumber * wavenumber)
}

/// What the rate of growth is, over that of [`growth_of_wave`], if sound travels at a finite speed in m/s: it is
/// larger, because the potential grows faster towards the surface, kappa^2 = k^2 + (q R/C)^2. (Of a viscous jet the
/// ratio without viscosity.)
pub fn compressible_growth_ratio(liquid: &Liquid, wavenumber: f64, radius: f64, sound_speed: f64) -> f64 {
    let incompressible = growth_square(liquid, (wavenumber, wavenumber), radius);
    let next = |square: f64, _| {
        let kappa = wavenumber.hypot(square.sqrt() * radius / sound_speed);
        growth_square(liquid, (wavenumber, kappa), radius)
    };
    // Each round corrects by a part (q R/C)^2 of what is left.
    ((0..40).fold(incompressible, next) / incompressible).sqrt()
}

/// The modified Bessel functions I0 and I1 by their power series.
fn bessel(x: f64) -> [f64; 2] {
    let quarter = 0.25 * x * x;
    let (mut term, mut zeroth, mut first) = (1.0, 0.0, 0.0);
    for k in 0..60 {
        let k = f64::from(k);
        zeroth += term;
        first += 0.5 * x * term / (k + 1.0);
        term *= quarter / ((k + 1.0) * (k + 1.0));
    }
    [zeroth, first]
}

/// What the whole run says. `columns` are the names of this measure's columns.
pub(super) fn evaluate(
    history: &History,
    columns: &[String],
    (liquid, sound_speed): (&Liquid, f64),
    (wavenumber, radius, particle_size): (f64, f64, f64),
) -> Vec<Outcome> {
    let times = history.of("time");
    let exact = growth_of_wave(liquid, wavenumber, radius);
    let amplitudes = amplitude(history, columns);
    let rate = exact.and_then(|exact| {
        let (times, values) = linear_part(&times, &amplitudes);
        growth::fit(&times, &values, exact)
    });
    let largest = amplitudes.iter().fold(0.0f64, |most, amplitude| most.max(amplitude.abs()));
    let [least, most] = LINEAR;
    let why = match amplitudes.first() {
        Some(first) if first.abs() > most => {
            format!("the wave is larger than {most} of the radius from the start; start with a smaller one")
        }
        _ if largest > most => {
            format!("the wave is seen fewer than 8 times while it grows from {least} to {most} of the radius")
        }
        _ => "the run is too short".to_owned(),
    };
    let growth = ["growth-rate", "compressible-growth-rate"];
    let mut growth = growth.map(|name| Outcome::of(name.to_owned(), rate, "1/s").lacking(&why));
    if let Some((exact, _)) = exact {
        growth[0].reference = Some(exact);
        let ratio = compressible_growth_ratio(liquid, wavenumber, radius, sound_speed);
        growth[1].reference = Some(ratio * exact);
    }
    let [growth, compressible] = growth;
    let necks = history.of(&columns[2]);
    let torn = times.iter().zip(&necks).find(|(_, neck)| **neck < TORN * particle_size);
    let time = Outcome::of("pinch-off-time".to_owned(), torn.map(|(time, _)| *time), "s");
    let time = time.lacking("the run ends before the jet breaks");
    let satellite = history.of(&columns[3]).last().copied().filter(|radius| *radius > 0.0);
    let satellite = Outcome::of("satellite-radius".to_owned(), satellite, "m");
    let satellite = satellite.lacking("there are no two drops at the end");
    vec![growth, compressible, time, satellite]
}

/// The larger of both parts of the amplitude.
pub(super) fn amplitude(history: &History, columns: &[String]) -> Vec<f64> {
    let [cosine, sine] = [0, 1].map(|k| history.of(&columns[k]));
    let largest = |values: &[f64]| values.iter().fold(0.0f64, |most, v| most.max(v.abs()));
    if largest(&cosine) >= largest(&sine) { cosine } else { sine }
}

fn linear_part(times: &[f64], values: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let start = values.iter().position(|a| a.abs() >= LINEAR[0]).unwrap_or(values.len());
    let both = times.iter().zip(values).skip(start);
    both.take_while(|(_, a)| a.abs() <= LINEAR[1]).map(|(t, a)| (*t, *a)).unzip()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::Quantity;
    use crate::scene::EquationOfState;

    #[test]
    fn why_no_growth_is_told() {
        let liquid = Liquid {
            density: 1.0,
            surface_tension: 1.0,
            viscosity: 0.0,
            sound_speed: None,
            equation_of_state: EquationOfState::Linear,
        };
        let columns = COLUMNS.map(|(name, _)| name.to_owned());
        let quantity = |name: &str| Quantity { name: name.to_owned(), unit: "1" };
        for (start, step, why) in
            [(0.06, 0.1, "larger than 0.05"), (0.001, 3.0, "fewer than 8 times"), (0.001, 0.01, "too short")]
        {
            let mut history = History::new(
                ["time"].into_iter().chain(COLUMNS.map(|(name, _)| name)).map(quantity).collect(),
            );
            for time in (0..20).map(|k| step * f64::from(k)) {
                history.push(vec![time, start * (0.34 * time).exp(), 0.0, 1.0, 0.0]);
            }
            let outcomes = evaluate(&history, &columns, (&liquid, 10.0), (0.628, 1.0, 0.01));
            assert!(outcomes[0].doubt.as_ref().unwrap().contains(why), "{outcomes:?}");
        }
    }
}
