//! The `hard` scenes of the cases without surface tension: nothing may become infinite, win energy, cross
//! the axis or gather neighbours without bound.

use meniscus_cases::scene::{Scene, read};
use meniscus_cases::simulation::Simulation;
use meniscus_tests::drops::{self, column, totals};
use std::path::Path;

/// Most neighbours of one particle within its list. A packing has 15 at the least smoothing length; a shock
/// or the axis may gather a few times as many, a collapse of the packing hundreds.
const MOST_NEIGHBOURS: usize = 100;

fn hard(case: &str, settings: &[&str]) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../cases").join(case).join("hard.toml");
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
            survive("drop-collision-impact", &[&speeds[0], &speeds[1], size]);
        }
    }
    for theta in ["method.theta=0.75", "method.theta=1"] {
        survive("drop-collision-impact", &[theta]);
    }
}

#[test]
fn water_layers_survive_strong_shocks() {
    survive("impact-shock", &["particle_size=\"20 um\""]);
}

#[test]
fn a_gas_without_heat_survives_its_way_into_a_point() {
    survive("noh", &[]);
}

#[test]
fn a_long_spheroid_does_not_win_energy() {
    survive("free-spheroid", &[]);
}
