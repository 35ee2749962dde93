//! Closing of voids: where gaps have opened between particles, density follows what their places say.

use crate::equation_of_state::Packing;
use crate::fields;
use crate::rows::PackedState;
use crate::surface::INSIDE;
use meniscus_engine::group::{Around, Chunk, ChunkStage, Partial};
use meniscus_engine::lanes::{Lanes, WIDTH};
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, World};
use meniscus_engine::store::{Add, Read, Update};
use meniscus_engine::wiring::Wiring;
use std::f64::consts::PI;

/// Fewest and most steps between two looks: in a drop with 35 particles to the radius the fewest take .04 t_c.
const STEPS: [u64; 2] = [80, 1280];
/// Part of the capillary time up to which it is twice the fewest, four times and so on.
const LONGEST: f64 = 0.045;

/// Void fraction that doesn't count, of either sign: that of packings that have settled is .001 with a deviation of .003.
const TOLERANCE: f64 = 0.01;

/// How fast voids close, over one by the scene's capillary time.
const RATE: f64 = 3.0;

/// Largest part of the void fraction that closes until the next look: with more than all of it voids would open and close
/// from look to look, and with small drops of few particles 3/t_c is as fast as that.
const MOST: f64 = 0.3;

/// Closing of voids, which neither the paper nor method.md has:
///
/// eps += RATE/t_c e, where the void fraction e = 1 - sum_b V_b W_b is the part of a particle's surroundings that
/// particles leave empty, with the flat kernel W = 3/(pi H^2) (1 - q^2)^2, whose sum hardly feels how the particles lie
/// that fill it.
///
/// The density is integrated, and the pair sum of the strain rate doesn't see all of what a violent flow does to the
/// packing: in a drop that had swung four times at a large amplitude particles took up 2 to 4 % more room than their
/// volumes V = m/rho, and nothing took that back. With the surface the drop had gained energy. So density falls slowly
/// where there is a void (and rises where particles are crowded), with it the pressure, and the void closes. Forces are
/// as before, momentum is untouched, and mass is what particles carry. The room is looked at inside alone, as far as
/// the surface leaves it whole.
pub struct VoidClosing {
    packing: Packing,
    /// 1/s.
    rate: f64,
    /// The same until the next look.
    rate_now: f64,
    /// Whether any particle has a void fraction, or nobody has looked yet.
    has_voids: bool,
    /// Longest time between two looks if the fewest [`STEPS`] don't take longer, s.
    longest: f64,
    position: [Read<f64>; 2],
    surface: Read<u32>,
    void_fraction: Update<f64>,
    strain_rate: Add<f64>,
}

impl VoidClosing {
    /// Adds to the strain rate. It must follow the boundary detection; `capillary_rate` is one over the scene's
    /// capillary time in 1/s.
    pub fn new(wiring: &mut Wiring, packing: Packing, capillary_rate: f64) -> Self {
        wiring.stage("void-closing");
        VoidClosing {
            packing,
            rate: RATE * capillary_rate,
            rate_now: 0.0,
            has_voids: true,
            longest: LONGEST / capillary_rate,
            position: fields::POSITION.map(|field| wiring.read(field)),
            surface: wiring.read(&fields::SURFACE),
            void_fraction: wiring.update(&fields::VOID_FRACTION),
            strain_rate: wiring.add(&fields::STRAIN_RATE),
        }
    }

    /// Looks at the room around every particle inside; whether any has a void fraction that counts.
    fn look(&self, world: &World) -> bool {
        let [r, z] = self.position.map(|field| world.store.read(field));
        let (packed, surface) = (PackedState(&world.rows), world.store.read(self.surface));
        let (list, domain) = (&world.neighbours, &self.packing.domain);
        let (r, z, surface) = (&r[..], &z[..], &surface[..]);
        let slack = self.packing.slack();
        // In the order of the list's cells neighbours lie side by side. Images weigh nothing.
        let in_cells = list.in_cells();
        let count = in_cells.len();
        let [cell_r, cell_z, area] = [(); 3].map(|()| world.arena.alloc_slice_fill_copy(count + WIDTH, 0.0));
        let columns = (&mut cell_r[..count], &mut cell_z[..count], &mut area[..count], in_cells);
        parallel::for_chunks(count, columns, |_, (cell_r, cell_z, area, members)| {
            for (k, b) in members.iter().map(|&member| member as usize).enumerate() {
                if b < r.len() {
                    (cell_r[k], cell_z[k], area[k]) = (r[b], z[b], packed.area(b));
                }
            }
        });
        let (cell_r, cell_z, area) = (&*cell_r, &*cell_z, &*area);
        // sum_b V_b W_b of the particles themselves around a place, without their images.
        let around = |[at_r, at_z]: [f64; 2], reach: f64| {
            let inverse_square = 1.0 / (reach * reach);
            let (lane_r, lane_z) = (Lanes::splat(at_r), Lanes::splat(at_z));
            let scale = Lanes::splat(inverse_square);
            let mut sum = Lanes::ZERO;
            list.near(at_r, at_z, reach + slack, |members| {
                for start in members.clone().step_by(WIDTH) {
                    let area = Lanes::load(&area[start..]).keep_first((members.end - start).min(WIDTH));
                    let dr = Lanes::load(&cell_r[start..]) - lane_r;
                    let dz = Lanes::load(&cell_z[start..]) - lane_z;
                    let inside = dr.mul_add(dr, dz * dz).neg_mul_add(scale, Lanes::ONE).max(Lanes::ZERO);
                    sum = (inside * inside).mul_add(area, sum);
                }
            });
            3.0 / PI * inverse_square * sum.sum()
        };
        // Who is inside has no boundary particle within the support 4 theta D, and those have half their size of liquid
        // beyond their centres: what the surface cuts off weighs some thousandths. (With half a size less the sums
        // near the surface and the axis differ by one per cent in packings that have settled.)
        let reach = 4.0 * self.packing.theta + 1.0;
        let mut void_fraction = world.store.write(self.void_fraction);
        parallel::for_chunks_of(64, r.len(), &mut void_fraction[..], |start, void_fraction| {
            for (k, void_fraction) in void_fraction.iter_mut().enumerate() {
                let i = start + k;
                let found = if surface[i] == INSIDE {
                    let reach = reach * packed.size(i).min(self.packing.largest_size);
                    // What its images see of the others is what it sees of their images.
                    let images = domain.images_of(r[i], z[i], reach);
                    let places = images.iter().map(|image| domain.place(image, r[i], z[i]));
                    let filled =
                        around([r[i], z[i]], reach) + places.map(|(r, z)| around([r, z], reach)).sum::<f64>();
                    1.0 - filled
                } else {
                    0.0
                };
                let beyond = found - found.clamp(-TOLERANCE, TOLERANCE);
                // Most are zero and stay so, and what is never written takes no memory.
                if *void_fraction != beyond {
                    *void_fraction = beyond;
                }
            }
        });
        void_fraction.iter().any(|beyond| *beyond != 0.0)
    }
}

impl ChunkStage for VoidClosing {
    fn name(&self) -> &'static str {
        "void-closing"
    }

    fn prepare(&mut self, world: &mut World) -> Result<(), Fault> {
        let step_size = world.clock.previous_step_size;
        let steps = world.clock.steps_within(self.longest, STEPS);
        if world.clock.step.is_multiple_of(steps) {
            self.has_voids = self.look(world);
        }
        self.rate_now = self.rate.min(MOST / (steps as f64 * step_size));
        Ok(())
    }

    fn chunk(&self, _: &Around, chunk: &Chunk) -> Partial {
        if !self.has_voids {
            return [0.0; 2];
        }
        let (void_fraction, mut strain_rate) =
            (chunk.read(self.void_fraction), chunk.write(self.strain_rate));
        for (strain_rate, void_fraction) in strain_rate.iter_mut().zip(&*void_fraction) {
            *strain_rate += self.rate_now * void_fraction;
        }
        [0.0; 2]
    }
}
