//! A checkpoint looked at in place: the operating system reads only the pages that are used.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::{Path, PathBuf};

use memmap2::Mmap;
use xxhash_rust::xxh3::Xxh3;

use super::contents::{COLUMNS, Contents, length};
use super::error::CheckpointError;
use super::header::{FORMAT_VERSION, Header};
use super::read::open;
use super::types::{ArchivedColumn, ArchivedData, ArchivedRole, Clock, Preface, Role};

/// Bytes that are read at a time; a multiple of every value's size, and small enough for a cache.
const PIECE: usize = 1 << 18;

/// An open checkpoint whose header, clock and scene were checked, and whose columns stay in the
/// file until they are asked for.
pub struct Mapped {
    path: PathBuf,
    file: File,
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
        Ok(Self { path: path.to_path_buf(), file, map, header, preface })
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

    /// Checksum of the columns as the header tells it, xxh3.
    pub fn columns_checksum(&self) -> u64 {
        self.header.columns.checksum
    }

    /// Reads the columns once and checks them completely (the rest was checked when the file was
    /// opened). They are read piece by piece: pages of the map would stay in memory.
    ///
    /// # Errors
    /// The first check that fails.
    pub fn verify(&self) -> Result<(), CheckpointError> {
        let mut hasher = Xxh3::new();
        if let Some(range) = self.header.columns_range() {
            self.read_pieces(range, |piece| hasher.update(piece))?;
        }
        let found = hasher.digest();
        let expected = self.header.columns.checksum;
        if found != expected {
            let path = self.path.clone();
            return Err(CheckpointError::SectionDamaged { path, section: COLUMNS, found, expected });
        }
        self.contents().table().map(|_| ())
    }

    /// Passes all values of a column, in the order of the particles and in the column's unit, to
    /// `visit`, some ten thousand at a time: memory stays small however large the file is.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn stream(
        &self,
        column: &ColumnView<'_>,
        mut visit: impl FnMut(&[f64]),
    ) -> Result<(), CheckpointError> {
        let mut values = Vec::with_capacity(PIECE / size_of::<u32>());
        let start = column.address().saturating_sub(self.map.as_ptr() as usize);
        let integer = column.is_integer();
        let size = if integer { size_of::<u32>() } else { size_of::<f64>() };
        self.read_pieces(start..start + size * column.len(), |piece| {
            values.clear();
            if integer {
                let (words, _) = piece.as_chunks();
                values.extend(words.iter().map(|bytes| f64::from(u32::from_le_bytes(*bytes))));
            } else {
                let (words, _) = piece.as_chunks();
                values.extend(words.iter().map(|bytes| f64::from_le_bytes(*bytes)));
            }
            visit(&values);
        })
    }

    fn read_pieces(&self, range: Range<usize>, mut visit: impl FnMut(&[u8])) -> Result<(), CheckpointError> {
        let read_error = || CheckpointError::io(&self.path, "read the file");
        let mut file = &self.file;
        file.seek(SeekFrom::Start(range.start as u64)).map_err(read_error())?;
        let mut buffer = vec![0; PIECE.min(range.len())];
        let mut left = range.len();
        while left > 0 {
            let piece = &mut buffer[..left.min(PIECE)];
            file.read_exact(piece).map_err(read_error())?;
            visit(piece);
            left -= piece.len();
        }
        Ok(())
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

    /// Where in memory the values begin.
    fn address(&self) -> usize {
        match &self.column.data {
            ArchivedData::F64(values) => values.as_ptr() as usize,
            ArchivedData::U32(values) => values.as_ptr() as usize,
        }
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
