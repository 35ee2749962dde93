//! Drops as scenes, and what tests measure of them.

use meniscus_cases::scene::{Scene, parse};
use meniscus_cases::simulation::{Simulation, to_the_end};
use meniscus_engine::field::{Role, Values};

/// A drop that oscillates in mode 2: 12 particles across its radius.
const DROP: &str = r#"format = 1
title = "A drop oscillates"
[parameters]
radius = "2.5 um"
resolution = 12
surface_tension = "0.074 N/m"
density = "1000 kg/m3"
amplitude = 0.02
capillary_velocity = "sqrt(surface_tension/(density*radius))"
[liquid]
density = "density"
surface_tension = "surface_tension"
sound_speed = "auto"
equation_of_state = "linear"
[[body]]
shape = { sphere = { radius = "radius", centre = "0 m" } }
velocity = { r = "-amplitude*capillary_velocity*(r/radius)/2", z = "amplitude*capillary_velocity*z/radius" }
[particles]
size = "radius/resolution"
[run]
until = "8 * sqrt(density*radius^3/surface_tension)"
"#;

/// Two drops of unequal size that collide: sizes become uneven, and neighbours exchange mass.
pub const COLLISION: &str = r#"format = 1
title = "Two drops collide"
[parameters]
surface_tension = "0.074 N/m"
[liquid]
density = "1000 kg/m3"
surface_tension = "surface_tension"
sound_speed = "60 m/s"
equation_of_state = "linear"
[[body]]
shape = { sphere = { radius = "1 um", centre = "-1.05 um" } }
velocity = { z = "4 m/s" }
[[body]]
shape = { sphere = { radius = "0.7 um", centre = "0.75 um" } }
velocity = { z = "-5 m/s" }
[particles]
size = "0.1 um"
[run]
until = "1 us"
"#;

/// A scene from its text and settings (`key=value`).
///
/// # Panics
/// If it has a mistake.
pub fn scene(text: &str, settings: &[&str]) -> Scene {
    let settings: Vec<String> = settings.iter().map(|&s| s.to_owned()).collect();
    match parse("test.toml", text, &settings) {
        Ok(scene) => scene,
        Err(diagnosis) => panic!("{diagnosis}"),
    }
}

/// The drop with settings.
pub fn drop(settings: &[&str]) -> Scene {
    scene(DROP, settings)
}

/// A scene in motion.
///
/// # Panics
/// If it cannot be set in motion.
pub fn start(scene: &Scene) -> Simulation {
    match Simulation::new(scene, &mut to_the_end) {
        Ok(simulation) => simulation,
        Err(error) => panic!("{error}"),
    }
}

/// Takes steps.
///
/// # Panics
/// At the first fault.
pub fn advance(simulation: &mut Simulation, steps: usize) {
    for _ in 0..steps {
        if let Err(fault) = simulation.step() {
            panic!("{fault}");
        }
    }
}

/// The bits of every State column, with the columns' names.
pub fn state_bits(simulation: &Simulation) -> Vec<(&'static str, Vec<u64>)> {
    let of = |values: &Values| match values {
        Values::F64(values) => values.iter().map(|value| value.to_bits()).collect(),
        Values::U32(values) => values.iter().map(|&value| u64::from(value)).collect(),
    };
    let columns = simulation.world.store.columns().filter(|(d, _)| d.role == Role::State);
    columns.map(|(description, values)| (description.name, of(&values))).collect()
}

/// The particles in their order in memory.
///
/// # Panics
/// If they have no identities, which all have.
pub fn identities(simulation: &Simulation) -> Vec<u32> {
    match simulation.world.store.by_name::<u32>("identity") {
        Some(identities) => identities.to_vec(),
        None => panic!("no identities"),
    }
}

/// A column of real numbers, in memory order.
///
/// # Panics
/// If the scene's pipeline has none of that name.
pub fn column(simulation: &Simulation, name: &str) -> Vec<f64> {
    match simulation.world.store.by_name::<f64>(name) {
        Some(values) => values.to_vec(),
        None => panic!("no column `{name}`"),
    }
}

/// Sums over all particles of one drop or several, in SI units.
#[derive(Clone, Copy, Debug, Default)]
pub struct Totals {
    /// Sum of m.
    pub mass: f64,
    /// Sum of m U_z.
    pub momentum: f64,
    /// Sum of |m U_z|.
    pub momentum_scale: f64,
    /// Sum of m U^2/2.
    pub kinetic: f64,
    /// Sum of m (z^2 - r^2/2) about the centre of mass.
    pub quadrupole: f64,
    /// Centre of mass on the axis.
    pub centre: f64,
}

/// The totals at the present time.
pub fn totals(simulation: &Simulation) -> Totals {
    let [r, z, u, w, m] =
        ["radius", "axial", "velocity_r", "velocity_z", "mass"].map(|name| column(simulation, name));
    let mut totals = Totals::default();
    for i in 0..m.len() {
        totals.mass += m[i];
        totals.momentum += m[i] * w[i];
        totals.momentum_scale += (m[i] * w[i]).abs();
        totals.kinetic += 0.5 * m[i] * (u[i] * u[i] + w[i] * w[i]);
        totals.centre += m[i] * z[i];
    }
    totals.centre /= totals.mass;
    for i in 0..m.len() {
        totals.quadrupole += m[i] * ((z[i] - totals.centre).powi(2) - 0.5 * r[i] * r[i]);
    }
    totals
}

/// Sum of m times the integral of P/rho^2 from the rest density on, for P = C^2 (rho - rho_0); in J.
pub fn elastic_energy(simulation: &Simulation, sound_speed: f64, rest_density: f64) -> f64 {
    let [density, mass] = ["density", "mass"].map(|name| column(simulation, name));
    let shape = |density: f64| {
        // ln x + 1/x - 1 cancels near x = 1: its series there.
        let excess = density / rest_density - 1.0;
        if excess.abs() < 1e-3 {
            excess * excess * (0.5 - excess * (2.0 / 3.0 - 0.75 * excess))
        } else {
            excess.ln_1p() - excess / (1.0 + excess)
        }
    };
    let energy = |(mass, density): (&f64, &f64)| mass * sound_speed * sound_speed * shape(*density);
    mass.iter().zip(&density).map(energy).sum()
}

/// Root of the mass-weighted mean square of the speed, m/s.
pub fn mean_speed(simulation: &Simulation) -> f64 {
    let totals = totals(simulation);
    (2.0 * totals.kinetic / totals.mass).sqrt()
}

/// Whether every State column of the run is finite.
pub fn is_finite(simulation: &Simulation) -> bool {
    use meniscus_engine::field::{Role, Values};
    let mut columns = simulation.world.store.columns();
    columns.all(|(description, values)| match &*values {
        Values::F64(values) if description.role == Role::State => {
            values.iter().all(|value| value.is_finite())
        }
        _ => true,
    })
}
