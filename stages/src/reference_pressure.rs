//! The reference pressure of every drop: a constant pressure that does not act on the packing's disorder.

use crate::components::components;
use crate::equation_of_state::Packing;
use crate::fields;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Read, Update};
use meniscus_engine::wiring::Wiring;

/// Steps between two updates.
const INTERVAL: u64 = 20;
/// How far the reference follows the mean pressure in one update.
const RELAXATION: f64 = 0.05;

/// The gauge of method.md, section 10 ("Two drops of different size"): one reference per connected
/// component of the pair graph, the mass-weighted mean pressure, followed slowly; where components
/// merge, their references merge by mass.
pub struct ReferencePressure {
    packing: Packing,
    position: [Read<f64>; 2],
    size: Read<f64>,
    mass: Read<f64>,
    pressure: Read<f64>,
    reference: Update<f64>,
}

impl ReferencePressure {
    /// Updates the reference that the next step uses.
    pub fn new(wiring: &mut Wiring, packing: Packing) -> Self {
        wiring.stage("reference-pressure");
        ReferencePressure {
            packing,
            position: [wiring.read(&fields::RADIUS), wiring.read(&fields::AXIAL)],
            size: wiring.read(&fields::SIZE),
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
        let component = {
            let [r, z] = self.position.map(|field| world.store.read(field));
            components(&world.neighbours, &self.packing, [&r, &z, &world.store.read(self.size)], &world.arena)
        };
        let (mass, pressure) = (world.store.read(self.mass), world.store.read(self.pressure));
        let mut reference = world.store.write(self.reference);
        // Per component: mass, mass times reference, mass times pressure above the reference.
        let sums = world.arena.alloc_slice_fill_copy(mass.len(), [0.0f64; 3]);
        for (i, &root) in component.iter().enumerate() {
            let sum = &mut sums[root as usize];
            sum[0] += mass[i];
            sum[1] += mass[i] * reference[i];
            sum[2] += mass[i] * (pressure[i] + reference[i]);
        }
        for (reference, &root) in reference.iter_mut().zip(component.iter()) {
            let [mass, before, now] = sums[root as usize];
            *reference = (before + RELAXATION * (now - before)) / mass;
        }
        Ok(())
    }
}
