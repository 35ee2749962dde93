//! `meniscus inspect diff`: where two checkpoints part.

use std::io::{self, Write};
use std::path::PathBuf;

use super::compare::{Difference, compare};
use super::failure::{Failure, Verdict};
use super::open::open;
use super::print::{self, number};

/// What to compare, and how strictly.
#[derive(clap::Args, Debug)]
#[command(after_help = "\
Examples:
  meniscus inspect diff one.meniscus other.meniscus
  meniscus inspect diff runs/a runs/b --tolerance 1e-9 && echo same

Particles are matched by the field `identity` where both files have it and no identity twice,
otherwise by their order. Step, time and further numbers of the clock count as well; scene and
revision are only mentioned.")]
pub struct Arguments {
    /// First checkpoint, or the folder of a run: then its newest checkpoint
    a: PathBuf,
    /// Second checkpoint or folder
    b: PathBuf,
    /// Difference to allow, relative to the largest magnitude of a field; whole numbers must agree
    #[arg(long, value_name = "X", default_value = "0", value_parser = tolerance, allow_negative_numbers = true)]
    tolerance: f64,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

fn tolerance(text: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    number
        .filter(|&number: &f64| number.is_finite() && number >= 0.0)
        .ok_or_else(|| "expected a number that is not negative, such as 1e-9".to_owned())
}

/// Compares two checkpoints and prints the differences.
pub fn run(arguments: &Arguments, output: &mut dyn Write) -> Result<Verdict, Failure> {
    let (a, b) = (open(&arguments.a)?, open(&arguments.b)?);
    let difference = compare(&a, &b, arguments.tolerance)?;
    if arguments.json {
        print::json(&difference, output)?;
    } else {
        for (letter, mapped) in [("a", &a), ("b", &b)] {
            let (step, time) = (mapped.clock().step, number(mapped.clock().time));
            let file = mapped.path().display();
            writeln!(output, "{letter}  {file}: step {step}, time {time} s")?;
        }
        text(&difference, output)?;
    }
    Ok(match difference.same {
        true => Verdict::Good,
        false => Verdict::Bad,
    })
}

fn text(difference: &Difference, output: &mut dyn Write) -> io::Result<()> {
    for sentence in difference.clock.iter().chain(&difference.remarks) {
        writeln!(output, "{sentence}")?;
    }
    for (letter, particles, fields) in [
        ("a", difference.particles_only_in_a, &difference.fields_only_in_a),
        ("b", difference.particles_only_in_b, &difference.fields_only_in_b),
    ] {
        if particles > 0 {
            writeln!(output, "{particles} particles only in {letter}")?;
        }
        for field in fields {
            writeln!(output, "field {field} only in {letter}")?;
        }
    }
    writeln!(output, "particles matched by {}\n", difference.matched_by)?;
    let rows = difference.fields.iter().map(|field| {
        let first = field.first.map_or(Default::default(), |first| {
            // All digits: a difference in the last one must show.
            let (a, b) = (format!("{:e}", first.a), format!("{:e}", first.b));
            [first.particle.to_string(), a, b]
        });
        let mut row = vec![
            field.name.clone(),
            field.unit.clone(),
            number(field.largest),
            number(field.root_mean_square),
            field.differing.to_string(),
        ];
        row.extend(first);
        row
    });
    let head = ["field", "unit", "largest", "rms", "differing", "first", "in a", "in b"];
    writeln!(output, "{}", print::table(&head, rows))?;
    let verdict = if difference.same { "same" } else { "different" };
    writeln!(output, "\n{verdict}")
}
