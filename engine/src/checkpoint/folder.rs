//! The checkpoints of one run: their names, the newest, and the removal of old ones.

use std::fs;
use std::path::{Path, PathBuf};

use super::error::{CheckpointError, Skipped};
use super::read::read;
use super::types::Checkpoint;
use super::write::UNFINISHED;

const PREFIX: &str = "step-";
const SUFFIX: &str = ".meniscus";
const CRASHED: &str = "crash-";
const SET_ASIDE: &str = ".damaged";

/// Name of the checkpoint after a number of steps: `step-000001234.meniscus`.
pub fn file_name(step: u64) -> String {
    format!("{PREFIX}{step:09}{SUFFIX}")
}

/// Name of the state of a run that broke down after a number of steps: `crash-step-000001234.meniscus`.
/// No run goes on from it, so [`list`] passes over it.
pub fn crash_file_name(step: u64) -> String {
    format!("{CRASHED}{}", file_name(step))
}

/// The checkpoints of a folder by name, with their steps, oldest first; none is opened.
///
/// # Errors
/// A folder that cannot be read.
pub fn list(folder: &Path) -> Result<Vec<(u64, PathBuf)>, CheckpointError> {
    named(folder, step_of)
}

/// The states in which runs of a folder broke down, with their steps, oldest first; none is opened.
///
/// # Errors
/// A folder that cannot be read.
pub fn list_crashes(folder: &Path) -> Result<Vec<(u64, PathBuf)>, CheckpointError> {
    named(folder, |name| step_of(name.strip_prefix(CRASHED)?))
}

fn named(
    folder: &Path,
    step_of: impl Fn(&str) -> Option<u64>,
) -> Result<Vec<(u64, PathBuf)>, CheckpointError> {
    let read_error = || CheckpointError::io(folder, "read the folder");
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(read_error())? {
        let entry = entry.map_err(read_error())?;
        if let Some(step) = entry.file_name().to_str().and_then(&step_of) {
            found.push((step, entry.path()));
        }
    }
    found.sort();
    Ok(found)
}

/// Checks that the name of a checkpoint, where it tells a step, tells that which the file holds.
///
/// # Errors
/// A name that tells another step.
pub fn check_name(path: &Path, step: u64) -> Result<(), CheckpointError> {
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    match step_of(name.strip_prefix(CRASHED).unwrap_or(name)) {
        Some(named) if named != step => {
            Err(CheckpointError::Misnamed { path: path.to_path_buf(), named, step })
        }
        _ => Ok(()),
    }
}

/// Reads the newest checkpoint of a folder that is whole and of the step that its name tells. Also returns the newer ones
/// that are not, each with the reason.
///
/// # Errors
/// A folder that cannot be read or holds no valid checkpoint; a newer file that cannot be opened or
/// is of another release: it may be whole, so nothing may go on without it.
pub fn newest_valid(folder: &Path) -> Result<(PathBuf, Checkpoint, Vec<Skipped>), CheckpointError> {
    let mut skipped = Vec::new();
    for (_, path) in list(folder)?.into_iter().rev() {
        match read(&path).and_then(|found| check_name(&path, found.clock.step).map(|()| found)) {
            Ok(checkpoint) => return Ok((path, checkpoint, skipped)),
            Err(error) if error.is_damage() => skipped.push((path, error)),
            Err(error) => return Err(error),
        }
    }
    Err(CheckpointError::NoneValid { folder: folder.to_path_buf(), skipped })
}

/// Renames a damaged checkpoint, so that it counts no longer among those of its folder: else it
/// would take the place of a whole one when old ones are removed. Returns the new name.
///
/// # Errors
/// A file that cannot be renamed.
pub fn set_aside(path: &Path) -> Result<PathBuf, CheckpointError> {
    let mut name = path.as_os_str().to_owned();
    name.push(SET_ASIDE);
    let aside = PathBuf::from(name);
    fs::rename(path, &aside).map_err(CheckpointError::io(path, "rename the damaged file"))?;
    Ok(aside)
}

/// Removes all but the newest `count` checkpoints of a folder (one stays in any case), and what
/// interrupted writes have left. Only the run that writes into the folder may call this, after a
/// write of its own.
///
/// # Errors
/// A folder that cannot be read, a file that cannot be removed.
pub fn keep_last(folder: &Path, count: usize) -> Result<(), CheckpointError> {
    let found = list(folder)?;
    let surplus = found.len().saturating_sub(count.max(1));
    let old = found.into_iter().take(surplus).map(|(_, path)| path);
    for path in old.chain(unfinished(folder)?) {
        fs::remove_file(&path).map_err(CheckpointError::io(&path, "remove the file"))?;
    }
    Ok(())
}

fn unfinished(folder: &Path) -> Result<Vec<PathBuf>, CheckpointError> {
    let read_error = || CheckpointError::io(folder, "read the folder");
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).map_err(read_error())? {
        let entry = entry.map_err(read_error())?;
        let name = entry.file_name();
        if name.to_str().is_some_and(|name| name.starts_with('.') && name.ends_with(UNFINISHED)) {
            found.push(entry.path());
        }
    }
    Ok(found)
}

fn step_of(name: &str) -> Option<u64> {
    let digits = name.strip_prefix(PREFIX)?.strip_suffix(SUFFIX)?;
    let plain = digits.bytes().all(|byte| byte.is_ascii_digit());
    plain.then(|| digits.parse().ok()).flatten()
}
