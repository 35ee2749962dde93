//! The reference pressure of every drop: a constant pressure that does not act on the packing's disorder, but does its work.

use crate::drops::{INTERVAL, count};
use crate::fields;
use crate::rows::PackedState;
use meniscus_engine::group::{Around, Chunk, ChunkStage, Partial};
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Add, Read, Update};
use meniscus_engine::wiring::Wiring;

/// The number of the clock that is the first drop's reference, Pa. Columns hold the others' less that: where there is
/// one drop, nothing is written and no memory taken.
pub const FIRST_REFERENCE: &str = "reference pressure of the first drop";

/// How far the reference follows the mean pressure in one update.
const RELAXATION: f64 = 0.05;

/// How far a body's pressures may spread: where their variance is a tenth of their mean's square, the reference is
/// half the mean. (Of .025, .05, .1 and .5 the one with which twelve fast collisions of small drops gain the least.)
const SPREAD: f64 = 0.1;

/// The gauge of method.md, section 10 ("Two drops of different size"): one reference per drop, followed slowly; where
/// drops merge, their references merge by mass. It is P/(1 + (v/(.1 P^2))^2) with the mean P by mass and the variance v.
///
/// In a drop that swings gently that is the mean, and the least of the pressure acts on the packing. Where pressures
/// differ, less the mean the lower ones are a tension, which pulls particles together (the tensile instability, Swegle
/// et al. 1995) and opens voids: films with 36 and 50 particles over the thickness swelled by 15 and 30 % in
/// their flat part, where there is no pressure, and a drop of aspect ratio 3 gained its own energy.
pub struct ReferencePressure {
    drop: Read<u32>,
    mass: Read<f64>,
    reference: Update<f64>,
}

impl ReferencePressure {
    /// Updates the reference that the next step uses.
    pub fn new(wiring: &mut Wiring) -> Self {
        wiring.stage("reference-pressure");
        ReferencePressure {
            drop: wiring.read(&fields::DROP),
            mass: wiring.read(&fields::MASS),
            reference: wiring.update(&fields::REFERENCE_PRESSURE),
        }
    }
}

impl Stage for ReferencePressure {
    fn name(&self) -> &'static str {
        "reference-pressure"
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        if !world.clock.step.is_multiple_of(INTERVAL) {
            return Ok(());
        }
        let first = world.clock.number(FIRST_REFERENCE);
        let drop = world.store.read(self.drop);
        let (mass, packed) = (world.store.read(self.mass), PackedState(&world.rows));
        let mut reference = world.store.write(self.reference);
        // Per drop: mass, and mass times reference, times pressure, and times that squared.
        let sums = world.arena.alloc_slice_fill_copy(count(&drop), [0.0f64; 4]);
        for (i, &number) in drop.iter().enumerate() {
            let reference = first + reference[i];
            let (sum, pressure) = (&mut sums[number as usize], packed.pressure(i) + reference);
            sum[0] += mass[i];
            sum[1] += mass[i] * reference;
            sum[2] += mass[i] * pressure;
            sum[3] += mass[i] * pressure * pressure;
        }
        for sum in &mut *sums {
            let [before, mean, square] = [1, 2, 3].map(|k| sum[k] / sum[0]);
            let spread = (square / (mean * mean) - 1.0) / SPREAD;
            let now = if mean == 0.0 { 0.0 } else { mean / (1.0 + spread * spread) };
            sum[1] = before + RELAXATION * (now - before);
        }
        let [_, first, ..] = sums[0];
        for (reference, &number) in reference.iter_mut().zip(drop.iter()) {
            let now = sums[number as usize][1] - first;
            if *reference != now {
                *reference = now;
            }
        }
        world.clock.set_number(FIRST_REFERENCE, first);
        Ok(())
    }
}

/// rho dE/dt += -P_ref d eps/dt, the work of the reference pressure in scenes that solve for the total energy. Contacts and
/// ghosts lack it, whose pressures are those less the reference: with the harmonic-mean weights, the ghost's weight bw
/// (equation (23)) and its velocity U*, a constant pressure P_ref gives a particle the power P_ref (2 U . bw - d eps/dt) by
/// its contacts, of whose first part only the force is left out, that of the packing's disorder, or its ghost's takes
/// it back (equations (16), (18) and (26)).
pub struct ReferenceWork {
    reference: Read<f64>,
    strain_rate: Read<f64>,
    power: Add<f64>,
}

impl ReferenceWork {
    /// Adds to the power.
    pub fn new(wiring: &mut Wiring) -> Self {
        wiring.stage("reference-work");
        ReferenceWork {
            reference: wiring.read(&fields::REFERENCE_PRESSURE),
            strain_rate: wiring.read(&fields::STRAIN_RATE),
            power: wiring.add(&fields::POWER),
        }
    }
}

impl ChunkStage for ReferenceWork {
    fn name(&self) -> &'static str {
        "reference-work"
    }

    fn chunk(&self, around: &Around, chunk: &Chunk) -> Partial {
        let first = around.clock.number(FIRST_REFERENCE);
        let (reference, strain_rate) = (chunk.read(self.reference), chunk.read(self.strain_rate));
        let mut power = chunk.write(self.power);
        for ((power, reference), strain_rate) in power.iter_mut().zip(&*reference).zip(&*strain_rate) {
            *power -= (first + reference) * strain_rate;
        }
        [0.0; 2]
    }
}
