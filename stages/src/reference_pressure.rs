//! The reference pressure of every drop: a constant pressure that does not act on the packing's disorder.

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

    /// Joins every two particles within each other's support; the roots are the components' least
    /// particles.
    fn components<'a>(&self, world: &'a World) -> &'a mut [u32] {
        let [r, z] = self.position.map(|field| world.store.read(field));
        let size = world.store.read(self.size);
        let list = &world.neighbours;
        let Packing {
            domain,
            theta,
            largest_size,
        } = self.packing;
        let parent = world.arena.alloc_slice_fill_with(r.len(), |i| i as u32);
        for a in 0..r.len() {
            for number in list.of(a) {
                let b = list.source(number);
                if b >= a {
                    continue;
                }
                let (r_b, z_b) = match number.checked_sub(list.len()) {
                    Some(image) => domain.place(&list.images()[image], r[b], z[b]),
                    None => (r[b], z[b]),
                };
                let support = 2.0 * theta * (size[a].min(largest_size) + size[b].min(largest_size));
                let (dr, dz) = (r_b - r[a], z_b - z[a]);
                if dr * dr + dz * dz < support * support {
                    join(parent, a as u32, b as u32);
                }
            }
        }
        for i in 0..parent.len() {
            parent[i] = root(parent, i as u32);
        }
        parent
    }
}

fn root(parent: &mut [u32], mut i: u32) -> u32 {
    while parent[i as usize] != i {
        let above = parent[parent[i as usize] as usize];
        parent[i as usize] = above;
        i = above;
    }
    i
}

fn join(parent: &mut [u32], a: u32, b: u32) {
    let (a, b) = (root(parent, a), root(parent, b));
    parent[a.max(b) as usize] = a.min(b);
}

impl Stage for ReferencePressure {
    fn name(&self) -> &'static str {
        "reference-pressure"
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        if !world.clock.step.is_multiple_of(INTERVAL) {
            return Ok(());
        }
        let component = self.components(world);
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
