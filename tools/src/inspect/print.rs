//! A survey as text, JSON or comma-separated values.

use std::io::{self, Write};

use comfy_table::{CellAlignment, Table, presets};
use serde::Serialize;

use super::nearest::Nearest;
use super::statistics::Histogram;
use super::survey::{Field, Survey};

/// Width of the longest bar of a histogram, characters.
const BAR: usize = 40;

/// Prints for a person at a terminal.
pub fn text(survey: &Survey, output: &mut dyn Write) -> io::Result<()> {
    head(survey, output)?;
    if !survey.fields.is_empty() {
        writeln!(output, "\n{}", fields(&survey.fields))?;
    }
    if !survey.totals.is_empty() {
        let rows = survey.totals.iter().map(|total| {
            let value = number(total.value);
            vec![total.name.to_owned(), value, total.unit.clone()]
        });
        writeln!(output, "\n{}", table(&["total", "value", "unit"], rows))?;
    }
    for field in &survey.fields {
        if let Some(of) = &field.histogram {
            writeln!(output, "\n{}: {}", field.name, field.about)?;
            histogram(of, output)?;
        }
    }
    if let Some(of) = &survey.nearest {
        nearest(of, output)?;
    }
    Ok(())
}

/// Prints one JSON object; a number that is not finite becomes null.
pub fn json(value: &impl Serialize, output: &mut dyn Write) -> io::Result<()> {
    let text = serde_json::to_string_pretty(value)?;
    writeln!(output, "{text}")
}

/// Prints a table: a row for each field, or for each value of the nearest particle.
pub fn csv(survey: &Survey, output: &mut dyn Write) -> io::Result<()> {
    // Built in memory, so that a closed pipe comes back as the error it is.
    let mut writer = csv::Writer::from_writer(Vec::new());
    if let Some(nearest) = &survey.nearest {
        for value in &nearest.fields {
            writer.serialize(value)?;
        }
    } else {
        writer.write_record([
            "name",
            "symbol",
            "unit",
            "role",
            "minimum",
            "maximum",
            "mean",
            "standard_deviation",
            "non_finite",
        ])?;
        for field in &survey.fields {
            let of = &field.statistics;
            let names = (&field.name, &field.symbol, &field.unit, field.role);
            let numbers = (of.minimum, of.maximum, of.mean, of.standard_deviation);
            writer.serialize((names, numbers, of.non_finite))?;
        }
    }
    let bytes = writer.into_inner().map_err(|error| error.into_error())?;
    output.write_all(&bytes)
}

/// A plain table: the first column to the left, the others to the right.
pub fn table(head: &[&str], rows: impl Iterator<Item = Vec<String>>) -> String {
    let mut table = Table::new();
    table.load_style(presets::NOTHING).set_header(head.to_vec());
    table.add_rows(rows);
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table.trim_fmt()
}

/// A number for people: up to six digits.
pub fn number(value: f64) -> String {
    if value.fract() == 0.0 && value.abs() < 1e9 {
        return format!("{value}");
    }
    if !(1e-2..1e6).contains(&value.abs()) {
        let text = format!("{value:.5e}");
        return match text.split_once('e') {
            Some((digits, exponent)) => format!("{}e{exponent}", trimmed(digits)),
            None => text,
        };
    }
    let before_point = value.abs().log10().floor() as i32;
    let decimals = usize::try_from(5 - before_point).unwrap_or(0);
    let text = format!("{value:.decimals$}");
    trimmed(&text).to_owned()
}

/// Digits without the zeros that end a fraction.
fn trimmed(digits: &str) -> &str {
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits }
}

fn head(survey: &Survey, output: &mut dyn Write) -> io::Result<()> {
    let title = survey.title.as_deref().unwrap_or("without title");
    let checksums = if survey.whole { "good" } else { "DAMAGED" };
    let particles = survey.particles.map_or("unknown".to_owned(), |particles| particles.to_string());
    let time = number(survey.time);
    let step_size = number(survey.step_size);
    writeln!(output, "checkpoint  {}", survey.file)?;
    writeln!(output, "scene       {title} (hash {})", survey.scene_hash)?;
    writeln!(output, "step        {}", survey.step)?;
    writeln!(output, "time        {time} s (last step {step_size} s)")?;
    for (name, value) in &survey.scalars {
        writeln!(output, "            {name} = {}", number(*value))?;
    }
    writeln!(output, "particles   {particles}")?;
    writeln!(output, "revision    {}", survey.revision)?;
    writeln!(
        output,
        "size        {} (columns {}), format {}",
        size(survey.file_length),
        size(survey.columns_length),
        survey.format
    )?;
    writeln!(output, "checksums   {checksums}")
}

fn fields(fields: &[Field]) -> String {
    let optional = |value: Option<f64>| value.map_or("-".to_owned(), number);
    let rows = fields.iter().map(|field| {
        let of = &field.statistics;
        vec![
            field.name.clone(),
            field.symbol.clone(),
            field.unit.clone(),
            optional(of.minimum),
            optional(of.maximum),
            optional(of.mean),
            optional(of.standard_deviation),
            of.non_finite.to_string(),
        ]
    });
    let head = ["field", "symbol", "unit", "minimum", "maximum", "mean", "deviation", "non-finite"];
    table(&head, rows)
}

fn histogram(histogram: &Histogram, output: &mut dyn Write) -> io::Result<()> {
    let longest = histogram.bins.iter().map(|bin| bin.count).max();
    for bin in &histogram.bins {
        let (from, to) = (number(bin.from), number(bin.to));
        // Rounded up: a bin with any value in it shows.
        let length = (bin.count * BAR).div_ceil(longest.unwrap_or(0).max(1));
        let bar = "█".repeat(length);
        writeln!(output, "{from:>13} {to:>13} {:>9} {bar}", bin.count)?;
    }
    Ok(())
}

fn nearest(nearest: &Nearest, output: &mut dyn Write) -> io::Result<()> {
    let distance = number(nearest.distance);
    writeln!(output, "\nnearest particle: index {}, {distance} m away", nearest.particle)?;
    let rows = nearest.fields.iter().map(|field| {
        let value = number(field.value);
        vec![field.name.clone(), field.symbol.clone(), value, field.unit.clone()]
    });
    writeln!(output, "{}", table(&["field", "symbol", "value", "unit"], rows))
}

fn size(bytes: u64) -> String {
    let mut amount = bytes as f64;
    for unit in ["B", "KiB", "MiB"] {
        if amount < 1024.0 {
            return format!("{} {unit}", (amount * 10.0).round() / 10.0);
        }
        amount /= 1024.0;
    }
    format!("{amount:.1} GiB")
}
