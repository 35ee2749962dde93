//! A quantity that goes bad stops the run with a name, not with a panic.

use meniscus_cases::simulation::Simulation;
use meniscus_engine::pipeline::Fault;
use meniscus_tests::drops;
use std::f64::consts::PI;

/// A drop after ten steps, with one particle's columns set.
fn spoiled(columns: &[(&str, f64)]) -> (Simulation, u32) {
    let mut simulation = drops::start(&drops::drop(&[]));
    drops::advance(&mut simulation, 10);
    let particle = 100;
    let identity = simulation.world.store.by_name::<u32>("identity").expect("a column")[particle];
    for &(name, value) in columns {
        let mut values = drops::column(&simulation, name);
        values[particle] = value;
        assert!(simulation.world.store.set(name, &values), "no column `{name}`");
    }
    (simulation, identity)
}

fn first_fault(simulation: &mut Simulation, steps: usize) -> Option<Fault> {
    (0..steps).find_map(|_| simulation.step().err())
}

#[test]
fn the_faults_sentence_names_everything() {
    let cases: [(&str, f64); 9] = [
        ("density", f64::NAN),
        ("density", -1000.0),
        ("density", 0.0),
        ("velocity_r", f64::NAN),
        ("velocity_z", f64::INFINITY),
        ("axial", f64::NAN),
        ("axial", f64::INFINITY),
        ("radius", f64::NAN),
        ("radius", -1e-7),
    ];
    for (name, value) in cases {
        let (mut simulation, identity) = spoiled(&[(name, value)]);
        let step = simulation.world.clock.step;
        let Some(fault) = first_fault(&mut simulation, 5) else {
            panic!("`{name}` = {value} goes unnoticed");
        };
        println!("{name} = {value}: {fault}");
        assert_eq!((fault.particle, fault.quantity), (identity, name), "{fault}");
        let text = fault.to_string();
        assert!(!fault.stage.is_empty() && !fault.quantity.is_empty());
        assert!(fault.step >= step && fault.step < step + 5);
        let parts = [
            fault.stage.to_owned(),
            format!("particle {}", fault.particle),
            fault.quantity.to_owned(),
            format!("step {}", fault.step),
        ];
        for part in parts {
            assert!(text.contains(&part), "`{part}` is missing in: {text}");
        }
    }
}

#[test]
fn a_particle_shot_at_the_axis_is_named() {
    let speed = drops::drop(&[]).derived_sound_speed();
    for (name, value) in [("velocity_r", -30.0 * speed), ("velocity_z", 1e30), ("velocity_r", 1e30)] {
        let (mut simulation, _) = spoiled(&[(name, value)]);
        match first_fault(&mut simulation, 3000) {
            Some(fault) => println!("{name} = {value:e}: {fault}"),
            None => assert!(drops::is_finite(&simulation), "{name} = {value:e}"),
        }
    }
}

#[test]
fn a_particle_across_the_axis_is_named() {
    // Shot from next to the axis, nothing lies in between that could hold it back.
    let (mut simulation, identity) = spoiled(&[("radius", 1e-9), ("velocity_r", -1e4)]);
    let fault = first_fault(&mut simulation, 50).expect("a fault");
    println!("{fault}");
    assert_eq!((fault.stage, fault.particle), ("time-step", identity), "{fault}");
}

#[test]
fn who_sets_the_viscous_bound_is_named() {
    let mut simulation = drops::start(&drops::drop(&["liquid.viscosity=1e3 Pa s"]));
    let fault = simulation.step().expect_err("a fault");
    println!("{fault}");
    let [r, density, mass] = ["radius", "density", "mass"].map(|name| drops::column(&simulation, name));
    let rate = |i: usize| {
        let area = mass[i] / (2.0 * PI * r[i] * density[i]);
        (8.0 / area + 1.0 / (r[i] * r[i])) / density[i]
    };
    let fastest = (0..r.len()).max_by(|&a, &b| rate(a).total_cmp(&rate(b))).expect("particles");
    let identity = simulation.world.store.by_name::<u32>("identity").expect("a column")[fastest];
    assert_eq!((fault.quantity, fault.particle), ("viscous time step", identity), "{fault}");
    let told = fault.to_string();
    assert!(told.contains(" s (at least ") && told.contains("lower the viscosity"), "{told}");
}

#[test]
fn a_fault_repeats_and_time_stands_still() {
    let (mut simulation, _) = spoiled(&[("density", f64::NAN)]);
    let (step, time) = (simulation.world.clock.step, simulation.world.clock.time);
    let first = simulation.step().expect_err("a fault");
    let second = simulation.step().expect_err("a fault");
    assert_eq!((first.stage, first.step), (second.stage, second.step));
    assert_eq!((simulation.world.clock.step, simulation.world.clock.time), (step, time));
}
