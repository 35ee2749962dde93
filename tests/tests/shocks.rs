//! Shocks against their exact solutions.

use meniscus_cases::scene::Scene;
use meniscus_cases::simulation::Simulation;
use meniscus_tests::drops::{self, column};
use std::f64::consts::PI;

/// Noh's problem in a cylinder, as cold as `heat` says, in J/kg.
const NOH: &str = r#"format = 1
title = "A cold gas streams into the axis"
[parameters]
heat = "0 J/kg"
size = "0.02 m"
[liquid]
density = "1 kg/m3"
equation_of_state = "ideal-gas"
heat_ratio = "5/3"
[domain]
period = "0.2 m"
[[body]]
shape = { cylinder = { radius = "1 m", bottom = "-0.1 m", top = "0.1 m" } }
velocity = { r = "-1 m/s" }
internal_energy = "heat"
[particles]
size = "size"
[run]
until = "0.6 s"
[method]
flux = "first-order"
time_integration = "euler"
"#;

fn run(scene: &Scene) -> Simulation {
    let mut simulation = drops::start(scene);
    while simulation.world.clock.time < scene.until {
        drops::advance(&mut simulation, 1);
    }
    simulation
}

/// Mass over volume between two radii in m, kg/m3.
fn density_between(simulation: &Simulation, [low, high]: [f64; 2]) -> f64 {
    let [r, mass] = ["radius", "mass"].map(|name| column(simulation, name));
    let inside = r.iter().zip(&mass).filter(|(r, _)| (low..high).contains(*r));
    inside.map(|(_, mass)| mass).sum::<f64>() / (0.2 * PI * (high * high - low * low))
}

/// Who has no heat has no waves, and no impedance.
#[test]
fn a_gas_without_heat_starts_with_any_flux() {
    for flux in ["first-order", "reconstructed"] {
        let flux = format!("method.flux={flux}");
        let scene = drops::scene(NOH, &["method.time_integration=adams-bashforth", &flux]);
        drops::advance(&mut drops::start(&scene), 50);
    }
}

/// It has nothing that bounds a step where it moves as a whole, either: one of 47 Ts ended the run.
#[test]
fn a_gas_without_heat_that_moves_as_a_whole_takes_steps_as_long_as_its_particles() {
    for flux in ["first-order", "reconstructed"] {
        let flux = format!("method.flux={flux}");
        let scene = drops::scene(NOH, &["body.0.velocity.r=0 m/s", "body.0.velocity.z=1 m/s", &flux]);
        let simulation = run(&scene);
        let clock = &simulation.world.clock;
        assert!(
            clock.time < scene.until + 0.021 && clock.step >= 28,
            "{} s, {} steps",
            clock.time,
            clock.step
        );
        let density = column(&simulation, "density");
        assert!(density.iter().all(|density| (density - 1.0).abs() < 1e-9), "{density:?}");
    }
}

#[test]
fn a_cold_gas_is_stopped_by_the_shock_of_nohs_problem() {
    for heat in ["heat=\"0 J/kg\"", "heat=\"1e-6 J/kg\""] {
        let simulation = run(&drops::scene(NOH, &[heat]));
        // The shock stands at 0.2 m, smeared over a few of the 0.02 m; the axis heats the inmost gas.
        let plateau = density_between(&simulation, [0.08, 0.16]);
        // Ahead of the shock the density is 1 + t/r, with t = 0.6 s: 2.765 in the mean of this ring.
        let ahead = density_between(&simulation, [0.3, 0.38]);
        println!("{heat}: behind {plateau}, ahead {ahead}");
        assert!((plateau / 16.0 - 1.0).abs() < 0.06, "{heat}: {plateau}");
        assert!((ahead / 2.765 - 1.0).abs() < 0.05, "{heat}: {ahead}");
    }
}
