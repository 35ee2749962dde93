//! The `hard` scenes of the cases: nothing may become infinite, win energy, cross the axis or gather
//! neighbours without bound.

use meniscus_cases::scene::{Scene, read};
use meniscus_cases::simulation::Simulation;
use meniscus_tests::drops::{self, column, totals};
use std::f64::consts::PI;
use std::path::Path;

/// Most neighbours of one particle within its list. A packing has 15 at the least smoothing length; a shock
/// or the axis may gather a few times as many, a collapse of the packing hundreds.
const MOST_NEIGHBOURS: usize = 100;

fn hard(case: &str, settings: &[&str]) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../cases").join(case);
    let settings: Vec<String> = settings.iter().map(|&s| s.to_owned()).collect();
    match read(&path, &settings) {
        Ok(scene) => scene,
        Err(diagnosis) => panic!("{diagnosis}"),
    }
}

/// Kinetic energy, and that of the central force or, where the energy equation is solved, the heat; in J.
fn energy(scene: &Scene, simulation: &Simulation) -> f64 {
    let mass = column(simulation, "mass");
    if simulation.physics.equation.with_energy() {
        let energy = column(simulation, "total_energy");
        return mass.iter().zip(&energy).map(|(m, e)| m * e).sum();
    }
    let [r, z] = ["radius", "axial"].map(|name| column(simulation, name));
    let squares = mass.iter().zip(r.iter().zip(&z)).map(|(m, (r, z))| m * (r * r + z * z));
    totals(simulation).kinetic + 0.5 * scene.central_force * squares.sum::<f64>()
}

/// Rounding alone: a thousand steps of sums that cancel to 1e-16 each.
const ROUNDING: f64 = 1e-12;

/// What the time integration may add to the energy where heat is not counted: the flux dissipates more.
const WON: f64 = 0.001;

/// Runs to the end and checks every hundred steps.
fn survive(case: &str, settings: &[&str]) {
    let scene = hard(case, settings);
    let mut simulation = drops::start(&scene);
    let start = energy(&scene, &simulation);
    let with_heat = simulation.physics.equation.with_energy();
    let (mut change, mut gathered) = (0.0, 0);
    while simulation.world.clock.time < scene.until {
        drops::advance(&mut simulation, 100);
        assert!(drops::is_finite(&simulation), "{case} {settings:?}");
        let least = column(&simulation, "radius").into_iter().fold(f64::INFINITY, f64::min);
        assert!(least + scene.domain.origin > 0.0, "{case} {settings:?}: radius {least}");
        let list = &simulation.world.neighbours;
        let neighbours = (0..list.len()).map(|i| list.of(i).count()).max().unwrap_or(0);
        assert!(neighbours < MOST_NEIGHBOURS, "{case} {settings:?}: {neighbours} neighbours");
        gathered = gathered.max(neighbours);
        change = energy(&scene, &simulation) / start - 1.0;
        let bounded = if with_heat { change.abs() < ROUNDING } else { change < WON };
        assert!(bounded, "{case} {settings:?}: energy changes by {change:e}");
    }
    println!("{case} {settings:?}: energy changes by {change:e}, {gathered} neighbours");
}

#[test]
fn water_drops_survive_fast_impacts() {
    for [large, small] in [[50, 200], [200, 50], [200, 200]] {
        let speeds = [format!("large_speed=\"{large} m/s\""), format!("small_speed=\"{small} m/s\"")];
        for size in ["particle_size=\"40 um\"", "particle_size=\"25 um\""] {
            survive("drop-collision-impact/hard.toml", &[&speeds[0], &speeds[1], size]);
        }
    }
    for setting in ["method.theta=0.75", "method.theta=1", "method.cfl=0.8"] {
        survive("drop-collision-impact/hard.toml", &[setting]);
    }
}

#[test]
fn water_layers_survive_strong_shocks() {
    survive("impact-shock/hard.toml", &["particle_size=\"20 um\""]);
}

#[test]
fn a_gas_without_heat_survives_its_way_into_a_point() {
    survive("noh/hard.toml", &[]);
}

#[test]
fn a_long_spheroid_does_not_win_energy() {
    survive("free-spheroid/hard.toml", &[]);
}

/// Momentum along the axis, over the largest sum of |m U_z|: each step adds a rounding of that sum.
const MOMENTUM: f64 = 1e-11;

/// Runs a scene with surface tension to the end; the largest part of all energy that was in motion. The surface
/// may give no more than all its energy at the start, `surface` times the tension (m2).
fn survive_with_tension(case: &str, settings: &[&str], surface: f64) -> f64 {
    let scene = hard(case, settings);
    let mut simulation = drops::start(&scene);
    let start = totals(&simulation);
    let available = start.kinetic + scene.liquid.surface_tension * surface;
    let (mut most, mut scale) = (0.0_f64, start.momentum_scale);
    while simulation.world.clock.time < scene.until {
        drops::advance(&mut simulation, 100);
        assert!(drops::is_finite(&simulation), "{case} {settings:?}");
        let least = column(&simulation, "radius").into_iter().fold(f64::INFINITY, f64::min);
        assert!(least > 0.0, "{case} {settings:?}: radius {least}");
        let now = totals(&simulation);
        most = most.max(now.kinetic / available);
        scale = scale.max(now.momentum_scale);
        assert!(most < 1.0, "{case} {settings:?}: {most} of the energy there was");
        let drift = (now.momentum - start.momentum).abs() / scale;
        assert!(drift < MOMENTUM, "{case} {settings:?}: axial momentum drifts by {drift:e}");
    }
    println!("{case} {settings:?}: at most {most:.3} of the energy in motion");
    most
}

/// Drops that become one set free a tenth of their surface. A rough surface must not drive itself on after that:
/// with Laplace pressures that changed at any rate, a fifth and more of the energy was in motion.
#[test]
fn splashes_do_not_drive_themselves() {
    let surface = 4.0 * PI * (1.0e-12 + 0.49e-12);
    for size in ["particle_size=small/7", "particle_size=small/12"] {
        let most = survive_with_tension("drop-collision-capillary/hard.toml", &[size], surface);
        assert!(most < 0.12, "{size}: {most} of the energy in motion");
    }
}

#[test]
fn small_drops_merge_at_speed() {
    let surface = 4.0 * PI * (1.0e-12 + 0.49e-12);
    for size in ["0.115 um", "0.1 um", "0.085 um", "0.067 um"] {
        survive_with_tension(
            "drop-collision-capillary/hard.toml",
            &[&format!("particle_size=\"{size}\"")],
            surface,
        );
    }
}

#[test]
fn a_long_drop_shoots_past_the_sphere_and_comes_back() {
    let (radial, axial) = (1e-6_f64, 3e-6_f64);
    let eccentricity = (1.0 - (radial / axial).powi(2)).sqrt();
    let surface = 2.0 * PI * radial * (radial + axial / eccentricity * eccentricity.asin());
    for size in ["90 nm", "75 nm", "66.7 nm"] {
        survive_with_tension("oscillating-drop/hard.toml", &[&format!("particle_size=\"{size}\"")], surface);
    }
    // Settling rounds it: without, it starts as long as it is.
    let settings = ["particle_size=\"90 nm\"", "particles.settle=0"];
    survive_with_tension("oscillating-drop/hard.toml", &settings, surface);
}

#[test]
fn a_drop_swings_at_a_large_amplitude() {
    let (radial, axial) = (2.5e-6 * 1.5_f64.powf(-1.0 / 3.0), 2.5e-6 * 1.5_f64.powf(2.0 / 3.0));
    let eccentricity = (1.0 - (radial / axial).powi(2)).sqrt();
    let surface = 2.0 * PI * radial * (radial + axial / eccentricity * eccentricity.asin());
    let settings = ["particle_size=radius/12", "periods=2"];
    survive_with_tension("large-amplitude-drop/scene.toml", &settings, surface);
}

#[test]
fn touching_drops_become_one() {
    for ratio in [1.0, 0.5] {
        let surface = 4.0 * PI * 1e-10 * (1.0 + ratio * ratio);
        let settings = [&format!("ratio={ratio}")[..], "particle_size=radius/14", "times=1.5"];
        survive_with_tension("drop-coalescence/scene.toml", &settings, surface);
    }
}

#[test]
fn equal_drops_meet_head_on() {
    for weber in ["weber=5", "weber=30"] {
        let settings = [weber, "particle_size=radius/12", "times=1.5"];
        survive_with_tension("equal-drop-impact/scene.toml", &settings, 8.0 * PI * 1e-10);
    }
}

#[test]
fn a_ring_closes_on_the_axis() {
    let surface = 4.0 * PI * PI * 2e-6 * 0.5e-6;
    for size in ["75 nm", "66.7 nm", "55 nm"] {
        survive_with_tension("closing-torus/hard.toml", &[&format!("particle_size=\"{size}\"")], surface);
    }
}

#[test]
fn a_disc_draws_back_and_closes_on_the_axis() {
    let (radius, thickness) = (3e-6, 0.5e-6);
    survive_with_tension("taylor-culick-film/hard.toml", &[], 2.0 * PI * radius * (radius + thickness));
}

#[test]
fn a_jet_breaks_up_and_its_drops_stay_whole() {
    let surface = 2.0 * PI * 1e-6 * 10e-6;
    for size in ["66.7 nm", "50 nm"] {
        let settings = [&format!("particle_size=\"{size}\"")[..], "times=18"];
        survive_with_tension("rayleigh-plateau-jet/scene.toml", &settings, surface);
    }
}
