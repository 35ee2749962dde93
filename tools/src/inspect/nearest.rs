//! The particle nearest to a place.

use std::str::FromStr;

use meniscus_engine::checkpoint::ColumnView;
use serde::Serialize;

use super::failure::{Failure, known};
use super::totals::column;

/// A place in the half plane, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Distance from the axis, m.
    pub radius: f64,
    /// Height along the axis, m.
    pub axial: f64,
}

impl FromStr for Place {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let Some((radius, axial)) = text.split_once(',') else {
            return Err(format!(
                "found `{text}`, expected two lengths with a comma between them, as in `2 um, 0`"
            ));
        };
        Ok(Self { radius: length(radius)?, axial: length(axial)? })
    }
}

/// Reads a length into metres; a bare number is in metres already.
fn length(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let unit_start = text.rfind(|letter: char| !letter.is_alphabetic());
    let number_end =
        unit_start.map_or(0, |start| start + text[start..].chars().next().map_or(0, char::len_utf8));
    let (number, unit) = text.split_at(number_end);
    let scale = match unit {
        "" | "m" => 1.0,
        "cm" => 1e-2,
        "mm" => 1e-3,
        // Unicode has the micro sign and the Greek letter.
        "um" | "\u{b5}m" | "\u{3bc}m" => 1e-6,
        "nm" => 1e-9,
        _ => {
            return Err(format!("found the unit `{unit}`, expected one of m, cm, mm, um, nm"));
        }
    };
    let number: Option<f64> = number.trim().parse().ok();
    match number.filter(|number| number.is_finite()) {
        Some(number) => Ok(number * scale),
        None => Err(format!("found `{text}`, expected a length such as `2.5 um`")),
    }
}

/// One particle and its fields.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Nearest {
    /// Index in the order of the checkpoint.
    pub particle: usize,
    /// Distance from the place asked for, m.
    pub distance: f64,
    pub fields: Vec<Value>,
}

/// A field of one particle.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Value {
    pub name: String,
    pub symbol: String,
    pub unit: String,
    pub value: f64,
}

/// Finds the particle nearest to a place and takes the chosen fields of it.
pub fn nearest(
    place: Place,
    columns: &[ColumnView<'_>],
    chosen: &[ColumnView<'_>],
) -> Result<Nearest, Failure> {
    let (Some(radius), Some(axial)) = (column(columns, "radius"), column(columns, "axial")) else {
        return Err(Failure::NoCoordinates { known: known(columns) });
    };
    let places = radius.values().zip(axial.values());
    let (particle, distance) = places
        .map(|(r, z)| (r - place.radius).hypot(z - place.axial))
        .enumerate()
        .filter(|(_, distance)| distance.is_finite())
        .min_by(|(_, one), (_, other)| one.total_cmp(other))
        .ok_or(Failure::NoParticle)?;
    let fields = chosen.iter().map(|column| Value {
        name: column.name().to_owned(),
        symbol: column.symbol().to_owned(),
        unit: column.unit().to_owned(),
        value: column.value(particle).unwrap_or(f64::NAN),
    });
    Ok(Nearest { particle, distance, fields: fields.collect() })
}
