//! What can be wrong with a checkpoint, in sentences.

use std::io;
use std::path::{Path, PathBuf};

use rkyv::rancor::BoxedError;

use super::header::{FORMAT_VERSION, HEADER_LENGTH};

/// A file that was passed over, and why.
pub type Skipped = (PathBuf, CheckpointError);

/// Why a checkpoint could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// The operating system refused.
    #[error("{}: cannot {action}: {source}; check that the path, its permissions and the free space are right", path.display())]
    Io {
        /// File or folder concerned.
        path: PathBuf,
        /// What was tried.
        action: &'static str,
        /// The system's reason.
        source: io::Error,
    },
    /// The file ends before its header does.
    #[error("{}: found {found} bytes, expected at least the {HEADER_LENGTH} of a checkpoint's header; the file was cut off or is no checkpoint, use an older one", path.display())]
    TooShort {
        /// The file.
        path: PathBuf,
        /// Its length in bytes.
        found: u64,
    },
    /// The file starts with other bytes than a checkpoint does.
    #[error("{}: the file does not start with the mark of a checkpoint, so it is damaged or something else; name a file written by a run", path.display())]
    NotACheckpoint {
        /// The file.
        path: PathBuf,
    },
    /// The format is not one this program knows.
    #[error("{}: found format version {found}, expected {FORMAT_VERSION}; use it with the release that wrote it", path.display())]
    Version {
        /// The file.
        path: PathBuf,
        /// Version the file claims.
        found: u32,
    },
    /// The numbers were written with their bytes in the other order.
    #[error("{}: its numbers were written most significant byte first, expected least significant first; convert it on the machine that wrote it", path.display())]
    ByteOrder {
        /// The file.
        path: PathBuf,
    },
    /// The header does not match its checksum.
    #[error("{}: the header has checksum {found:016x}, expected {expected:016x}; the file is damaged, use an older checkpoint", path.display())]
    HeaderDamaged {
        /// The file.
        path: PathBuf,
        /// Checksum of the bytes.
        found: u64,
        /// Checksum stored in the header.
        expected: u64,
    },
    /// The file's length is not the one its header tells.
    #[error("{}: found {found} bytes, expected {expected} by its header; the file is incomplete or damaged, use an older checkpoint", path.display())]
    Length {
        /// The file.
        path: PathBuf,
        /// Its length in bytes.
        found: u64,
        /// Length by the header, bytes.
        expected: u64,
    },
    /// A section does not match its checksum.
    #[error("{}: the {section} have checksum {found:016x}, expected {expected:016x}; the file is damaged, use an older checkpoint", path.display())]
    SectionDamaged {
        /// The file.
        path: PathBuf,
        /// What the section holds.
        section: &'static str,
        /// Checksum of the bytes.
        found: u64,
        /// Checksum stored in the header.
        expected: u64,
    },
    /// A section is no valid archive although its checksum holds.
    #[error("{}: the {section} are no valid archive ({source}); the file was not written by this program, use another checkpoint", path.display())]
    Archive {
        /// The file.
        path: PathBuf,
        /// What the section holds.
        section: &'static str,
        /// The archive's complaint.
        source: BoxedError,
    },
    /// Header and preface tell different things.
    #[error("{}: header and clock disagree about the {what}; the file was not written by this program, use another checkpoint", path.display())]
    Disagreement {
        /// The file.
        path: PathBuf,
        /// What they disagree about.
        what: &'static str,
    },
    /// The name tells another step than the file holds.
    #[error("{}: found step {step} in it, expected {named} by its name; give it back its name, or use another checkpoint", path.display())]
    Misnamed {
        /// The file.
        path: PathBuf,
        /// The step of the name.
        named: u64,
        /// The step in the file.
        step: u64,
    },
    /// Two columns share a name.
    #[error("{}: found two columns named `{name}`, expected each name once; the program that filled the checkpoint is at fault", path.display())]
    DuplicateColumn {
        /// The file.
        path: PathBuf,
        /// The name.
        name: String,
    },
    /// A column is shorter or longer than the first one.
    #[error("{}: column `{name}` has {found} values, expected {expected} as in the first column; the program that filled the checkpoint is at fault", path.display())]
    UnequalColumns {
        /// The file.
        path: PathBuf,
        /// The column.
        name: String,
        /// Its number of values.
        found: usize,
        /// Number of values of the first column.
        expected: usize,
    },
    /// A folder holds no checkpoint that can be read.
    #[error("{}: found no valid checkpoint among {} files{}; start the run anew", folder.display(), skipped.len(), reasons(skipped))]
    NoneValid {
        /// The folder.
        folder: PathBuf,
        /// The files found, newest first, and why each was refused.
        skipped: Vec<Skipped>,
    },
}

impl CheckpointError {
    /// Whether a file was found but its content is wrong, as opposed to one that is missing,
    /// cannot be opened, or was written by another release or machine.
    pub fn is_damage(&self) -> bool {
        match self {
            Self::Io { .. } | Self::Version { .. } | Self::ByteOrder { .. } => false,
            Self::NoneValid { skipped, .. } => skipped.iter().any(|(_, error)| error.is_damage()),
            _ => true,
        }
    }

    /// Turns an error of the operating system into one that names the path and the action.
    pub(super) fn io(path: &Path, action: &'static str) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_path_buf();
        move |source| Self::Io { path, action, source }
    }
}

fn reasons(skipped: &[Skipped]) -> String {
    let reasons: Vec<String> = skipped.iter().map(|(_, error)| error.to_string()).collect();
    if reasons.is_empty() { String::new() } else { format!(" ({})", reasons.join("; ")) }
}
