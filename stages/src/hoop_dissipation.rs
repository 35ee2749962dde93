//! What rings near the axis lose of a radial motion that is not smooth across it.

use crate::equation_of_state::Packing;
use crate::fields;
use crate::record::Precision;
use crate::rows::PackedState;
use crate::sound_speed::SoundSpeed;
use meniscus_engine::group::{Around, Chunk, ChunkStage, Partial};
use meniscus_engine::lanes::{Lanes, WIDTH};
use meniscus_engine::store::{Add, Read};
use meniscus_engine::wiring::Wiring;

/// rho dU_r/dt += -rho C J/2 (1 - R/h)^2/R for R < h.
///
/// A ring's own hoop terms, P/(rho R) and U_r/R, swing with C/R, and no contact damps that: the weight of a ring's own
/// image across the axis is zero. So the hoop pressure becomes that of the contact with the image, as P* is for pairs.
/// In the acoustic Riemann problem (equation (19)) of two equal states that part with the jump J it is P - rho C J/2. The image has -U_r,
/// 2 R away: J = 2 U_r less van Leer's mean of x = 2 G - J and J on either side (`contact::Limited`), where G = 2 R dU_r/dr. That leaves
/// J/2 = U_r (U_r/R - dU_r/dr)/(dU_r/dr), or U_r where dU_r/dr is of the other sign or less than half of U_r/R: a flow that
/// is linear in R feels nothing. The last factor lets go of an image that leaves the support: both see each other up to 2 h.
///
/// The force is radial and works on nothing but the particle itself, whose total energy it leaves: what motion loses
/// becomes heat. Axial momentum is not touched.
pub struct HoopDissipation {
    packing: Packing,
    radius: Read<f64>,
    velocity: Read<f64>,
    density: Read<f64>,
    deformation: Read<f64>,
    sound_speed: SoundSpeed,
    dissipation: Add<f64>,
}

impl HoopDissipation {
    /// For scenes with an axis, whose coordinates begin there. It must follow the velocity gradient.
    pub fn new(wiring: &mut Wiring, packing: Packing, constant_sound_speed: Option<f64>) -> Self {
        wiring.stage("hoop-dissipation");
        HoopDissipation {
            packing,
            radius: wiring.read(&fields::RADIUS),
            velocity: wiring.read(&fields::VELOCITY_R),
            density: wiring.read(&fields::DENSITY),
            deformation: wiring.read(&fields::DEFORMATION_RR),
            sound_speed: SoundSpeed::new(wiring, constant_sound_speed),
            dissipation: wiring.add(&fields::DISSIPATION_R),
        }
    }
}

impl ChunkStage for HoopDissipation {
    fn name(&self) -> &'static str {
        "hoop-dissipation"
    }

    fn chunk(&self, around: &Around, chunk: &Chunk) -> Partial {
        let [radius, velocity, density, deformation] =
            [self.radius, self.velocity, self.density, self.deformation].map(|field| chunk.read(field));
        let sound_speed = self.sound_speed.of(chunk);
        let packed = PackedState(around.rows);
        let mut dissipation = chunk.write(self.dissipation);
        let farthest = Lanes::splat(self.packing.reach(self.packing.largest_size));
        let support = self.packing.support(Precision::Double);
        for first in (0..chunk.len()).step_by(WIDTH) {
            let eight = first..chunk.len().min(first + WIDTH);
            let load = |column: &[f64], fill| Lanes::load_or(&column[eight.clone()], fill);
            // Whoever fills up the last eight is far from the axis.
            let radius = load(&radius, 1e150);
            if (radius - farthest).all_positive() {
                continue;
            }
            let size = packed.sizes(chunk.start + first);
            let distance = radius + radius;
            let inside = (Lanes::ONE - distance / support.of_pair(size, size)).max(Lanes::ZERO);
            // J/(2 R): U_r/R where van Leer's mean is zero.
            let (rate, slope) = (load(&velocity, 0.0) / radius, load(&deformation, 0.0));
            let both = (slope + slope - rate) * rate;
            let safe = both.select_greater(Lanes::ZERO, slope, Lanes::ONE);
            let rough = both.select_greater(Lanes::ZERO, rate * (rate - slope) / safe, rate);
            let force = load(&density, 0.0) * sound_speed.of(eight.clone()) * rough * inside * inside;
            (load(&dissipation, 0.0) - force).store(&mut dissipation[eight]);
        }
        [0.0; 2]
    }
}
