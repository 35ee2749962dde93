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

/// g^n = T L^{-1}, and s += .1 [(g^n - g^{n-1})/h - s]: what the next step needs to predict its
/// gradients (method.md, section 10, "One traversal a step").
pub struct VelocityGradient {
    moment: [Read<f64>; 3],
    velocity_sum: [Read<f64>; 4],
    gradient: [Update<f64>; 4],
    rate: [Update<f64>; 4],
}

impl VelocityGradient {
    /// Updates gradient and rate.
    pub fn new(wiring: &mut Wiring) -> Self {
        wiring.stage("velocity-gradient");
        let moment = [&fields::MOMENT_RR, &fields::MOMENT_RZ, &fields::MOMENT_ZZ];
        let sum = [
            &fields::VELOCITY_SUM_RR,
            &fields::VELOCITY_SUM_RZ,
            &fields::VELOCITY_SUM_ZR,
            &fields::VELOCITY_SUM_ZZ,
        ];
        let gradient = [
            &fields::GRADIENT_RR,
            &fields::GRADIENT_RZ,
            &fields::GRADIENT_ZR,
            &fields::GRADIENT_ZZ,
        ];
        let rate = [
            &fields::GRADIENT_RATE_RR,
            &fields::GRADIENT_RATE_RZ,
            &fields::GRADIENT_RATE_ZR,
            &fields::GRADIENT_RATE_ZZ,
        ];
        VelocityGradient {
            moment: moment.map(|field| wiring.read(field)),
            velocity_sum: sum.map(|field| wiring.read(field)),
            gradient: gradient.map(|field| wiring.update(field)),
            rate: rate.map(|field| wiring.update(field)),
        }
    }
}

impl Stage for VelocityGradient {
    fn name(&self) -> &'static str {
        "velocity-gradient"
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        let elapsed = world.clock.previous_step_size;
        let store = &world.store;
        let [rr, rz, zz] = self.moment.map(|field| store.read(field));
        let sum = self.velocity_sum.map(|field| store.read(field));
        let [mut g0, mut g1, mut g2, mut g3] = self.gradient.map(|field| store.write(field));
        let [mut s0, mut s1, mut s2, mut s3] = self.rate.map(|field| store.write(field));
        let gradient = (&mut g0[..], &mut g1[..], &mut g2[..], &mut g3[..]);
        let rate = (&mut s0[..], &mut s1[..], &mut s2[..], &mut s3[..]);
        parallel::for_chunks(rr.len(), (gradient, rate), |start, (gradient, rate)| {
            let gradient = [gradient.0, gradient.1, gradient.2, gradient.3];
            let rate = [rate.0, rate.1, rate.2, rate.3];
            for k in 0..gradient[0].len() {
                let i = start + k;
                let moment = Moment {
                    rr: rr[i],
                    rz: rz[i],
                    zz: zz[i],
                };
                let now = if moment.smallest_eigenvalue() >= INVERTIBLE {
                    moment.solve(std::array::from_fn(|c| sum[c][i]))
                } else {
                    [0.0; 4]
                };
                for c in 0..4 {
                    if elapsed > 0.0 {
                        let change = (now[c] - gradient[c][k]) / elapsed;
                        rate[c][k] += RELAXATION * (change - rate[c][k]);
                    }
                    gradient[c][k] = now[c];
                }
            }
        });
        Ok(())
    }
}
