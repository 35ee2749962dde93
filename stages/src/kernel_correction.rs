//! The kernel's factor: makes the discrete gradient exact in the mean of every particle's directions.

use crate::boundary_detect::EIGENVALUE;
use crate::fields;
use crate::moment::Moment;
use crate::surface::INSIDE;
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Read, Update};
use meniscus_engine::wiring::Wiring;

/// How fast the factor follows the moment matrix, per step.
const RELAXATION: f64 = 0.1;

/// G: s_a *= 1 + 0.1 (1/lambda_a - 1) with lambda_a = tr(L_a)/2 (method.md, section 10, "The surface error,
/// later"). Whoever has few neighbours takes the mean of the interior. So do those near the surface that ask for
/// more than that: they lack some neighbours, and a trace filled up there makes the layer below push too hard.
/// Those that ask for less are crowded: with the mean they would push too hard.
pub struct KernelCorrection {
    moment: [Read<f64>; 3],
    surface: Option<Read<u32>>,
    scale: Update<f64>,
}

impl KernelCorrection {
    /// Updates the factor that the next step's pair pass uses; `with_surface` where the scene detects it.
    pub fn new(wiring: &mut Wiring, with_surface: bool) -> Self {
        wiring.stage("kernel-correction");
        let moment = [&fields::MOMENT_RR, &fields::MOMENT_RZ, &fields::MOMENT_ZZ];
        KernelCorrection {
            moment: moment.map(|field| wiring.read(field)),
            surface: with_surface.then(|| wiring.read(&fields::SURFACE)),
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
        let surface = self.surface.map(|surface| world.store.read(surface));
        let surface = surface.as_deref();
        let columns = (&rr[..], &rz[..], &zz[..], &mut scale[..]);
        let body = |start: usize, columns: Columns, len: usize| match surface {
            Some(surface) => {
                let surface = &surface[start..start + len];
                follow(columns, len, |i| surface[i] == INSIDE)
            }
            None => follow(columns, len, |_| true),
        };
        let add = |a: (f64, f64), b: (f64, f64)| (a.0 + b.0, a.1 + b.1);
        let (sum, count) = parallel::fold_chunks(rr.len(), columns, &body, &add);
        let mean = if count > 0.0 { sum / count } else { 1.0 };
        parallel::for_chunks(rr.len(), &mut scale[..], |start, scale| {
            for (i, scale) in scale.iter_mut().enumerate() {
                let inside = surface.is_none_or(|surface| surface[start + i] == INSIDE);
                // NaN marks few neighbours, and the least of it and the mean is the mean.
                *scale = if inside && !scale.is_nan() { *scale } else { scale.min(mean) };
            }
        });
        Ok(())
    }
}

type Columns<'a> = (&'a [f64], &'a [f64], &'a [f64], &'a mut [f64]);

/// Moves the factors of all particles that have enough neighbours, marks the others by a NaN, and gives sum and
/// number of those inside.
#[inline(always)]
fn follow((rr, rz, zz, scale): Columns, len: usize, is_inside: impl Fn(usize) -> bool) -> (f64, f64) {
    let (rr, rz, zz, scale) = (&rr[..len], &rz[..len], &zz[..len], &mut scale[..len]);
    let (mut sum, mut count) = (0.0, 0.0);
    for i in 0..len {
        let moment = Moment { rr: rr[i], rz: rz[i], zz: zz[i] };
        let now = scale[i] * (1.0 + RELAXATION * (2.0 / moment.trace() - 1.0));
        let complete = moment.eigenvalues_at_least(EIGENVALUE);
        let interior = complete & is_inside(i);
        scale[i] = if complete { now } else { f64::NAN };
        sum += if interior { now } else { 0.0 };
        count += if interior { 1.0 } else { 0.0 };
    }
    (sum, count)
}
