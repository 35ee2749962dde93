//! The folder of a run: made once, never overwritten by accident.

use std::fs::{self, File, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::atomic::{UNFINISHED_PREFIX, write_atomic};
use super::{OutputError, OutputResult};

/// Plain files that a run makes at the top of its folder.
const FILES: [&str; 5] = ["summary.json", "series.csv", "particles.pvd", "scene.toml", "profile.json"];
/// Folders that a run makes and fills alone.
const FOLDERS: [&str; 2] = ["checkpoints", "frames"];
/// Endings of the pictures that a run makes at the top of its folder.
const PICTURES: [&str; 2] = ["png", "svg"];
/// Any one of these shows that a folder was made by a run. A scene file does
/// not: it may be the user's own.
const SIGNS: [&str; 3] = ["summary.json", "series.csv", "checkpoints"];

/// The folder of one run, with the places of its files. No other process can
/// write into it as a run while this lives.
#[derive(Debug, Clone)]
pub struct RunFolder {
    path: PathBuf,
    _lock: Option<Arc<File>>,
}

impl RunFolder {
    /// Makes the folder of a new run, with its subfolders.
    ///
    /// With `overwrite`, an earlier run in it is removed first: only the files
    /// that a run makes; whatever else lies there stays.
    ///
    /// # Errors
    /// When the folder holds anything and `overwrite` is not given, when it
    /// holds files but no run, when it is no folder, cannot be made, or is
    /// being written by another process.
    pub fn create(path: impl Into<PathBuf>, overwrite: bool) -> OutputResult<Self> {
        let path = path.into();
        if path.symlink_metadata().is_ok() && !path.is_dir() {
            return Err(OutputError::NotAFolder(path));
        }
        if path.is_dir() && !is_empty(&path)? {
            if !overwrite {
                return Err(OutputError::Occupied(path));
            }
            if !SIGNS.iter().any(|sign| path.join(sign).exists()) {
                return Err(OutputError::NotARun(path));
            }
            let run = Self::lock(path)?;
            remove_run(&run.path)?;
            return run.with_subfolders();
        }
        fs::create_dir_all(&path).map_err(OutputError::file("create the folder", &path))?;
        Self::lock(path)?.with_subfolders()
    }

    /// Opens the folder of an earlier run, to continue it, and removes the
    /// files that it could not finish.
    ///
    /// # Errors
    /// When there is no run in it, or another process writes into it.
    pub fn open(path: impl Into<PathBuf>) -> OutputResult<Self> {
        let path = path.into();
        if !path.join("checkpoints").is_dir() {
            return Err(OutputError::NoRun(path));
        }
        let run = Self::lock(path)?.with_subfolders()?;
        remove_unfinished(&run.path)?;
        remove_unfinished(&run.frames())?;
        Ok(run)
    }

    /// Takes the folder for this process. Where the system locks no folders, nothing is taken.
    fn lock(path: PathBuf) -> OutputResult<Self> {
        let folder = File::open(&path).ok();
        match folder.as_ref().map(File::try_lock) {
            Some(Err(TryLockError::WouldBlock)) => Err(OutputError::InUse(path)),
            _ => Ok(Self { path, _lock: folder.map(Arc::new) }),
        }
    }

    fn with_subfolders(self) -> OutputResult<Self> {
        for name in FOLDERS {
            let folder = self.path.join(name);
            fs::create_dir_all(&folder).map_err(OutputError::file("create the folder", &folder))?;
        }
        Ok(self)
    }

    /// The folder itself.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Any file of the run by its name, such as "period.png".
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// The machine-readable result of the run.
    pub fn summary(&self) -> PathBuf {
        self.file("summary.json")
    }

    /// The time series of the run.
    pub fn series(&self) -> PathBuf {
        self.file("series.csv")
    }

    /// The scene as it was run, every change to it included.
    pub fn scene(&self) -> PathBuf {
        self.file("scene.toml")
    }

    /// Writes the scene, all of it or nothing.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write_scene(&self, text: &str) -> OutputResult<()> {
        write_atomic(&self.scene(), |file| file.write_all(text.as_bytes()))
    }

    /// The trace of a profiled run.
    pub fn profile(&self) -> PathBuf {
        self.file("profile.json")
    }

    /// The index of the particle frames, by time.
    pub fn particles(&self) -> PathBuf {
        self.file("particles.pvd")
    }

    /// The folder of the checkpoints.
    pub fn checkpoints(&self) -> PathBuf {
        self.file("checkpoints")
    }

    /// The folder of the particle frames.
    pub fn frames(&self) -> PathBuf {
        self.file("frames")
    }
}

fn is_empty(path: &Path) -> OutputResult<bool> {
    Ok(entries(path)?.is_empty())
}

fn remove_run(folder: &Path) -> OutputResult<()> {
    let mut paths = entries(folder)?;
    // What shows that this is a run goes last: an interrupted removal can be taken up again.
    paths.sort_by_key(|path| path.file_name().is_some_and(|name| SIGNS.iter().any(|sign| name == *sign)));
    for path in paths {
        let kind = path.symlink_metadata().map_err(OutputError::file("inspect", &path))?;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if kind.is_dir() && FOLDERS.contains(&name.as_ref()) {
            fs::remove_dir_all(&path).map_err(OutputError::file("remove the folder", &path))?;
        } else if !kind.is_dir() && is_made_by_a_run(&path, &name) {
            // A link is removed, never followed.
            fs::remove_file(&path).map_err(OutputError::file("remove", &path))?;
        }
    }
    Ok(())
}

fn entries(folder: &Path) -> OutputResult<Vec<PathBuf>> {
    let unread = || OutputError::file("read the folder", folder);
    let entries = fs::read_dir(folder).map_err(unread())?;
    entries.map(|entry| Ok(entry.map_err(unread())?.path())).collect()
}

fn remove_unfinished(folder: &Path) -> OutputResult<()> {
    let unfinished = |path: &&PathBuf| {
        path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(UNFINISHED_PREFIX))
    };
    for path in entries(folder)?.iter().filter(unfinished) {
        fs::remove_file(path).map_err(OutputError::file("remove", path))?;
    }
    Ok(())
}

fn is_made_by_a_run(path: &Path, name: &str) -> bool {
    let ending = path.extension().unwrap_or_default();
    FILES.contains(&name)
        || FOLDERS.contains(&name)
        || name.starts_with(UNFINISHED_PREFIX)
        || PICTURES.iter().any(|picture| ending == *picture)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_new_folder_gets_its_subfolders_and_an_empty_one_is_taken() {
        let parent = tempfile::tempdir().unwrap();
        let run = RunFolder::create(parent.path().join("a/b"), false).unwrap();
        assert!(run.checkpoints().is_dir() && run.frames().is_dir());
        let empty = parent.path().join("empty");
        fs::create_dir(&empty).unwrap();
        assert!(RunFolder::create(&empty, false).is_ok());
        assert!(RunFolder::open(&empty).is_ok());
    }

    #[test]
    fn an_occupied_folder_is_refused_with_the_way_out() {
        let parent = tempfile::tempdir().unwrap();
        fs::write(parent.path().join("thesis.tex"), "dear").unwrap();
        let refusal = RunFolder::create(parent.path(), false).unwrap_err().to_string();
        assert!(refusal.contains("--out") && refusal.contains("--overwrite"), "{refusal}");
        assert!(refusal.contains(&parent.path().display().to_string()));
        let refusal = RunFolder::create(parent.path(), true).unwrap_err().to_string();
        assert!(refusal.contains("no earlier run"), "{refusal}");
        assert!(RunFolder::open(parent.path()).is_err());
    }

    #[test]
    fn overwriting_removes_the_run_and_nothing_else() {
        let parent = tempfile::tempdir().unwrap();
        let run = RunFolder::create(parent.path().join("run"), false).unwrap();
        for name in FILES.iter().chain(&["frames/0.vtp", "checkpoints/1", "a.png", "b.svg"]) {
            fs::write(run.file(name), "old").unwrap();
        }
        for name in ["notes.txt", "analysis.py"] {
            fs::write(run.file(name), "mine").unwrap();
        }
        let run = RunFolder::create(path_of(run), true).unwrap();
        let mut names: Vec<_> = fs::read_dir(run.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        assert_eq!(names, ["analysis.py", "checkpoints", "frames", "notes.txt"]);
        assert!(is_empty(&run.frames()).unwrap() && is_empty(&run.checkpoints()).unwrap());
    }

    #[cfg(unix)]
    #[test]
    fn a_linked_folder_is_unlinked_not_emptied() {
        let parent = tempfile::tempdir().unwrap();
        let precious = parent.path().join("precious");
        fs::create_dir(&precious).unwrap();
        fs::write(precious.join("data"), "dear").unwrap();
        let run = RunFolder::create(parent.path().join("run"), false).unwrap();
        fs::remove_dir(run.frames()).unwrap();
        std::os::unix::fs::symlink(&precious, run.frames()).unwrap();
        RunFolder::create(path_of(run), true).unwrap();
        assert!(precious.join("data").exists());
    }

    /// Lets a folder go.
    fn path_of(run: RunFolder) -> PathBuf {
        run.path
    }

    #[cfg(unix)]
    #[test]
    fn a_folder_belongs_to_one_run_at_a_time() {
        let parent = tempfile::tempdir().unwrap();
        let run = RunFolder::create(parent.path().join("run"), false).unwrap();
        for refused in [RunFolder::create(run.path(), true), RunFolder::open(run.path())] {
            let refusal = refused.unwrap_err().to_string();
            assert!(refusal.contains("another run is writing"), "{refusal}");
        }
        fs::write(run.file(&format!("{UNFINISHED_PREFIX}x")), "half").unwrap();
        let run = RunFolder::open(path_of(run)).unwrap();
        assert_eq!(entries(run.path()).unwrap().len(), 2, "what was left unfinished is gone");
    }

    #[test]
    fn a_file_in_the_way_is_named() {
        let parent = tempfile::tempdir().unwrap();
        let file = parent.path().join("file");
        fs::write(&file, "").unwrap();
        let refusal = RunFolder::create(&file, true).unwrap_err().to_string();
        assert!(refusal.contains("is not a folder"), "{refusal}");
    }
}
