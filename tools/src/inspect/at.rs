//! `meniscus inspect at`: the particles nearest to a place.

use std::io::Write;
use std::path::{Path, PathBuf};

use super::columns::{Quantity, values};
use super::failure::{Failure, Verdict};
use super::listing::{Choice, Listing};
use super::open::open;
use super::print::number;

/// Which place, and how many particles.
#[derive(clap::Args, Debug)]
#[command(after_help = "\
Examples:
  meniscus inspect at runs/drop '2.5 um' 0
  meniscus inspect at runs/drop 0 '-1 um' --count 5 --fields pressure,speed")]
pub struct Arguments {
    /// A checkpoint, or the folder of a run: then its newest checkpoint
    checkpoint: PathBuf,
    /// The scene's r, the distance from the axis less `domain.origin`, in metres or with a unit: "2 um"
    #[arg(value_parser = length, allow_hyphen_values = true)]
    r: f64,
    /// Height along the axis, likewise
    #[arg(value_parser = length, allow_hyphen_values = true)]
    z: f64,
    /// How many particles
    #[arg(long, default_value_t = 1, value_name = "N", allow_negative_numbers = true)]
    count: u32,
    #[command(flatten)]
    choice: Choice,
}

/// Reads a length into metres; a bare number is in metres already.
pub fn length(text: &str) -> Result<f64, String> {
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

/// A place: the scene's r and z, m.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    r: f64,
    z: f64,
}

/// Reads a place from two lengths with a comma between them.
pub fn place(text: &str) -> Result<Place, String> {
    let (r, z) = text
        .split_once(',')
        .ok_or_else(|| format!("found `{text}`, expected two lengths with a comma, such as `2.5 um,0`"))?;
    Ok(Place { r: length(r)?, z: length(z)? })
}

/// Lists the particles nearest to the place.
pub fn run(arguments: &Arguments, output: &mut dyn Write) -> Result<Verdict, Failure> {
    let place = Place { r: arguments.r, z: arguments.z };
    list(&arguments.checkpoint, place, arguments.count as usize, &arguments.choice, output)
}

/// Lists as many particles as are wanted, the nearest first.
pub fn list(
    checkpoint: &Path,
    place: Place,
    count: usize,
    choice: &Choice,
    output: &mut dyn Write,
) -> Result<Verdict, Failure> {
    let mapped = open(checkpoint)?;
    let columns = mapped.columns()?;
    let places = values(&columns, "radius")?.into_iter().zip(values(&columns, "axial")?);
    let mut distances: Vec<(usize, f64)> = places
        .map(|(r, z)| (r - place.r).hypot(z - place.z))
        .enumerate()
        .filter(|(_, distance)| distance.is_finite())
        .collect();
    if distances.is_empty() {
        return Err(Failure::NoParticle);
    }
    distances.sort_by(|(_, one), (_, other)| one.total_cmp(other));
    distances.truncate(count);
    let (particles, distances) = distances.into_iter().unzip();
    let listing = Listing {
        caption: format!("nearest to r = {} m, z = {} m:", number(place.r), number(place.z)),
        particles,
        chosen_by: Some(Quantity { name: "distance".to_owned(), unit: "m".to_owned(), values: distances }),
    };
    listing.print(&mapped, &columns, choice, output)?;
    Ok(Verdict::Good)
}
