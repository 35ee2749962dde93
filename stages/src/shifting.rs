//! Shifting: particles give way to crowding, so that the packing stays even.

use crate::fields;
use crate::surface::{BOUNDARY, INSIDE};
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Read, Update};
use meniscus_engine::wiring::Wiring;

/// Largest shift in one step, in particle sizes.
const CAP: f64 = 0.01;

/// Strength of the shifting.
#[derive(Clone, Copy, Debug)]
pub struct Strength {
    /// Coefficient, .3 to 2.
    pub coefficient: f64,
    /// Speed that scales the shift, m/s: fixed, because scaled with the present maximum it runs away.
    pub speed: f64,
    /// Smoothing length parameter.
    pub theta: f64,
    /// Distance of the scene's origin from the axis, m.
    pub origin: f64,
}

/// dr = -coefficient speed dt H grad C, at most 0.01 D; without the normal component at the boundary
/// and without its outward part near it (method.md, sections 10 and 12).
pub struct Shifting {
    strength: Strength,
    size: Read<f64>,
    crowding: [Read<f64>; 2],
    surface: Read<u32>,
    weight: [Read<f64>; 2],
    position: [Update<f64>; 2],
}

impl Shifting {
    /// Shifts after the step.
    pub fn new(wiring: &mut Wiring, strength: Strength) -> Self {
        wiring.stage("shifting");
        Shifting {
            strength,
            size: wiring.read(&fields::SIZE),
            crowding: [wiring.read(&fields::CROWDING_R), wiring.read(&fields::CROWDING_Z)],
            surface: wiring.read(&fields::SURFACE),
            weight: [wiring.read(&fields::GHOST_WEIGHT_R), wiring.read(&fields::GHOST_WEIGHT_Z)],
            position: [wiring.update(&fields::RADIUS), wiring.update(&fields::AXIAL)],
        }
    }
}

/// What is left of a shift at or near the surface, given the outward direction.
fn along_surface(shift: [f64; 2], outward: [f64; 2], surface: u32) -> [f64; 2] {
    let length = outward[0].hypot(outward[1]);
    if surface == INSIDE || length == 0.0 {
        return shift;
    }
    let normal = [outward[0] / length, outward[1] / length];
    let out = shift[0] * normal[0] + shift[1] * normal[1];
    let removed = if surface == BOUNDARY { out } else { out.max(0.0) };
    [shift[0] - removed * normal[0], shift[1] - removed * normal[1]]
}

impl Stage for Shifting {
    fn name(&self) -> &'static str {
        "shifting"
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        let Some(bound) = world.clock.bound() else {
            return Ok(());
        };
        let store = &world.store;
        let size = store.read(self.size);
        let [crowding_r, crowding_z] = self.crowding.map(|field| store.read(field));
        let surface = store.read(self.surface);
        let [weight_r, weight_z] = self.weight.map(|field| store.read(field));
        let (surface, weight_r, weight_z) = (&surface[..], &weight_r[..], &weight_z[..]);
        let [mut r, mut z] = self.position.map(|field| store.write(field));
        let Strength { coefficient, speed, theta, origin } = self.strength;
        let factor = coefficient * speed * bound.step_size * 4.0 * theta;
        parallel::for_chunks(size.len(), (&mut r[..], &mut z[..]), |start, (r, z)| {
            for k in 0..r.len() {
                let i = start + k;
                let shift = [-factor * size[i] * crowding_r[i], -factor * size[i] * crowding_z[i]];
                let shift = along_surface(shift, [weight_r[i], weight_z[i]], surface[i]);
                let length = shift[0].hypot(shift[1]);
                let keep = if length > CAP * size[i] { CAP * size[i] / length } else { 1.0 };
                // A shift must not carry a particle across the axis.
                let radius = r[k] + origin;
                r[k] += (keep * shift[0]).max(-0.5 * radius);
                z[k] += keep * shift[1];
            }
        });
        Ok(())
    }
}
