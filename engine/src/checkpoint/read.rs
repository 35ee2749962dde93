//! Reading a whole checkpoint into memory, to continue a run from it.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use rkyv::rancor::BoxedError;
use rkyv::util::AlignedVec;

use super::contents::Contents;
use super::error::CheckpointError;
use super::header::{HEADER_LENGTH, Header};
use super::types::{Checkpoint, Column, Preface};

/// Reads a checkpoint and checks every byte of it.
///
/// # Errors
/// The first check that fails, in the order told at the module; nothing is returned in part.
pub fn read(path: &Path) -> Result<Checkpoint, CheckpointError> {
    let (mut file, header) = open(path)?;
    let mut bytes: AlignedVec = AlignedVec::new();
    // The header was found to agree with the file's true length, so this asks for no more memory
    // than there is file.
    let end = header.columns_range().map(|range| range.end);
    bytes.resize(end.unwrap_or(HEADER_LENGTH), 0);
    // The header's own place stays zero: it has been read.
    file.read_exact(&mut bytes[HEADER_LENGTH..]).map_err(CheckpointError::io(path, "read the file"))?;
    take(&Contents { path, bytes: &bytes, header: &header })
}

/// Reads a checkpoint from the bytes of a file and checks all of them; `path` is only what errors name.
///
/// # Errors
/// As [`read`].
pub fn parse(path: &Path, bytes: &[u8]) -> Result<Checkpoint, CheckpointError> {
    let header = Header::decode(path, bytes, bytes.len() as u64)?;
    let mut aligned: AlignedVec = AlignedVec::with_capacity(bytes.len());
    aligned.extend_from_slice(bytes);
    take(&Contents { path, bytes: &aligned, header: &header })
}

fn take(contents: &Contents<'_>) -> Result<Checkpoint, CheckpointError> {
    let path = contents.path;
    let Preface { clock, scene, revision } = contents.preface()?;
    let columns =
        rkyv::deserialize::<Vec<Column>, BoxedError>(contents.verified_columns()?).map_err(|source| {
            CheckpointError::Archive { path: path.to_path_buf(), section: "columns", source }
        })?;
    Ok(Checkpoint { clock, scene, revision, columns })
}

/// Opens a file and checks its header; the file stands behind the header afterwards.
pub(super) fn open(path: &Path) -> Result<(File, Header), CheckpointError> {
    let open_error = || CheckpointError::io(path, "open the file");
    let mut file = File::open(path).map_err(open_error())?;
    let metadata = file.metadata().map_err(open_error())?;
    if metadata.is_dir() {
        return Err(open_error()(io::ErrorKind::IsADirectory.into()));
    }
    let mut start = Vec::with_capacity(HEADER_LENGTH);
    file.by_ref()
        .take(HEADER_LENGTH as u64)
        .read_to_end(&mut start)
        .map_err(CheckpointError::io(path, "read the file"))?;
    let header = Header::decode(path, &start, metadata.len())?;
    Ok((file, header))
}
