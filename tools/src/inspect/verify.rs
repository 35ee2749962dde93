//! `meniscus inspect verify`: is every byte as it was written?

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use meniscus_engine::checkpoint::{CheckpointError, Mapped, check_name, list};
use serde::Serialize;

use super::failure::{Failure, Verdict};
use super::open::{checkpoints, particles};
use super::print::{self, number};
use crate::output::{OutputError, series, summary};
use crate::run::{count_frames, same_scene};

/// What to check.
#[derive(clap::Args, Debug)]
#[command(after_help = "\
Examples:
  meniscus inspect verify runs/drop                       checkpoints, series, summary and index of frames
  meniscus inspect verify runs/drop/checkpoints/step-*    some of its checkpoints
  meniscus inspect verify runs/* --json

Exit codes: 0 all is whole; 1 something is damaged; 2 something cannot be read.")]
pub struct Arguments {
    /// Checkpoints, or folders of runs: then all that can be checked in them
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// What was found out about one file. The names of the entries are those of the JSON output.
#[derive(Debug, Serialize)]
struct Finding {
    file: String,
    /// None where the file could not be read.
    whole: Option<bool>,
    /// What it holds, or what is wrong with it.
    note: String,
}

/// Checks all files and prints one line for each. Damage outranks a file that cannot be opened.
pub fn run(arguments: &Arguments, output: &mut dyn Write) -> Result<Verdict, Failure> {
    let mut findings = Vec::new();
    let mut unreadable = None;
    for named in &arguments.files {
        let files = files(named)?;
        if files.is_empty() {
            unreadable = Some(Failure::NoCheckpoint { folder: named.clone() });
        }
        for file in files {
            let (whole, note) = match check(&file) {
                Ok(note) => (Some(true), note),
                Err(failure) if is_damage(&failure) => (Some(false), failure.to_string()),
                Err(failure) => {
                    let note = failure.to_string();
                    unreadable = Some(failure);
                    (None, note)
                }
            };
            findings.push(Finding { file: file.display().to_string(), whole, note });
        }
    }
    if arguments.json {
        print::json(&findings, output)?;
    } else {
        for Finding { file, whole, note } in &findings {
            match whole {
                Some(true) => writeln!(output, "{file}: whole, {note}")?,
                Some(false) => writeln!(output, "DAMAGED {note}")?,
                None => writeln!(output, "UNREAD {note}")?,
            }
        }
    }
    let damaged = findings.iter().any(|finding| finding.whole == Some(false));
    match unreadable {
        _ if damaged => Ok(Verdict::Bad),
        Some(failure) => Err(failure),
        None => Ok(Verdict::Good),
    }
}

fn is_damage(failure: &Failure) -> bool {
    match failure {
        Failure::Checkpoint(error) => error.is_damage(),
        Failure::File(OutputError::Content { .. }) => true,
        _ => false,
    }
}

/// A file that cannot be read is no damaged one.
fn unread(error: OutputError) -> Failure {
    match error {
        OutputError::File { .. } => Failure::Unread(error),
        other => Failure::File(other),
    }
}

/// A file itself; of a run's folder all checkpoints, oldest first, its series, its summary and its index of frames.
fn files(named: &Path) -> Result<Vec<PathBuf>, Failure> {
    if !named.is_dir() {
        return Ok(vec![named.to_path_buf()]);
    }
    let folder = checkpoints(named);
    let unread = |source| CheckpointError::Io { path: folder.clone(), action: "read the folder", source };
    let entries = fs::read_dir(&folder).map_err(unread)?;
    let mut found = Vec::new();
    for entry in entries {
        let path = entry.map_err(unread)?.path();
        if path.extension().is_some_and(|ending| ending == "meniscus") {
            found.push(path);
        }
    }
    found.sort();
    let others = ["series.csv", "summary.json", "frames/index.json"].map(|name| named.join(name));
    found.extend(others.into_iter().filter(|path| path.exists()));
    Ok(found)
}

/// A series reaches without holes from its first row to the newest checkpoint beside it.
fn check_series(file: &Path) -> Result<String, Failure> {
    let series = series::read(file).map_err(unread)?;
    let every = series.rows.windows(2).map(|pair| pair[1].step.saturating_sub(pair[0].step)).min();
    if let (Some(every), Some(last)) = (every, series.rows.last()) {
        let checkpoints = list(&checkpoints(file.parent().unwrap_or(Path::new(""))));
        let newest = checkpoints.ok().and_then(|found| Some(found.last()?.0));
        let end = newest.map_or(last.step, |newest| newest.max(last.step));
        if let Some((before, after)) = series.hole(every.max(1), end) {
            let problem = format!("the rows between steps {before} and {after} are missing");
            return Err(Failure::File(OutputError::content(file, problem)));
        }
    }
    Ok(format!("{} rows", series.rows.len()))
}

fn check(file: &Path) -> Result<String, Failure> {
    let name = file.file_name().and_then(|name| name.to_str());
    if name == Some("series.csv") {
        return check_series(file);
    }
    if name == Some("index.json") {
        return Ok(format!("{} frames", count_frames(file).map_err(unread)?));
    }
    if name == Some("summary.json") {
        return Ok(format!("{} steps", summary::Summary::read(file).map_err(unread)?.steps));
    }
    let mapped = Mapped::open(file)?;
    mapped.verify()?;
    check_name(file, mapped.clock().step)?;
    // A run has one scene; how far it goes may have changed.
    let folder = file.parent().filter(|folder| folder.ends_with("checkpoints"));
    let scene = folder.and_then(Path::parent).map(|run| run.join("scene.toml"));
    let text = scene.as_ref().and_then(|scene| fs::read_to_string(scene).ok());
    if text.is_some_and(|text| !same_scene(&text, mapped.scene())) {
        return Err(Failure::File(OutputError::content(
            file,
            "it is of another scene than the run's `scene.toml`",
        )));
    }
    let columns = mapped.columns()?;
    Ok(format!(
        "step {}, time {} s, {} particles, {} fields",
        mapped.clock().step,
        number(mapped.clock().time),
        particles(&columns),
        columns.len()
    ))
}
