//! A central force: every particle is drawn to a point on the axis.

use crate::fields;
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Add, Read};
use meniscus_engine::wiring::Wiring;

/// f += -rho B^2 (x - x_0), the force of the free-spheroid test.
pub struct CentralForce {
    stiffness: f64,
    origin: f64,
    position: [Read<f64>; 2],
    density: Read<f64>,
    force: [Add<f64>; 2],
}

impl CentralForce {
    /// `stiffness` is B^2 in 1/s2, `origin` the distance of the scene's origin from the axis in m; the
    /// centre lies at z = 0.
    pub fn new(wiring: &mut Wiring, stiffness: f64, origin: f64) -> Self {
        wiring.stage("central-force");
        CentralForce {
            stiffness,
            origin,
            position: [wiring.read(&fields::RADIUS), wiring.read(&fields::AXIAL)],
            density: wiring.read(&fields::DENSITY),
            force: [wiring.add(&fields::FORCE_R), wiring.add(&fields::FORCE_Z)],
        }
    }
}

impl Stage for CentralForce {
    fn name(&self) -> &'static str {
        "central-force"
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        let store = &world.store;
        let [r, z] = self.position.map(|field| store.read(field));
        let density = store.read(self.density);
        let [mut force_r, mut force_z] = self.force.map(|field| store.write(field));
        let columns = ((&r[..], &z[..], &density[..]), (&mut force_r[..], &mut force_z[..]));
        parallel::for_chunks(r.len(), columns, |_, ((r, z, density), (force_r, force_z))| {
            for k in 0..r.len() {
                force_r[k] -= density[k] * self.stiffness * (r[k] + self.origin);
                force_z[k] -= density[k] * self.stiffness * z[k];
            }
        });
        Ok(())
    }
}
