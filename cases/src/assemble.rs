//! From a scene's choices to a pipeline: one line a stage, with the reason why it is in or left out.

mod builder;
mod choices;
mod flux;

use crate::scene::Method;
use builder::Builder;
use meniscus_engine::domain::Domain;
use meniscus_engine::pipeline::Pipeline;
use meniscus_engine::wiring::{Wiring, WiringError};
use meniscus_stages::colour_field::ColourField;
use meniscus_stages::equation_of_state::Packing;
use meniscus_stages::liquids::{EquationOfState, IdealGas, Linear, MieGrueneisen};
use std::sync::{Arc, Mutex};

/// The equations of state to choose from.
#[derive(Clone, Copy, Debug)]
pub enum Equation {
    /// Weakly compressible liquid.
    Linear(Linear),
    /// Liquid under shocks.
    MieGrueneisen(MieGrueneisen),
    /// Gas.
    IdealGas(IdealGas),
}

impl Equation {
    /// Pressure in Pa at a density in kg/m3 and a specific internal energy in J/kg.
    pub fn pressure(&self, density: f64, energy: f64) -> f64 {
        match self {
            Equation::Linear(equation) => equation.pressure(density, energy),
            Equation::MieGrueneisen(equation) => equation.pressure(density, energy),
            Equation::IdealGas(equation) => equation.pressure(density, energy),
        }
    }

    /// The speed of sound in m/s if it is the same whatever the state.
    pub fn constant_sound_speed(&self) -> Option<f64> {
        match self {
            Equation::Linear(equation) => equation.constant_sound_speed(),
            Equation::MieGrueneisen(equation) => equation.constant_sound_speed(),
            Equation::IdealGas(equation) => equation.constant_sound_speed(),
        }
    }

    /// s of the shock adiabat D = C + s u.
    pub fn shock_slope(&self) -> f64 {
        match self {
            Equation::Linear(equation) => equation.shock_slope(),
            Equation::MieGrueneisen(equation) => equation.shock_slope(),
            Equation::IdealGas(equation) => equation.shock_slope(),
        }
    }

    /// Whether the energy equation is needed.
    pub fn with_energy(&self) -> bool {
        match self {
            Equation::Linear(_) => Linear::WITH_ENERGY,
            Equation::MieGrueneisen(_) => MieGrueneisen::WITH_ENERGY,
            Equation::IdealGas(_) => IdealGas::WITH_ENERGY,
        }
    }
}

/// What the pipeline models, in SI units.
#[derive(Clone, Debug)]
pub struct Physics {
    /// Numerical choices.
    pub method: Method,
    /// Equation of state.
    pub equation: Equation,
    /// Speed of sound at rest in m/s.
    pub sound_speed: f64,
    /// Density at rest in kg/m3.
    pub reference_density: f64,
    /// B^2 of a central force in 1/s2; zero for none.
    pub central_force: f64,
    /// Surface tension in N/m.
    pub surface_tension: f64,
    /// Viscosity in Pa s; zero for none.
    pub viscosity: f64,
    /// Axis and period.
    pub domain: Domain,
    /// Particle size at the start in m.
    pub particle_size: f64,
    /// Greatest speed that scales shifting, m/s.
    pub shifting_speed: f64,
    /// One over the capillary time, 1/s; zero without surface tension.
    pub capillary_rate: f64,
}

/// One stage that could be in the pipeline.
#[derive(Clone, Debug)]
pub struct PlanLine {
    /// Name of the stage.
    pub stage: &'static str,
    /// Whether it is in.
    pub present: bool,
    /// Why it is in or out.
    pub reason: String,
}

/// A checked pipeline with its wiring and plan.
pub struct Assembly {
    /// The fields and who touches them.
    pub wiring: Wiring,
    /// The stages.
    pub pipeline: Pipeline,
    /// Every stage, in or out, with the reason.
    pub plan: Vec<PlanLine>,
}

/// Builds the pipeline of the given physics.
///
/// # Errors
/// A mistake in the order or access of stages: a mistake here, not in the scene.
pub fn assemble(physics: &Physics) -> Result<Assembly, WiringError> {
    let packing = Packing {
        domain: physics.domain,
        theta: physics.method.theta,
        // D grows without bound as a particle nears the axis; its support must not.
        largest_size: 2.0 * physics.particle_size,
    };
    let colour = Arc::new(Mutex::new(ColourField::default()));
    let mut builder = Builder { physics, packing, colour, wiring: Wiring::new(), plan: Vec::new() };
    let stages = builder.step();
    builder.wiring.check()?;
    let plan = std::mem::take(&mut builder.plan);
    let start = builder.start();
    let pipeline = Pipeline::new(start, stages, &builder.wiring)?;
    Ok(Assembly { wiring: builder.wiring, pipeline, plan })
}
