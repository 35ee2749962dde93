//! The first 4096 bytes of a file: enough to know what it is without its payload.

use std::ops::Range;
use std::path::Path;

use xxhash_rust::xxh3::xxh3_64;

use super::error::CheckpointError;

/// Version of the format that this program writes and reads.
pub const FORMAT_VERSION: u32 = 1;
/// Length of the header, and the unit in which sections are placed, bytes.
pub(super) const HEADER_LENGTH: usize = 4096;
const MAGIC: [u8; 8] = *b"MENISCUS";

/// Places of the header's entries, bytes from the start; all numbers are little-endian. What is
/// not named here is zero, and under the header's checksum all the same.
mod place {
    pub const VERSION: usize = 8;
    pub const FILE_LENGTH: usize = 16;
    pub const PREFACE_LENGTH: usize = 24;
    pub const PREFACE_CHECKSUM: usize = 32;
    pub const COLUMNS_LENGTH: usize = 40;
    pub const COLUMNS_CHECKSUM: usize = 48;
    pub const SCENE_HASH: usize = 56;
    pub const STEP: usize = 64;
    pub const TIME: usize = 72;
    pub const STEP_SIZE: usize = 80;
    pub const REVISION: usize = 128;
    pub const REVISION_END: usize = 384;
    pub const CHECKSUM: usize = super::HEADER_LENGTH - 8;
}

/// Length and checksum of a section.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Section {
    /// Length of the archive without the padding that follows, bytes.
    pub length: u64,
    /// xxh3 of archive and padding.
    pub checksum: u64,
}

impl Section {
    /// Length with padding, if it is a number at all: a forged header may claim anything.
    fn padded(self) -> Option<u64> {
        self.length.checked_next_multiple_of(HEADER_LENGTH as u64)
    }
}

/// What the header tells.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Header {
    pub preface: Section,
    pub columns: Section,
    pub scene_hash: u64,
    pub step: u64,
    pub time: f64,
    pub step_size: f64,
    /// The source's revision, shortened to what fits.
    pub revision: String,
}

impl Header {
    /// Bytes of the file that hold the preface with its padding.
    pub fn preface_range(&self) -> Option<Range<usize>> {
        range(HEADER_LENGTH as u64, self.preface)
    }

    /// Bytes of the file that hold the columns with their padding.
    pub fn columns_range(&self) -> Option<Range<usize>> {
        range(self.preface_range()?.end as u64, self.columns)
    }

    /// Length of the whole file, bytes; none if the claimed lengths exceed any file.
    pub fn file_length(&self) -> Option<u64> {
        Some(self.columns_range()?.end as u64)
    }

    pub fn encode(&self) -> [u8; HEADER_LENGTH] {
        let mut bytes = [0; HEADER_LENGTH];
        bytes[..MAGIC.len()].copy_from_slice(&MAGIC);
        bytes[place::VERSION..][..4].copy_from_slice(&FORMAT_VERSION.to_le_bytes());
        let revision = shortened(&self.revision).as_bytes();
        bytes[place::REVISION..][..revision.len()].copy_from_slice(revision);
        for (place, word) in [
            (place::FILE_LENGTH, self.file_length().unwrap_or(u64::MAX)),
            (place::PREFACE_LENGTH, self.preface.length),
            (place::PREFACE_CHECKSUM, self.preface.checksum),
            (place::COLUMNS_LENGTH, self.columns.length),
            (place::COLUMNS_CHECKSUM, self.columns.checksum),
            (place::SCENE_HASH, self.scene_hash),
            (place::STEP, self.step),
            (place::TIME, self.time.to_bits()),
            (place::STEP_SIZE, self.step_size.to_bits()),
        ] {
            put(&mut bytes, place, word);
        }
        let checksum = xxh3_64(&bytes[..place::CHECKSUM]);
        put(&mut bytes, place::CHECKSUM, checksum);
        bytes
    }

    /// Reads and checks the header; `start` is the beginning of the file, as much as is at hand.
    pub fn decode(path: &Path, start: &[u8], file_length: u64) -> Result<Self, CheckpointError> {
        let path_buf = || path.to_path_buf();
        let Some(bytes) = start.first_chunk::<HEADER_LENGTH>() else {
            return Err(CheckpointError::TooShort { path: path_buf(), found: file_length });
        };
        if !bytes.starts_with(&MAGIC) {
            return Err(CheckpointError::NotACheckpoint { path: path_buf() });
        }
        // Every version ends its header with the checksum, so that damage and a newer version are told apart.
        let found = xxh3_64(&bytes[..place::CHECKSUM]);
        let expected = word(bytes, place::CHECKSUM);
        if found == expected.swap_bytes() {
            return Err(CheckpointError::ByteOrder { path: path_buf() });
        }
        if found != expected {
            return Err(CheckpointError::HeaderDamaged { path: path_buf(), found, expected });
        }
        let mut version = [0; 4];
        version.copy_from_slice(&bytes[place::VERSION..][..4]);
        let found = u32::from_le_bytes(version);
        if found != FORMAT_VERSION {
            return Err(CheckpointError::Version { path: path_buf(), found });
        }
        let header = Self::parse(bytes);
        let claimed = word(bytes, place::FILE_LENGTH);
        if claimed != file_length || header.file_length() != Some(file_length) {
            return Err(CheckpointError::Length { path: path_buf(), found: file_length, expected: claimed });
        }
        Ok(header)
    }

    fn parse(bytes: &[u8; HEADER_LENGTH]) -> Self {
        let revision = &bytes[place::REVISION..place::REVISION_END];
        let used = revision.iter().position(|&byte| byte == 0);
        let revision = &revision[..used.unwrap_or(revision.len())];
        Self {
            preface: Section {
                length: word(bytes, place::PREFACE_LENGTH),
                checksum: word(bytes, place::PREFACE_CHECKSUM),
            },
            columns: Section {
                length: word(bytes, place::COLUMNS_LENGTH),
                checksum: word(bytes, place::COLUMNS_CHECKSUM),
            },
            scene_hash: word(bytes, place::SCENE_HASH),
            step: word(bytes, place::STEP),
            time: f64::from_bits(word(bytes, place::TIME)),
            step_size: f64::from_bits(word(bytes, place::STEP_SIZE)),
            revision: String::from_utf8_lossy(revision).into_owned(),
        }
    }
}

/// The part of a revision that fits the header, ending between two characters.
pub(super) fn shortened(revision: &str) -> &str {
    let room = place::REVISION_END - place::REVISION;
    let end = revision.find('\0').unwrap_or(revision.len());
    &revision[..revision.floor_char_boundary(end.min(room))]
}

fn range(start: u64, section: Section) -> Option<Range<usize>> {
    let end = start.checked_add(section.padded()?)?;
    Some(usize::try_from(start).ok()?..usize::try_from(end).ok()?)
}

fn put(bytes: &mut [u8; HEADER_LENGTH], place: usize, word: u64) {
    bytes[place..][..8].copy_from_slice(&word.to_le_bytes());
}

fn word(bytes: &[u8; HEADER_LENGTH], place: usize) -> u64 {
    let mut word = [0; 8];
    word.copy_from_slice(&bytes[place..][..8]);
    u64::from_le_bytes(word)
}
