//! What the benchmarks share: scenes, and the one thread on which they run.

pub mod budget;
pub mod callgrind;
pub mod physics;

/// As in the program that is measured.
#[cfg(unix)]
#[global_allocator]
static MEMORY: meniscus_engine::memory::StaggeredMemory = meniscus_engine::memory::StaggeredMemory::new();

use meniscus_cases::scene::{self, Scene};
use meniscus_cases::simulation::{Simulation, to_the_end};
use rayon::{ThreadPool, ThreadPoolBuilder};

const DROP: &str = include_str!("../../cases/oscillating-drop/scene.toml");

/// The repository's oscillating drop of water, 2.5 um in radius, with settings (`key=value`).
///
/// # Panics
/// If the scene has a mistake.
pub fn drop_scene(settings: &[&str]) -> Scene {
    read(DROP, settings)
}

/// A drop of about so many particles.
///
/// # Panics
/// If the scene has a mistake.
pub fn drop_of(particles: u64) -> Scene {
    // They fill half a circle.
    let resolution = (2.0 * particles as f64 / std::f64::consts::PI).sqrt();
    drop_scene(&[&format!("particle_size=radius/{resolution}")])
}

/// A scene from its text, with settings (`key=value`).
fn read(text: &str, settings: &[&str]) -> Scene {
    let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
    scene::parse("scene.toml", text, &settings).unwrap_or_else(|diagnosis| panic!("{diagnosis}"))
}

/// A scene filled with particles and ready to step.
///
/// # Panics
/// If it can't be started.
pub fn start(scene: &Scene) -> Simulation {
    Simulation::new(scene, &mut to_the_end).unwrap_or_else(|error| panic!("{error}"))
}

/// Takes steps.
///
/// # Panics
/// At the first fault.
pub fn advance(simulation: &mut Simulation, steps: u64) {
    for _ in 0..steps {
        simulation.step().unwrap_or_else(|fault| panic!("{fault}"));
    }
}

/// The thread on which everything is measured.
///
/// # Panics
/// If the system refuses it.
pub fn one_thread() -> ThreadPool {
    ThreadPoolBuilder::new().num_threads(1).build().expect("the system has one more thread")
}

/// The numbers below `count` in an order of no order, always the same.
pub fn shuffled(count: usize) -> Vec<u32> {
    let mut order: Vec<u32> = (0..count as u32).collect();
    // Multiplication by an odd number permutes the numbers of 32 bits.
    order.sort_unstable_by_key(|number| number.wrapping_mul(0x9e37_79b1).swap_bytes());
    order
}
