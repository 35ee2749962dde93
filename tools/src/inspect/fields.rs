//! `meniscus inspect fields`: numbers that sum up every field.

use std::io::Write;
use std::path::{Path, PathBuf};

use meniscus_engine::checkpoint::{CheckpointError, ColumnView, Mapped};
use serde::Serialize;

use super::columns::{Chosen, choose, column};
use super::failure::{Failure, Verdict};
use super::open::open;
use super::print::{self, number};
use super::statistics::{Gathering, Histogram, Statistics};

/// Which fields, and how to show them.
#[derive(clap::Args, Debug)]
#[command(after_help = "\
Examples:
  meniscus inspect fields runs/drop                    one line for each field
  meniscus inspect fields runs/drop density pressure   with histograms and the places of the extremes
  meniscus inspect fields runs/drop --csv")]
pub struct Arguments {
    /// A checkpoint, or the folder of a run: then its newest checkpoint
    checkpoint: PathBuf,
    /// Fields to show, or speed, size, pressure, each with a histogram [default: all fields, without]
    fields: Vec<String>,
    /// Print JSON
    #[arg(long, conflicts_with = "csv")]
    json: bool,
    /// Print comma-separated values
    #[arg(long)]
    csv: bool,
}

/// What is told about one field. The names of the entries are those of the JSON output.
#[derive(Debug, Serialize)]
struct Field {
    name: String,
    symbol: String,
    unit: String,
    about: String,
    role: &'static str,
    #[serde(flatten)]
    statistics: Statistics,
    minimum_at: Option<Spot>,
    maximum_at: Option<Spot>,
    #[serde(skip_serializing_if = "Option::is_none")]
    histogram: Option<Histogram>,
}

/// Where an extreme is.
#[derive(Clone, Copy, Debug, Serialize)]
struct Spot {
    /// The particle's identity, or its index where there are none.
    particle: u64,
    /// m
    r: Option<f64>,
    /// m
    z: Option<f64>,
}

/// Prints statistics of the chosen fields.
pub fn run(arguments: &Arguments, output: &mut dyn Write) -> Result<Verdict, Failure> {
    if arguments.csv {
        return records(&arguments.checkpoint, &arguments.fields, output);
    }
    let fields = gather(&arguments.checkpoint, &arguments.fields)?;
    if arguments.json {
        print::json(&fields, output)?;
    } else {
        text(&fields, output)?;
    }
    Ok(Verdict::Good)
}

/// Prints statistics of the fields of these names, or of all where no name is given, as
/// comma-separated values.
pub fn records(checkpoint: &Path, names: &[String], output: &mut dyn Write) -> Result<Verdict, Failure> {
    print::records(table(&gather(checkpoint, names)?), output)?;
    Ok(Verdict::Good)
}

fn gather(checkpoint: &Path, names: &[String]) -> Result<Vec<Field>, Failure> {
    let mapped = open(checkpoint)?;
    let columns = mapped.columns()?;
    let chosen = choose(&mapped, &columns, names)?;
    let with_histogram = !names.is_empty();
    chosen.iter().map(|chosen| field(&mapped, &columns, chosen, with_histogram)).collect()
}

/// What all values of a field amount to.
pub fn gathered(mapped: &Mapped, of: &Chosen<'_>) -> Result<Gathering, CheckpointError> {
    let mut gathering = Gathering::default();
    of.stream(mapped, |values| gathering.add(values))?;
    Ok(gathering)
}

fn field(
    mapped: &Mapped,
    columns: &[ColumnView<'_>],
    of: &Chosen<'_>,
    with_histogram: bool,
) -> Result<Field, Failure> {
    let gathering = gathered(mapped, of)?;
    let statistics = gathering.statistics();
    let histogram = match with_histogram {
        false => None,
        true => {
            let mut histogram = Histogram::between(&statistics);
            of.stream(mapped, |values| histogram.add(values))?;
            Some(histogram)
        }
    };
    let spot = |particle: usize| {
        let value = |name| column(columns, name).and_then(|column| column.value(particle));
        let identity = value("identity").map_or(particle as u64, |identity| identity as u64);
        Spot { particle: identity, r: value("radius"), z: value("axial") }
    };
    let places = gathering.places();
    Ok(Field {
        name: of.name().to_owned(),
        symbol: of.symbol().to_owned(),
        unit: of.unit().to_owned(),
        about: of.about().to_owned(),
        role: of.role(),
        statistics,
        minimum_at: places.map(|[least, _]| spot(least)),
        maximum_at: places.map(|[_, greatest]| spot(greatest)),
        histogram,
    })
}

fn table(fields: &[Field]) -> Vec<Vec<String>> {
    let head = [
        "name",
        "symbol",
        "unit",
        "role",
        "minimum",
        "maximum",
        "mean",
        "standard_deviation",
        "non_finite",
        "minimum_particle",
        "maximum_particle",
    ];
    let optional = |value: Option<f64>| value.map_or(String::new(), |value| format!("{value:?}"));
    let place = |spot: Option<Spot>| spot.map_or(String::new(), |spot| spot.particle.to_string());
    let row = |field: &Field| {
        let of = &field.statistics;
        let names = [&field.name, &field.symbol, &field.unit].map(String::clone);
        let mut row = names.to_vec();
        row.push(field.role.to_owned());
        row.extend([of.minimum, of.maximum, of.mean, of.standard_deviation].map(optional));
        row.push(of.non_finite.to_string());
        row.extend([field.minimum_at, field.maximum_at].map(place));
        row
    };
    std::iter::once(head.map(str::to_owned).to_vec()).chain(fields.iter().map(row)).collect()
}

fn text(fields: &[Field], output: &mut dyn Write) -> Result<(), Failure> {
    let optional = |value: Option<f64>| value.map_or("-".to_owned(), number);
    let rows = fields.iter().map(|field| {
        let of = &field.statistics;
        let names = [&field.name, &field.symbol, &field.unit].map(String::clone);
        let mut row = names.to_vec();
        row.extend([of.minimum, of.maximum, of.mean, of.standard_deviation].map(optional));
        row.push(of.non_finite.to_string());
        row
    });
    let head = ["field", "symbol", "unit", "minimum", "maximum", "mean", "deviation", "non-finite"];
    writeln!(output, "{}", print::table(&head, rows))?;
    for field in fields {
        let Some(histogram) = &field.histogram else {
            continue;
        };
        writeln!(output, "\n{}: {}", field.name, field.about)?;
        for (what, spot) in [("minimum", field.minimum_at), ("maximum", field.maximum_at)] {
            if let Some(Spot { particle, r, z }) = spot {
                let place = format!("r = {} m, z = {} m", optional(r), optional(z));
                writeln!(output, "{what} at particle {particle}, {place}")?;
            }
        }
        print::histogram(histogram, output)?;
    }
    Ok(())
}
