//! The kernel's factor: makes the discrete gradient exact in the mean of every particle's directions.

use crate::boundary_detect::EIGENVALUE;
use crate::fields;
use crate::moment::eigenvalue_margin;
use crate::surface::INSIDE;
use meniscus_engine::clock::Clock;
use meniscus_engine::group::{Around, Chunk, ChunkStage, Partial};
use meniscus_engine::lanes::{Lanes, WIDTH};
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, World};
use meniscus_engine::store::{Read, Update};
use meniscus_engine::wiring::Wiring;

/// What is left after a step of the distance to what the moment matrix asks for.
const LEFT: f64 = 0.9;

/// G: s_a *= 1 + 0.1 (1/lambda_a - 1) in every step, or with 1 - 0.9^n for 0.1 in every nth, lambda_a = tr(L_a)/2
/// (method.md, section 10, "The surface error, later"). Whoever has few neighbours takes the mean of the interior. So do those near the surface that ask for
/// more than that: they lack some neighbours, and a trace filled up there makes the layer below push too hard.
/// Those that ask for less are crowded: with the mean they would push too hard.
pub struct KernelCorrection {
    moment: [Read<f64>; 3],
    surface: Option<Read<u32>>,
    scale: Update<f64>,
    interval: u64,
}

impl KernelCorrection {
    /// Updates the factor that the next step's pair pass uses, in every `interval`th step; `with_surface` where the scene
    /// detects it.
    pub fn new(wiring: &mut Wiring, interval: u64, with_surface: bool) -> Self {
        wiring.stage("kernel-correction");
        KernelCorrection {
            moment: fields::MOMENT.map(|field| wiring.read(field)),
            surface: with_surface.then(|| wiring.read(&fields::SURFACE)),
            scale: wiring.update(&fields::KERNEL_SCALE),
            interval,
        }
    }

    fn is_due_at(&self, clock: &Clock) -> bool {
        clock.step.is_multiple_of(self.interval)
    }
}

impl ChunkStage for KernelCorrection {
    fn name(&self) -> &'static str {
        "kernel-correction"
    }

    fn chunk(&self, around: &Around, chunk: &Chunk) -> Partial {
        if !self.is_due_at(around.clock) {
            return Partial::default();
        }
        let [rr, rz, zz] = self.moment.map(|field| chunk.read(field));
        let mut scale = chunk.write(self.scale);
        let surface = self.surface.map(|surface| chunk.read(surface));
        let part = 1.0 - LEFT.powi(self.interval as i32);
        follow((&rr, &rz, &zz, &mut scale), part, surface.as_deref())
    }

    /// Those with few neighbours and those near the surface look at the mean. NaN marks few neighbours, and the least
    /// of it and the mean is the mean.
    fn finish(&mut self, world: &mut World, [sum, count]: Partial) -> Result<(), Fault> {
        if !self.is_due_at(&world.clock) {
            return Ok(());
        }
        let mut scale = world.store.write(self.scale);
        let surface = self.surface.map(|surface| world.store.read(surface));
        let surface = surface.as_deref();
        let mean = if count > 0.0 { sum / count } else { 1.0 };
        parallel::for_chunks(scale.len(), (&mut scale[..], surface), |_, (scale, surface)| {
            for (k, eight) in scale.chunks_mut(WIDTH).enumerate() {
                let surface = surface.map(|surface| &surface[k * WIDTH..k * WIDTH + eight.len()]);
                let codes = surface.unwrap_or_default();
                let is_inside = codes.iter().fold(INSIDE, |any, code| any | code) == INSIDE;
                // Most are left as they are: eight of them are looked at together.
                if is_inside && !eight.iter().sum::<f64>().is_nan() {
                    continue;
                }
                for (lane, scale) in eight.iter_mut().enumerate() {
                    let is_inside = codes.get(lane).is_none_or(|code| *code == INSIDE);
                    *scale = if is_inside && !scale.is_nan() { *scale } else { scale.min(mean) };
                }
            }
        });
        Ok(())
    }
}

type Columns<'a> = (&'a [f64], &'a [f64], &'a [f64], &'a mut [f64]);

/// Moves the factors of all particles that have enough neighbours by a part of the way, marks the others by a NaN, and gives sum and
/// number of those inside.
fn follow((rr, rz, zz, scale): Columns, part: f64, surface: Option<&[u32]>) -> Partial {
    let (mut sum, mut count) = (Lanes::ZERO, Lanes::ZERO);
    for first in (0..scale.len()).step_by(WIDTH) {
        let eight = first..scale.len().min(first + WIDTH);
        let load = |column: &[f64], fill| Lanes::load_or(&column[eight.clone()], fill);
        let (rr, rz, zz) = (load(rr, 1.0), load(rz, 0.0), load(zz, 1.0));
        let change = Lanes::splat(2.0) / (rr + zz) - Lanes::ONE;
        let now = load(scale, 1.0) * Lanes::splat(part).mul_add(change, Lanes::ONE);
        let margin = eigenvalue_margin([rr, rz, zz], EIGENVALUE);
        margin.select_greater(Lanes::ZERO, now, Lanes::splat(f64::NAN)).store(&mut scale[eight.clone()]);
        let is_inside = |k: usize| {
            let inside = surface.is_none_or(|surface| surface[k] == INSIDE);
            if inside { 1.0 } else { 0.0 }
        };
        let inside: [f64; WIDTH] = match eight.len() {
            WIDTH => std::array::from_fn(|lane| is_inside(first + lane)),
            len => std::array::from_fn(|lane| if lane < len { is_inside(first + lane) } else { 0.0 }),
        };
        let interior = margin.select_greater(Lanes::ZERO, Lanes::load(&inside), Lanes::ZERO);
        sum += interior.select_greater(Lanes::ZERO, now, Lanes::ZERO);
        count += interior;
    }
    [sum.sum(), count.sum()]
}
