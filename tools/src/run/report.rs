//! What stands at the end of a run: its summary, its plots, and the table for people.

use meniscus_cases::measure::{Outcome, conservation, evaluate};
use meniscus_cases::scene::{Precision, Scene};
use meniscus_cases::simulation::Simulation;

use super::plots;
use super::profile;
use super::recorder::{OUTPUTS, Recorder};
use super::stopwatch::Stopwatch;
use super::{Costs, FIRST_PARTICLES};
use crate::command::version;
use crate::failure::Failure;
use crate::output::folder::RunFolder;
use crate::output::summary::{Conservation, Measure, StageCost, Status, Summary};

/// How the run ended, and why it failed if it did.
pub(super) struct Ending {
    pub(super) status: Status,
    pub(super) failure: Option<String>,
    /// What messages about it begin with.
    pub(super) prefix: String,
}

/// Writes the summary and the plots.
pub(super) fn report(
    scene: &Scene,
    folder: &RunFolder,
    simulation: &Simulation,
    (recorder, costs): (&Recorder, &Costs),
    ending: Ending,
) -> Result<Summary, Failure> {
    let history = &recorder.history;
    let outcomes = evaluate(scene, history);
    for outcome in &outcomes {
        if let Some(doubt) = &outcome.doubt {
            eprintln!("{}`{}` {doubt}", ending.prefix, outcome.name);
        }
    }
    plots::draw(scene, folder, history)?;
    let [momentum_z, energy, mass] = conservation(scene, history);
    let clock = &simulation.world.clock;
    // Before the first step nothing has a cost for each.
    let taken = Some(simulation.particle_steps()).filter(|taken| *taken > 0);
    let particle_steps = taken.map_or(f64::NAN, |taken| taken as f64);
    let Stopwatch { wall: wall_seconds, cpu: cpu_seconds } = costs.started.elapsed();
    let stages = stages(simulation, recorder, costs, (wall_seconds, particle_steps));
    let told = (simulation.costs(), stages.as_slice());
    let profile = costs.profiler.as_ref();
    let profile = profile
        .map(|profiler| profile::profile(profiler, &folder.profile(), told, simulation.particle_steps()));
    let summary = Summary {
        scene: scene.title.clone(),
        status: Some(ending.status),
        failure: ending.failure,
        particles: simulation.world.store.len() as u64,
        first_particles: clock.number(FIRST_PARTICLES) as u64,
        steps: clock.step,
        time: clock.time,
        wall_seconds,
        cpu_seconds,
        threads: rayon::current_num_threads(),
        ns_per_particle_step: costs.steps.wall * 1e9 / particle_steps,
        core_ns_per_particle_step: costs.steps.cpu * 1e9 / particle_steps,
        mixed_precision: scene.method.precision == Precision::Mixed,
        step_bounds: clock.bounds_met().iter().map(|(reason, steps)| (reason.to_string(), *steps)).collect(),
        profile: profile.transpose()?,
        stages,
        measures: outcomes.iter().map(measure).collect(),
        conservation: Conservation { momentum_z, energy, mass },
        version: version(),
    };
    summary.write(&folder.summary())?;
    Ok(summary)
}

fn measure(outcome: &Outcome) -> Measure {
    Measure {
        name: outcome.name.clone(),
        value: outcome.value,
        unit: if outcome.unit == "1" { "" } else { outcome.unit }.to_owned(),
        reference: outcome.reference,
        relative_error: outcome.relative_error(),
    }
}

/// The stages of a step, and what came before and between the steps.
fn stages(
    simulation: &Simulation,
    recorder: &Recorder,
    costs: &Costs,
    (wall_seconds, particle_steps): (f64, f64),
) -> Vec<StageCost> {
    let stage = |name: &str, calls: u64, seconds: f64| StageCost {
        name: name.to_owned(),
        calls,
        seconds,
        ns_per_particle_step: seconds * 1e9 / particle_steps,
        share: seconds / wall_seconds,
    };
    let steps = simulation.costs().iter();
    let mut stages: Vec<StageCost> =
        steps.map(|cost| stage(cost.stage, cost.calls, cost.time.as_secs_f64())).collect();
    if costs.filling.wall > 0.0 {
        stages.push(stage("packing", 1, costs.filling.wall));
    }
    let taken = simulation.world.clock.step - costs.first_step;
    stages.push(stage(OUTPUTS, taken, recorder.cost.wall));
    stages
}
