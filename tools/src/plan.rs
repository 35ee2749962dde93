//! `meniscus plan`: what a run would do, and what it would cost.

mod calibration;

use std::process::ExitCode;

use meniscus_cases::assemble::{Physics, assemble};
use meniscus_cases::scene::{self, Scene};
use meniscus_engine::wiring::{Access, Wiring};

use crate::command::{PlanArguments, pool};
use crate::failure::Failure;
use crate::output::units::{duration, grouped, quantity};
use calibration::calibrate;

/// Prints the plan of a scene.
pub(crate) fn plan(arguments: &PlanArguments) -> Result<ExitCode, Failure> {
    let scene = scene::read(&arguments.scene, &arguments.set)?;
    for warning in &scene.warnings {
        eprintln!("{:?}", miette::Report::new(warning.clone()));
    }
    let pool = pool(arguments.threads)?;
    println!("{}\n", scene.title);
    print_stages(&scene)?;
    pool.install(|| print_costs(&scene))?;
    if arguments.fields {
        print_fields(&assembled(&scene)?.wiring);
    }
    Ok(ExitCode::SUCCESS)
}

fn assembled(scene: &Scene) -> Result<meniscus_cases::assemble::Assembly, Failure> {
    assemble(&Physics::of(scene)).map_err(|error| Failure::on_the_way(error.to_string()))
}

fn print_stages(scene: &Scene) -> Result<(), Failure> {
    let plan = assembled(scene)?.plan;
    for (heading, present) in [("stages of a step", true), ("left out", false)] {
        println!("{heading}");
        for line in plan.iter().filter(|line| line.present == present) {
            println!("  {:<22} {}", line.stage, line.reason);
        }
        if plan.iter().all(|line| line.present != present) {
            println!("  none");
        }
    }
    Ok(())
}

/// Where the sound speed comes from, in a sentence.
pub(crate) fn sound_speed_sentence(scene: &Scene) -> String {
    let speed = quantity(scene.derived_sound_speed(), "m/s", 4);
    if scene.liquid.sound_speed.is_some() {
        return format!("sound speed {speed}, as the scene says");
    }
    let motion = scene.fastest_initial_speed();
    let waves = 8f64.sqrt() * scene.capillary_velocity();
    let (cause, fastest) = if motion > waves {
        ("the fastest initial motion", motion)
    } else {
        ("the fastest capillary motion to expect", waves)
    };
    let fastest = quantity(fastest, "m/s", 4);
    format!("sound speed {speed}, ten times {cause}, {fastest}")
}

/// Fills the scene and runs a piece of it.
fn print_costs(scene: &Scene) -> Result<(), Failure> {
    let costs = calibrate(scene)?;
    let world = &costs.simulation.world;
    let particles = world.store.len() as u64;
    let bounds = world.clock.bounds_met().iter();
    let bound = bounds.max_by_key(|(_, count)| *count).map_or("", |(reason, _)| reason.as_ref());
    println!("\n{}", sound_speed_sentence(scene));
    println!("{} particles of {}", grouped(particles), quantity(scene.particle_size, "m", 3));
    println!("time step {}, bounded as {bound}", quantity(costs.step_size, "s", 3));
    println!("about {} steps to {}", grouped(costs.steps), quantity(scene.until, "s", 4));
    println!("memory about {} MB", quantity(costs.simulation.bytes() as f64 / 1e6, "", 3));
    println!(
        "about {} on {} (measured over {})",
        duration(costs.seconds()),
        counted(rayon::current_num_threads(), "thread"),
        duration(costs.measured),
    );
    println!(
        "  {} until the particles are placed, {} for the steps, {} for pictures",
        duration(costs.start_seconds),
        duration(costs.step_seconds * costs.steps as f64),
        duration(costs.picture_seconds),
    );
    println!("  a particle and step: {}", quantity(costs.step_seconds / particles as f64, "s", 3));
    Ok(())
}

fn counted(number: usize, thing: &str) -> String {
    format!("{number} {thing}{}", if number == 1 { "" } else { "s" })
}

fn print_fields(wiring: &Wiring) {
    println!("\nfields");
    let mut names = Vec::new();
    for used in wiring.uses() {
        if names.contains(&used.field.name) {
            continue;
        }
        names.push(used.field.name);
        println!("  {} [{}] {}", used.field.name, used.field.unit, used.field.about);
        for (verb, accesses) in [
            ("written by", [Access::Write, Access::Update, Access::Add]),
            ("read by", [Access::Read, Access::Update, Access::Read]),
        ] {
            let mut stages: Vec<&str> = Vec::new();
            for other in wiring.uses() {
                let same = other.field.name == used.field.name && accesses.contains(&other.access);
                if same && !stages.contains(&other.stage) {
                    stages.push(other.stage);
                }
            }
            if !stages.is_empty() {
                println!("      {verb} {}", stages.join(", "));
            }
        }
    }
}
