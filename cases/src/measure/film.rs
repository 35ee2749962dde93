//! A film about a plane z = const whose two edges draw back.

use super::evaluate::Outcome;
use super::growth::slope;
use super::history::History;
use super::observe::Particles;
use crate::assemble::Physics;
use crate::scene::Liquid;
use std::f64::consts::PI;

/// Momentum per length of edge, and how far tips and fronts have come: means over both edges.
pub(super) const COLUMNS: [(&str, &str); 3] =
    [("edge momentum", "kg/s"), ("tip position", "m"), ("front position", "m")];

/// Local thickness over that of the film from which on it counts as its rim.
const RIM: f64 = 1.12;

/// One row. Both edges are told apart by the film's centre of mass.
pub(super) fn observe(particles: &Particles, physics: &Physics, thickness: f64) -> Vec<f64> {
    let mass: f64 = particles.mass.iter().sum();
    let mean = |values: &[f64]| values.iter().zip(particles.mass).map(|(v, m)| v * m).sum::<f64>() / mass;
    let (middle, plane) = (mean(particles.r), mean(particles.z));
    let mut edges = [f64::INFINITY, f64::NEG_INFINITY];
    let mut momenta = [0.0; 2];
    for i in 0..particles.r.len() {
        let r = particles.r[i];
        let side = usize::from(r > middle);
        edges = [edges[0].min(r), edges[1].max(r)];
        momenta[side] += particles.mass[i] * particles.velocity[0][i];
    }
    let fronts = fronts(particles, edges, (plane, thickness), 2.0 * physics.particle_size);
    let per_length = |k: usize| momenta[k] / (2.0 * PI * (physics.domain.origin + edges[k]));
    vec![0.5 * (per_length(0) - per_length(1)), 0.5 * (edges[0] - edges[1]), 0.5 * (fronts[0] - fronts[1])]
}

/// Where the rims end: the way from each edge to the first slice (of a width in m) that is as thin as the
/// film. A layer's thickness is four times the mean distance from its middle.
fn fronts(particles: &Particles, edges: [f64; 2], (plane, thickness): (f64, f64), width: f64) -> [f64; 2] {
    let slices = ((edges[1] - edges[0]) / width) as usize + 1;
    let (mut masses, mut moments) = (vec![0.0; slices], vec![0.0; slices]);
    for i in 0..particles.r.len() {
        let slice = (((particles.r[i] - edges[0]) / width) as usize).min(slices - 1);
        masses[slice] += particles.mass[i];
        moments[slice] += particles.mass[i] * (particles.z[i] - plane).abs();
    }
    // The tip itself is thin, too: the rim begins behind it.
    let way = |order: &mut dyn Iterator<Item = usize>| {
        let thick = |slice: usize| 4.0 * moments[slice] > RIM * thickness * masses[slice];
        let (mut inside, mut count) = (false, 0.0);
        for slice in order {
            if inside && !thick(slice) {
                return count * width;
            }
            inside |= thick(slice);
            count += 1.0;
        }
        0.0
    };
    [edges[0] + way(&mut (0..slices)), edges[1] - way(&mut (0..slices).rev())]
}

/// A rim that stays a circle and takes up the film: where its front and its tip are.
struct CircularRim {
    thickness: f64,
    speed: f64,
}

impl CircularRim {
    /// Front and tip in m at a time in s: s^2/2 - sqrt(h/pi) s^1.5/3 = U^2 t^2/2 for the length s of film
    /// that the circle has taken up.
    fn at(&self, time: f64) -> [f64; 2] {
        let ratio = (self.thickness / PI).sqrt();
        let target = 0.5 * (self.speed * time).powi(2);
        let mut length = self.speed * time + self.thickness;
        for _ in 0..100 {
            let value = 0.5 * length * length - ratio * length.powf(1.5) / 3.0 - target;
            let derivative = length - 0.5 * ratio * length.sqrt();
            length -= value / derivative;
        }
        [length, length - 2.0 * ratio * length.sqrt()]
    }
}

/// What the whole run says. `columns` are the names of this measure's columns.
pub(super) fn evaluate(
    history: &History,
    columns: &[String],
    liquid: &Liquid,
    thickness: f64,
) -> Vec<Outcome> {
    let unit = (liquid.density * thickness.powi(3) / liquid.surface_tension).sqrt();
    let speed = (2.0 * liquid.surface_tension / (liquid.density * thickness)).sqrt();
    let times = history.of("time");
    let end = times.last().copied().unwrap_or(0.0);
    let window = |from: f64, to: f64, values: &[f64]| -> Option<f64> {
        let chosen = times.iter().zip(values).filter(|(t, _)| **t >= from && **t <= to);
        let (places, values): (Vec<f64>, Vec<f64>) = chosen.unzip();
        (places.len() >= 5).then(|| slope(&places, &values)).flatten()
    };
    let rim = CircularRim { thickness, speed };
    // Speeds over the second half of the run; the model's come out of the same fit.
    let both = |name: &str, column: usize, model: usize| {
        let measured = window(0.5 * end, end, &history.of(&columns[column]));
        let exact: Vec<f64> = times.iter().map(|time| rim.at(*time)[model]).collect();
        let outcome = Outcome::of(name.to_owned(), measured, "m/s");
        match window(0.5 * end, end, &exact) {
            Some(exact) => outcome.against(exact),
            None => outcome,
        }
    };
    let rate = window(unit, 6.0 * unit, &history.of(&columns[0]));
    vec![
        Outcome::of("momentum-rate".to_owned(), rate, "N/m").against(2.0 * liquid.surface_tension),
        both("tip-speed", 1, 1),
        both("front-speed", 2, 0),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rim_has_the_known_speeds() {
        let rim = CircularRim { thickness: 1.0, speed: 2.0f64.sqrt() };
        for (time, front, tip) in [(10.0, 1.025, 0.875), (100.0, 1.008, 0.961)] {
            let [before, after] = [rim.at(time - 1e-3), rim.at(time + 1e-3)];
            let speed = |k: usize| (after[k] - before[k]) / (2e-3 * rim.speed);
            assert!((speed(0) - front).abs() < 1e-3 && (speed(1) - tip).abs() < 1e-3, "{time}");
        }
    }
}
