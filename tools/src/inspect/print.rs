//! Tables, numbers and machine-readable forms that all subcommands share.

use std::io::{self, Write};

use comfy_table::{CellAlignment, Table, presets};
use serde::Serialize;

use super::statistics::Histogram;

/// Width of the longest bar of a histogram, characters.
const BAR: usize = 40;

/// Prints JSON; a number that is not finite becomes null.
pub fn json(value: &impl Serialize, output: &mut dyn Write) -> io::Result<()> {
    let text = serde_json::to_string_pretty(value)?;
    writeln!(output, "{text}")
}

/// Prints comma-separated values.
pub fn records(records: Vec<Vec<String>>, output: &mut dyn Write) -> io::Result<()> {
    // Built in memory, so that a closed pipe comes back as the error it is.
    let mut writer = csv::Writer::from_writer(Vec::new());
    for record in records {
        writer.write_record(record)?;
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

/// Prints the bars of a histogram.
pub fn histogram(histogram: &Histogram, output: &mut dyn Write) -> io::Result<()> {
    let longest = histogram.bins.iter().map(|bin| bin.count).max();
    // As many digits as tell the edges from each other.
    let differ = |digits: &usize| {
        histogram.bins.iter().all(|bin| rounded(bin.from, *digits) != rounded(bin.to, *digits))
    };
    let digits = (DIGITS..17).find(differ).unwrap_or(DIGITS);
    let width = 13.max(digits + 7);
    for bin in &histogram.bins {
        let (from, to) = (rounded(bin.from, digits), rounded(bin.to, digits));
        // Rounded up: a bin with any value in it shows.
        let length = (bin.count * BAR).div_ceil(longest.unwrap_or(0).max(1));
        let bar = "█".repeat(length);
        writeln!(output, "{from:>width$} {to:>width$} {:>9} {bar}", bin.count)?;
    }
    Ok(())
}

/// Digits of a number for people.
const DIGITS: usize = 6;

/// A number for people: up to six digits.
pub fn number(value: f64) -> String {
    rounded(value, DIGITS)
}

/// A number with up to so many digits.
fn rounded(value: f64, digits: usize) -> String {
    if value.fract() == 0.0 && value.abs() < 1e9 {
        return format!("{value}");
    }
    if !(1e-2..1e6).contains(&value.abs()) {
        let text = format!("{value:.*e}", digits - 1);
        return match text.split_once('e') {
            Some((digits, exponent)) => format!("{}e{exponent}", trimmed(digits)),
            None => text,
        };
    }
    let before_point = value.abs().log10().floor() as i32;
    let decimals = usize::try_from(digits as i32 - 1 - before_point).unwrap_or(0);
    let text = format!("{value:.decimals$}");
    trimmed(&text).to_owned()
}

/// Digits without the zeros that end a fraction.
fn trimmed(digits: &str) -> &str {
    if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { digits }
}
