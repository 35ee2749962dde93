//! What a run writes.

use super::diagnosis::Fault;
use super::entry::Entry;
use super::section::Section;

/// What follows from fields and has none, with its unit.
pub const FOLLOWING: [(&str, &str); 3] = [("speed", "m/s"), ("size", "m"), ("pressure", "Pa")];

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
