//! The work of forces: a part of the change of the total energy, in scenes that solve for that.

use crate::fields;
use meniscus_engine::group::Chunk;
use meniscus_engine::store::{Add, Read};
use meniscus_engine::wiring::Wiring;
use std::cell::{Ref, RefMut};

/// What a stage that adds a force needs to add its work, too.
pub(crate) struct Work {
    velocity: [Read<f64>; 2],
    power: Add<f64>,
}

impl Work {
    /// For the stage that the wiring is at, `with_energy` where the scene solves for the total energy.
    pub fn new(wiring: &mut Wiring, with_energy: bool) -> Option<Self> {
        with_energy.then(|| Work {
            velocity: fields::VELOCITY.map(|field| wiring.read(field)),
            power: wiring.add(&fields::POWER),
        })
    }

    /// The columns of a chunk.
    pub fn of<'c>(&self, chunk: &'c Chunk) -> WorkColumns<'c> {
        WorkColumns { velocity: self.velocity.map(|field| chunk.read(field)), power: chunk.write(self.power) }
    }
}

/// Velocities (m/s), and the power density (W/m3) of a chunk of particles.
pub(crate) struct WorkColumns<'c> {
    velocity: [Ref<'c, [f64]>; 2],
    power: RefMut<'c, [f64]>,
}

impl WorkColumns<'_> {
    /// rho dE/dt += f . U + `more`, of a force density f (N/m3) on one particle.
    #[inline(always)]
    pub fn add(&mut self, i: usize, force: [f64; 2], more: f64) {
        let [u, w] = &self.velocity;
        self.power[i] += force[0] * u[i] + force[1] * w[i] + more;
    }

    /// The same of a force along the axis alone, on every particle of the chunk.
    #[inline(always)]
    pub fn add_axial(&mut self, force: impl Fn(usize) -> f64) {
        let [_, w] = &self.velocity;
        for (i, (power, w)) in self.power.iter_mut().zip(&**w).enumerate() {
            *power += force(i) * w;
        }
    }
}
