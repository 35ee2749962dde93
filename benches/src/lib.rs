//! What the benchmarks share: a drop in motion.

use meniscus_cases::scene;
use meniscus_cases::simulation::Simulation;

const SCENE: &str = include_str!("../../cases/oscillating-drop/scene.toml");

/// The oscillating drop of water, 2.5 um in radius, ready to step; it hasn't settled.
///
/// # Panics
/// If the scene of the repository can't be read.
pub fn drop_in_motion(settings: &[&str]) -> Simulation {
    let mut settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
    settings.push("particles.settle=0".to_string());
    let scene = scene::parse("oscillating-drop", SCENE, &settings).expect("the repository's scene is valid");
    Simulation::new(&scene, &mut |_, _| {}).expect("the repository's scene starts")
}
