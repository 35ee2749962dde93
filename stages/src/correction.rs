//! Correction: the surface force joins the others, without moving the whole.

use crate::fields;
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Add, Read};
use meniscus_engine::wiring::Wiring;

/// f += f_s - rho F_z/m_tot e_z with F_z = sum_a (m_a/rho_a) f_s,z: the paper's momentum correction
/// (method.md, section 8). Ghosts are no bodies that could take up momentum.
pub struct MomentumCorrection {
    conserve: bool,
    mass: Read<f64>,
    density: Read<f64>,
    surface_force: [Read<f64>; 2],
    force: [Add<f64>; 2],
}

impl MomentumCorrection {
    /// With `conserve` false the surface force is added as it is.
    pub fn new(wiring: &mut Wiring, conserve: bool) -> Self {
        wiring.stage("correction");
        let surface_force = [&fields::SURFACE_FORCE_R, &fields::SURFACE_FORCE_Z];
        MomentumCorrection {
            conserve,
            mass: wiring.read(&fields::MASS),
            density: wiring.read(&fields::DENSITY),
            surface_force: surface_force.map(|field| wiring.read(field)),
            force: [wiring.add(&fields::FORCE_R), wiring.add(&fields::FORCE_Z)],
        }
    }
}

impl Stage for MomentumCorrection {
    fn name(&self) -> &'static str {
        "correction"
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        let store = &world.store;
        let (mass, density) = (store.read(self.mass), store.read(self.density));
        let [surface_r, surface_z] = self.surface_force.map(|field| store.read(field));
        let [mut force_r, mut force_z] = self.force.map(|field| store.write(field));
        let (mass, density) = (&mass[..], &density[..]);
        let (surface_r, surface_z) = (&surface_r[..], &surface_z[..]);
        let acceleration = if self.conserve {
            let force = parallel::sum(mass.len(), |i| mass[i] / density[i] * surface_z[i]);
            force / parallel::sum(mass.len(), |i| mass[i])
        } else {
            0.0
        };
        let columns = (&mut force_r[..], &mut force_z[..]);
        parallel::for_chunks(mass.len(), columns, |start, (force_r, force_z)| {
            for k in 0..force_r.len() {
                let i = start + k;
                force_r[k] += surface_r[i];
                force_z[k] += surface_z[i] - density[i] * acceleration;
            }
        });
        Ok(())
    }
}
