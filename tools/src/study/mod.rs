//! `meniscus study`: a scene at every combination of some settings, error against cost.

pub(crate) mod batch;
pub(crate) mod error;
mod results;
mod variation;

use std::path::PathBuf;
use std::process::ExitCode;

use meniscus_cases::scene::Diagnosis;

use crate::command::{pool, print};
use crate::failure::{Failure, INTERRUPTED};
use crate::output::summary::Status;
use batch::{Job, prepare, run_all};
use results::Results;
use variation::{Variation, combinations};

const EXAMPLES: &str = "\
Examples:
  meniscus study drop.toml --vary particle_size='100 nm','71.4 nm','50 nm'
  meniscus study drop.toml --vary particle_size=radius/12,radius/25 --vary method.theta=.5,.6,.8
  meniscus study drop.toml --vary method.scheme=harmonic-mean,parshikov --set run.until='2 us' --out schemes

Every combination of the listed values runs once. DIR gets study.html, study.csv, study.json,
study.png, study.svg, and each run's own results in runs/.
Exit codes: 0 done; 1 a run broke down; 2 bad input; 130 interrupted.";

/// What a study leaves beside its runs.
const RESULTS: [&str; 5] = ["study.csv", "study.json", "study.png", "study.svg", "study.html"];

/// Arguments of `study`.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct StudyArguments {
    /// The scene
    #[arg(value_name = "SCENE.toml")]
    scene: PathBuf,
    /// Values of a key, separated by commas; may be given several times
    #[arg(long, value_name = "KEY=A,B,C", required = true)]
    vary: Vec<String>,
    /// Replace a value of the scene in all runs; may be given several times
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Folder for the results
    #[arg(long, value_name = "DIR", default_value = "runs/study")]
    out: PathBuf,
    /// Replace an earlier study in the folder
    #[arg(long)]
    overwrite: bool,
    /// Threads [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..), allow_negative_numbers = true)]
    threads: Option<u16>,
    /// Show no progress
    #[arg(long, short)]
    quiet: bool,
}

/// Runs a scene at every combination of the varied settings.
pub(crate) fn study(arguments: &StudyArguments) -> Result<ExitCode, Failure> {
    let variations: Vec<Variation> =
        arguments.vary.iter().map(|text| Variation::parse(text)).collect::<Result<_, _>>()?;
    variation::check_keys(&variations, &arguments.set)?;
    let combinations = combinations(&variations);
    let width = combinations.len().to_string().len();
    let mut jobs = Vec::new();
    for (index, values) in combinations.iter().enumerate() {
        let pairs = variations.iter().zip(values);
        let varied: Vec<String> =
            pairs.map(|(variation, value)| format!("{}={value}", variation.key)).collect();
        let blamed = |diagnosis: Diagnosis| {
            varied.iter().fold(diagnosis, |diagnosis, setting| diagnosis.given_by("--vary", setting, 0))
        };
        let settings = [&arguments.set[..], &varied].concat();
        let name = format!("run-{:0width$}", index + 1);
        let mut job = Job::read(name, &arguments.scene, &settings).map_err(blamed)?;
        job.scene.warnings = job.scene.warnings.into_iter().map(blamed).collect();
        jobs.push(job);
    }
    warn_once(&jobs);
    let pool = pool(arguments.threads)?;
    prepare(&arguments.out, arguments.overwrite, &jobs, |name| {
        let number = name.strip_prefix("runs/run-").map(str::parse::<u64>);
        RESULTS.contains(&name) || number.is_some_and(|number| number.is_ok())
    })?;
    let (summaries, done) = run_all(&jobs, &arguments.out, (&pool, arguments.quiet));
    let interrupted = summaries.iter().any(|summary| summary.status == Some(Status::Interrupted));
    let failed = summaries.iter().any(|summary| summary.status == Some(Status::Failed));
    let results = Results::new(&variations, combinations, &jobs, summaries);
    results.write(&arguments.out)?;
    print(&format!("{}\n\nresults in {}\n", results.table(), arguments.out.join("study.html").display()))?;
    if let Some(interruption) = results.interruption() {
        eprintln!("{interruption}");
    }
    done?;
    Ok(match (interrupted, failed) {
        (true, _) => ExitCode::from(INTERRUPTED),
        (_, true) => ExitCode::from(1),
        _ => ExitCode::SUCCESS,
    })
}

/// Shows the doubts about the scenes, those that several share once.
fn warn_once(jobs: &[Job]) {
    let mut told: Vec<String> = Vec::new();
    for warning in jobs.iter().flat_map(|job| &job.scene.warnings) {
        let sentence = warning.to_string();
        if !told.contains(&sentence) {
            eprintln!("{:?}", miette::Report::new(warning.clone()));
            told.push(sentence);
        }
    }
}
