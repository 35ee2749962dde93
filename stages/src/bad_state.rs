//! Particles whose state is no number or out of bounds: they end the run.

use crate::fields;
use meniscus_engine::pipeline::{Fault, World};
use meniscus_engine::store::Read;
use meniscus_engine::wiring::Wiring;

/// What is looked at, for a stage that moves time on.
pub(crate) struct BadState {
    stage: &'static str,
    origin: f64,
    identity: Read<u32>,
    /// Density, velocities, axial position and radius.
    state: [Read<f64>; 5],
}

const NAMES: [&str; 5] = ["density", "velocity_r", "velocity_z", "axial", "radius"];

impl BadState {
    /// `origin` is the distance of the scene's origin from the axis in m.
    pub(crate) fn new(wiring: &mut Wiring, stage: &'static str, origin: f64) -> Self {
        let state =
            [&fields::DENSITY, &fields::VELOCITY_R, &fields::VELOCITY_Z, &fields::AXIAL, &fields::RADIUS];
        let identity = wiring.read(&fields::IDENTITY);
        BadState { stage, origin, identity, state: state.map(|field| wiring.read(field)) }
    }

    /// The first particle whose density is no number or out of bounds; else velocity; else position, which shifting
    /// has moved in the same step where a neighbour's density went bad.
    pub(crate) fn first(&self, world: &World) -> Option<Fault> {
        let state = self.state.map(|field| world.store.read(field));
        let is_bad = |k: usize, i: usize| is_bad(k, state[k][i], self.origin);
        let bad = |k: usize| (0..world.store.len()).find(|&i| is_bad(k, i)).map(|i| (k, i));
        (0..NAMES.len()).find_map(bad).map(|(k, i)| self.fault(world, i, NAMES[k], state[k][i]))
    }

    /// What is wrong with a particle, of which something is.
    pub(crate) fn of(&self, world: &World, i: usize) -> Fault {
        let state = self.state.map(|field| world.store.read(field)[i]);
        let k = (0..NAMES.len()).find(|&k| is_bad(k, state[k], self.origin)).unwrap_or_default();
        self.fault(world, i, NAMES[k], state[k])
    }

    /// A quantity of a particle that went bad.
    pub(crate) fn fault(&self, world: &World, i: usize, quantity: &'static str, value: f64) -> Fault {
        let [.., z, r] = self.state.map(|field| world.store.read(field)[i]);
        let particle = world.store.read(self.identity)[i];
        Fault {
            stage: self.stage,
            particle,
            quantity,
            value,
            note: String::new(),
            r,
            z,
            step: world.clock.step,
        }
    }
}

/// Whether a value of the quantity `k` is none that a particle can have.
fn is_bad(k: usize, value: f64, origin: f64) -> bool {
    let above = [0.0, f64::NEG_INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY, -origin];
    !(value > above[k] && value.is_finite())
}

/// Whether density, velocities, axial position and radius are those of a particle.
pub(crate) fn is_sound(state: [f64; 5], origin: f64) -> bool {
    (0..state.len()).all(|k| !is_bad(k, state[k], origin))
}
