//! Scenes: what a user writes down about an experiment, read from TOML with units and checked.
//!
//! [`read`] turns a file into a [`Scene`] in SI units, or into one [`Diagnosis`] that shows the
//! place of the first mistake.

mod body;
mod checks;
mod choices;
mod compiler;
mod condition;
mod diagnosis;
mod entry;
mod expression;
mod formula;
mod functions;
mod liquid;
mod measures;
mod method;
mod output;
mod parameters;
mod parser;
mod quantity;
mod reading;
mod scanner;
mod section;
mod settings;
mod shapes;
mod source;
mod suggest;
#[cfg(test)]
mod tests;
mod units;
mod values;
mod written;

pub use body::{Body, VelocityField};
pub use choices::{
    AxisTreatment, Curvature, Flux, Precision, Recoil, ReferencePressure, Scheme, TimeIntegration,
};
pub use condition::Condition;
pub use diagnosis::Diagnosis;
pub use formula::Formula;
pub(crate) use functions::legendre;
pub use liquid::{EquationOfState, Liquid};
pub use measures::Measure;
pub use method::{FREE_SHIFTING, FREE_SHIFTING_THETA, Method, SHIFTING, SHIFTING_INTERVAL};
pub use output::{FOLLOWING, Output};
pub use quantity::{Dimension, Quantity};
pub use values::Choice;

use miette::Severity;
use std::path::Path;

/// A scene in SI units.
#[derive(Debug, Clone)]
pub struct Scene {
    /// One line that says what happens.
    pub title: String,
    /// Whether unset choices of the method are the paper's own.
    pub paper: bool,
    /// The scene's text with all settings written into it. Read again without settings, it gives
    /// the same scene.
    pub text: String,
    /// Name of the scene's file.
    pub source_name: String,
    /// The named quantities, in the order of the text.
    pub parameters: Vec<Parameter>,
    /// The liquid.
    pub liquid: Liquid,
    /// The bodies of liquid, at least one.
    pub bodies: Vec<Body>,
    /// Particle size in metres.
    pub particle_size: f64,
    /// End of the run in seconds.
    pub until: f64,
    /// Steps at most.
    pub steps: Option<u64>,
    /// Where the scene lies.
    pub domain: Domain,
    /// B^2 in 1/s2 of a force -rho B^2 x towards the scene's r = -origin, z = 0; 0 for none.
    pub central_force: f64,
    /// Numerical choices.
    pub method: Method,
    /// What the run writes.
    pub output: Output,
    /// What is compared with exact solutions.
    pub measures: Vec<Measure>,
    /// Doubts about the scene.
    pub warnings: Vec<Diagnosis>,
    /// For each body what is told, but for the reason, where particles cannot fill it.
    pub(crate) unfilled: Vec<Diagnosis>,
}

/// A named quantity of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Its value; `None` for "auto".
    pub value: Option<Quantity>,
}

/// Where a scene lies.
#[derive(Debug, Clone, PartialEq)]
pub struct Domain {
    /// Radius of the scene's r = 0 in metres; the axis is at r = -origin.
    pub origin: f64,
    /// Length in metres after which everything repeats in z.
    pub period: Option<f64>,
}

/// Reads a scene from a file, with settings (`key=value`) that replace its values.
///
/// # Errors
/// A file that cannot be read, or the first mistake in the scene.
pub fn read(path: &Path, settings: &[String]) -> Result<Scene, Diagnosis> {
    let name = path.display().to_string();
    let text = std::fs::read_to_string(path).map_err(|error| {
        let message = format!("the scene {name} cannot be read: {error}");
        let help = match error.kind() {
            std::io::ErrorKind::InvalidData => "a scene is a text: save it in UTF-8",
            _ => "check the path of the scene",
        };
        Diagnosis::new(Severity::Error, message, help.to_owned(), None)
    })?;
    parse(&name, &text, settings)
}

/// Reads a scene from a text, with settings (`key=value`) that replace its values. A bare key sets a
/// parameter (or `paper`, `title`, `format`), a dotted one any other value.
///
/// # Errors
/// The first mistake in the scene.
pub fn parse(name: &str, text: &str, settings: &[String]) -> Result<Scene, Diagnosis> {
    let source = source::Source::new(name, text, settings)?;
    let error = |fault| source.diagnose(Severity::Error, fault);
    let (mut scene, doubts, unfilled) = reading::scene(name, &source.text).map_err(error)?;
    scene.unfilled = unfilled.into_iter().map(error).collect();
    scene.warnings = doubts.into_iter().map(|doubt| source.diagnose(Severity::Warning, doubt)).collect();
    Ok(scene)
}

impl Scene {
    /// Speed in m/s of capillary waves as short as the smallest body: the root of surface tension
    /// over density and half the body's smallest extent.
    pub fn capillary_velocity(&self) -> f64 {
        let extents = self.bodies.iter().map(|body| body.shape.smallest_extent());
        let half = 0.5 * extents.fold(f64::INFINITY, f64::min);
        (self.liquid.surface_tension / (self.liquid.density * half)).sqrt()
    }

    /// Highest initial speed in m/s, sampled on a grid inside every body.
    pub fn fastest_initial_speed(&self) -> f64 {
        let speed = |body: &Body, [r, z]: [f64; 2]| {
            let [radial, axial] = body.velocity.at(r, z);
            radial.hypot(axial)
        };
        let fastest = |body: &Body| {
            body.shape.interior_points(body::SAMPLES).map(|point| speed(body, point)).fold(0.0, f64::max)
        };
        self.bodies.iter().map(fastest).fold(0.0, f64::max)
    }

    /// Particles at the start, by the bodies' areas.
    pub fn expected_particles(&self) -> f64 {
        let area: f64 = self.bodies.iter().map(|body| body.shape.moments()[0]).sum();
        area / self.particle_size.powi(2)
    }

    /// The given sound speed in m/s, or ten times the fastest motion the scene can expect: the
    /// initial one, or the root of eight times the capillary velocity; never below that of its gas.
    pub fn derived_sound_speed(&self) -> f64 {
        self.liquid.sound_speed.unwrap_or_else(|| self.automatic_sound_speed())
    }

    /// The sound speed in m/s that the scene has where it gives none.
    pub(crate) fn automatic_sound_speed(&self) -> f64 {
        let fastest = self.fastest_initial_speed().max(8.0_f64.sqrt() * self.capillary_velocity());
        self.gas_sound_speed().max(10.0 * fastest)
    }

    /// Highest speed of sound in m/s of an ideal gas at the start; 0 for a liquid.
    fn gas_sound_speed(&self) -> f64 {
        let EquationOfState::IdealGas { heat_ratio } = self.liquid.equation_of_state else {
            return 0.0;
        };
        let hottest = |body: &Body| {
            let points = body.shape.interior_points(body::SAMPLES);
            points.map(|[r, z]| body.internal_energy.at(r, z)).fold(0.0, f64::max)
        };
        let energy = self.bodies.iter().map(hottest).fold(0.0, f64::max);
        (heat_ratio * (heat_ratio - 1.0) * energy).sqrt()
    }
}
