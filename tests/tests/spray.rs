//! Spray: particles that nobody touches, on their way outward and into the axis.

use meniscus_tests::drops;
use meniscus_tests::liquid::{self, Block, DENSITY, Random, SIZE, SOUND_SPEED};
use meniscus_tests::reference::Particle;
use std::f64::consts::PI;

/// A particle at rest with a tenth of the block's size, which lies at the given place, in those sizes.
fn small([r, z]: [f64; 2]) -> Particle {
    let radius = r * SIZE;
    Particle {
        position: [radius, z * SIZE],
        density: DENSITY,
        mass: DENSITY * 2.0 * PI * radius * 0.01 * SIZE * SIZE,
        kernel_scale: 1.0,
        ..Particle::default()
    }
}

/// The first step of a block with some more, s.
fn step_size(more: &[Particle]) -> f64 {
    let mut particles = liquid::block([10, 12], 0.5, 0.2, &mut Random::new(47));
    particles.extend(more);
    let mut block = Block::new(&liquid::physics(liquid::bare_method()), &particles);
    block.step();
    block.world.clock.previous_step_size
}

/// Spray becomes small on its way outward. What touches nobody has no sound to carry on.
#[test]
fn spray_holds_nobody() {
    let alone = step_size(&[]);
    let [far, far_neighbour] = [[100.0, 6.0], [100.0, 6.1]].map(small);
    assert_eq!(step_size(&[far]), alone);
    // Two that touch do, and so does one in the liquid: the test can fail.
    assert!(step_size(&[far, far_neighbour]) < 0.2 * alone);
    assert!(step_size(&[small([4.5, 6.0])]) < 0.2 * alone);
}

/// Where two that held everyone's step part it grows, but by no more than half a step.
#[test]
fn steps_grow_slowly_where_spray_parts() {
    let mut particles = liquid::block([10, 12], 0.5, 0.2, &mut Random::new(47));
    for (z, speed) in [(6.0, -50.0), (6.1, 50.0)] {
        particles.push(Particle { velocity: [0.0, speed], ..small([100.0, z]) });
    }
    let mut block = Block::new(&liquid::physics(liquid::bare_method()), &particles);
    let steps: Vec<f64> = (0..40)
        .map(|_| {
            block.step();
            block.world.clock.previous_step_size
        })
        .collect();
    assert!(steps[39] > 4.0 * steps[0], "{steps:?}");
    assert!(steps.windows(2).all(|two| two[1] < 1.5001 * two[0]), "{steps:?}");
}

/// A lone ring has its hoop terms still: nearer to the axis than the size at the start its distance takes the place of its size, and
/// its ghost damps what swings.
#[test]
fn the_hoop_terms_of_a_lone_ring_bound_the_step() {
    // 1.5 of its own sizes from the axis: its image is out of reach. The Courant number is .5.
    let found = step_size(&[small([0.15, 40.0])]);
    let expected = 0.5 * 0.15 * SIZE / SOUND_SPEED;
    assert!((found / expected - 1.0).abs() < 1e-3, "{found} instead of {expected}");
    for distance in [0.15, 0.3, 0.45, 0.6] {
        let mut ring = small([distance, 40.0]);
        ring.density *= 1.001;
        let mut block = Block::new(&liquid::physics(liquid::bare_method()), &[ring]);
        let mut speeds = [0.0; 2];
        for step in 0..400 {
            block.step();
            let speed = block.column("velocity_r")[0].abs();
            speeds[step / 200] = speed.max(speeds[step / 200]);
        }
        assert!(speeds[1] < 0.1 * speeds[0], "{distance}: {speeds:?} m/s");
    }
}

/// Nobody comes nearer to it than a tenth of a size: the hoop terms of a fiftieth would leave no step to anybody.
#[test]
fn a_ring_that_runs_into_the_axis_stops_before_it() {
    let mut ring = small([0.02, 40.0]);
    ring.mass *= 100.0;
    ring.velocity = [-1.0, 0.0];
    let mut block = Block::new(&liquid::physics(liquid::bare_method()), &[ring]);
    for _ in 0..10 {
        block.step();
        let [r, mass, density] = ["radius", "mass", "density"].map(|name| block.column(name)[0]);
        let distance = r / (mass / (2.0 * PI * r * density)).sqrt();
        // Within one step its density may change.
        assert!(distance > 0.09, "{distance} sizes from the axis");
    }
}

/// A particle beside a drop, out of its reach: the drop's Laplace pressure, fitted along its surface, would drive it.
#[test]
fn a_drop_near_by_does_not_drive_spray() {
    let mut simulation = drops::start(&drops::drop(&[]));
    let z = drops::column(&simulation, "axial");
    let top = (0..z.len()).max_by(|&a, &b| z[a].total_cmp(&z[b])).unwrap();
    let thrown = drops::identities(&simulation)[top];
    let size = (drops::column(&simulation, "mass")[top]
        / (2.0 * PI * 1000.0 * drops::column(&simulation, "radius")[top]))
        .sqrt();
    simulation.world.store.by_name_mut::<f64>("axial").unwrap()[top] += 2.0 * size;
    for _ in 0..3 {
        drops::advance(&mut simulation, 8);
        let spray = drops::identities(&simulation).iter().position(|&identity| identity == thrown).unwrap();
        let drop = simulation.world.store.by_name::<u32>("drop").unwrap().to_vec();
        assert!(drop.iter().enumerate().all(|(i, &d)| i == spray || d != drop[spray]), "it touches nobody");
        let [pressures, slopes] =
            ["laplace_pressure", "laplace_slope"].map(|name| drops::column(&simulation, name));
        assert_eq!([pressures[spray], slopes[spray]], [0.0; 2]);
        assert!(slopes.iter().any(|&slope| slope != 0.0), "the drop has slopes");
    }
}
