//! Sort and bin: Morton order and the neighbour list, anew when particles have moved too far.

use crate::equation_of_state::Packing;
use crate::fields;
use meniscus_engine::group::{Around, Chunk, ChunkStage, Partial};
use meniscus_engine::lanes::{Lanes, WIDTH};
use meniscus_engine::morton;
use meniscus_engine::neighbours::{NeighbourList, WINDOW};
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Read, Update};
use meniscus_engine::wiring::Wiring;
use std::f64::consts::PI;

/// The first skin, for particles whose speed is not known yet.
const FIRST_SKIN: f64 = 0.1;
/// The narrowest skin, below which a list is built too often to be worth it whatever the particles do.
const NARROWEST_SKIN: f64 = 0.02;
/// The widest skin.
pub(crate) const WIDEST_SKIN: f64 = 1.0;
/// The cost of building the list over that of the pairs that a skin of one particle size adds to a step.
const BUILD_COST: f64 = 2.0;
/// Steps for which a list must hold for it to pay that lists of eight particles become even.
const LASTING: f64 = 12.0;
/// Parts of its own speed and of the mean one at which a particle may use up its half of the skin: flows change while a
/// list holds.
const OF_OWN: f64 = 1.25;
const OF_MEAN: f64 = 0.25;

/// When the list was built, among the numbers of the clock.
pub const LISTED: &str = "list";

/// The stage. The list is a pure function of the State (order, and the positions and reaches for which
/// it was built), so that a resumed run finds the list that the interrupted one had.
///
/// A reach includes half of the skin, the distance that a pair may close in before the list is built anew. Each particle
/// has its own, in proportion to its speed v: of a jet some particles are twenty times as fast as the mean, and with one skin for all
/// they would have the list built in every step. With a half T (1.25 v + .25 v_mean) a list holds for a time T; building costs
/// 2 dt/T of a build a step, and walking the pairs in the skin costs in proportion to T v_mean: the sum is
/// least for the square root that [`SortBin`] takes, from the motion since the last build.
pub struct SortBin {
    packing: Packing,
    position: [Update<f64>; 2],
    density: Read<f64>,
    mass: Read<f64>,
    listed: [Update<f64>; 3],
}

impl SortBin {
    /// `packing` gives the support of a pair.
    pub fn new(wiring: &mut Wiring, packing: Packing) -> Self {
        wiring.stage("sort-bin");
        SortBin {
            packing,
            position: fields::POSITION.map(|field| wiring.update(field)),
            density: wiring.read(&fields::DENSITY),
            mass: wiring.read(&fields::MASS),
            listed: fields::LISTED.map(|field| wiring.update(field)),
        }
    }

    /// Whether every particle lies within the circle for which the list was built.
    fn is_valid(&self, world: &World) -> bool {
        let [r, z] = self.position.map(|field| world.store.read(field));
        let listed = self.listed.map(|field| world.store.read(field));
        let (density, mass) = (world.store.read(self.density), world.store.read(self.mass));
        let listed = listed.each_ref().map(|column| &column[..]);
        self.packing.are_within([&r, &z, &density, &mass], listed)
    }

    /// Calls `build` with list and places. This is the first stage: Derived columns lend the list
    /// their memory, and what they held must be made anew.
    fn with_list<R>(&self, world: &mut World, build: impl FnOnce(&mut NeighbourList, [&[f64]; 3]) -> R) -> R {
        world.store.swap_derived(&mut world.neighbours.scratch);
        world.rows.are_current = false;
        let listed = self.listed.map(|field| world.store.read(field));
        let built = build(&mut world.neighbours, listed.each_ref().map(|column| &column[..]));
        drop(listed);
        world.store.swap_derived(&mut world.neighbours.scratch);
        built
    }

    /// Builds the list, and orders particles within a window so that there is less of it to fill up, if that pays.
    fn build_even(&self, world: &mut World, pays: bool) {
        let domain = &self.packing.domain;
        let is_new = self.with_list(world, |list, points| {
            list.count(points, domain);
            let is_new = pays && list.find_even_order();
            if !is_new {
                list.fill(points);
            }
            is_new
        });
        if is_new {
            world.store.permute(world.neighbours.order());
            self.with_list(world, |list, points| {
                list.reorder(points, domain);
                list.fill(points);
            });
        }
    }

    /// What [`Skins`] cost least if particles at (r, z), m, go on as since the last list was built; each one's speed, m/s,
    /// is noted in `speeds`.
    fn best_skins(&self, world: &World, [r, z]: [&[f64]; 2], speeds: &mut [f64]) -> Skins {
        let size = 0.5 * self.packing.largest_size;
        let [narrowest, first, widest] =
            [NARROWEST_SKIN, FIRST_SKIN, WIDEST_SKIN].map(|skin| 0.5 * skin * size);
        let elapsed = world.clock.time - world.clock.mark(LISTED);
        if elapsed <= 0.0 {
            speeds.fill(0.0);
            return Skins { steps: LASTING, lifetime: 0.0, mean: 0.0, narrowest: first, widest };
        }
        let [list_r, list_z] = [self.listed[0], self.listed[1]].map(|field| world.store.read(field));
        for (i, speed) in speeds.iter_mut().enumerate() {
            let (dr, dz) = (r[i] - list_r[i], z[i] - list_z[i]);
            *speed = (dr * dr + dz * dz).sqrt() / elapsed;
        }
        let mean = (parallel::sum_of(speeds) / speeds.len() as f64).max(f64::MIN_POSITIVE);
        let step_size = world.clock.previous_step_size;
        let steps = (0.5 * BUILD_COST * size / ((OF_OWN + OF_MEAN) * mean * step_size)).sqrt();
        Skins { steps, lifetime: steps * step_size, mean, narrowest, widest }
    }

    /// Wraps a periodic domain, sorts, and notes where the list is built.
    fn renew(&self, world: &mut World) {
        let mut memory = world.neighbours.take_entries();
        let (order, skins) = {
            let [r, mut z] = self.position.map(|field| world.store.write(field));
            let mut list_reach = world.store.write(self.listed[2]);
            let skins = self.best_skins(world, [&r, &z], &mut list_reach);
            // Not before: who crosses the period has not moved by it.
            if let Some((bottom, length)) = self.packing.domain.period {
                for z in z.iter_mut() {
                    *z -= length * ((*z - bottom) / length).floor();
                }
            }
            let [mut list_r, mut list_z] =
                [self.listed[0], self.listed[1]].map(|field| world.store.write(field));
            let (density, mass) = (world.store.read(self.density), world.store.read(self.mass));
            list_r.copy_from_slice(&r);
            list_z.copy_from_slice(&z);
            for (i, reach) in list_reach.iter_mut().enumerate() {
                let size = self.packing.size(r[i], density[i], mass[i]);
                *reach = self.packing.reach(size) + skins.half_of(*reach);
            }
            let cell = parallel::maximum(r.len(), |i| list_reach[i]);
            (morton::order(&r, &z, cell, WINDOW, &mut memory), skins)
        };
        if let Some(order) = order {
            world.store.permute(order);
        }
        world.neighbours.return_entries(memory);
        world.clock.set_mark(LISTED);
        self.build_even(world, skins.steps >= LASTING);
        world.neighbours.margin = skins.half_of(0.0);
    }
}

/// How wide skins are.
#[derive(Clone, Copy, Debug)]
struct Skins {
    /// For how many steps the list should hold.
    steps: f64,
    /// How long that is, s.
    lifetime: f64,
    /// Mean speed, m/s.
    mean: f64,
    /// Bounds of half a skin, m.
    narrowest: f64,
    widest: f64,
}

impl Skins {
    /// Half of the skin, m, of a particle with that speed, m/s.
    fn half_of(&self, speed: f64) -> f64 {
        let half = self.lifetime * (OF_OWN * speed + OF_MEAN * self.mean);
        half.clamp(self.narrowest, self.widest)
    }
}

impl Stage for SortBin {
    fn name(&self) -> &'static str {
        "sort-bin"
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        // Where a list was built before this run began, its places are still noted.
        let listed = world.store.read(self.listed[2]).first().is_some_and(|reach| *reach > 0.0);
        if listed && world.neighbours.is_empty() {
            self.with_list(world, |list, points| list.build(points, &self.packing.domain));
            world.neighbours.margin = 0.0;
        }
        if world.store.is_changed() {
            // What somebody moved from outside is not in the margin.
            world.neighbours.margin = 0.0;
        }
        // A NaN builds the list, too, and goes on to the stage that names it.
        let checked = world.neighbours.still_holds.take();
        let checked = checked.or((world.neighbours.margin > 0.0).then_some(true));
        let checked = checked.filter(|_| !world.store.is_changed());
        let holds = !world.neighbours.is_empty() && checked.unwrap_or_else(|| self.is_valid(world));
        if !holds {
            self.renew(world);
        }
        Ok(())
    }
}

impl Packing {
    /// Whether particles (columns r, z, density and mass) lie within the circles for which the list was built (r, z and
    /// reach), all in SI units, and nobody beyond the slack, where one that flew outward has become smaller; not so for a NaN.
    fn are_within(
        &self,
        [r, z, density, mass]: [&[f64]; 4],
        [list_r, list_z, list_reach]: [&[f64]; 3],
    ) -> bool {
        let origin = Lanes::splat(self.domain.origin);
        let [largest, slack] = [self.largest_size, self.slack()].map(Lanes::splat);
        let (two_pi, two_theta) = (Lanes::splat(2.0 * PI), Lanes::splat(2.0 * self.theta));
        (0..r.len()).step_by(WIDTH).all(|k| {
            let load = |column: &[f64], fill| Lanes::load_or(&column[k..r.len().min(k + WIDTH)], fill);
            let radius = load(r, 1.0);
            let (dr, dz) = (radius - load(list_r, 1.0), load(z, 0.0) - load(list_z, 0.0));
            let area = load(mass, 0.0) / (two_pi * (radius + origin) * load(density, 1.0));
            let reach = two_theta * area.sqrt().min(largest);
            let room = (load(list_reach, 1.0) - reach).min(slack);
            room.all_positive() && (room * room - dr.mul_add(dr, dz * dz)).all_positive()
        })
    }
}

/// Looks at the end of a step whether the list still holds for the next one, while the particles lie in the cache;
/// only where what moved farthest in each step could have used up the skin.
pub struct ListCheck {
    packing: Packing,
    is_needed: bool,
    /// The list's margin before the step, m.
    margin: f64,
    particles: [Read<f64>; 4],
    listed: [Read<f64>; 3],
}

impl ListCheck {
    /// `packing` gives the support of a pair.
    pub fn new(wiring: &mut Wiring, packing: Packing) -> Self {
        wiring.stage("list-check");
        let particles = [&fields::RADIUS, &fields::AXIAL, &fields::DENSITY, &fields::MASS];
        ListCheck {
            packing,
            is_needed: true,
            margin: 0.0,
            particles: particles.map(|field| wiring.read(field)),
            listed: fields::LISTED.map(|field| wiring.read(field)),
        }
    }
}

impl ChunkStage for ListCheck {
    fn name(&self) -> &'static str {
        "list-check"
    }

    fn prepare(&mut self, world: &mut World) -> Result<(), Fault> {
        // This step's motion is not known yet: it may be twice the one before.
        let margin = world.neighbours.margin;
        let before = std::mem::replace(&mut self.margin, margin);
        let is_enough = margin > 2.0 * (before - margin).max(0.0);
        self.is_needed = !is_enough;
        Ok(())
    }

    /// Above zero where it doesn't hold.
    fn chunk(&self, _: &Around, chunk: &Chunk) -> Partial {
        if !self.is_needed {
            return [0.0; 2];
        }
        let particles = self.particles.map(|field| chunk.read(field));
        let listed = self.listed.map(|field| chunk.read(field));
        let particles = particles.each_ref().map(|column| &column[..]);
        let holds = self.packing.are_within(particles, listed.each_ref().map(|column| &column[..]));
        [if holds { 0.0 } else { 1.0 }, 0.0]
    }

    fn finish(&mut self, world: &mut World, [fails, _]: Partial) -> Result<(), Fault> {
        world.neighbours.still_holds = self.is_needed.then_some(fails == 0.0);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use meniscus_engine::domain::Domain;

    /// A ring that flies outward becomes smaller, which gives it room in its circle; but stages that look for the surface
    /// count on nobody having moved farther than the slack.
    #[test]
    fn nobody_moves_farther_than_the_slack() {
        let packing = Packing { domain: Domain::default(), theta: 0.5, largest_size: 2.0 };
        let listed = packing.reach(1.0) + 0.5;
        let holds = |way: f64| {
            let radius = 2.0 + way;
            let mass = [2.0 * PI * 2.0];
            packing.are_within([&[radius], &[0.0], &[1.0], &mass], [&[2.0], &[0.0], &[listed]])
        };
        assert!(packing.reach(packing.size(2.6, 1.0, 4.0 * PI)) + 0.6 < listed, "there is room");
        assert!(holds(0.4) && !holds(0.6));
    }
}
