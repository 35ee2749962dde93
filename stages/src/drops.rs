//! Which particles belong to one drop.

use crate::components::components;
use crate::equation_of_state::Packing;
use crate::fields;
use crate::rows::PackedState;
use crate::time_step::steps_to_move;
use bumpalo::Bump;
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Read, Update};
use meniscus_engine::wiring::Wiring;

/// Fewest steps between two looks.
pub const INTERVAL: u64 = 20;
/// Most of them.
const MOST_STEPS: u64 = 32 * INTERVAL;
/// How far the fastest particle may move, in particle sizes, in more steps than the fewest.
const FARTHEST: f64 = 0.1;

/// Numbers the drops, the connected components of the pair graph, from zero on (method.md, section 10, "Two
/// drops of different size"). Which they are changes no faster than particles move.
pub struct Drops {
    packing: Packing,
    position: [Read<f64>; 2],
    velocity: [Read<f64>; 2],
    drop: Update<u32>,
}

impl Drops {
    /// Looks for drops every [`INTERVAL`] steps, less often where all are slow.
    pub fn new(wiring: &mut Wiring, packing: Packing) -> Self {
        wiring.stage("drops");
        Drops {
            packing,
            position: fields::POSITION.map(|field| wiring.read(field)),
            velocity: fields::VELOCITY.map(|field| wiring.read(field)),
            drop: wiring.update(&fields::DROP),
        }
    }

    /// Steps between two looks at the present pace.
    fn interval(&self, world: &World) -> u64 {
        let [u, w] = self.velocity.map(|field| world.store.read(field));
        let farthest = FARTHEST * 0.5 * self.packing.largest_size;
        steps_to_move(&world.clock, [&u, &w], farthest, [INTERVAL, MOST_STEPS])
    }
}

impl Stage for Drops {
    fn name(&self) -> &'static str {
        "drops"
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        let step = world.clock.step;
        if !step.is_multiple_of(INTERVAL) || !step.is_multiple_of(self.interval(world)) {
            return Ok(());
        }
        let [r, z] = self.position.map(|field| world.store.read(field));
        let packed = PackedState(&world.rows);
        let reach = |i: usize| self.packing.reach(packed.size(i));
        let root = components(&world.neighbours, &self.packing.domain, [&r, &z], reach, &world.arena);
        let mut drop = world.store.write(self.drop);
        let mut count = 0;
        // A component is named after its least particle, which comes first.
        for (i, &root) in root.iter().enumerate() {
            let number = if root as usize == i {
                count += 1;
                count - 1
            } else {
                drop[root as usize]
            };
            // Memory of the first drop, which may be the only one, need not be written.
            if drop[i] != number {
                drop[i] = number;
            }
        }
        Ok(())
    }
}

/// Number of drops that particles are numbered by, at least one.
pub fn count(drop: &[u32]) -> usize {
    let most = |_: usize, drop: &[u32], _: usize| drop.iter().copied().fold(0, u32::max);
    parallel::fold_chunks(drop.len(), drop, &most, &u32::max) as usize + 1
}

/// How many particles each drop has.
pub(crate) fn particles_of_drops<'a>(drop: &[u32], arena: &'a Bump) -> &'a [u32] {
    let particles = arena.alloc_slice_fill_copy(count(drop), 0);
    drop.iter().for_each(|&number| particles[number as usize] += 1);
    particles
}
