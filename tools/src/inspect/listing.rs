//! A table of chosen particles.

use std::io::Write;

use meniscus_engine::checkpoint::{ColumnView, Mapped};
use serde_json::{Map, Value, json};

use super::columns::{Quantity, column, quantity};
use super::failure::Failure;
use super::print::{self, number};

/// What every list of particles shows beside their places, and how.
#[derive(clap::Args, Debug)]
pub struct Choice {
    /// Fields to show, separated by commas; also speed, size and pressure
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub fields: Vec<String>,
    /// Print JSON
    #[arg(long, conflicts_with = "csv")]
    pub json: bool,
    /// Print comma-separated values with all their digits
    #[arg(long)]
    pub csv: bool,
}

/// Fields that are shown where none are asked for.
const USUAL: [&str; 4] = ["density", "velocity_r", "velocity_z", "surface"];

/// Chosen particles with a caption and, if there is one, a value that they were chosen by.
pub struct Listing {
    pub caption: String,
    /// Indices in the order of the checkpoint.
    pub particles: Vec<usize>,
    /// Shown first, one value a chosen particle.
    pub chosen_by: Option<Quantity>,
}

impl Listing {
    /// Prints the particles with the fields that the choice wants.
    pub fn print(
        mut self,
        mapped: &Mapped,
        columns: &[ColumnView<'_>],
        choice: &Choice,
        output: &mut dyn Write,
    ) -> Result<(), Failure> {
        let usual = USUAL.iter().map(|name| (*name).to_owned());
        let names: Vec<String> = match choice.fields.is_empty() {
            true => usual.filter(|name| column(columns, name).is_some()).collect(),
            false => choice.fields.clone(),
        };
        let place = ["radius", "axial"].iter().map(|name| (*name).to_owned());
        let mut shown: Vec<Quantity> = self.chosen_by.take().into_iter().collect();
        for name in place.chain(names) {
            if shown.iter().all(|quantity| quantity.name != name) {
                let mut found = quantity(mapped, columns, &name)?;
                found.values = self.particles.iter().map(|&particle| found.values[particle]).collect();
                shown.push(found);
            }
        }
        let rows = Rows { listing: &self, identity: column(columns, "identity"), shown: &shown };
        if choice.json {
            print::json(&rows.json(), output)?;
        } else if choice.csv {
            print::records(rows.csv(), output)?;
        } else {
            rows.text(output)?;
        }
        Ok(())
    }
}

struct Rows<'a> {
    listing: &'a Listing,
    identity: Option<ColumnView<'a>>,
    shown: &'a [Quantity],
}

impl Rows<'_> {
    /// What to call a particle: its identity, which it keeps for life, or its index.
    fn name(&self, particle: usize) -> u64 {
        self.identity.and_then(|column| column.value(particle)).map_or(particle as u64, |value| value as u64)
    }

    fn json(&self) -> Value {
        let row = |(row, &particle): (usize, &usize)| {
            let mut object = Map::from_iter([("particle".to_owned(), json!(self.name(particle)))]);
            object.extend(
                self.shown.iter().map(|quantity| (quantity.name.clone(), json!(quantity.values[row]))),
            );
            Value::Object(object)
        };
        let units = self.shown.iter().map(|quantity| (quantity.name.clone(), json!(quantity.unit)));
        let particles: Vec<Value> = self.listing.particles.iter().enumerate().map(row).collect();
        json!({ "units": Map::from_iter(units), "particles": particles })
    }

    fn csv(&self) -> Vec<Vec<String>> {
        let head = self.shown.iter().map(|quantity| quantity.name.clone());
        let head = std::iter::once("particle".to_owned()).chain(head).collect();
        let row = |(row, &particle): (usize, &usize)| {
            let values = self.shown.iter().map(|quantity| format!("{:?}", quantity.values[row]));
            std::iter::once(self.name(particle).to_string()).chain(values).collect()
        };
        std::iter::once(head).chain(self.listing.particles.iter().enumerate().map(row)).collect()
    }

    fn text(&self, output: &mut dyn Write) -> Result<(), Failure> {
        writeln!(output, "{}", self.listing.caption)?;
        if self.listing.particles.is_empty() {
            return Ok(());
        }
        let head: Vec<String> = std::iter::once("particle".to_owned())
            .chain(self.shown.iter().map(|quantity| match quantity.unit.as_str() {
                "" | "1" => quantity.name.clone(),
                unit => format!("{} [{unit}]", quantity.name),
            }))
            .collect();
        let head: Vec<&str> = head.iter().map(String::as_str).collect();
        let rows = self.listing.particles.iter().enumerate().map(|(row, &particle)| {
            let values = self.shown.iter().map(|quantity| number(quantity.values[row]));
            std::iter::once(self.name(particle).to_string()).chain(values).collect()
        });
        writeln!(output, "{}", print::table(&head, rows))?;
        Ok(())
    }
}
