//! A resumed run goes on bit by bit as the one it continues.

use meniscus_cases::scene::Scene;
use meniscus_cases::simulation::Simulation;
use meniscus_stages::correction::WHOLE_MASS;
use meniscus_tests::drops::{self, COLLISION};

/// The recoil of the surface forces spread over all mass, whatever drops there are.
const WHOLE: &str = "method.momentum_correction=whole";

/// Fails where a run that is resumed every so many steps ends in other bits than one that is not.
fn resumed(scene: &Scene, steps: usize, between: usize) {
    let mut whole = drops::start(scene);
    let mut broken = drops::start(scene);
    for step in (0..steps).step_by(between) {
        drops::advance(&mut whole, between);
        broken = match Simulation::resume(scene, &broken.checkpoint(scene)) {
            Ok(resumed) => resumed,
            Err(error) => panic!("{error}"),
        };
        drops::advance(&mut broken, between);
        for ((name, whole), (_, broken)) in drops::state_bits(&whole).iter().zip(&drops::state_bits(&broken))
        {
            assert_eq!(whole, broken, "`{name}` differs after step {step}");
        }
    }
}

#[test]
fn drops_that_exchange_mass() {
    resumed(&drops::scene(COLLISION, &[WHOLE]), 1200, 7);
}

/// Where the drops meet liquid is spread to a disc, where particles merge; when it comes back to the axis they are split.
#[test]
fn particles_that_split_and_merge() {
    let scene = drops::scene(COLLISION, &[]);
    let mut simulation = drops::start(&scene);
    let (mut split, mut merged) = (0, 0);
    for _ in 0..120 {
        let before = drops::identities(&simulation);
        drops::advance(&mut simulation, 20);
        let after = drops::identities(&simulation);
        split += after.iter().filter(|identity| !before.contains(identity)).count();
        merged += before.iter().filter(|identity| !after.contains(identity)).count();
    }
    assert!(split > 5 && merged > 10, "{split} were split, {merged} merged");
    resumed(&scene, 2400, 20);
}

/// The jet is so thin from the start on that its particles become smaller.
#[test]
fn a_thread_whose_particles_become_smaller() {
    const JET: &str = include_str!("../../cases/rayleigh-plateau-jet/pinch-off.toml");
    let scene = drops::scene(JET, &["particle_size=radius/7"]);
    let mut simulation = drops::start(&scene);
    let first = drops::identities(&simulation).len();
    drops::advance(&mut simulation, 600);
    assert!(drops::identities(&simulation).len() > first + 20, "nobody was split");
    resumed(&scene, 600, 20);
}

/// Nor does a step need anything of what the one before computed, however much of that it may leave as it is.
#[test]
fn derived_columns_are_written_before_they_are_read() {
    const SPHEROID: &str = include_str!("../../cases/free-spheroid/scene.toml");
    const NOH: &str = include_str!("../../cases/noh/scene.toml");
    let scenes = [
        drops::scene(COLLISION, &[]),
        drops::drop(&["amplitude=0.5", "liquid.viscosity=1 mPa s", "method.precision=mixed"]),
        drops::scene(SPHEROID, &["particle_size=\"0.08 m\""]),
        drops::scene(NOH, &["particle_size=\"0.02 m\""]),
    ];
    for scene in &scenes {
        let (mut kept, mut poisoned) = (drops::start(scene), drops::start(scene));
        for step in 0..300 {
            poisoned.world.store.poison_derived();
            drops::advance(&mut kept, 1);
            drops::advance(&mut poisoned, 1);
            assert_eq!(drops::state_bits(&kept), drops::state_bits(&poisoned), "{:?}, {step}", scene.title);
        }
    }
}

/// The whole mass was summed anew with every list: not after an exchange of mass, but after a restart. Only rarely
/// is the recoil large enough for forces to show such a change of the last bit.
#[test]
fn the_whole_mass_is_summed_once() {
    let scene = drops::scene(COLLISION, &[WHOLE]);
    let mut simulation = drops::start(&scene);
    drops::advance(&mut simulation, 1);
    let whole = |simulation: &Simulation| simulation.world.clock.number(WHOLE_MASS);
    let (first, masses) = (whole(&simulation), sorted(&simulation));
    assert!((first / masses.iter().sum::<f64>() - 1.0).abs() < 1e-13);
    drops::advance(&mut simulation, 800);
    assert_ne!(masses, sorted(&simulation), "nothing was exchanged");
    let resumed =
        Simulation::resume(&scene, &simulation.checkpoint(&scene)).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!([whole(&simulation), whole(&resumed)], [first; 2]);
}

fn sorted(simulation: &Simulation) -> Vec<f64> {
    let mut masses = drops::column(simulation, "mass");
    masses.sort_by(f64::total_cmp);
    masses
}
