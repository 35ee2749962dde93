//! `meniscus resume`: where an interrupted run goes on.

use std::fs;
use std::process::ExitCode;

use meniscus_cases::scene::{self, Scene};
use meniscus_engine::checkpoint::{self, Checkpoint, newest_valid, set_aside};

use super::profile::Profiler;
use super::stopwatch::Moment;
use super::{Display, Run, Start, is_over, listen, tell};
use crate::command::{ResumeArguments, pool};
use crate::failure::Failure;
use crate::output::folder::RunFolder;
use crate::output::series::{self, Series};
use crate::output::summary::{Status, Summary};
use crate::output::units::{counted, grouped, quantity};

/// Continues a run.
pub(crate) fn resume(arguments: &ResumeArguments) -> Result<ExitCode, Failure> {
    let started = Moment::now();
    let signals = listen()?;
    let folder = RunFolder::open(&arguments.folder);
    let folder = folder.map_err(|error| Failure::input(error.to_string()))?;
    let Found { name, source, text, start } = find(&folder)?;
    let settings = arguments.extent.settings();
    let scene = scene::parse(&source, &text, &settings);
    let scene = scene.map_err(|diagnosis| arguments.extent.blamed(diagnosis))?;
    if !settings.is_empty() {
        check_end(&folder, &scene, (&source, &text), &start)?;
    }
    if let Some(summary) = finished(&folder, &scene, &start) {
        let (end, further) = match start {
            Start::Running(checkpoint) if checkpoint.clock.time < scene.until => ("its last step", "--steps"),
            _ => ("its end", "--until"),
        };
        let folder = folder.path().display();
        eprintln!(
            "the run in {folder} has reached {end}; its results stay, and `{further}` lets it go further"
        );
        return tell(&summary);
    }
    let pool = pool(arguments.extent.threads)?;
    let display = Display::alone(arguments.extent.quiet);
    let profiler = Profiler::asked(&arguments.extent, &pool)?;
    let run = Run { scene, folder, signals, display, profiler, started };
    eprintln!("continues from {name}");
    tell(&pool.install(|| run.take_up(start))?)
}

/// From where a run goes on, and its scene.
struct Found {
    /// The checkpoint, or the scene where there is none.
    name: String,
    /// Where the scene's text stands.
    source: String,
    text: String,
    start: Start,
}

/// The newest whole checkpoint of a run; else its scene.
fn find(folder: &RunFolder) -> Result<Found, Failure> {
    let refuse = |error: checkpoint::CheckpointError| Failure::input(error.to_string());
    let checkpoints = folder.checkpoints();
    if !checkpoint::list(&checkpoints).map_err(refuse)?.is_empty() {
        let (path, checkpoint, skipped) = newest_valid(&checkpoints).map_err(refuse)?;
        for (damaged, error) in skipped {
            let aside = set_aside(&damaged).map_err(refuse)?;
            eprintln!("passed over: {error}\nit is now called {}", aside.display());
        }
        return Found::of(folder, path.display().to_string(), checkpoint);
    }
    if is_recorded(folder) {
        return Err(Failure::input(format!(
            "`{0}` holds results, but no checkpoint any more from which to go on; bring its checkpoints back from a \
             copy, or run `{1}` anew into another folder with `--out DIR`",
            folder.path().display(),
            folder.scene().display(),
        )));
    }
    // Interrupted before its first checkpoint: nothing is lost but the time since its start.
    let path = folder.scene();
    let text = fs::read_to_string(&path).map_err(|error| {
        let folder = folder.path().display();
        Failure::input(format!(
            "`{folder}` holds no checkpoint, and its scene `{}` cannot be read ({error}); start the run anew",
            path.display()
        ))
    })?;
    let name = path.display().to_string();
    Ok(Found { source: name.clone(), name, text, start: Start::Scene })
}

/// Whether a run without checkpoints once had some. From the first step on there is one, or what was written of it when
/// the run was killed.
fn is_recorded(folder: &RunFolder) -> bool {
    let nothing = fs::read_dir(folder.checkpoints()).is_ok_and(|mut entries| entries.next().is_none());
    let path = folder.series();
    let begun = |series: Series| series.rows.iter().any(|row| row.step > 0);
    let steps = path.exists() && series::read(&path).map_or(true, begun);
    folder.summary().exists() || (nothing && steps)
}

impl Found {
    fn of(folder: &RunFolder, name: String, checkpoint: Checkpoint) -> Result<Self, Failure> {
        let path = folder.scene();
        let Ok(text) = fs::read_to_string(&path) else {
            let text = checkpoint.scene.clone();
            return Ok(Found {
                source: name.clone(),
                name,
                text,
                start: Start::Running(Box::new(checkpoint)),
            });
        };
        if !same_scene(&text, &checkpoint.scene) {
            return Err(Failure::input(format!(
                "{name}: the checkpoint is of another scene than `{}`; a run goes on with the scene it began \
                 with: remove the one of both that does not belong here (a checkpoint holds its scene)",
                path.display()
            )));
        }
        // It is newer than the checkpoint: a run that was resumed to another end may have stopped before its next one.
        let source = path.display().to_string();
        Ok(Found { name, source, text, start: Start::Running(Box::new(checkpoint)) })
    }
}

/// Whether two texts describe the same scene; how far it runs may differ.
pub(crate) fn same_scene(one: &str, other: &str) -> bool {
    let essence = |text: &str| {
        let mut table: toml::Table = text.parse().ok()?;
        if let Some(run) = table.get_mut("run").and_then(toml::Value::as_table_mut) {
            run.retain(|key, _| key != "until" && key != "steps");
        }
        Some(table)
    };
    matches!((essence(one), essence(other)), (Some(one), Some(other)) if one == other)
}

/// Refuses a new end that the run has passed already: there would be nothing to compute.
fn check_end(
    folder: &RunFolder,
    scene: &Scene,
    (source, text): (&str, &str),
    start: &Start,
) -> Result<(), Failure> {
    let Start::Running(checkpoint) = start else {
        return Ok(());
    };
    let clock = &checkpoint.clock;
    let before = scene::parse(source, text, &[])?;
    let same = (before.until, before.steps) == (scene.until, scene.steps);
    if same || !is_over(scene, clock.step, clock.time) {
        return Ok(());
    }
    let mut passed = Vec::new();
    if let Some(steps) = scene.steps.filter(|steps| clock.step >= *steps) {
        passed.push(format!("would end after {}: choose more with --steps", counted(steps, "step")));
    }
    if clock.time >= scene.until {
        passed.push(format!(
            "would end at {}: choose a later time with --until",
            quantity(scene.until, "s", 4)
        ));
    }
    Err(Failure::input(format!(
        "the run in `{}` is at step {}, t = {} already; it {}",
        folder.path().display(),
        grouped(clock.step),
        quantity(clock.time, "s", 4),
        passed.join("; it "),
    )))
}

/// The results of a run that has nothing left to do.
fn finished(folder: &RunFolder, scene: &Scene, start: &Start) -> Option<Summary> {
    let Start::Running(checkpoint) = start else {
        return None;
    };
    let clock = &checkpoint.clock;
    let summary = Summary::read(&folder.summary()).ok()?;
    let same = summary.status == Some(Status::Done) && summary.steps == clock.step;
    (same && is_over(scene, clock.step, clock.time)).then_some(summary)
}
