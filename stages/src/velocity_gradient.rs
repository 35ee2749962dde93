//! The velocity gradient for the reconstruction and the strain rate, and how fast it changes.

use crate::fields;
use crate::moment::eigenvalue_margin;
use meniscus_engine::group::{Around, Chunk, ChunkStage, Partial};
use meniscus_engine::lanes::{Lanes, WIDTH};
use meniscus_engine::pipeline::{Fault, World};
use meniscus_engine::store::{Add, Read, Update, Write};
use meniscus_engine::wiring::Wiring;

/// Smallest eigenvalue of L below which its inverse is not used.
const INVERTIBLE: f64 = 0.2;

/// How fast the smoothed rate follows, per step.
const RELAXATION: f64 = 0.1;

/// The symmetric part of g^n = T L^{-1}, and s += .1 [(g^n - g^{n-1})/h - s]: what the next step
/// needs to predict its gradients (method.md, section 10, "One traversal a step"). The reconstruction
/// projects on the pair axis, so the rotation has no part in it.
///
/// S: the pair sum of the strain rate is off by tr(g) - tr(T), for it sees of a linear flow what L sees of lengths: too little
/// at the surface, where neighbours lack, and inside too little or too much where neighbours are farther apart in one
/// direction than in the other (method.md, section 10, "The surface error, later", has it for the surface alone).
pub struct VelocityGradient {
    moment: [Read<f64>; 3],
    velocity_sum: [Read<f64>; 4],
    /// The rate of deformation and its change, where somebody predicts.
    kept: Option<[[Update<f64>; 3]; 2]>,
    strain_rate: Option<Add<f64>>,
    rotation: Option<Write<f64>>,
    /// One over the length of the last step, and how fast the smoothed rate follows.
    rates: [f64; 2],
}

impl VelocityGradient {
    /// Updates the rate of deformation and its change where they are to be `kept` for the next step, `with_strain` adds S to the
    /// strain rate; `with_rotation` where somebody needs the whole gradient.
    pub fn new(wiring: &mut Wiring, kept: bool, with_strain: bool, with_rotation: bool) -> Self {
        wiring.stage("velocity-gradient");
        VelocityGradient {
            moment: fields::MOMENT.map(|field| wiring.read(field)),
            velocity_sum: fields::VELOCITY_SUM.map(|field| wiring.read(field)),
            kept: kept.then(|| {
                [fields::DEFORMATION, fields::DEFORMATION_CHANGE]
                    .map(|kept| kept.map(|field| wiring.update(field)))
            }),
            strain_rate: with_strain.then(|| wiring.add(&fields::STRAIN_RATE)),
            rotation: with_rotation.then(|| wiring.write(&fields::ROTATION)),
            rates: [0.0; 2],
        }
    }
}

impl ChunkStage for VelocityGradient {
    fn name(&self) -> &'static str {
        "velocity-gradient"
    }

    fn prepare(&mut self, world: &mut World) -> Result<(), Fault> {
        let elapsed = world.clock.previous_step_size;
        self.rates = if elapsed > 0.0 { [1.0 / elapsed, RELAXATION] } else { [0.0; 2] };
        Ok(())
    }

    fn chunk(&self, _: &Around, chunk: &Chunk) -> Partial {
        let [l_rr, l_rz, l_zz] = self.moment.map(|field| chunk.read(field));
        let [t_rr, t_rz, t_zr, t_zz] = self.velocity_sum.map(|field| chunk.read(field));
        let mut kept = self.kept.map(|kept| kept.map(|kept| kept.map(|field| chunk.write(field))));
        let mut strain_rate = self.strain_rate.map(|field| chunk.write(field));
        let mut rotation = self.rotation.map(|field| chunk.write(field));
        let [inverse_elapsed, follow] = self.rates.map(Lanes::splat);
        for first in (0..chunk.len()).step_by(WIDTH) {
            let eight = first..chunk.len().min(first + WIDTH);
            let load = |column: &[f64], fill| Lanes::load_or(&column[eight.clone()], fill);
            let moment = [load(&l_rr, 1.0), load(&l_rz, 0.0), load(&l_zz, 1.0)];
            let sum = [load(&t_rr, 0.0), load(&t_rz, 0.0), load(&t_zr, 0.0), load(&t_zz, 0.0)];
            let known = eigenvalue_margin(moment, INVERTIBLE);
            let [rr, rz, zr, zz] = solve(moment, sum, known);
            if let Some(strain_rate) = &mut strain_rate {
                let missing = (rr - sum[0]) + (zz - sum[3]);
                let missing = known.select_greater(Lanes::ZERO, missing, Lanes::ZERO);
                (load(strain_rate, 0.0) + missing).store(&mut strain_rate[eight.clone()]);
            }
            if let Some(rotation) = &mut rotation {
                (rz - zr).store(&mut rotation[eight.clone()]);
            }
            let Some([gradient, change]) = &mut kept else { continue };
            for (c, now) in [rr, rz + zr, zz].into_iter().enumerate() {
                let rate = (now - load(&gradient[c], 0.0)) * inverse_elapsed;
                let before = load(&change[c], 0.0);
                follow.mul_add(rate - before, before).store(&mut change[c][eight.clone()]);
                now.store(&mut gradient[c][eight.clone()]);
            }
        }
        [0.0; 2]
    }
}

/// T L^{-1} for L in the order rr, rz, zz and T in the order rr, rz, zr, zz (velocity component, direction); zero
/// where `known` is not above zero.
#[inline(always)]
fn solve([rr, rz, zz]: [Lanes; 3], sum: [Lanes; 4], known: Lanes) -> [Lanes; 4] {
    let inverse = Lanes::ONE / rz.neg_mul_add(rz, rr * zz);
    let by = |direct: Lanes, across: Lanes, own: Lanes| {
        let solved = rz.neg_mul_add(across, own * direct) * inverse;
        known.select_greater(Lanes::ZERO, solved, Lanes::ZERO)
    };
    [by(sum[0], sum[1], zz), by(sum[1], sum[0], rr), by(sum[2], sum[3], zz), by(sum[3], sum[2], rr)]
}
