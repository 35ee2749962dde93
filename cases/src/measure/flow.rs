//! Flows without surface tension: a free spheroid, Noh's shock, the impact of two layers.

use super::evaluate::Outcome;
use super::growth::slope;
use super::history::History;
use super::observe::Particles;
use super::spheroid::Spheroid;
use crate::assemble::Physics;
use crate::scene::{EquationOfState, Liquid};
use std::f64::consts::PI;

/// Semi-axes from the second moments.
pub(super) const SEMI_AXES: [(&str, &str); 2] = [("radial semi-axis", "m"), ("axial semi-axis", "m")];
/// Density behind the shock: mass over volume, and what the particles there carry.
pub(super) const PLATEAU: [(&str, &str); 2] = [("plateau density", "kg/m3"), ("carried density", "kg/m3")];
/// Thickness at rest of what a shock has stopped, and the pressure there.
pub(super) const SHOCK: [(&str, &str); 2] = [("shocked length", "m"), ("plateau pressure", "Pa")];

/// Part of the shock's distance within which the plateau is measured: outside of the zone that the wall
/// heats, and behind the smeared front.
const PLATEAU_ZONE: [f64; 2] = [0.4, 0.8];

/// sqrt(5/2 <r^2>) and sqrt(5 <z^2>), means over the mass.
pub(super) fn observe_semi_axes(particles: &Particles) -> Vec<f64> {
    let mass: f64 = particles.mass.iter().sum();
    let mean = |values: &[f64]| {
        let squares = values.iter().zip(particles.mass).map(|(v, m)| v * v * m);
        squares.sum::<f64>() / mass
    };
    vec![(2.5 * mean(particles.r)).sqrt(), (5.0 * mean(particles.z)).sqrt()]
}

/// Mean densities behind the shock r = speed (heat ratio - 1)/2 t; 0 where no particle is. A cylinder is
/// one period high.
pub(super) fn observe_plateau(
    particles: &Particles,
    physics: &Physics,
    liquid: &Liquid,
    (dimensions, speed, time): (u32, f64, f64),
) -> Vec<f64> {
    let front = 0.5 * (heat_ratio(liquid) - 1.0) * speed * time;
    let distance = |i: usize| {
        let r = particles.r[i] + physics.domain.origin;
        if dimensions == 2 { r } else { r.hypot(particles.z[i]) }
    };
    let inside = |i: &usize| (PLATEAU_ZONE[0] * front..PLATEAU_ZONE[1] * front).contains(&distance(*i));
    let (mass, volume) = (0..particles.r.len()).filter(inside).fold((0.0, 0.0), |(mass, volume), i| {
        (mass + particles.mass[i], volume + particles.mass[i] / particles.density[i])
    });
    let powers = PLATEAU_ZONE.map(|part| (part * front).powi(dimensions as i32));
    let height = physics.domain.period.map_or(f64::NAN, |(_, height)| height);
    let zone = (powers[1] - powers[0]) * if dimensions == 2 { PI * height } else { 4.0 * PI / 3.0 };
    let over = |volume: f64| if volume > 0.0 { mass / volume } else { 0.0 };
    vec![over(zone), over(volume)]
}

fn heat_ratio(liquid: &Liquid) -> f64 {
    match liquid.equation_of_state {
        EquationOfState::IdealGas { heat_ratio } => heat_ratio,
        // Density behind the strongest shock of a liquid: not limited like that of a gas.
        _ => f64::NAN,
    }
}

/// What has lost its speed, as a thickness at rest of each layer; and the mean pressure at |r| within half
/// of that.
pub(super) fn observe_shock(particles: &Particles, physics: &Physics, speed: f64, length: f64) -> Vec<f64> {
    let (mut moving, mut mass) = (0.0, 0.0);
    for i in 0..particles.r.len() {
        // Inward counts, so that the noise behind the shock cancels.
        moving -= particles.mass[i] * particles.velocity[0][i] * particles.r[i].signum() / speed;
        mass += particles.mass[i];
    }
    let stopped = (1.0 - moving / mass) * length;
    let near = |i: &usize| particles.r[*i].abs() < 0.5 * stopped;
    let (sum, weight) = (0..particles.r.len()).filter(near).fold((0.0, 0.0), |(sum, weight), i| {
        let pressure = physics.equation.pressure(particles.density[i], particles.internal_energy(i));
        (sum + particles.mass[i] * pressure, weight + particles.mass[i])
    });
    vec![stopped, if weight > 0.0 { sum / weight } else { 0.0 }]
}

/// The semi-axis that is farthest from the exact one at any time, and at the end.
pub(super) fn evaluate_semi_axes(history: &History, columns: &[String], start: Spheroid) -> Vec<Outcome> {
    let measured = [history.of(&columns[0]), history.of(&columns[1])];
    let exact = start.at_times(&history.of("time"));
    let worst_of = |rows: std::ops::Range<usize>| {
        let pairs = rows.flat_map(|row| [0, 1].map(|axis| (measured[axis][row], exact[row][axis])));
        let error = |pair: &(f64, f64)| (pair.0 / pair.1 - 1.0).abs();
        pairs.max_by(|one, other| error(one).total_cmp(&error(other)))
    };
    let outcome = |name: &str, worst: Option<(f64, f64)>| {
        let outcome = Outcome::of(name.to_owned(), worst.map(|(value, _)| value), "m");
        worst.map_or(outcome.clone(), |(_, exact)| outcome.against(exact))
    };
    let rows = exact.len();
    // The start is the packing's, not the flow's.
    vec![
        outcome("semi-axis", worst_of(1.min(rows)..rows)),
        outcome("semi-axis-end", worst_of(rows.saturating_sub(1)..rows)),
    ]
}

/// ((gamma + 1)/(gamma - 1))^d of the density at rest.
pub(super) fn evaluate_plateau(
    history: &History,
    columns: &[String],
    liquid: &Liquid,
    dimensions: u32,
) -> Vec<Outcome> {
    let ratio = heat_ratio(liquid);
    let compression = ((ratio + 1.0) / (ratio - 1.0)).powi(dimensions as i32);
    let outcome = |name: &str, column: usize| {
        let last = history.of(&columns[column]).last().copied().filter(|density| *density > 0.0);
        let outcome = Outcome::of(name.to_owned(), last, "kg/m3").against(liquid.density * compression);
        outcome.lacking("no particles are behind the shock yet, or there is none")
    };
    vec![outcome("plateau-density", 0), outcome("carried-density", 1)]
}

/// Shock speed relative to what it runs into, on the adiabat c + s u, and the pressure rho D u behind it.
pub(super) fn evaluate_shock(
    history: &History,
    columns: &[String],
    liquid: &Liquid,
    (speed, length): (f64, f64),
) -> Vec<Outcome> {
    let times = history.of("time");
    let stopped = history.of(&columns[0]);
    // Neither the first contact nor the way out of the far side.
    let fit = times.iter().zip(&stopped).filter(|(_, s)| (0.2 * length..0.8 * length).contains(s));
    let (places, values): (Vec<f64>, Vec<f64>) = fit.unzip();
    let measured = (places.len() >= 5).then(|| slope(&places, &values)).flatten();
    let pressures = history.of(&columns[1]);
    let plateau = pressures.iter().zip(&stopped).filter(|(_, s)| (0.4 * length..0.8 * length).contains(s));
    let (sum, count) = plateau.fold((0.0, 0.0), |(sum, count), (p, _)| (sum + p, count + 1.0));
    let why =
        "no shock is seen to go from a fifth to four fifths of a layer's `length`, in 5 outputs at least";
    let outcome = |name: &str, value, unit| Outcome::of(name.to_owned(), value, unit).lacking(why);
    let mut shock = outcome("shock-speed", measured, "m/s");
    let mut plateau = outcome("plateau-pressure", (count > 0.0).then(|| sum / count), "Pa");
    if let (EquationOfState::MieGrueneisen { adiabat_slope, .. }, Some(rest)) =
        (liquid.equation_of_state, liquid.sound_speed)
    {
        let exact = rest + adiabat_slope * speed;
        shock = shock.against(exact);
        plateau = plateau.against(liquid.density * exact * speed);
    }
    vec![shock, plateau]
}
