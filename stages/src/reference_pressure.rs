//! The reference pressure of every drop: a constant pressure that does not act on the packing's disorder.

use crate::drops::{INTERVAL, count};
use crate::fields;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Read, Update};
use meniscus_engine::wiring::Wiring;

/// How far the reference follows the mean pressure in one update.
const RELAXATION: f64 = 0.05;

/// The gauge of method.md, section 10 ("Two drops of different size"): one reference per drop,
/// the mass-weighted mean pressure, followed slowly; where drops
/// merge, their references merge by mass.
pub struct ReferencePressure {
    drop: Read<u32>,
    mass: Read<f64>,
    pressure: Read<f64>,
    reference: Update<f64>,
}

impl ReferencePressure {
    /// Updates the reference that the next step uses.
    pub fn new(wiring: &mut Wiring) -> Self {
        wiring.stage("reference-pressure");
        ReferencePressure {
            drop: wiring.read(&fields::DROP),
            mass: wiring.read(&fields::MASS),
            pressure: wiring.read(&fields::PRESSURE),
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
        let drop = world.store.read(self.drop);
        let (mass, pressure) = (world.store.read(self.mass), world.store.read(self.pressure));
        let mut reference = world.store.write(self.reference);
        // Per drop: mass, mass times reference, mass times pressure above the reference.
        let sums = world.arena.alloc_slice_fill_copy(count(&drop), [0.0f64; 3]);
        for (i, &number) in drop.iter().enumerate() {
            let sum = &mut sums[number as usize];
            sum[0] += mass[i];
            sum[1] += mass[i] * reference[i];
            sum[2] += mass[i] * (pressure[i] + reference[i]);
        }
        for (reference, &number) in reference.iter_mut().zip(drop.iter()) {
            let [mass, before, now] = sums[number as usize];
            *reference = (before + RELAXATION * (now - before)) / mass;
        }
        Ok(())
    }
}
