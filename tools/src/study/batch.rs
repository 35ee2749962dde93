//! Runs of scenes, one after the other.

use std::path::{Path, PathBuf};

use meniscus_cases::region::Region;
use meniscus_cases::scene::{self, Diagnosis, Scene};

use crate::failure::Failure;
use crate::output::OutputError;
use crate::output::folder::{RunFolder, entries, is_run, name_of, remove};
use crate::output::summary::{Status, Summary};
use crate::run::{self, Display};

/// A scene to be run under a name that tells it from the others.
pub(crate) struct Job {
    /// Name in the progress, and of the run's folder.
    pub(crate) name: String,
    /// What is run.
    pub(crate) scene: Scene,
}

/// What every run of many does without: it is measured, not looked at.
const PLAIN: [&str; 2] = ["output.frames=0", "output.checkpoint_every=0"];

impl Job {
    /// Reads a scene with settings.
    pub(crate) fn read(name: String, path: &Path, settings: &[String]) -> Result<Self, Diagnosis> {
        let plain = PLAIN.iter().map(|setting| (*setting).to_owned());
        let settings: Vec<String> = plain.chain(settings.iter().cloned()).collect();
        Ok(Job { name, scene: scene::read(path, &settings)? })
    }

    /// Expected work, in arbitrary units: particles times steps.
    fn work(&self) -> f64 {
        let scene = &self.scene;
        let area = |[inner, outer, bottom, top]: [f64; 4]| (outer - inner) * (top - bottom);
        let area: f64 = scene.bodies.iter().map(|body| area(body.shape.bounds())).sum();
        let particles = area / scene.particle_size.powi(2);
        particles * scene.until * scene.derived_sound_speed() / scene.particle_size
    }
}

/// Makes the folder of all runs' results. Of earlier ones, which are told by their names in it and what the runs hold, only
/// runs stay that these jobs will replace.
///
/// # Errors
/// Bad input if something else lies there already.
pub(crate) fn prepare(
    out: &Path,
    overwrite: bool,
    jobs: &[Job],
    is_result: impl Fn(&str) -> bool,
) -> Result<(), Failure> {
    let refuse = |error: OutputError| Failure::input(error.to_string());
    if out.exists() && !out.is_dir() {
        return Err(refuse(OutputError::NotAFolder(out.to_owned())));
    }
    let found = if out.is_dir() { entries(out).map_err(refuse)? } else { Vec::new() };
    if !found.is_empty() && !overwrite {
        return Err(refuse(OutputError::Occupied(out.to_owned())));
    }
    let runs = out.join("runs");
    let inner = if runs.is_dir() { entries(&runs).map_err(refuse)? } else { Vec::new() };
    let is_earlier = |path: &&PathBuf| {
        is_result(&format!("runs/{}", name_of(path))) && is_run(path).is_ok_and(|is_run| is_run)
    };
    let earlier: Vec<&PathBuf> = inner.iter().filter(is_earlier).collect();
    let results: Vec<&PathBuf> = found.iter().filter(|path| is_result(&name_of(path))).collect();
    // Of runs that could not begin nothing is left.
    let is_ours =
        !earlier.is_empty() || runs.is_dir() && inner.is_empty() && results.len() + 1 == found.len();
    if !found.is_empty() && !is_ours {
        return Err(refuse(OutputError::NotARun(out.to_owned())));
    }
    for path in earlier {
        if !jobs.iter().any(|job| job.name == name_of(path)) {
            RunFolder::take(path, true).map_err(refuse)?.give_up();
        }
    }
    for path in results {
        remove(path).map_err(refuse)?;
    }
    let made = std::fs::create_dir_all(out);
    made.map_err(OutputError::file("create the folder", out)).map_err(refuse)
}

/// Runs all scenes into `runs/` of a folder; after an interruption the rest is left out, and the
/// interrupted run is the last one. Hands back what the runs have given, and why no more of them could be run.
pub(crate) fn run_all(
    jobs: &[Job],
    out: &Path,
    (pool, quiet): (&rayon::ThreadPool, bool),
) -> (Vec<Summary>, Result<(), Failure>) {
    let mut summaries = Vec::new();
    let done = run_each(jobs, out, (pool, quiet), &mut summaries);
    (summaries, done)
}

fn run_each(
    jobs: &[Job],
    out: &Path,
    (pool, quiet): (&rayon::ThreadPool, bool),
    summaries: &mut Vec<Summary>,
) -> Result<(), Failure> {
    let signals = run::listen()?;
    let work: Vec<f64> = jobs.iter().map(Job::work).collect();
    for (index, job) in jobs.iter().enumerate() {
        let folder = RunFolder::take(out.join("runs").join(&job.name), true)?;
        let later = work[index + 1..].iter().sum::<f64>() / work[index];
        let name = format!("{}/{} {}", index + 1, jobs.len(), job.name);
        let display = Display::Among { name, later, quiet };
        let scene = job.scene.clone();
        let summary = pool.install(|| run::run_into(folder, scene, &signals, display))?;
        let interrupted = summary.status == Some(Status::Interrupted);
        summaries.push(summary);
        if interrupted {
            break;
        }
    }
    Ok(())
}
