//! A checkpoint looked at in place: the operating system reads only the pages that are used.

use std::path::{Path, PathBuf};

use memmap2::Mmap;

use super::contents::{Contents, length};
use super::error::CheckpointError;
use super::header::{FORMAT_VERSION, Header};
use super::read::open;
use super::types::{ArchivedColumn, ArchivedData, ArchivedRole, Clock, Preface, Role};

/// An open checkpoint whose header, clock and scene were checked, and whose columns stay in the
/// file until they are asked for.
pub struct Mapped {
    path: PathBuf,
    map: Mmap,
    header: Header,
    preface: Preface,
}

impl Mapped {
    /// Opens a checkpoint; reads and checks header, clock, scene and revision, not the columns.
    ///
    /// # Errors
    /// A file that cannot be opened, or whose header or clock is damaged.
    pub fn open(path: &Path) -> Result<Self, CheckpointError> {
        let (file, header) = open(path)?;
        // SAFETY: the bytes must not change while the map lives. Checkpoints are written only by
        // `write`, which fills another file and renames it over this name: a map that is open
        // keeps the old file. Nothing in this program changes or shortens a finished checkpoint.
        // Somebody else's edit could be seen as wrong values or end the program, as with any map.
        let map =
            unsafe { Mmap::map(&file) }.map_err(CheckpointError::io(path, "map the file into memory"))?;
        let contents = Contents { path, bytes: &map, header: &header };
        let preface = contents.preface()?;
        Ok(Self { path: path.to_path_buf(), map, header, preface })
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Version of the file's format.
    pub fn format_version(&self) -> u32 {
        FORMAT_VERSION
    }

    /// Where the run stands.
    pub fn clock(&self) -> &Clock {
        &self.preface.clock
    }

    /// Text of the effective scene.
    pub fn scene(&self) -> &str {
        &self.preface.scene
    }

    /// xxh3 of the scene's text: equal for runs of the same scene.
    pub fn scene_hash(&self) -> u64 {
        self.header.scene_hash
    }

    /// Revision of the source that wrote the file.
    pub fn revision(&self) -> &str {
        &self.preface.revision
    }

    /// Length of the file, bytes.
    pub fn file_length(&self) -> u64 {
        self.map.len() as u64
    }

    /// Length of the columns' archive, bytes.
    pub fn columns_length(&self) -> u64 {
        self.header.columns.length
    }

    /// Reads the whole file once and checks it completely.
    ///
    /// # Errors
    /// The first check that fails.
    pub fn verify(&self) -> Result<(), CheckpointError> {
        self.contents().verified_columns().map(|_| ())
    }

    /// The columns, in place. Safe to walk also where [`verify`](Self::verify) was not called, but
    /// then the values are only as good as the disk.
    ///
    /// # Errors
    /// A structure so damaged that it cannot be walked.
    pub fn columns(&self) -> Result<Vec<ColumnView<'_>>, CheckpointError> {
        let columns = self.contents().columns()?;
        Ok(columns.iter().map(|column| ColumnView { column }).collect())
    }

    fn contents(&self) -> Contents<'_> {
        Contents { path: &self.path, bytes: &self.map, header: &self.header }
    }
}

/// One column of a mapped checkpoint; its values are read from the file where they are used.
#[derive(Clone, Copy)]
pub struct ColumnView<'a> {
    column: &'a ArchivedColumn,
}

impl<'a> ColumnView<'a> {
    /// Name of the field.
    pub fn name(&self) -> &'a str {
        &self.column.name
    }

    /// Symbol used in formulas.
    pub fn symbol(&self) -> &'a str {
        &self.column.symbol
    }

    /// Unit of the values; empty or "1" for a plain number.
    pub fn unit(&self) -> &'a str {
        &self.column.unit
    }

    /// One sentence about the field.
    pub fn about(&self) -> &'a str {
        &self.column.about
    }

    /// Whether the next step depends on it.
    pub fn role(&self) -> Role {
        match self.column.role {
            ArchivedRole::State => Role::State,
            ArchivedRole::Derived => Role::Derived,
        }
    }

    /// Whether the values are whole numbers.
    pub fn is_integer(&self) -> bool {
        matches!(self.column.data, ArchivedData::U32(_))
    }

    /// Number of values.
    pub fn len(&self) -> usize {
        length(&self.column.data)
    }

    /// Whether there is no value.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The value of one particle, in the column's unit; none beyond the last particle. Whole
    /// numbers are exact too: each u32 is an f64.
    pub fn value(&self, particle: usize) -> Option<f64> {
        match &self.column.data {
            ArchivedData::F64(values) => values.get(particle).map(|value| value.to_native()),
            ArchivedData::U32(values) => values.get(particle).map(|value| value.to_native().into()),
        }
    }

    /// All values in the order of the particles, in the column's unit.
    pub fn values(&self) -> impl ExactSizeIterator<Item = f64> + use<'a> {
        let column = *self;
        // An index beyond the end cannot come up here; NaN would show it.
        (0..self.len()).map(move |particle| column.value(particle).unwrap_or(f64::NAN))
    }
}
