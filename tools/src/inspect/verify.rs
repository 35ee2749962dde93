//! `meniscus inspect verify`: is every byte as it was written?

use std::io::Write;
use std::path::{Path, PathBuf};

use meniscus_engine::checkpoint::{CheckpointError, ColumnView, Mapped};

use super::all;
use super::failure::{Failure, Verdict};
use super::print::number;

/// What to check.
#[derive(clap::Args, Debug)]
pub struct Arguments {
    /// Checkpoints, or folders of runs: then all their checkpoints
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
}

/// Checks all files and prints one line for each. Damage outranks a file that cannot be opened.
pub fn run(arguments: &Arguments, output: &mut dyn Write) -> Result<Verdict, Failure> {
    let mut verdict = Verdict::Good;
    let mut unreadable = None;
    for named in &arguments.files {
        let files = all(named)?;
        if files.is_empty() {
            unreadable = Some(Failure::NoCheckpoint { folder: named.clone() });
        }
        for file in files {
            match check(&file) {
                Ok(line) => writeln!(output, "{}: whole, {line}", file.display())?,
                Err(error) if error.is_damage() => {
                    writeln!(output, "DAMAGED {error}")?;
                    verdict = Verdict::Bad;
                }
                Err(error) => unreadable = Some(error.into()),
            }
        }
    }
    match unreadable {
        Some(failure) if verdict == Verdict::Good => Err(failure),
        Some(failure) => {
            writeln!(output, "{failure}")?;
            Ok(verdict)
        }
        None => Ok(verdict),
    }
}

fn check(file: &Path) -> Result<String, CheckpointError> {
    let mapped = Mapped::open(file)?;
    mapped.verify()?;
    let columns = mapped.columns()?;
    Ok(format!(
        "step {}, time {} s, {} particles, {} fields",
        mapped.clock().step,
        number(mapped.clock().time),
        columns.first().map_or(0, ColumnView::len),
        columns.len()
    ))
}
