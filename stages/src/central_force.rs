//! A central force: every particle is drawn to a point on the axis.

use crate::fields;
use crate::work::Work;
use meniscus_engine::group::{Around, Chunk, ChunkStage, Partial};
use meniscus_engine::store::{Add, Read};
use meniscus_engine::wiring::Wiring;

/// f += -rho B^2 (x - x_0), the force of the free-spheroid test.
pub struct CentralForce {
    stiffness: f64,
    origin: f64,
    position: [Read<f64>; 2],
    density: Read<f64>,
    force: [Add<f64>; 2],
    work: Option<Work>,
}

impl CentralForce {
    /// `stiffness` is B^2 in 1/s2, `origin` the distance of the scene's origin from the axis in m; the
    /// centre lies at z = 0.
    pub fn new(wiring: &mut Wiring, stiffness: f64, origin: f64, with_energy: bool) -> Self {
        wiring.stage("central-force");
        CentralForce {
            stiffness,
            origin,
            position: fields::POSITION.map(|field| wiring.read(field)),
            density: wiring.read(&fields::DENSITY),
            force: fields::FORCE.map(|field| wiring.add(field)),
            work: Work::new(wiring, with_energy),
        }
    }
}

impl ChunkStage for CentralForce {
    fn name(&self) -> &'static str {
        "central-force"
    }

    fn chunk(&self, _: &Around, chunk: &Chunk) -> Partial {
        let [r, z] = self.position.map(|field| chunk.read(field));
        let density = chunk.read(self.density);
        let [mut force_r, mut force_z] = self.force.map(|field| chunk.write(field));
        let mut work = self.work.as_ref().map(|work| work.of(chunk));
        for k in 0..chunk.len() {
            let force = [r[k] + self.origin, z[k]].map(|way| -density[k] * self.stiffness * way);
            force_r[k] += force[0];
            force_z[k] += force[1];
            if let Some(work) = &mut work {
                work.add(k, force, 0.0);
            }
        }
        [0.0; 2]
    }
}
