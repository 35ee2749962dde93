//! `meniscus inspect`: what stands in a checkpoint, whether it is whole, how two of them differ.
//!
//! One file for each subcommand; what they share lies in `open`, `columns`, `listing`, `around`, `print`.

mod around;
mod at;
mod columns;
mod compare;
mod convert;
mod diagnose;
mod diff;
mod drops;
mod export;
mod failure;
mod fields;
mod listing;
mod open;
mod print;
mod render;
mod statistics;
mod summary;
#[cfg(test)]
mod tests;
mod top;
mod totals;
mod verify;
mod wanted;

use std::io::{self, BufWriter, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use failure::{Failure, Verdict};

const EXAMPLES: &str = "\
Examples:
  meniscus inspect runs/drop                              the newest checkpoint of a run
  meniscus inspect runs/drop --field density --json       one field of it, for scripts
  meniscus inspect runs/drop --at '2 um,0'                the particle nearest to r = 2 um, z = 0
  meniscus inspect fields runs/drop density               statistics, histogram, places of the extremes
  meniscus inspect diagnose runs/drop                     energies, drops, neighbours, time step
  meniscus inspect at runs/drop '2 um' 0 --count 5        the five particles nearest to a place
  meniscus inspect top runs/drop speed                    the fastest particles
  meniscus inspect where runs/drop 'density < 990 kg/m3'  the particles that are thin
  meniscus inspect render runs/drop speed speed.png       a picture
  meniscus inspect export runs/drop drop.vtp              for ParaView; .csv and .npy as well
  meniscus inspect convert old.meniscus new.meniscus      the same in the newest format
  meniscus inspect verify runs/drop                       check every byte of a run
  meniscus inspect diff a.meniscus b.meniscus             where two of them part

All take --json. Exit codes: 0 done; 1 a file is damaged, or `diff` found a
difference; 2 bad input.";

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
    /// Show this field (or speed, size, pressure) alone; may be given several times
    #[arg(long = "field", value_name = "NAME")]
    fields: Vec<String>,
    /// Show the particle nearest to a place, in metres or with units: '2 um,0'
    #[arg(long, value_name = "R,Z", value_parser = at::place, allow_hyphen_values = true)]
    at: Option<at::Place>,
    /// Print JSON
    #[arg(long, conflicts_with = "csv")]
    json: bool,
    /// Print comma-separated values: a line for each field, or the particle of --at
    #[arg(long)]
    csv: bool,
}

#[derive(clap::Subcommand, Debug)]
enum Action {
    /// Statistics of the fields: extremes and their places, mean, deviation, histogram
    Fields(fields::Arguments),
    /// Mass, momentum, energies, drops, neighbours, packing, bounds of the time step
    Diagnose(diagnose::Arguments),
    /// Check every byte of checkpoints or of a run's folder; exit code 1 if one is damaged
    Verify(verify::Arguments),
    /// Compare two checkpoints field by field; exit code 1 if they differ
    Diff(diff::Arguments),
    /// List the particles nearest to a place
    At(at::Arguments),
    /// List the particles with the largest values of a field
    Top(top::Arguments),
    /// List the particles that meet a condition
    Where(wanted::Arguments),
    /// Draw a field as a PNG picture
    Render(render::Arguments),
    /// Write a checkpoint of an older format in the newest one
    Convert(convert::Arguments),
    /// Write all fields for other programs: ParaView (.vtp), tables (.csv), numpy (.npy)
    Export(export::Arguments),
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
            let _ = writeln!(io::stderr(), "{}", failure.told());
            failure.exit_code()
        }
    }
}

fn execute(arguments: &Arguments, output: &mut dyn Write) -> Result<Verdict, Failure> {
    match &arguments.action {
        Some(Action::Fields(arguments)) => fields::run(arguments, output),
        Some(Action::Diagnose(arguments)) => diagnose::run(arguments, output),
        Some(Action::Verify(arguments)) => verify::run(arguments, output),
        Some(Action::Diff(arguments)) => diff::run(arguments, output),
        Some(Action::At(arguments)) => at::run(arguments, output),
        Some(Action::Top(arguments)) => top::run(arguments, output),
        Some(Action::Where(arguments)) => wanted::run(arguments, output),
        Some(Action::Render(arguments)) => render::run(arguments, output),
        Some(Action::Convert(arguments)) => convert::run(arguments, output),
        Some(Action::Export(arguments)) => export::run(arguments, output),
        None => {
            let path = arguments.checkpoint.as_deref().ok_or(Failure::NothingNamed)?;
            let (names, json, csv) = (&arguments.fields, arguments.json, arguments.csv);
            match arguments.at {
                Some(place) => {
                    let choice = listing::Choice { fields: names.clone(), json, csv };
                    at::list(path, place, 1, &choice, output)
                }
                None if csv => fields::records(path, names, output),
                None => summary::run(path, names, json, output),
            }
        }
    }
}
