//! `meniscus inspect where`: the particles that meet a condition.

use std::io::Write;
use std::path::PathBuf;

use meniscus_cases::scene::{Condition, FOLLOWING};
use meniscus_engine::checkpoint::ColumnView;

use super::columns::{column, quantity, values};
use super::failure::{Failure, Verdict};
use super::listing::{Choice, Listing};
use super::open::{open, particles};

/// Which condition, and how many particles to list.
#[derive(clap::Args, Debug)]
#[command(after_help = "\
Examples:
  meniscus inspect where runs/drop 'density < 990 kg/m3 and surface == 0'
  meniscus inspect where runs/drop 'r < 2*size or speed > 3 m/s' --csv --fields speed,pressure
  meniscus inspect where runs/drop 'surface == 2 and (z < 0 or r < 1 um)'

Conditions compare expressions as in scenes, with < <= > >= == !=, and join them with not, and, or.
`and` binds more than `or`; brackets go around values and around conditions.
They know r, z, every field of the checkpoint, speed, size and pressure. Values have units.")]
pub struct Arguments {
    /// A checkpoint, or the folder of a run: then its newest checkpoint
    checkpoint: PathBuf,
    /// The condition
    condition: String,
    /// How many particles to list; all are counted
    #[arg(long, default_value_t = 20, value_name = "N", allow_negative_numbers = true)]
    count: u32,
    #[command(flatten)]
    choice: Choice,
}

/// Lists the particles that meet the condition.
pub fn run(arguments: &Arguments, output: &mut dyn Write) -> Result<Verdict, Failure> {
    let mapped = open(&arguments.checkpoint)?;
    let columns = mapped.columns()?;
    let mut known: Vec<(&str, &str)> =
        columns.iter().map(|column| (ColumnView::name(column), ColumnView::unit(column))).collect();
    let following = FOLLOWING.into_iter();
    known.extend(following.filter(|(name, _)| column(&columns, name).is_none()));
    let condition = Condition::parse(&arguments.condition, &known).map_err(Failure::Condition)?;
    let used = condition.fields();
    let fields = used.iter().map(|&field| Ok(quantity(&mapped, &columns, known[field].0)?.values));
    let fields: Vec<Vec<f64>> = fields.collect::<Result<_, Failure>>()?;
    let (r, z) = (values(&columns, "radius")?, values(&columns, "axial")?);
    let mut row = vec![f64::NAN; known.len()];
    let mut found: Vec<usize> = Vec::new();
    for particle in 0..particles(&columns) {
        for (&field, values) in used.iter().zip(&fields) {
            row[field] = values[particle];
        }
        if condition.holds(r[particle], z[particle], &row) {
            found.push(particle);
        }
    }
    let (met, all) = (found.len(), particles(&columns));
    found.truncate(arguments.count as usize);
    let caption = match found.len() {
        shown if shown < met => format!("{met} of {all} particles, the first {shown}:"),
        _ => format!("{met} of {all} particles{}", if met > 0 { ":" } else { "" }),
    };
    let listing = Listing { caption, particles: found, chosen_by: None };
    listing.print(&mapped, &columns, &arguments.choice, output)?;
    Ok(Verdict::Good)
}
