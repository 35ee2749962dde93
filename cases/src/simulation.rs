//! A scene in motion: filled with particles, then stepped.

pub mod crash;
mod restart;
mod start;

use crate::assemble::{Assembly, Equation, Physics, PlanLine, assemble};
use crate::region::Region;
use crate::scene::{Diagnosis, EquationOfState, Scene};
use crate::shape::Shape;
use meniscus_engine::clock::Clock;
use meniscus_engine::domain::Domain;
use meniscus_engine::pipeline::{Cost, Fault, Pipeline, World};
use meniscus_engine::wiring::WiringError;
use meniscus_stages::fields;
use meniscus_stages::liquids::{IdealGas, Linear, MieGrueneisen};
pub use start::{FillProgress, to_the_end};

/// Why a scene can't be set in motion.
#[derive(Debug, thiserror::Error)]
pub enum StartError {
    /// A body can't be filled.
    #[error("{0}")]
    Packing(Diagnosis),
    /// Whoever followed the filling did not want it to go on.
    #[error("stopped while the particles were placed")]
    Stopped,
    /// The pipeline is wired wrongly, which is a mistake in Meniscus.
    #[error("the pipeline is wired wrongly: {0}")]
    Wiring(#[from] WiringError),
    /// The first state can't move.
    #[error("the particles could not start: {0}")]
    FirstState(Fault),
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
            viscosity: scene.liquid.viscosity,
            domain: Domain {
                origin: scene.domain.origin,
                period: scene.domain.period.map(|length| (bottom, length)),
            },
            particle_size: scene.particle_size,
            capillary_rate: match scene.liquid.surface_tension > 0.0 {
                true => 1.0 / Simulation::capillary_time(scene),
                false => 0.0,
            },
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

impl Simulation {
    fn of_count(physics: &Physics, count: usize) -> Result<Self, StartError> {
        let Assembly { wiring, pipeline, plan } = assemble(physics)?;
        let mut store = wiring.allocate(count);
        if let Some(scale) = store.by_name_mut::<f64>(fields::KERNEL_SCALE.description.name) {
            scale.fill(1.0);
        }
        let world = World::new(store, Clock::default());
        Ok(Simulation { physics: physics.clone(), world, plan, pipeline })
    }

    fn begin(&mut self) -> Result<(), Fault> {
        self.pipeline.begin(&mut self.world)
    }

    /// One time step.
    ///
    /// # Errors
    /// The first quantity that went bad.
    pub fn step(&mut self) -> Result<(), Fault> {
        self.pipeline.step(&mut self.world)
    }

    /// Runs one stage of the step alone, for benchmarks; false if the scene has no stage of that name.
    ///
    /// # Errors
    /// The stage's fault.
    pub fn run_stage(&mut self, name: &str) -> Result<bool, Fault> {
        self.pipeline.run_stage(name, &mut self.world)
    }

    /// Bytes that particles, neighbours, rows and stages take.
    pub fn bytes(&self) -> usize {
        self.world.bytes() + self.pipeline.bytes()
    }

    /// What each stage has cost so far.
    pub fn costs(&self) -> &[Cost] {
        self.pipeline.costs()
    }

    /// The numbers of particles of all steps so far, added up.
    pub fn particle_steps(&self) -> u64 {
        self.pipeline.particle_steps()
    }

    /// sqrt(rho L^3/sigma) with L of the scene's capillary velocity: L over it.
    pub fn capillary_time(scene: &Scene) -> f64 {
        let velocity = scene.capillary_velocity();
        scene.liquid.surface_tension / (scene.liquid.density * velocity.powi(3))
    }
}
