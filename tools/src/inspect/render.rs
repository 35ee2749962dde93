//! `meniscus inspect render`: a picture of a field.

use std::io::Write;
use std::path::PathBuf;

use super::columns::{quantity, sizes, values};
use super::export::{refuse_existing, tell_written};
use super::failure::{Failure, Verdict};
use super::open::{open, scene};
use crate::output::colour::ColourMap;
use crate::output::picture::{Particles, Picture, Shade, Window, write_picture};

/// What to draw, and where.
#[derive(clap::Args, Debug)]
#[command(after_help = "\
Examples:
  meniscus inspect render runs/drop pressure pressure.png
  meniscus inspect render runs/drop velocity_z velocity.png --side one --low -1 --high 1

Signed fields are blue and red about zero where --low is minus --high.")]
pub struct Arguments {
    /// A checkpoint, or the folder of a run: then its newest checkpoint
    checkpoint: PathBuf,
    /// The field, or speed, size or pressure
    field: String,
    /// The picture, a name that ends in .png
    #[arg(value_name = "FILE.png")]
    output: PathBuf,
    /// Sides of the axis [default: both, unless the liquid is far from the axis]
    #[arg(long, value_enum)]
    side: Option<Side>,
    /// Value at the lower end of the colours, in the field's unit [default: the least]
    #[arg(long, requires = "high", allow_hyphen_values = true)]
    low: Option<f64>,
    /// Value at the upper end of the colours [default: the greatest]
    #[arg(long, requires = "low", allow_hyphen_values = true)]
    high: Option<f64>,
    /// Replace a file of that name
    #[arg(long)]
    overwrite: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Sides of the axis that a picture shows.
#[derive(Clone, Copy, Debug, Eq, PartialEq, clap::ValueEnum)]
enum Side {
    /// Mirrored at the axis
    Both,
    /// The half plane alone
    One,
}

/// Draws the picture.
pub fn run(arguments: &Arguments, output: &mut dyn Write) -> Result<Verdict, Failure> {
    let path = &arguments.output;
    if path.extension().is_none_or(|ending| ending != "png") {
        return Err(Failure::UnknownEnding { path: path.clone(), expected: ".png" });
    }
    refuse_existing(path, arguments.overwrite)?;
    let mapped = open(&arguments.checkpoint)?;
    let columns = mapped.columns()?;
    let scene = scene(&mapped);
    let shown = quantity(&mapped, &columns, &arguments.field)?;
    let (r, z) = (values(&columns, "radius")?, values(&columns, "axial")?);
    let origin = scene.as_ref().map_or(0.0, |scene| scene.domain.origin);
    let r: Vec<f64> = r.iter().map(|r| r + origin).collect();
    let diameter = sizes(&columns, scene.as_ref())?;
    let particles = Particles { r: &r, z: &z, diameter: &diameter };
    let range = arguments.low.zip(arguments.high);
    let mirrored = arguments.side.map(|side| side == Side::Both);
    let picture = Picture {
        title: scene.as_ref().map_or("", |scene| &scene.title),
        time: mapped.clock().time,
        particles,
        shade: Shade {
            name: &shown.name,
            unit: if shown.unit == "1" { "" } else { &shown.unit },
            values: &shown.values,
            map: if range.is_some_and(|(low, high)| low == -high) {
                ColourMap::BlueRed
            } else {
                ColourMap::Viridis
            },
            range,
        },
        window: Window::around(&particles).map(|window| Window { mirrored, ..window }),
    };
    write_picture(path, &picture)?;
    tell_written(path, arguments.json, output)?;
    Ok(Verdict::Good)
}
