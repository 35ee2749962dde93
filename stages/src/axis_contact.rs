//! The contact across the axis: a particle that streams into the axis meets its own mirror image.

use crate::contact::KERNEL;
use crate::equation_of_state::Packing;
use crate::fields;
use crate::rows::PackedState;
use meniscus_engine::group::{Around, Chunk, ChunkStage, Partial};
use meniscus_engine::store::{Add, Read};
use meniscus_engine::wiring::Wiring;

/// rho dU_r/dt += 2 V g(2 R) q with q = rho (C + s |U_r|) |U_r| where U_r < 0: the dissipative part of P* at
/// the contact with the image, weighted like Parshikov's pairs. The harmonic-mean weight of a particle's
/// image is zero, so that nothing else would stop a cold gas before it has crossed the axis. The force is
/// radial and works on nothing but the particle itself, whose total energy it leaves: what is lost in
/// motion becomes heat, and axial momentum is not touched.
pub struct AxisContact {
    packing: Packing,
    slope: f64,
    radius: Read<f64>,
    velocity: Read<f64>,
    density: Read<f64>,
    sound_speed: Read<f64>,
    dissipation: Add<f64>,
}

impl AxisContact {
    /// `packing` gives the support of a pair, `slope` is that of the shock adiabat.
    pub fn new(wiring: &mut Wiring, packing: Packing, slope: f64) -> Self {
        wiring.stage("axis-contact");
        AxisContact {
            packing,
            slope,
            radius: wiring.read(&fields::RADIUS),
            velocity: wiring.read(&fields::VELOCITY_R),
            density: wiring.read(&fields::DENSITY),
            sound_speed: wiring.read(&fields::SOUND_SPEED),
            dissipation: wiring.add(&fields::DISSIPATION_R),
        }
    }
}

impl ChunkStage for AxisContact {
    fn name(&self) -> &'static str {
        "axis-contact"
    }

    fn chunk(&self, around: &Around, chunk: &Chunk) -> Partial {
        let (radius, velocity) = (chunk.read(self.radius), chunk.read(self.velocity));
        let (density, sound_speed) = (chunk.read(self.density), chunk.read(self.sound_speed));
        let packed = PackedState(around.rows);
        let mut dissipation = chunk.write(self.dissipation);
        let size = |i: usize| packed.size(chunk.start + i);
        for (i, dissipation) in dissipation.iter_mut().enumerate() {
            let support = 2.0 * self.packing.reach(size(i));
            let (distance, closing) = (2.0 * radius[i], -velocity[i]);
            if distance < support && closing > 0.0 {
                let inside = 1.0 - distance / support;
                let kernel = KERNEL * inside.powi(3) / support.powi(4);
                let excess = density[i] * (sound_speed[i] + self.slope * closing) * closing;
                *dissipation += 2.0 * size(i) * size(i) * kernel * distance * excess;
            }
        }
        [0.0; 2]
    }
}
