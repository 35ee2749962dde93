//! The same bits for any number of threads.

use meniscus_cases::scene::Scene;
use meniscus_tests::drops;

/// The bits of every State column after some steps, with the columns' names.
fn bits(threads: usize, scene: &Scene, steps: usize) -> Vec<(&'static str, Vec<u64>)> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
    pool.install(|| {
        let mut simulation = drops::start(scene);
        drops::advance(&mut simulation, steps);
        drops::state_bits(&simulation)
    })
}

fn same(settings: &[&str], steps: usize) {
    same_of(&drops::drop(settings), steps);
}

fn same_of(scene: &Scene, steps: usize) {
    let one = bits(1, scene, steps);
    assert!(one.len() > 10 && one[0].1.len() > 1900);
    for threads in [2, 8] {
        let many = bits(threads, scene, steps);
        for ((name, one), (_, many)) in one.iter().zip(&many) {
            assert_eq!(one.len(), many.len(), "particles with {threads} threads");
            let different = one.iter().zip(many).filter(|(a, b)| a != b).count();
            assert_eq!(different, 0, "`{name}` differs for {threads} threads");
        }
    }
}

#[test]
fn an_oscillating_drop() {
    same(&["resolution=36", "amplitude=0.5"], 200);
}

#[test]
fn a_viscous_drop() {
    same(&["resolution=36", "amplitude=0.5", "liquid.viscosity=1 mPa s"], 100);
}

#[test]
fn mixed_precision() {
    same(&["resolution=36", "amplitude=0.5", "method.precision=mixed"], 200);
}

/// Shifting carries velocities along, and takes off the momentum of all.
#[test]
fn a_free_spheroid() {
    const SPHEROID: &str = include_str!("../../cases/free-spheroid/scene.toml");
    same_of(&drops::scene(SPHEROID, &["particle_size=\"0.02 m\""]), 200);
}

/// Some of them merge where the drops spread.
#[test]
fn two_drops_that_collide() {
    const COLLISION: &str = include_str!("../../cases/drop-collision-capillary/hard.toml");
    let scene = drops::scene(COLLISION, &["particle_size=32 nm"]);
    same_of(&scene, 800);
    let mut simulation = drops::start(&scene);
    let particles = simulation.world.store.len();
    drops::advance(&mut simulation, 800);
    assert!(simulation.world.store.len() < particles - 10, "hardly any merged");
}

/// The jet is so thin from the start on that its particles become smaller.
#[test]
fn a_thin_jet() {
    const JET: &str = include_str!("../../cases/rayleigh-plateau-jet/pinch-off.toml");
    let scene = drops::scene(JET, &["particle_size=radius/7", "wavenumber=0.15"]);
    same_of(&scene, 400);
}
