//! `meniscus inspect`: what stands in a checkpoint, whether it is whole, how two of them differ.

mod compare;
mod difference;
mod failure;
mod nearest;
mod print;
mod statistics;
mod survey;
#[cfg(test)]
mod tests;
mod totals;
mod verify;

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use meniscus_engine::checkpoint::list;

use failure::{Failure, Verdict};
use nearest::Place;

const EXAMPLES: &str = "\
Examples:
  meniscus inspect runs/drop                       the newest checkpoint of a run
  meniscus inspect step-000001000.meniscus --field density --field pressure
  meniscus inspect runs/drop --at '2 um, 0'        the particle nearest to r = 2 um, z = 0
  meniscus inspect runs/drop --json | jq .time
  meniscus inspect verify runs/drop/checkpoints/*  check every byte
  meniscus inspect diff a.meniscus b.meniscus --tolerance 1e-9

Exit codes: 0 done; 1 a file is damaged, or `diff` found a difference; 2 bad input.";

/// What to inspect, and how to show it.
#[derive(clap::Args, Debug)]
#[command(
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    after_help = EXAMPLES
)]
pub struct Arguments {
    #[command(subcommand)]
    action: Option<Action>,
    /// A checkpoint, or the folder of a run: then its newest checkpoint
    #[arg(required = true)]
    checkpoint: Option<PathBuf>,
    /// Show this field only, with a histogram; may be given several times
    #[arg(long = "field", value_name = "NAME")]
    fields: Vec<String>,
    /// Show the fields of the particle nearest to this place; metres, or with a unit: "2 um, 0"
    #[arg(long, value_name = "R,Z", allow_hyphen_values = true)]
    at: Option<Place>,
    /// Print JSON
    #[arg(long, conflicts_with = "csv")]
    json: bool,
    /// Print the table of fields as comma-separated values
    #[arg(long)]
    csv: bool,
}

#[derive(clap::Subcommand, Debug)]
enum Action {
    /// Check every byte of checkpoints; exit code 1 if one is damaged
    Verify(verify::Arguments),
    /// Compare two checkpoints field by field; exit code 1 if they differ
    Diff(difference::Arguments),
}

/// Inspects, prints to standard output, and tells how it went: 0 done, 1 damage or difference,
/// 2 bad input. A reader that closes the pipe early is no error.
pub fn run(arguments: &Arguments) -> ExitCode {
    let mut output = BufWriter::new(io::stdout().lock());
    let result = execute(arguments, &mut output);
    let flushed = output.flush().map_err(Failure::from);
    match result.and_then(|verdict| flushed.map(|()| verdict)) {
        Ok(verdict) => verdict.exit_code(),
        Err(failure) if failure.is_closed_pipe() => ExitCode::SUCCESS,
        Err(failure) => {
            // Nobody can be told if standard error is closed as well; the exit code still speaks.
            let _ = writeln!(io::stderr(), "error: {failure}");
            failure.exit_code()
        }
    }
}

fn execute(arguments: &Arguments, output: &mut dyn Write) -> Result<Verdict, Failure> {
    match &arguments.action {
        Some(Action::Verify(arguments)) => verify::run(arguments, output),
        Some(Action::Diff(arguments)) => difference::run(arguments, output),
        None => show(arguments, output),
    }
}

fn show(arguments: &Arguments, output: &mut dyn Write) -> Result<Verdict, Failure> {
    let path = arguments.checkpoint.as_deref().ok_or(Failure::NothingNamed)?;
    let path = newest(path)?;
    let (survey, damage) = survey::take(&path, &arguments.fields, arguments.at)?;
    if arguments.json {
        print::json(&survey, output)?;
    } else if arguments.csv {
        print::csv(&survey, output)?;
    } else {
        print::text(&survey, output)?;
    }
    match damage {
        None => Ok(Verdict::Good),
        Some(error) => Err(error.into()),
    }
}

/// The checkpoint that a path means: itself, or the newest of a folder.
fn newest(path: &Path) -> Result<PathBuf, Failure> {
    match all(path)?.pop() {
        Some(path) => Ok(path),
        None => Err(Failure::NoCheckpoint { folder: path.to_path_buf() }),
    }
}

/// The checkpoints that a path means, oldest first: itself, or those of a run's folder.
fn all(path: &Path) -> Result<Vec<PathBuf>, Failure> {
    if !path.is_dir() {
        return Ok(vec![path.to_path_buf()]);
    }
    let inner = path.join("checkpoints");
    let folder = if inner.is_dir() { &inner } else { path };
    Ok(list(folder)?.into_iter().map(|(_, path)| path).collect())
}
