//! From what a user names to an open checkpoint.

use std::path::{Path, PathBuf};

use meniscus_cases::scene::{self, Scene};
use meniscus_engine::checkpoint::{ColumnView, Mapped, list};

use super::failure::Failure;

/// Opens the checkpoint that a path means, and checks every byte of it.
pub fn open(path: &Path) -> Result<Mapped, Failure> {
    let mapped = Mapped::open(&newest(path)?)?;
    mapped.verify()?;
    Ok(mapped)
}

/// The checkpoint that a path means: itself, or the newest of a folder.
pub fn newest(path: &Path) -> Result<PathBuf, Failure> {
    match all(path)?.pop() {
        Some(path) => Ok(path),
        None => Err(Failure::NoCheckpoint { folder: path.to_path_buf() }),
    }
}

/// The checkpoints that a path means, oldest first: itself, or those of a run's folder.
pub fn all(path: &Path) -> Result<Vec<PathBuf>, Failure> {
    if !path.is_dir() {
        return Ok(vec![path.to_path_buf()]);
    }
    Ok(list(&checkpoints(path))?.into_iter().map(|(_, path)| path).collect())
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
