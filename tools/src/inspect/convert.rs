//! `meniscus inspect convert`: a checkpoint of an older format in the newest one.

use std::io::Write;
use std::path::PathBuf;

use meniscus_engine::checkpoint::{FORMAT_VERSION, Mapped, read, write};

use super::export::check_target;
use super::failure::{Failure, Verdict};
use super::open::newest;
use super::print;

/// What to convert, and where to.
#[derive(clap::Args, Debug)]
#[command(after_help = "\
Examples:
  meniscus inspect convert old.meniscus new.meniscus
  meniscus inspect convert runs/drop drop.meniscus    the newest checkpoint of a run

Every byte is checked first. Values, clock, scene and revision stay what they are, bit for bit; a file
that has the newest format already gives a copy.")]
pub struct Arguments {
    /// A checkpoint, or the folder of a run: then its newest checkpoint
    checkpoint: PathBuf,
    /// The file to write
    #[arg(value_name = "FILE")]
    output: PathBuf,
    /// Replace a file of that name
    #[arg(long)]
    overwrite: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Writes the file, and says from which format to which.
pub fn run(arguments: &Arguments, output: &mut dyn Write) -> Result<Verdict, Failure> {
    let path = &arguments.output;
    check_target(path, arguments.overwrite)?;
    let source = newest(&arguments.checkpoint)?;
    let found = Mapped::open(&source)?.format_version();
    // The writer gives the same bytes for the same content, so this copies a file of the newest format.
    write(path, &read(&source)?)?;
    let (source, path) = (source.display().to_string(), path.display().to_string());
    if arguments.json {
        let told = serde_json::json!({ "file": path, "from": source, "from_format": found, "format": FORMAT_VERSION });
        print::json(&told, output)?;
    } else if found == FORMAT_VERSION {
        writeln!(output, "{path}: a copy, as {source} has the newest format, {FORMAT_VERSION}, already")?;
    } else {
        writeln!(output, "{path}: format {FORMAT_VERSION}, converted from format {found} of {source}")?;
    }
    Ok(Verdict::Good)
}
