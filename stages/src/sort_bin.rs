//! Sort and bin: Morton order and the neighbour list, anew when particles have moved too far.

use crate::equation_of_state::Packing;
use crate::fields;
use meniscus_engine::morton;
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Read, Update};
use meniscus_engine::wiring::Wiring;
use std::f64::consts::PI;

/// The stage. The list is a pure function of the State (order, and the positions and reaches at which
/// it was built), so that a resumed run finds the list that the interrupted one had.
pub struct SortBin {
    packing: Packing,
    skin: f64,
    position: [Update<f64>; 2],
    density: Read<f64>,
    mass: Read<f64>,
    listed: [Update<f64>; 3],
    reach: Vec<f64>,
    keys: Vec<(u64, u32)>,
    order: Vec<u32>,
}

impl SortBin {
    /// `skin` is the distance in metres that a pair may close in before the list is built anew.
    pub fn new(wiring: &mut Wiring, packing: Packing, skin: f64) -> Self {
        wiring.stage("sort-bin");
        let listed = [&fields::LIST_RADIUS, &fields::LIST_AXIAL, &fields::LIST_REACH];
        SortBin {
            packing,
            skin,
            position: [wiring.update(&fields::RADIUS), wiring.update(&fields::AXIAL)],
            density: wiring.read(&fields::DENSITY),
            mass: wiring.read(&fields::MASS),
            listed: listed.map(|field| wiring.update(field)),
            reach: Vec::new(),
            keys: Vec::new(),
            order: Vec::new(),
        }
    }

    /// Half the support radius of every particle, 2 theta D.
    fn measure_reach(&mut self, world: &World) {
        let r = world.store.write(self.position[0]);
        let (density, mass) = (world.store.read(self.density), world.store.read(self.mass));
        let Packing { domain, theta, largest_size } = self.packing;
        self.reach.resize(r.len(), 0.0);
        let columns = (&r[..], &density[..], &mass[..], &mut self.reach[..]);
        parallel::for_chunks(r.len(), columns, |_, (r, density, mass, reach)| {
            let len = reach.len();
            let (r, density, mass) = (&r[..len], &density[..len], &mass[..len]);
            for i in 0..len {
                let area = mass[i] / (2.0 * PI * (r[i] + domain.origin) * density[i]);
                reach[i] = 2.0 * theta * area.sqrt().min(largest_size);
            }
        });
    }

    /// The most by which one particle's side of a pair has used up the skin.
    fn used_skin(&self, world: &World) -> f64 {
        let [r, z] = self.position.map(|field| world.store.write(field));
        let [list_r, list_z, list_reach] = self.listed.map(|field| world.store.write(field));
        let len = r.len();
        let (r, z, list_r, list_z) = (&r[..len], &z[..len], &list_r[..len], &list_z[..len]);
        let (reach, list_reach) = (&self.reach[..len], &list_reach[..len]);
        parallel::maximum(len, |i| {
            let (dr, dz) = (r[i] - list_r[i], z[i] - list_z[i]);
            (dr * dr + dz * dz).sqrt() + (reach[i] - list_reach[i]).max(0.0)
        })
    }

    fn build(&self, world: &mut World) {
        let [r, z, reach] = self.listed.map(|field| world.store.write(field));
        world.neighbours.build(&r, &z, &reach, self.skin, &self.packing.domain);
    }

    /// Wraps a periodic domain, sorts, and notes where the list is built.
    fn renew(&mut self, world: &mut World) {
        {
            let [r, mut z] = self.position.map(|field| world.store.write(field));
            if let Some((bottom, length)) = self.packing.domain.period {
                for z in z.iter_mut() {
                    *z -= length * ((*z - bottom) / length).floor();
                }
            }
            let [mut list_r, mut list_z, mut list_reach] = self.listed.map(|field| world.store.write(field));
            list_r.copy_from_slice(&r);
            list_z.copy_from_slice(&z);
            list_reach.copy_from_slice(&self.reach);
            let cell = parallel::maximum(self.reach.len(), |i| self.reach[i]);
            morton::order(&r, &z, cell, &mut self.keys, &mut self.order);
        }
        world.store.permute(&self.order);
        self.build(world);
    }
}

impl Stage for SortBin {
    fn name(&self) -> &'static str {
        "sort-bin"
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        self.measure_reach(world);
        let resumed = world.clock.step > 0 && world.neighbours.is_empty();
        if resumed {
            self.build(world);
        }
        // Both particles of a pair may use half of the skin. A NaN goes on to the stage that names it.
        if world.neighbours.is_empty() || self.used_skin(world) > 0.5 * self.skin {
            self.renew(world);
        }
        Ok(())
    }
}
