//! The velocity gradient for the reconstruction, and how fast it changes.

use crate::fields;
use crate::moment::Moment;
use crate::surface_corrections::INVERTIBLE;
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Read, Update};
use meniscus_engine::wiring::Wiring;

/// How fast the smoothed rate follows, per step.
const RELAXATION: f64 = 0.1;

/// The symmetric part of g^n = T L^{-1}, and s += .1 [(g^n - g^{n-1})/h - s]: what the next step
/// needs to predict its gradients (method.md, section 10, "One traversal a step"). The reconstruction
/// projects on the pair axis, so the rotation has no part in it.
pub struct VelocityGradient {
    moment: [Read<f64>; 3],
    velocity_sum: [Read<f64>; 4],
    deformation: [Update<f64>; 3],
    change: [Update<f64>; 3],
}

impl VelocityGradient {
    /// Updates the rate of deformation and its change.
    pub fn new(wiring: &mut Wiring) -> Self {
        wiring.stage("velocity-gradient");
        let moment = [&fields::MOMENT_RR, &fields::MOMENT_RZ, &fields::MOMENT_ZZ];
        let sum = [
            &fields::VELOCITY_SUM_RR,
            &fields::VELOCITY_SUM_RZ,
            &fields::VELOCITY_SUM_ZR,
            &fields::VELOCITY_SUM_ZZ,
        ];
        let deformation = [&fields::DEFORMATION_RR, &fields::DEFORMATION_SHEAR, &fields::DEFORMATION_ZZ];
        let change = [
            &fields::DEFORMATION_CHANGE_RR,
            &fields::DEFORMATION_CHANGE_SHEAR,
            &fields::DEFORMATION_CHANGE_ZZ,
        ];
        VelocityGradient {
            moment: moment.map(|field| wiring.read(field)),
            velocity_sum: sum.map(|field| wiring.read(field)),
            deformation: deformation.map(|field| wiring.update(field)),
            change: change.map(|field| wiring.update(field)),
        }
    }
}

impl Stage for VelocityGradient {
    fn name(&self) -> &'static str {
        "velocity-gradient"
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        let elapsed = world.clock.previous_step_size;
        let (inverse_elapsed, follow) = if elapsed > 0.0 { (1.0 / elapsed, RELAXATION) } else { (0.0, 0.0) };
        let store = &world.store;
        let [rr, rz, zz] = self.moment.map(|field| store.read(field));
        let [sum_rr, sum_rz, sum_zr, sum_zz] = self.velocity_sum.map(|field| store.read(field));
        let [mut g0, mut g1, mut g2] = self.deformation.map(|field| store.write(field));
        let [mut s0, mut s1, mut s2] = self.change.map(|field| store.write(field));
        let columns = (
            (&rr[..], &rz[..], &zz[..]),
            (&sum_rr[..], &sum_rz[..], &sum_zr[..], &sum_zz[..]),
            (&mut g0[..], &mut g1[..], &mut g2[..]),
            (&mut s0[..], &mut s1[..], &mut s2[..]),
        );
        parallel::for_chunks(rr.len(), columns, |_, (moment, sum, gradient, change)| {
            let len = moment.0.len();
            let (rr, rz, zz) = (&moment.0[..len], &moment.1[..len], &moment.2[..len]);
            let sum = [&sum.0[..len], &sum.1[..len], &sum.2[..len], &sum.3[..len]];
            let gradient = [&mut gradient.0[..len], &mut gradient.1[..len], &mut gradient.2[..len]];
            let change = [&mut change.0[..len], &mut change.1[..len], &mut change.2[..len]];
            for i in 0..len {
                let moment = Moment { rr: rr[i], rz: rz[i], zz: zz[i] };
                let now = moment.solve([sum[0][i], sum[1][i], sum[2][i], sum[3][i]]);
                let usable = moment.eigenvalues_at_least(INVERTIBLE);
                let now = [now[0], now[1] + now[2], now[3]].map(|g| if usable { g } else { 0.0 });
                for c in 0..3 {
                    let rate = (now[c] - gradient[c][i]) * inverse_elapsed;
                    change[c][i] += follow * (rate - change[c][i]);
                    gradient[c][i] = now[c];
                }
            }
        });
        Ok(())
    }
}
