//! `meniscus inspect render`: a picture of a field.

use std::io::Write;
use std::path::PathBuf;

use super::columns::{quantity, sizes, values};
use super::export::{check_target, tell_written};
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
    #[arg(long, value_parser = finite, allow_hyphen_values = true)]
    low: Option<f64>,
    /// Value at the upper end of the colours [default: the greatest]
    #[arg(long, value_parser = finite, allow_hyphen_values = true)]
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

fn finite(text: &str) -> Result<f64, String> {
    let number: Option<f64> = text.trim().parse().ok();
    let number = number.filter(|number| number.is_finite());
    number.ok_or_else(|| format!("found `{text}`, expected a number such as -1.5"))
}

/// The values at the ends of the colours where either is given; the other end is an extreme of the field.
fn range(arguments: &Arguments, values: &[f64]) -> Result<Option<(f64, f64)>, Failure> {
    if arguments.low.is_none() && arguments.high.is_none() {
        return Ok(None);
    }
    let finite = || values.iter().copied().filter(|value| value.is_finite());
    let low = arguments.low.unwrap_or_else(|| finite().fold(f64::INFINITY, f64::min));
    let high = arguments.high.unwrap_or_else(|| finite().fold(f64::NEG_INFINITY, f64::max));
    if low >= high { Err(Failure::Range { low, high }) } else { Ok(Some((low, high))) }
}

/// Draws the picture.
pub fn run(arguments: &Arguments, output: &mut dyn Write) -> Result<Verdict, Failure> {
    let path = &arguments.output;
    if path.extension().is_none_or(|ending| ending != "png") {
        return Err(Failure::UnknownEnding { path: path.clone(), expected: ".png" });
    }
    check_target(path, arguments.overwrite)?;
    let mapped = open(&arguments.checkpoint)?;
    let columns = mapped.columns()?;
    let scene = scene(&mapped);
    let shown = quantity(&mapped, &columns, &arguments.field)?;
    let (r, z) = (values(&columns, "radius")?, values(&columns, "axial")?);
    let origin = scene.as_ref().map_or(0.0, |scene| scene.domain.origin);
    let r: Vec<f64> = r.iter().map(|r| r + origin).collect();
    let diameter = sizes(&columns, scene.as_ref())?;
    let particles = Particles { r: &r, z: &z, diameter: &diameter };
    let range = range(arguments, &shown.values)?;
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
