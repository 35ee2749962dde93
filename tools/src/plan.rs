//! `meniscus plan`: what a run would do, and what it would cost.

use std::process::ExitCode;
use std::time::Instant;

use meniscus_cases::assemble::{Physics, assemble};
use meniscus_cases::scene::{self, Scene};
use meniscus_cases::simulation::{SETTLE, Simulation};
use meniscus_engine::lanes::Row;
use meniscus_engine::wiring::{Access, Wiring};

use crate::command::{PlanArguments, pool};
use crate::failure::Failure;
use crate::output::units::{duration, grouped, quantity};

/// Steps of the trial that tells step size and cost, and those before it that warm it up.
const TRIAL: u32 = 50;
const WARM_UP: u32 = 10;
/// Packed rows of a particle at most: flow and gradient.
const ROWS_EACH: usize = 2;

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

/// Packs the scene and takes a few steps, without settling: their size and cost are the same.
fn print_costs(scene: &Scene) -> Result<(), Failure> {
    let mut unsettled = scene.clone();
    unsettled.settle = Some(0.0);
    let mut simulation = Simulation::new(&unsettled, &mut |_, _| {})?;
    let mut trial = |steps: u32| -> Result<f64, Failure> {
        let started = Instant::now();
        for _ in 0..steps {
            let step = simulation.step();
            step.map_err(|fault| Failure::on_the_way(format!("the trial broke down: {fault}")))?;
        }
        Ok(started.elapsed().as_secs_f64() / f64::from(steps))
    };
    trial(WARM_UP)?;
    let seconds = trial(TRIAL)?;
    let world = &simulation.world;
    let (particles, step_size) = (world.store.len() as u64, world.clock.previous_step_size);
    let bounds = world.clock.bounds_met().iter();
    let bound = bounds.max_by_key(|(_, count)| *count).map_or("", |(reason, _)| reason.as_ref());
    let settling = if scene.liquid.surface_tension > 0.0 {
        scene.settle.unwrap_or(SETTLE) * Simulation::capillary_time(scene)
    } else {
        0.0
    };
    let steps = ((scene.until / step_size).ceil() as u64).min(scene.steps.unwrap_or(u64::MAX));
    let settling_steps = (settling / step_size).ceil() as u64;
    println!("\n{}", sound_speed_sentence(scene));
    println!("{} particles of {}", grouped(particles), quantity(scene.particle_size, "m", 3));
    println!("time step {}, bounded as {bound}", quantity(step_size, "s", 3));
    let end = quantity(scene.until, "s", 4);
    println!("about {} steps to {end}, after {} to settle", grouped(steps), grouped(settling_steps));
    println!("memory about {}", memory(&simulation));
    println!(
        "about {} on {} threads: {} a particle and step in a trial of {TRIAL} steps",
        duration(seconds * (steps + settling_steps) as f64),
        rayon::current_num_threads(),
        quantity(seconds / particles as f64, "s", 3),
    );
    Ok(())
}

/// Columns, packed rows, and neighbour list in both its forms.
fn memory(simulation: &Simulation) -> String {
    let world = &simulation.world;
    let columns = world.store.len() * world.store.bytes_per_particle();
    let images = world.neighbours.images().len();
    let rows = ROWS_EACH * size_of::<Row>() * (world.store.len() + images);
    let list = 2 * 4 * world.neighbours.pairs() as usize;
    quantity((columns + rows + list) as f64 / 1e6, "", 3) + " MB"
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
