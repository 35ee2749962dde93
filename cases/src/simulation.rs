//! A scene in motion: filled with particles, settled, then stepped.

mod restart;

use crate::assemble::{Assembly, Equation, Physics, PlanLine, assemble};
use crate::packing::{PackingError, PackingOptions, pack};
use crate::region::Region;
use crate::scene::{EquationOfState, Flux, Scene};
use crate::shape::Shape;
use meniscus_engine::clock::Clock;
use meniscus_engine::field::{Role, Values};
use meniscus_engine::neighbours::Domain;
use meniscus_engine::pipeline::{Cost, Fault, Pipeline, World};
use meniscus_engine::store::Store;
use meniscus_engine::wiring::WiringError;
use meniscus_stages::fields;
use meniscus_stages::liquids::{IdealGas, Linear, MieGrueneisen};
use std::f64::consts::PI;

/// Why a scene can't be set in motion.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// A body can't be filled.
    #[error("body {body} cannot be filled with particles: {source}")]
    Packing {
        /// Number of the body in the scene, from 1.
        body: usize,
        /// What went wrong.
        source: PackingError,
    },
    /// The pipeline is wired wrongly, which is a mistake in Meniscus.
    #[error("the pipeline is wired wrongly: {0}")]
    Wiring(#[from] WiringError),
    /// Settling failed.
    #[error("the particles could not settle: {0}")]
    Settling(Fault),
    /// A checkpoint doesn't fit the scene.
    #[error("the checkpoint does not fit its scene: {0}")]
    Checkpoint(String),
}

/// A scene's particles, pipeline and clock.
pub struct Simulation {
    /// What is modelled.
    pub physics: Physics,
    /// The particles and all that a step works on.
    pub world: World,
    /// Every possible stage, in or out, with the reason.
    pub plan: Vec<PlanLine>,
    pipeline: Pipeline,
}

/// Settling: how far it has come, in capillary times, and how far it goes.
pub type SettleProgress<'a> = &'a mut dyn FnMut(f64, f64);

/// How long particles settle where the scene doesn't say, in capillary times.
pub const SETTLE: f64 = 3.0;

impl Physics {
    /// What a scene models.
    pub fn of(scene: &Scene) -> Physics {
        let sound_speed = scene.derived_sound_speed();
        // The liquid has the scene's density at the pressure of its surface, not at none: else its artificial
        // compressibility would shrink a drop.
        let reference_density = match scene.liquid.equation_of_state {
            // (A sound speed far too low must not make this negative: such a run is warned of and fails.)
            EquationOfState::Linear => {
                let excess = rest_pressure(scene) / sound_speed.powi(2);
                scene.liquid.density - excess.min(0.5 * scene.liquid.density)
            }
            _ => scene.liquid.density,
        };
        let equation = match scene.liquid.equation_of_state {
            EquationOfState::Linear => Equation::Linear(Linear { sound_speed, reference_density }),
            EquationOfState::MieGrueneisen { adiabat_slope: slope, grueneisen } => {
                Equation::MieGrueneisen(MieGrueneisen { reference_density, sound_speed, slope, grueneisen })
            }
            EquationOfState::IdealGas { heat_ratio } => Equation::IdealGas(IdealGas { heat_ratio }),
        };
        let bottom = scene.bodies.iter().map(|b| b.shape.bounds()[2]).fold(f64::INFINITY, f64::min);
        Physics {
            method: scene.method.clone(),
            equation,
            sound_speed,
            reference_density,
            central_force: scene.central_force,
            surface_tension: scene.liquid.surface_tension,
            domain: Domain {
                origin: scene.domain.origin,
                period: scene.domain.period.map(|length| (bottom, length)),
            },
            particle_size: scene.particle_size,
            shifting_speed: scene.fastest_initial_speed().max(scene.capillary_velocity()),
        }
    }
}

/// The pressure in Pa that surface tension gives the liquid at rest, the mean over its bodies by volume:
/// 2 sigma/R in a sphere, sigma/R in a jet, and taken as none in other shapes.
fn rest_pressure(scene: &Scene) -> f64 {
    let curvature = |shape: &Shape| match shape {
        Shape::Sphere { radius, .. } => 2.0 / radius,
        Shape::Cylinder { radius, .. } if scene.domain.period.is_some() => 1.0 / radius,
        _ => 0.0,
    };
    let volumes = scene.bodies.iter().map(|body| (body.shape.volume_about(scene.domain.origin), &body.shape));
    let (weighted, volume) = volumes
        .fold((0.0, 0.0), |(sum, total), (volume, shape)| (sum + volume * curvature(shape), total + volume));
    scene.liquid.surface_tension * weighted / volume
}

/// Particles before they are ones.
#[derive(Default)]
struct Seeds {
    r: Vec<f64>,
    z: Vec<f64>,
    mass: Vec<f64>,
    density: Vec<f64>,
    /// Specific internal energy, J/kg.
    energy: Vec<f64>,
    body: Vec<usize>,
}

fn seed(scene: &Scene) -> Result<Seeds, StartError> {
    let mut seeds = Seeds::default();
    let origin = scene.domain.origin;
    for (k, body) in scene.bodies.iter().enumerate() {
        let options = PackingOptions {
            period: scene.domain.period,
            origin,
            volume: (origin > 0.0).then(|| body.shape.volume_about(origin)),
            ..PackingOptions::new(scene.particle_size)
        };
        let packing =
            pack(&body.shape, &options).map_err(|source| StartError::Packing { body: k + 1, source })?;
        let density = body.density.unwrap_or(scene.liquid.density);
        let mass = |(r, area): (&f64, &f64)| density * 2.0 * PI * (r + origin) * area;
        seeds.mass.extend(packing.r.iter().zip(&packing.area).map(mass));
        let energy = |(r, z): (&f64, &f64)| body.internal_energy.at(*r, *z);
        seeds.energy.extend(packing.r.iter().zip(&packing.z).map(energy));
        seeds.density.extend(std::iter::repeat_n(density, packing.r.len()));
        seeds.body.extend(std::iter::repeat_n(k, packing.r.len()));
        seeds.r.extend(packing.r);
        seeds.z.extend(packing.z);
    }
    Ok(seeds)
}

fn place(store: &mut Store, seeds: &Seeds) {
    let count = seeds.r.len();
    let identity: Vec<u32> = (0..count as u32).collect();
    store.set(fields::IDENTITY.description.name, &identity);
    store.set(fields::RADIUS.description.name, &seeds.r);
    store.set(fields::AXIAL.description.name, &seeds.z);
    store.set(fields::MASS.description.name, &seeds.mass);
    store.set(fields::DENSITY.description.name, &seeds.density);
    store.set(fields::TOTAL_ENERGY.description.name, &seeds.energy);
    store.set(fields::KERNEL_SCALE.description.name, &vec![1.0; count]);
}

impl Simulation {
    /// Fills the scene's bodies, lets the particles settle with the first-order flux, then gives them
    /// their initial velocities (method.md, section 10, "Packing" and "Rest").
    ///
    /// # Errors
    /// A body that can't be filled, or particles that don't settle.
    pub fn new(scene: &Scene, progress: SettleProgress) -> Result<Self, StartError> {
        let physics = Physics::of(scene);
        let seeds = seed(scene)?;
        let mut simulation = Self::of_seeds(&physics, &seeds)?;
        let settle = scene.settle.unwrap_or(SETTLE);
        if settle > 0.0 && physics.surface_tension > 0.0 {
            let settled = settle_down(scene, &physics, &seeds, settle, progress)?;
            simulation.adopt(&settled);
        }
        simulation.set_velocities(scene, &seeds);
        simulation.begin().map_err(StartError::Settling)?;
        Ok(simulation)
    }

    fn of_seeds(physics: &Physics, seeds: &Seeds) -> Result<Self, StartError> {
        let Assembly { wiring, pipeline, plan } = assemble(physics)?;
        let mut store = wiring.allocate(seeds.r.len());
        place(&mut store, seeds);
        let world = World::new(store, Clock::default());
        Ok(Simulation { physics: physics.clone(), world, plan, pipeline })
    }

    fn begin(&mut self) -> Result<(), Fault> {
        self.pipeline.begin(&mut self.world)
    }

    /// Takes over the State of another run that this one keeps, too.
    fn adopt(&mut self, other: &Store) {
        for (description, values) in other.columns().filter(|(d, _)| d.role == Role::State) {
            match &*values {
                Values::F64(values) => self.world.store.set(description.name, values),
                Values::U32(values) => self.world.store.set(description.name, values),
            };
        }
    }

    fn set_velocities(&mut self, scene: &Scene, seeds: &Seeds) {
        let store = &mut self.world.store;
        let column = |store: &Store, name: &str| store.by_name::<f64>(name).map(|v| v.to_vec());
        let r = column(store, fields::RADIUS.description.name).unwrap_or_default();
        let z = column(store, fields::AXIAL.description.name).unwrap_or_default();
        let identity = store.by_name::<u32>(fields::IDENTITY.description.name).map(|v| v.to_vec());
        let identity = identity.unwrap_or_default();
        let velocity = |i: usize| {
            let body = &scene.bodies[seeds.body[identity[i] as usize]];
            body.velocity.at(r[i], z[i])
        };
        let (radial, axial): (Vec<f64>, Vec<f64>) = (0..r.len()).map(|i| velocity(i).into()).unzip();
        // Only an equation of state that needs the energy has a column for it.
        let kinetic = |i: usize| 0.5 * (radial[i] * radial[i] + axial[i] * axial[i]);
        let total = |i: usize| seeds.energy[identity[i] as usize] + kinetic(i);
        let total: Vec<f64> = (0..r.len()).map(total).collect();
        store.set(fields::TOTAL_ENERGY.description.name, &total);
        store.set(fields::VELOCITY_R.description.name, &radial);
        store.set(fields::VELOCITY_Z.description.name, &axial);
    }

    /// One time step.
    ///
    /// # Errors
    /// The first quantity that went bad.
    pub fn step(&mut self) -> Result<(), Fault> {
        self.pipeline.step(&mut self.world)
    }

    /// Lets velocities decay at a rate in 1/s over the last step.
    fn damp(&mut self, rate: f64) {
        let factor = (-rate * self.world.clock.previous_step_size).exp();
        for field in [&fields::VELOCITY_R, &fields::VELOCITY_Z] {
            if let Some(velocity) = self.world.store.by_name_mut::<f64>(field.description.name) {
                velocity.iter_mut().for_each(|velocity| *velocity *= factor);
            }
        }
    }

    /// Runs one stage of the step alone, for benchmarks; false if the scene has no stage of that name.
    ///
    /// # Errors
    /// The stage's fault.
    pub fn run_stage(&mut self, name: &str) -> Result<bool, Fault> {
        self.pipeline.run_stage(name, &mut self.world)
    }

    /// What each stage has cost so far.
    pub fn costs(&self) -> &[Cost] {
        self.pipeline.costs()
    }

    /// sqrt(rho L^3/sigma) with L of the scene's capillary velocity: L over it.
    pub fn capillary_time(scene: &Scene) -> f64 {
        let velocity = scene.capillary_velocity();
        scene.liquid.surface_tension / (scene.liquid.density * velocity.powi(3))
    }
}

/// The first-order flux leaves waves as long as a drop for many periods: while particles settle velocities
/// decay at this rate, per capillary time. It is the critical damping of a drop's slowest mode,
/// 2 omega_2 = 2 sqrt(8): every mode then dies with e^{-2.8} a capillary time or faster.
const SETTLING_DAMPING: f64 = 5.66;

/// Runs the scene without initial velocities, with the first-order flux and damped; the settled store.
fn settle_down(
    scene: &Scene,
    physics: &Physics,
    seeds: &Seeds,
    settle: f64,
    progress: SettleProgress,
) -> Result<Store, StartError> {
    let mut physics = physics.clone();
    physics.method.flux = Flux::FirstOrder;
    let mut rest = Simulation::of_seeds(&physics, seeds)?;
    rest.begin().map_err(StartError::Settling)?;
    let unit = Simulation::capillary_time(scene);
    while rest.world.clock.time < settle * unit {
        rest.step().map_err(StartError::Settling)?;
        rest.damp(SETTLING_DAMPING / unit);
        progress(rest.world.clock.time / unit, settle);
    }
    Ok(rest.world.store)
}
