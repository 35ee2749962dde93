//! Ghost coupling: every surface particle meets one ghost that holds the Laplace pressure.

use crate::fields;
use crate::surface::for_surface;
use crate::surface_interval::COMPUTED;
use meniscus_engine::field::clear;
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Add, Read, Write};
use meniscus_engine::wiring::Wiring;

/// Impedance of a ghost relative to its particle's: nearly vacuum (method.md, section 8).
const IMPEDANCE_RATIO: f64 = 1e-6;

/// How far a ghost's weight may deviate from facing the surface, over one over the particle's size: in settled
/// packings and gentle flows it never deviates by more than 0.13.
pub(crate) const DISORDER: f64 = 0.2;

/// Surface tension's part of the coupling.
pub struct Tension {
    pressure: Read<f64>,
    rate: Read<f64>,
    facing: Option<([Read<f64>; 2], Read<f64>)>,
}

impl Tension {
    /// Reads the Laplace pressure, and the surface's tangent where the scene computes it.
    pub fn new(wiring: &mut Wiring, with_tangent: bool) -> Self {
        wiring.stage("ghost-coupling");
        let tangent = [&fields::SURFACE_TANGENT_R, &fields::SURFACE_TANGENT_Z];
        Tension {
            pressure: wiring.read(&fields::LAPLACE_PRESSURE),
            rate: wiring.read(&fields::LAPLACE_PRESSURE_RATE),
            facing: with_tangent
                .then(|| (tangent.map(|field| wiring.read(field)), wiring.read(&fields::SIZE))),
        }
    }
}

/// The part of a ghost's weight that faces the surface, whose unit tangent t has (-t_z, t_r) outward. A weight that
/// points inward or along the surface by more than disorder makes it comes from neighbours
/// that crowd on one side, in a torn surface, and no liquid is missing there: the Laplace pressure on it would
/// drive the particle along the surface, or out of it, without end.
pub(crate) fn facing(weight: [f64; 2], tangent: [f64; 2], disorder: f64) -> [f64; 2] {
    let [t_r, t_z] = tangent;
    let (outward, along) = (t_r * weight[1] - t_z * weight[0], t_r * weight[0] + t_z * weight[1]);
    let most = outward.max(0.0) + disorder;
    if outward >= -disorder && along.abs() <= most {
        return weight;
    }
    let (outward, along) = (outward.max(-disorder), along.clamp(-most, most));
    [along * t_r - outward * t_z, along * t_z + outward * t_r]
}

/// The stage: d eps += 2 (U* - U_a . e)|bw| and the surface force -2 P* bw, with e = bw/|bw|,
/// U_g = U_a and P_g = P_external + P_L and with the
/// energy equation rho dE += -2 P* U*|bw| (equations (24) to (26); method.md, section 8). Where the surface's
/// tangent is known, bw is what of it faces the surface.
pub struct GhostCoupling {
    external_pressure: f64,
    tension: Option<Tension>,
    surface: Read<u32>,
    weight: [Read<f64>; 2],
    pressure: Read<f64>,
    reference_pressure: Read<f64>,
    density: Read<f64>,
    sound_speed: Read<f64>,
    strain_rate: Add<f64>,
    force: [Write<f64>; 2],
    work: Option<Work>,
}

/// The energy equation's part of the coupling.
struct Work {
    velocity: [Read<f64>; 2],
    power: Add<f64>,
}

impl GhostCoupling {
    /// Ghosts hold the external pressure in Pa, and the Laplace pressure where there is surface tension.
    pub fn new(
        wiring: &mut Wiring,
        external_pressure: f64,
        tension: Option<Tension>,
        with_energy: bool,
    ) -> Self {
        wiring.stage("ghost-coupling");
        let force = [&fields::SURFACE_FORCE_R, &fields::SURFACE_FORCE_Z];
        GhostCoupling {
            external_pressure,
            tension,
            surface: wiring.read(&fields::SURFACE),
            weight: [wiring.read(&fields::GHOST_WEIGHT_R), wiring.read(&fields::GHOST_WEIGHT_Z)],
            pressure: wiring.read(&fields::PRESSURE),
            reference_pressure: wiring.read(&fields::REFERENCE_PRESSURE),
            density: wiring.read(&fields::DENSITY),
            sound_speed: wiring.read(&fields::SOUND_SPEED),
            strain_rate: wiring.add(&fields::STRAIN_RATE),
            force: force.map(|field| wiring.write(field)),
            work: with_energy.then(|| Work {
                velocity: [wiring.read(&fields::VELOCITY_R), wiring.read(&fields::VELOCITY_Z)],
                power: wiring.add(&fields::POWER),
            }),
        }
    }
}

impl Stage for GhostCoupling {
    fn name(&self) -> &'static str {
        "ghost-coupling"
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        let store = &world.store;
        let surface = store.read(self.surface);
        let [weight_r, weight_z] = self.weight.map(|field| store.read(field));
        let (pressure, reference) = (store.read(self.pressure), store.read(self.reference_pressure));
        let (density, sound_speed) = (store.read(self.density), store.read(self.sound_speed));
        let tension = self.tension.as_ref().map(|t| (store.read(t.pressure), store.read(t.rate)));
        let tension = tension.as_ref().map(|(pressure, rate)| (&pressure[..], &rate[..]));
        let facing_of = self.tension.as_ref().and_then(|t| t.facing);
        let facing_of = facing_of.map(|(tangent, size)| (tangent.map(|t| store.read(t)), store.read(size)));
        let facing_of = facing_of.as_ref().map(|([r, z], size)| (&r[..], &z[..], &size[..]));
        // Between two computations of the curvature its pressure is carried on at the last rate:
        // a lag would feed the oscillation (method.md, section 10).
        let elapsed = world.clock.time - world.clock.mark(COMPUTED);
        let mut strain_rate = store.write(self.strain_rate);
        let [mut force_r, mut force_z] = self.force.map(|field| store.write(field));

        let velocity = self.work.as_ref().map(|work| work.velocity.map(|field| store.read(field)));
        let velocity = velocity.as_ref().map(|[u, w]| (&u[..], &w[..]));
        let mut power = self.work.as_ref().map(|work| store.write(work.power));

        let columns = (&mut strain_rate[..], &mut force_r[..], &mut force_z[..], power.as_deref_mut());
        parallel::for_chunks(surface.len(), columns, |start, (strain_rate, force_r, force_z, mut power)| {
            clear(force_r);
            clear(force_z);
            for_surface(&surface[start..start + strain_rate.len()], |k| {
                let i = start + k;
                let laplace = tension.map_or(0.0, |(pressure, rate)| pressure[i] + elapsed * rate[i]);
                let ghost_pressure = self.external_pressure + laplace - reference[i];
                let impedance = density[i] * sound_speed[i];
                let ghost_impedance = IMPEDANCE_RATIO * impedance;
                let both = impedance + ghost_impedance;
                let star = (ghost_pressure * impedance + pressure[i] * ghost_impedance) / both;
                let rise = (pressure[i] - ghost_pressure) / both;
                let weight = match facing_of {
                    Some((r, z, size)) => {
                        facing([weight_r[i], weight_z[i]], [r[i], z[i]], DISORDER / size[i])
                    }
                    None => [weight_r[i], weight_z[i]],
                };
                let length = (weight[0] * weight[0] + weight[1] * weight[1]).sqrt();
                strain_rate[k] += 2.0 * rise * length;
                if let (Some(power), Some((u, w))) = (&mut power, velocity) {
                    // U* |bw| = U_a . bw + rise |bw|.
                    power[k] -= 2.0 * star * (u[i] * weight[0] + w[i] * weight[1] + rise * length);
                }
                force_r[k] = -2.0 * star * weight[0];
                force_z[k] = -2.0 * star * weight[1];
            });
        });
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_faces_the_surface_is_kept() {
        // The surface lies in the direction of r.
        let tangent = [0.0, -1.0];
        for weight in [[0.5, 0.1], [0.5, -0.65], [-0.15, 0.1], [0.0, 0.2]] {
            assert_eq!(facing(weight, tangent, 0.2), weight);
        }
        assert_eq!(facing([-1.0, 0.1], tangent, 0.2), [-0.2, 0.1]);
        assert_eq!(facing([-1.0, 1.5], tangent, 0.2), [-0.2, 0.2]);
        assert_eq!(facing([0.5, -2.0], tangent, 0.2), [0.5, -0.7]);
        // Without a tangent nothing is known.
        assert_eq!(facing([-1.0, 1.5], [0.0, 0.0], 0.2), [-1.0, 1.5]);
    }
}
