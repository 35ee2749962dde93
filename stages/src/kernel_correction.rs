//! The kernel's factor: makes the discrete gradient exact in the mean of every particle's directions.

use crate::boundary_detect::EIGENVALUE;
use crate::fields;
use crate::moment::Moment;
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Read, Update};
use meniscus_engine::wiring::Wiring;

/// How fast the factor follows the moment matrix, per step.
const RELAXATION: f64 = 0.1;

/// G: s_a *= 1 + 0.1 (1/lambda_a - 1) with lambda_a = tr(L_a)/2 for interior particles; boundary
/// particles take the mean (method.md, section 10, "The surface error, later").
pub struct KernelCorrection {
    moment: [Read<f64>; 3],
    scale: Update<f64>,
}

impl KernelCorrection {
    /// Updates the factor that the next step's pair pass uses.
    pub fn new(wiring: &mut Wiring) -> Self {
        wiring.stage("kernel-correction");
        let moment = [&fields::MOMENT_RR, &fields::MOMENT_RZ, &fields::MOMENT_ZZ];
        KernelCorrection {
            moment: moment.map(|field| wiring.read(field)),
            scale: wiring.update(&fields::KERNEL_SCALE),
        }
    }
}

impl Stage for KernelCorrection {
    fn name(&self) -> &'static str {
        "kernel-correction"
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        let [rr, rz, zz] = self.moment.map(|field| world.store.read(field));
        let mut scale = world.store.write(self.scale);
        let interior = |i: usize| {
            let moment = Moment {
                rr: rr[i],
                rz: rz[i],
                zz: zz[i],
            };
            (moment.smallest_eigenvalue() >= EIGENVALUE).then(|| 0.5 * moment.trace())
        };
        let follow = |start: usize, scale: &mut [f64], _: usize| {
            let (mut sum, mut count) = (0.0, 0.0);
            for (k, scale) in scale.iter_mut().enumerate() {
                if let Some(lambda) = interior(start + k) {
                    *scale *= 1.0 + RELAXATION * (1.0 / lambda - 1.0);
                    sum += *scale;
                    count += 1.0;
                }
            }
            (sum, count)
        };
        let add = |a: (f64, f64), b: (f64, f64)| (a.0 + b.0, a.1 + b.1);
        let (sum, count) = parallel::fold_chunks(rr.len(), &mut scale[..], &follow, &add);
        if count == 0.0 {
            return Ok(());
        }
        parallel::for_chunks(rr.len(), &mut scale[..], |start, scale| {
            for (k, scale) in scale.iter_mut().enumerate() {
                if interior(start + k).is_none() {
                    *scale = sum / count;
                }
            }
        });
        Ok(())
    }
}
