//! Evening of sizes: neighbours whose sizes have become too different exchange mass.

use crate::equation_of_state::Packing;
use crate::fields;
use crate::rows::PackedState;
use crate::time_step::{INNERMOST, steps_to_move};
use arrayvec::ArrayVec;
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Read, Update};
use meniscus_engine::wiring::Wiring;

/// Difference of two areas over their sum that remains. With .1 the sizes over ten neighbours may still differ by a factor of
/// 2.7. Packings that have settled have differences up to .05; that those become even, too, makes a drop's mode 2 slower by 2e-5.
const TOLERANCE: f64 = 0.03;

/// Part of what is beyond it that is exchanged each time: all neighbours give at the same time.
const PART: f64 = 0.5;

/// Farthest way of any particle, in sizes, from one exchange to the next: it is the flow that makes sizes uneven, and
/// a gentle one has hardly any.
const FARTHEST: f64 = 0.5;
/// Fewest and most steps that this may take. With ten at least violent flows take another 5 % longer steps, for twice the exchanges.
const STEPS: [u64; 2] = [20, 1280];

/// Sum of 1 - q over the neighbours of a particle in a settled packing, over theta^2: six at q = 1/2 and six at .87 with
/// theta = .5. (With 4 for every theta a particle among fifty neighbours came to have a negative mass, theta = 1.)
const NEIGHBOURS: f64 = 16.0;

/// What mass carries along besides its place: velocity, the acceleration of the step before, energy.
pub(crate) type Carried = ArrayVec<Update<f64>, CARRIED>;
const CARRIED: usize = 5;

/// Exchange of mass, which neither the paper nor method.md has.
///
/// Of two neighbours with areas V = D^2, over what they want to have (`wanted_size`), the larger gives the smaller one mass until
/// x = (V_b - V_a)/(V_a + V_b) is no more than the tolerance:
///
///   dm_ab = PART (1 - q)/(16 theta^2) 2 m_a m_b/(m_a + m_b) (x - TOLERANCE sign x).
///
/// What is given comes from half the way between both and has the mean of their velocities. So mass, momentum and the
/// first moment of mass are kept, and a flow that is linear in the place; kinetic energy is to first order in dm, as
/// dm ((U_a - U_b) . U - (U_a^2 - U_b^2)/2) vanishes for the mean U.
///
/// A ring keeps its mass m = 2 pi R V rho, so V falls where it moves outward. A smooth flow hardly changes ratios of
/// neighbours' R. But where it compresses the packing along the axis, rings leave the innermost row, at R = .43 D, and
/// when it is drawn out again others take their places. In a drop that swung far, rings of that row came along the
/// surface to R = 24 D within four swings, with .14 of their size. They held everyone's step, and gathered where the
/// surface was rough.
///
/// The smallest of all bounds the step. With a tolerance of .1 and a third exchanged every eighty steps it measured .60 of the
/// median in a long drop that had drawn together, gone flat and come back (`cases/oscillating-drop/hard.toml`, 20 to the half-axis), the largest 2.6; now
/// they are .77 and 2.0. Eleven such drops take 14 % fewer steps, 29 fast collisions 22 %.
pub struct SizeEvening {
    packing: Packing,
    position: [Update<f64>; 2],
    velocity: [Read<f64>; 2],
    mass: Update<f64>,
    refinement: Read<f64>,
    carried: Carried,
}

/// What a particle gains, with its sign.
#[derive(Clone, Copy, Debug, Default)]
struct Gain {
    /// kg.
    mass: f64,
    /// Of the first moment of mass about the particle's place, kg m.
    moment: [f64; 2],
    /// Of each carried quantity, beyond the particle's own times the mass gained.
    carried: [f64; CARRIED],
}

impl SizeEvening {
    /// It must end the step: forces are balanced for the masses they were computed with. `two_step` where the
    /// accelerations of the step before still count.
    pub fn new(wiring: &mut Wiring, packing: Packing, two_step: bool, with_energy: bool) -> Self {
        wiring.stage("size-evening");
        SizeEvening {
            packing,
            velocity: fields::VELOCITY.map(|field| wiring.read(field)),
            position: fields::POSITION.map(|field| wiring.update(field)),
            mass: wiring.update(&fields::MASS),
            refinement: wiring.read(&fields::REFINEMENT),
            carried: carried_by_mass(wiring, two_step, with_energy),
        }
    }

    /// Who has a neighbour of another size: in a gentle flow nobody. (What is noted here of particles lies in the scratch
    /// memory of a step: in a violent flow it is of most.)
    fn find_uneven<'a>(&self, world: &'a World) -> &'a [u32] {
        let (packed, list) = (PackedState(&world.rows), &world.neighbours);
        let refinement = world.store.read(self.refinement);
        let refinement = &refinement[..];
        let area = |i: usize| (packed.area(i), 1.0 - refinement[i]);
        let is_uneven = |i: usize| {
            let own = area(i);
            list.of(i).any(|number| excess(own, area(list.source(number))) != 0.0)
        };
        let uneven = world.arena.alloc_slice_fill_copy(world.store.len(), 0);
        parallel::for_chunks(uneven.len(), &mut uneven[..], |start, marks: &mut [u32]| {
            for (k, mark) in marks.iter_mut().enumerate() {
                *mark = u32::from(is_uneven(start + k));
            }
        });
        // Those marked move up, in place.
        let mut count = 0;
        for i in 0..uneven.len() {
            if uneven[i] != 0 {
                uneven[count] = i as u32;
                count += 1;
            }
        }
        &uneven[..count]
    }

    /// What they gain.
    fn find_gains<'a>(&self, world: &'a World, uneven: &[u32]) -> &'a [Gain] {
        let domain = &self.packing.domain;
        let packed = PackedState(&world.rows);
        let [r, z] = self.position.map(|field| world.store.read(field));
        let mass = world.store.read(self.mass);
        let carried: ArrayVec<_, CARRIED> =
            self.carried.iter().map(|&field| world.store.read(field)).collect();
        let carried: ArrayVec<&[f64], CARRIED> = carried.iter().map(|column| &column[..]).collect();
        let (r, z, mass, list) = (&r[..], &z[..], &mass[..], &world.neighbours);
        let refinement = world.store.read(self.refinement);
        let refinement = &refinement[..];
        let area = |i: usize| (packed.area(i), 1.0 - refinement[i]);
        let part = PART / (NEIGHBOURS * self.packing.theta.powi(2));
        let gain_of = |a: usize| {
            let mut gain = Gain::default();
            for number in list.of(a) {
                let b = list.source(number);
                let excess = excess(area(a), area(b));
                if excess == 0.0 {
                    continue;
                }
                // Across the axis lies the same ring.
                if list.is_mirrored(number) {
                    continue;
                }
                let (r_b, z_b) = list.place_of(number, domain, [r, z]);
                let (dr, dz) = (r_b - r[a], z_b - z[a]);
                let support = self.packing.reach(packed.size(a)) + self.packing.reach(packed.size(b));
                let inside = (1.0 - (dr * dr + dz * dz).sqrt() / support).max(0.0);
                let both = 2.0 * mass[a] * mass[b] / (mass[a] + mass[b]);
                let given = part * inside * both * excess;
                gain.mass += given;
                gain.moment[0] += 0.5 * given * dr;
                gain.moment[1] += 0.5 * given * dz;
                for (sum, column) in gain.carried.iter_mut().zip(&carried) {
                    *sum += 0.5 * given * (column[b] - column[a]);
                }
            }
            gain
        };
        let gains = world.arena.alloc_slice_fill_default(uneven.len());
        parallel::for_chunks_of(64, uneven.len(), &mut gains[..], |start, gains: &mut [Gain]| {
            for (gain, &i) in gains.iter_mut().zip(&uneven[start..]) {
                *gain = gain_of(i as usize);
            }
        });
        gains
    }

    /// Gives out what was found; no less than how far, m, any of them moved and its reach grew.
    fn exchange(&self, world: &World, uneven: &[u32], gains: &[Gain]) -> f64 {
        let packed = PackedState(&world.rows);
        let [mut r, mut z] = self.position.map(|field| world.store.write(field));
        let mut mass = world.store.write(self.mass);
        let mut carried: ArrayVec<_, CARRIED> =
            self.carried.iter().map(|&field| world.store.write(field)).collect();
        let mut farthest = 0.0_f64;
        for (&i, gain) in uneven.iter().zip(gains) {
            let i = i as usize;
            let now = mass[i] + gain.mass;
            let [dr, dz] = gain.moment.map(|moment| moment / now);
            // The innermost rings stay where they are; nothing would hold them off the axis.
            let size = packed.size(i);
            let radius = r[i] + self.packing.domain.origin;
            let dr = if radius + dr < INNERMOST * size { dr.max(0.0) } else { dr };
            // A ring that moves inward grows in the plane, too.
            let growth = (now / mass[i] * radius / (radius + dr)).sqrt() - 1.0;
            r[i] += dr;
            z[i] += dz;
            mass[i] = now;
            for (column, sum) in carried.iter_mut().zip(gain.carried) {
                column[i] += sum / now;
            }
            let reach = 2.0 * self.packing.theta * size;
            farthest = farthest.max((dr * dr + dz * dz).sqrt() + reach * growth.abs());
        }
        farthest
    }
}

/// Whether the flow may have changed sizes since they were last looked at.
pub(crate) fn is_due(world: &World, velocity: [Read<f64>; 2], packing: &Packing) -> bool {
    let step = world.clock.step;
    let interval = || {
        let [u, w] = velocity.map(|field| world.store.read(field));
        steps_to_move(&world.clock, [&u, &w], FARTHEST * 0.5 * packing.largest_size, STEPS)
    };
    step.is_multiple_of(STEPS[0]) && step.is_multiple_of(interval())
}

/// The columns of what mass carries along, those of the velocity first.
pub(crate) fn carried_by_mass(wiring: &mut Wiring, two_step: bool, with_energy: bool) -> Carried {
    let mut carried = Carried::new();
    carried.extend(fields::VELOCITY.map(|field| wiring.update(field)));
    if two_step {
        carried.extend(fields::PREVIOUS_ACCELERATION.map(|field| wiring.update(field)));
    }
    if with_energy {
        carried.push(wiring.update(&fields::TOTAL_ENERGY));
    }
    carried
}

/// By how much (V_b - V_a)/(V_a + V_b) is beyond the tolerance, of areas (V, V_w/V_0) over the wanted ones.
#[inline]
fn excess((area_a, wanted_a): (f64, f64), (area_b, wanted_b): (f64, f64)) -> f64 {
    let (a, b) = (area_a * wanted_b, area_b * wanted_a);
    let (difference, both) = (b - a, a + b);
    let tolerated = TOLERANCE * both;
    if difference.abs() <= tolerated {
        return 0.0;
    }
    (difference - tolerated.copysign(difference)) / both
}

impl Stage for SizeEvening {
    fn name(&self) -> &'static str {
        "size-evening"
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        if !is_due(world, self.velocity, &self.packing) {
            return Ok(());
        }
        let uneven = self.find_uneven(world);
        if uneven.is_empty() {
            return Ok(());
        }
        let farthest = self.exchange(world, uneven, self.find_gains(world, uneven));
        world.neighbours.note_motion(farthest);
        world.neighbours.still_holds = None;
        world.rows.are_current = false;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_one_gains_the_other_gives() {
        let excess_of = |a, b| excess((a, 1.0), (b, 1.0));
        assert_eq!(excess_of(1.0, 1.05), 0.0);
        assert_eq!(excess_of(1.0, 3.0), 0.5 - TOLERANCE);
        assert_eq!(excess_of(3.0, 1.0), -excess_of(1.0, 3.0));
        assert_eq!(excess((1.0, 0.5), (0.5, 0.25)), 0.0);
        assert_eq!(excess((1.0, 1.0), (1.5, 0.5)), excess_of(1.0, 3.0));
    }
}
