//! The profile of a run: how fast each stage is, how evenly its threads are busy, and a trace of some steps.

mod profiler;
mod subscriber;
mod trace;

use std::path::Path;

use meniscus_engine::pipeline::Cost;

use crate::output::OutputResult;
use crate::output::summary::{PairSpeed, Profile, StageCost, StageProfile};
use profiler::Busy;
pub(super) use profiler::Profiler;

/// Writes the trace, and tells how fast the stages of a run were.
///
/// # Errors
/// When the trace cannot be written.
pub(super) fn profile(
    profiler: &Profiler,
    trace: &Path,
    (costs, stages): (&[Cost], &[StageCost]),
    particle_steps: u64,
) -> OutputResult<Profile> {
    profiler.stop();
    trace::write(profiler, trace)?;
    let particle_steps = particle_steps.max(1) as f64;
    let busy = profiler.busy();
    let stages = stages.iter().map(|stage| StageProfile {
        cost: stage.clone(),
        busy: find(&busy, &stage.name).map_or_else(Vec::new, shares),
        imbalance: find(&busy, &stage.name).map(imbalance),
        pairs: costs
            .iter()
            .find(|cost| cost.stage == stage.name)
            .and_then(|cost| speed(cost, particle_steps)),
    });
    Ok(Profile { stages: stages.collect() })
}

/// How busy the threads were with the chunks of a stage; none where it has no chunks.
fn find<'a>(busy: &'a [Busy], stage: &str) -> Option<&'a Busy> {
    busy.iter().find(|busy| busy.stage == stage && busy.longest > 0)
}

/// The part of the elapsed time in which each thread was busy. Stages that take chunks in turn share that time by what all
/// threads did for each: of one of them a thread can have done more than it lasts, while the other was at the next. All
/// together are no busier than their number.
fn shares(busy: &Busy) -> Vec<f64> {
    busy.threads.iter().map(|&thread| thread as f64 / busy.elapsed as f64).collect()
}

/// The longest time that a thread was busy over the mean of all threads, call by call: so much
/// shorter the chunks of a stage would take if they were evenly spread.
fn imbalance(busy: &Busy) -> f64 {
    busy.longest as f64 * busy.threads.len() as f64 / busy.threads.iter().sum::<u64>() as f64
}

/// The speed of a pair pass; none where a stage is none.
fn speed(cost: &Cost, particle_steps: f64) -> Option<PairSpeed> {
    let (work, nanoseconds) = (cost.pair_work, cost.time.as_secs_f64() * 1e9);
    (work.pairs > 0 && nanoseconds > 0.0).then(|| PairSpeed {
        per_particle_step: work.pairs as f64 / particle_steps,
        per_nanosecond: work.pairs as f64 / nanoseconds,
        gigabytes_per_second: work.bytes as f64 / nanoseconds,
        gigaflops: work.operations as f64 / nanoseconds,
    })
}
