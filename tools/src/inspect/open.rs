//! From what a user names to an open checkpoint.

use std::path::{Path, PathBuf};

use meniscus_cases::scene::{self, Scene};
use meniscus_engine::checkpoint::{ColumnView, Mapped, list, list_crashes};

use super::failure::Failure;

/// Opens the checkpoint that a path means, and checks every byte of it.
pub fn open(path: &Path) -> Result<Mapped, Failure> {
    let mapped = Mapped::open(&newest(path)?)?;
    mapped.verify()?;
    Ok(mapped)
}

/// The checkpoint that a path means: itself, or the newest of a folder. Where a run broke down after its
/// last checkpoint, or right at it, that is the state of the crash.
pub fn newest(path: &Path) -> Result<PathBuf, Failure> {
    if !path.is_dir() {
        return Ok(path.to_path_buf());
    }
    let folder = checkpoints(path);
    let all = list(&folder)?.into_iter().chain(list_crashes(&folder)?);
    // Of equal steps the last one counts: the crash.
    match all.max_by_key(|(step, _)| *step) {
        Some((_, newest)) => Ok(newest),
        None => Err(Failure::NoCheckpoint { folder: path.to_path_buf() }),
    }
}

/// Where the checkpoints of a run's folder lie; the folder itself may be that place.
pub fn checkpoints(folder: &Path) -> PathBuf {
    let inner = folder.join("checkpoints");
    if inner.is_dir() { inner } else { folder.to_path_buf() }
}

/// The scene of a checkpoint; none where this release cannot read it.
pub fn scene(mapped: &Mapped) -> Option<Scene> {
    scene::parse(&mapped.path().display().to_string(), mapped.scene(), &[]).ok()
}

/// Number of particles.
pub fn particles(columns: &[ColumnView<'_>]) -> usize {
    columns.first().map_or(0, ColumnView::len)
}
