//! Before the clock starts: bodies are filled with particles, which then settle.

use super::{SETTLE, Simulation, StartError};
use crate::assemble::Physics;
use crate::packing::{PackingOptions, pack};
use crate::scene::{Flux, Precision, Scene};
use crate::shape::Endless;
use meniscus_engine::checkpoint::Checkpoint;
use meniscus_engine::store::Store;
use meniscus_stages::fields;
use std::f64::consts::PI;

/// Name of the checkpoint's number that tells particles which still settle from a run.
const MARK: &str = "settling";

/// The first-order flux leaves waves as long as a drop for many periods: while particles settle velocities
/// decay at this rate, per capillary time. It is the critical damping of a drop's slowest mode,
/// 2 omega_2 = 2 sqrt(8): every mode then dies with e^{-2.8} a capillary time or faster.
const DAMPING: f64 = 5.66;

/// Particles before they are ones.
#[derive(Default)]
pub(super) struct Seeds {
    pub(super) r: Vec<f64>,
    z: Vec<f64>,
    mass: Vec<f64>,
    density: Vec<f64>,
    /// Specific internal energy, J/kg; empty where the equation of state needs none.
    energy: Vec<f64>,
    /// Number of the body, of every particle.
    body: Vec<u32>,
}

impl Seeds {
    /// Keeps what a particle has been given for good; the store knows the rest.
    fn forget_places(&mut self) {
        let Seeds { energy, body, .. } = std::mem::take(self);
        *self = Seeds { energy, body, ..Seeds::default() };
    }
}

fn seed(scene: &Scene, with_energy: bool) -> Result<Seeds, StartError> {
    let mut seeds = Seeds::default();
    let origin = scene.domain.origin;
    for (k, body) in scene.bodies.iter().enumerate() {
        let options = PackingOptions {
            period: scene.domain.period,
            origin,
            volume: (origin > 0.0).then(|| body.shape.volume_about(origin)),
            ..PackingOptions::new(scene.particle_size)
        };
        let packing = match scene.domain.period {
            Some(period) => pack(&Endless::new(&body.shape, period), &options),
            None => pack(&body.shape, &options),
        };
        let packing = packing.map_err(|source| StartError::Packing { body: k + 1, source })?;
        let density = body.density.unwrap_or(scene.liquid.density);
        let mass = |(r, area): (&f64, &f64)| density * 2.0 * PI * (r + origin) * area;
        seeds.mass.extend(packing.r.iter().zip(&packing.area).map(mass));
        let energy = |(r, z): (&f64, &f64)| body.internal_energy.at(*r, *z);
        if with_energy {
            seeds.energy.extend(packing.r.iter().zip(&packing.z).map(energy));
        }
        seeds.density.extend(std::iter::repeat_n(density, packing.r.len()));
        seeds.body.extend(std::iter::repeat_n(k as u32, packing.r.len()));
        seeds.r.extend(packing.r);
        seeds.z.extend(packing.z);
    }
    Ok(seeds)
}

pub(super) fn place(store: &mut Store, seeds: &Seeds) {
    let count = seeds.body.len();
    let identity: Vec<u32> = (0..count as u32).collect();
    store.set(fields::IDENTITY.description.name, &identity);
    store.set(fields::RADIUS.description.name, &seeds.r);
    store.set(fields::AXIAL.description.name, &seeds.z);
    store.set(fields::MASS.description.name, &seeds.mass);
    store.set(fields::DENSITY.description.name, &seeds.density);
    store.set(fields::TOTAL_ENERGY.description.name, &seeds.energy);
}

/// Particles that settle: at rest, with the first-order flux and damped, on a clock of their own.
pub struct Settling {
    physics: Physics,
    seeds: Seeds,
    /// None where nothing has to settle.
    rest: Option<Simulation>,
    /// Length of a capillary time, s.
    unit: f64,
    end: f64,
}

impl Settling {
    /// Fills the scene's bodies with particles.
    ///
    /// # Errors
    /// A body that can't be filled, or a first state that is none.
    pub fn begin(scene: &Scene) -> Result<Self, StartError> {
        let mut settling = Self::fill(scene)?;
        if settling.end > 0.0 && settling.physics.surface_tension > 0.0 {
            let seeds = &mut settling.seeds;
            let mut rest = Simulation::of_count(&slow(&settling.physics), seeds.body.len())?;
            place(&mut rest.world.store, seeds);
            seeds.forget_places();
            rest.begin().map_err(StartError::Settling)?;
            settling.rest = Some(rest);
        }
        Ok(settling)
    }

    /// Goes on from a checkpoint of settling particles, bit for bit as if there had been no interruption.
    ///
    /// # Errors
    /// A checkpoint that doesn't fit the scene.
    pub fn resume(scene: &Scene, checkpoint: &Checkpoint) -> Result<Self, StartError> {
        let mut settling = Self::fill(scene)?;
        let mut state = checkpoint.clone();
        state.clock.scalars.retain(|(name, _)| name != MARK);
        let rest = Simulation::restore(&slow(&settling.physics), scene.domain.origin, &state)?;
        settling.seeds.forget_places();
        if rest.world.store.len() != settling.seeds.body.len() {
            let (found, expected) = (rest.world.store.len(), settling.seeds.body.len());
            let problem = format!("it holds {found} settling particles, the scene {expected}");
            return Err(StartError::Checkpoint(problem));
        }
        settling.rest = Some(rest);
        Ok(settling)
    }

    /// Whether a checkpoint is one of settling particles.
    pub fn wrote(checkpoint: &Checkpoint) -> bool {
        checkpoint.clock.scalar(MARK).is_some()
    }

    fn fill(scene: &Scene) -> Result<Self, StartError> {
        let physics = Physics::of(scene);
        Ok(Settling {
            seeds: seed(scene, physics.equation.with_energy())?,
            physics,
            rest: None,
            unit: Simulation::capillary_time(scene),
            end: scene.settle.unwrap_or(SETTLE),
        })
    }

    /// How long the particles have settled, in capillary times.
    pub fn time(&self) -> f64 {
        self.rest.as_ref().map_or(self.end, |rest| rest.world.clock.time / self.unit)
    }

    /// How long they will, in capillary times.
    pub fn end(&self) -> f64 {
        self.end
    }

    /// Steps taken so far.
    pub fn steps(&self) -> u64 {
        self.rest.as_ref().map_or(0, |rest| rest.world.clock.step)
    }

    /// Whether they have settled.
    pub fn is_over(&self) -> bool {
        self.rest.as_ref().is_none_or(|rest| rest.world.clock.time >= self.end * self.unit)
    }

    /// One time step.
    ///
    /// # Errors
    /// The first quantity that went bad.
    pub fn step(&mut self) -> Result<(), StartError> {
        if let Some(rest) = &mut self.rest {
            rest.step().map_err(StartError::Settling)?;
            rest.damp(DAMPING / self.unit);
        }
        Ok(())
    }

    /// Shows the whole state; none where nothing settles.
    pub fn with_checkpoint<R>(&self, scene: &Scene, look: impl FnOnce(&Checkpoint) -> R) -> Option<R> {
        let mark = vec![(MARK.to_owned(), 1.0)];
        self.rest.as_ref().map(|rest| rest.lend(scene, mark, false, look))
    }

    /// The scene at the start of its clock: the settled particles with their initial velocities.
    ///
    /// # Errors
    /// A first state that is none.
    pub fn finish(self, scene: &Scene) -> Result<Simulation, StartError> {
        let Settling { physics, seeds, rest, .. } = self;
        // All but the particles themselves makes room first.
        let settled = rest.map(|rest| rest.world.store);
        let mut simulation = Simulation::of_count(&physics, seeds.body.len())?;
        match settled {
            Some(mut settled) => simulation.adopt(&mut settled),
            None => place(&mut simulation.world.store, &seeds),
        }
        simulation.set_velocities(scene, &seeds);
        simulation.begin().map_err(StartError::Settling)?;
        Ok(simulation)
    }
}

/// What settles models: the same, with the flux's viscosity instead of the liquid's.
fn slow(physics: &Physics) -> Physics {
    let mut physics = physics.clone();
    physics.method.flux = Flux::FirstOrder;
    physics.viscosity = 0.0;
    // The start is the same in any precision.
    physics.method.precision = Precision::Double;
    // The packing is even as it is, and the first-order flux knows no rate of deformation to scale a shift.
    physics.method.shifting = Some(0.0);
    physics
}

impl Simulation {
    /// Lets velocities decay at a rate in 1/s over the last step.
    fn damp(&mut self, rate: f64) {
        let factor = (-rate * self.world.clock.previous_step_size).exp();
        for field in [&fields::VELOCITY_R, &fields::VELOCITY_Z] {
            if let Some(velocity) = self.world.store.by_name_mut::<f64>(field.description.name) {
                velocity.iter_mut().for_each(|velocity| *velocity *= factor);
            }
        }
    }

    /// Takes over the State of another run that this one keeps, too.
    fn adopt(&mut self, other: &mut Store) {
        self.world.store.adopt(other);
        // The neighbour list is another run's: this one makes its own.
        let count = self.world.store.len();
        self.world.store.set(fields::LIST_REACH.description.name, &vec![0.0; count]);
    }

    fn set_velocities(&mut self, scene: &Scene, seeds: &Seeds) {
        let store = &mut self.world.store;
        let column = |store: &Store, name: &str| store.by_name::<f64>(name).map(|v| v.to_vec());
        let r = column(store, fields::RADIUS.description.name).unwrap_or_default();
        let z = column(store, fields::AXIAL.description.name).unwrap_or_default();
        let identity = store.by_name::<u32>(fields::IDENTITY.description.name).map(|v| v.to_vec());
        let identity = identity.unwrap_or_default();
        let velocity = |i: usize| {
            let body = &scene.bodies[seeds.body[identity[i] as usize] as usize];
            body.velocity.at(r[i], z[i])
        };
        let (radial, axial): (Vec<f64>, Vec<f64>) = (0..r.len()).map(|i| velocity(i).into()).unzip();
        if !seeds.energy.is_empty() {
            let kinetic = |i: usize| 0.5 * (radial[i] * radial[i] + axial[i] * axial[i]);
            let total = |i: usize| seeds.energy[identity[i] as usize] + kinetic(i);
            let total: Vec<f64> = (0..r.len()).map(total).collect();
            store.set(fields::TOTAL_ENERGY.description.name, &total);
        }
        store.set(fields::VELOCITY_R.description.name, &radial);
        store.set(fields::VELOCITY_Z.description.name, &axial);
    }
}
