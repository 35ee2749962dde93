//! `meniscus inspect top`: the particles with the largest values of a field.

use std::io::Write;
use std::path::PathBuf;

use super::columns::quantity;
use super::failure::{Failure, Verdict};
use super::listing::{Choice, Listing};
use super::open::open;

/// Which field, and how many particles.
#[derive(clap::Args, Debug)]
#[command(after_help = "\
Examples:
  meniscus inspect top runs/drop speed
  meniscus inspect top runs/drop density --smallest --count 3
  meniscus inspect top runs/drop velocity_z --magnitude --csv")]
pub struct Arguments {
    /// A checkpoint, or the folder of a run: then its newest checkpoint
    checkpoint: PathBuf,
    /// The field, or speed, size or pressure
    field: String,
    /// How many particles
    #[arg(long, default_value_t = 10, value_name = "N", allow_negative_numbers = true)]
    count: u32,
    /// The smallest values instead
    #[arg(long)]
    smallest: bool,
    /// By magnitude
    #[arg(long)]
    magnitude: bool,
    #[command(flatten)]
    choice: Choice,
}

/// Lists the particles; what is no number comes first: it is what one looks for.
pub fn run(arguments: &Arguments, output: &mut dyn Write) -> Result<Verdict, Failure> {
    let mapped = open(&arguments.checkpoint)?;
    let columns = mapped.columns()?;
    let mut field = quantity(&mapped, &columns, &arguments.field)?;
    let key = |particle: usize| {
        let value = field.values[particle];
        let value = if arguments.magnitude { value.abs() } else { value };
        match (value.is_nan(), arguments.smallest) {
            (true, _) => f64::NEG_INFINITY,
            (false, true) => value,
            (false, false) => -value,
        }
    };
    let mut particles: Vec<usize> = (0..field.values.len()).collect();
    particles.sort_by(|&one, &other| key(one).total_cmp(&key(other)));
    particles.truncate(arguments.count as usize);
    field.values = particles.iter().map(|&particle| field.values[particle]).collect();
    let which = if arguments.smallest { "smallest" } else { "largest" };
    let of = if arguments.magnitude { "magnitude of " } else { "" };
    let caption = format!("{which} {of}{}:", arguments.field);
    let listing = Listing { caption, particles, chosen_by: Some(field) };
    listing.print(&mapped, &columns, &arguments.choice, output)?;
    Ok(Verdict::Good)
}
