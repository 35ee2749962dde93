//! What a run writes, and what it compares with exact solutions.

use super::diagnosis::Fault;
use super::entry::Entry;
use super::quantity::{Kind, LENGTH, NUMBER};
use super::section::Section;

/// What a run writes.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// Steps from one checkpoint to the next; 0 for one at the end only.
    pub checkpoint_every: u64,
    /// Steps from one row of the time series to the next; 0 for none.
    pub series_every: u64,
    /// Pictures and ParaView files over the run; 0 for none.
    pub frames: u64,
    /// Name of the field that colours the pictures.
    pub colour_by: String,
    /// Whether pictures are drawn.
    pub picture: bool,
    /// Whether ParaView files are written.
    pub paraview: bool,
}

impl Output {
    /// What a scene without an `[output]` table writes.
    pub fn defaults() -> Self {
        Self {
            checkpoint_every: 0,
            series_every: 10,
            frames: 10,
            colour_by: "pressure".to_owned(),
            picture: true,
            paraview: true,
        }
    }

    pub(super) fn read(entry: Entry<'_>) -> Result<Self, Fault> {
        let keys = ["checkpoint_every", "series_every", "frames", "colour_by", "picture", "paraview"];
        let table = Section::new(entry, &keys)?;
        let base = Self::defaults();
        Ok(Self {
            checkpoint_every: table
                .read_or("checkpoint_every", base.checkpoint_every, |entry| entry.count(0))?,
            series_every: table.read_or("series_every", base.series_every, |entry| entry.count(0))?,
            frames: table.read_or("frames", base.frames, |entry| entry.count(0))?,
            colour_by: table.read_or("colour_by", base.colour_by, |entry| entry.text().map(str::to_owned))?,
            picture: table.read_or("picture", base.picture, |entry| entry.flag())?,
            paraview: table.read_or("paraview", base.paraview, |entry| entry.flag())?,
        })
    }
}

/// What is compared with an exact solution at the end of a run. Lengths in metres.
#[derive(Debug, Clone, PartialEq)]
pub enum Measure {
    /// The pressure inside a drop at rest.
    LaplacePressure {
        /// Radius of the drop.
        radius: f64,
        /// Height z of its centre.
        centre: f64,
    },
    /// The period of an oscillating drop.
    Oscillation {
        /// Degree of the Legendre polynomial, at least 2.
        mode: u32,
        /// Radius of the sphere it oscillates about.
        radius: f64,
        /// Height z of its centre.
        centre: f64,
    },
    /// The speed of a drop that should rest.
    SpuriousVelocity {
        /// Radius of the drop.
        radius: f64,
    },
}

impl Measure {
    pub(super) fn read(entry: Entry<'_>) -> Result<Self, Fault> {
        const EXAMPLE: &str = "laplace-pressure = { radius = \"2.5 um\" }";
        let entry = entry.variant(&["laplace-pressure", "oscillation", "spurious-velocity"], EXAMPLE)?;
        let kind = entry.key().to_owned();
        let keys: &[&str] = match kind.as_str() {
            "oscillation" => &["mode", "radius", "centre"],
            "laplace-pressure" => &["radius", "centre"],
            _ => &["radius"],
        };
        let table = Section::new(entry, keys)?;
        let radius = table.required("radius", "radius = \"2.5 um\"")?.positive(LENGTH)?;
        let centre = table.read_or("centre", 0.0, |entry| entry.quantity(LENGTH))?;
        Ok(match kind.as_str() {
            "oscillation" => {
                let mode = table.required("mode", "mode = 2")?;
                let rule = |value: f64| value.fract() == 0.0 && (2.0..=1000.0).contains(&value);
                let number = Kind { example: "2", ..NUMBER };
                let mode = mode.checked(number, "must be a whole number from 2 to 1000", rule)?;
                Measure::Oscillation { mode: mode as u32, radius, centre }
            }
            "laplace-pressure" => Measure::LaplacePressure { radius, centre },
            _ => Measure::SpuriousVelocity { radius },
        })
    }
}
