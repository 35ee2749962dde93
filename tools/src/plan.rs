//! `meniscus plan`: what a run would do, and what it would cost.

mod calibration;

use std::process::ExitCode;

use meniscus_cases::assemble::{Physics, assemble};
use meniscus_cases::scene::{self, Scene};
use meniscus_engine::wiring::{Access, Wiring};

use crate::command::{PlanArguments, pool, print};
use crate::failure::Failure;
use crate::output::units::{counted, duration, quantity};
use calibration::calibrate;

/// Prints the plan of a scene.
pub(crate) fn plan(arguments: &PlanArguments) -> Result<ExitCode, Failure> {
    let scene = scene::read(&arguments.scene, &arguments.set)?;
    for warning in &scene.warnings {
        eprintln!("{:?}", miette::Report::new(warning.clone()));
    }
    let pool = pool(arguments.threads)?;
    print(&format!("{}\n\n{}", scene.title, stages(&scene)?))?;
    print(&pool.install(|| costs(&scene))?)?;
    if arguments.fields {
        print(&fields(&assembled(&scene)?.wiring))?;
    }
    Ok(ExitCode::SUCCESS)
}

fn assembled(scene: &Scene) -> Result<meniscus_cases::assemble::Assembly, Failure> {
    assemble(&Physics::of(scene)).map_err(|error| Failure::on_the_way(error.to_string()))
}

/// The stages that are in and those that are out, with the reasons.
fn stages(scene: &Scene) -> Result<String, Failure> {
    let plan = assembled(scene)?.plan;
    let mut text = String::new();
    for (heading, present) in [("stages of a step", true), ("left out", false)] {
        text += &format!("{heading}\n");
        for line in plan.iter().filter(|line| line.present == present) {
            text += &format!("  {:<22} {}\n", line.stage, line.reason);
        }
        if plan.iter().all(|line| line.present != present) {
            text += "  none\n";
        }
    }
    Ok(text)
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

/// Fills the scene and runs a piece of it: what the whole would cost.
fn costs(scene: &Scene) -> Result<String, Failure> {
    let costs = calibrate(scene)?;
    let world = &costs.simulation.world;
    let particles = world.store.len() as u64;
    let bounds = world.clock.bounds_met().iter();
    let bound = bounds.max_by_key(|(_, count)| *count).map_or("", |(reason, _)| reason.as_ref());
    let lines = [
        String::new(),
        sound_speed_sentence(scene),
        format!("{} of {}", counted(particles, "particle"), quantity(scene.particle_size, "m", 3)),
        format!("time step {}, bounded as {bound}", quantity(costs.step_size, "s", 3)),
        format!("about {} to {}", counted(costs.steps, "step"), quantity(costs.end, "s", 4)),
        format!("memory about {} MB", quantity(costs.simulation.bytes() as f64 / 1e6, "", 3)),
        format!(
            "about {} on {} (measured over {})",
            duration(costs.seconds()),
            counted(rayon::current_num_threads() as u64, "thread"),
            duration(costs.measured),
        ),
        format!(
            "  {} until the particles are placed, {} for the steps, {} for pictures",
            duration(costs.start_seconds),
            duration(costs.step_seconds * costs.steps as f64),
            duration(costs.picture_seconds),
        ),
        format!("  a particle and step: {}", quantity(costs.step_seconds / particles as f64, "s", 3)),
    ];
    Ok(lines.join("\n") + "\n")
}

/// Every field, and who writes and reads it.
fn fields(wiring: &Wiring) -> String {
    let mut text = "\nfields\n".to_owned();
    let mut names = Vec::new();
    for used in wiring.uses() {
        if names.contains(&used.field.name) {
            continue;
        }
        names.push(used.field.name);
        text += &format!("  {} [{}] {}\n", used.field.name, used.field.unit, used.field.about);
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
                text += &format!("      {verb} {}\n", stages.join(", "));
            }
        }
    }
    text
}
