//! The checks that reading and mapping share, over the bytes of a whole file.

use std::collections::HashSet;
use std::ops::Range;
use std::path::Path;

use rkyv::bytecheck::CheckBytes;
use rkyv::rancor::{BoxedError, Strategy};
use rkyv::validation::Validator;
use rkyv::validation::archive::ArchiveValidator;
use rkyv::validation::shared::SharedValidator;
use rkyv::vec::ArchivedVec;
use rkyv::{Portable, access};
use xxhash_rust::xxh3::xxh3_64;

use super::error::CheckpointError;
use super::header::{Header, Section, shortened};
use super::types::{ArchivedColumn, ArchivedData, ArchivedPreface, Preface};

const PREFACE: &str = "clock and scene";
pub(super) const COLUMNS: &str = "columns";

/// A file's bytes under a header that matches their number.
#[derive(Clone, Copy)]
pub(super) struct Contents<'a> {
    pub path: &'a Path,
    pub bytes: &'a [u8],
    pub header: &'a Header,
}

impl<'a> Contents<'a> {
    /// Clock, scene and revision, fully checked.
    pub fn preface(&self) -> Result<Preface, CheckpointError> {
        let bytes = self.checked(PREFACE, self.header.preface_range(), self.header.preface)?;
        let archived: &ArchivedPreface = self.archived(PREFACE, bytes, self.header.preface)?;
        let preface = rkyv::deserialize::<Preface, BoxedError>(archived)
            .map_err(|source| self.invalid(PREFACE, source))?;
        self.agree(&preface)?;
        Ok(preface)
    }

    /// The columns, with their structure validated but their checksum not compared.
    pub fn columns(&self) -> Result<&'a ArchivedVec<ArchivedColumn>, CheckpointError> {
        let bytes = self.section(self.header.columns_range())?;
        self.archived(COLUMNS, bytes, self.header.columns)
    }

    /// The columns, fully checked.
    pub fn verified_columns(&self) -> Result<&'a ArchivedVec<ArchivedColumn>, CheckpointError> {
        self.checked(COLUMNS, self.header.columns_range(), self.header.columns)?;
        self.table()
    }

    /// The columns, with all checked but their checksum.
    pub fn table(&self) -> Result<&'a ArchivedVec<ArchivedColumn>, CheckpointError> {
        let columns = self.columns()?;
        let lengths = columns.iter().map(|column| (column.name.as_str(), length(&column.data)));
        check_columns(self.path, lengths)?;
        Ok(columns)
    }

    fn checked(
        &self,
        name: &'static str,
        range: Option<Range<usize>>,
        section: Section,
    ) -> Result<&'a [u8], CheckpointError> {
        let bytes = self.section(range)?;
        let found = xxh3_64(bytes);
        if found == section.checksum {
            return Ok(bytes);
        }
        Err(CheckpointError::SectionDamaged {
            path: self.path.to_path_buf(),
            section: name,
            found,
            expected: section.checksum,
        })
    }

    fn section(&self, range: Option<Range<usize>>) -> Result<&'a [u8], CheckpointError> {
        let bytes = range.and_then(|range| self.bytes.get(range));
        bytes.ok_or_else(|| CheckpointError::Length {
            path: self.path.to_path_buf(),
            found: self.bytes.len() as u64,
            expected: self.header.file_length().unwrap_or(u64::MAX),
        })
    }

    /// Validates the archive in front of the padding: rkyv finds the root at the archive's end.
    fn archived<T>(
        &self,
        name: &'static str,
        bytes: &'a [u8],
        section: Section,
    ) -> Result<&'a T, CheckpointError>
    where
        T: Portable
            + for<'b> CheckBytes<Strategy<Validator<ArchiveValidator<'b>, SharedValidator>, BoxedError>>,
    {
        access(&bytes[..section.length as usize]).map_err(|source| self.invalid(name, source))
    }

    fn agree(&self, preface: &Preface) -> Result<(), CheckpointError> {
        let Preface { clock, scene, revision } = preface;
        let header = self.header;
        let same_time = header.time.to_bits() == clock.time.to_bits()
            && header.step_size.to_bits() == clock.step_size.to_bits();
        for (what, same) in [
            ("step", header.step == clock.step),
            ("time", same_time),
            ("scene", header.scene_hash == xxh3_64(scene.as_bytes())),
            ("revision", header.revision == shortened(revision)),
        ] {
            if !same {
                return Err(CheckpointError::Disagreement { path: self.path.to_path_buf(), what });
            }
        }
        Ok(())
    }

    fn invalid(&self, section: &'static str, source: BoxedError) -> CheckpointError {
        CheckpointError::Archive { path: self.path.to_path_buf(), section, source }
    }
}

/// Checks what makes a list of columns a table: unique names and equal lengths.
pub(super) fn check_columns<'n>(
    path: &Path,
    columns: impl Iterator<Item = (&'n str, usize)>,
) -> Result<(), CheckpointError> {
    let mut names = HashSet::new();
    let mut expected = None;
    for (name, found) in columns {
        if !names.insert(name) {
            return Err(CheckpointError::DuplicateColumn { path: path.to_path_buf(), name: name.to_owned() });
        }
        let expected = *expected.get_or_insert(found);
        if found != expected {
            return Err(CheckpointError::UnequalColumns {
                path: path.to_path_buf(),
                name: name.to_owned(),
                found,
                expected,
            });
        }
    }
    Ok(())
}

/// Number of values of an archived column.
pub(super) fn length(data: &ArchivedData) -> usize {
    match data {
        ArchivedData::F64(values) => values.len(),
        ArchivedData::U32(values) => values.len(),
    }
}
