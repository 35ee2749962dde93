//! The folder of a run: made once, never overwritten by accident.

use std::fs::{self, File, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::atomic::{UNFINISHED_PREFIX, write_atomic};
use super::series;
use super::summary::Summary;
use super::{OutputError, OutputResult};
use clap::ValueEnum;
use meniscus_cases::measure::numbered;

/// Plain files that a run makes at the top of its folder.
const FILES: [&str; 5] = ["summary.json", "series.csv", "particles.pvd", "scene.toml", "profile.json"];
/// Folders that a run makes.
const FOLDERS: [&str; 2] = ["checkpoints", "frames"];
/// Either of these shows, by what it holds, that a folder was made by a run. A scene file does
/// not: it may be the user's own.
const SIGNS: [&str; 2] = ["summary.json", "series.csv"];

/// What a run draws at the top of its folder, one plot a measure: `NAME.png`, `NAME-2.svg` and so on. The names are
/// those of the variants, in small letters with hyphens.
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
#[allow(missing_docs, reason = "their names say it")]
pub enum PlotKind {
    Coalescence,
    Film,
    Growth,
    LaplacePressure,
    LargeOscillation,
    Oscillation,
    PinchOff,
    PlateauDensity,
    SemiAxis,
    Shock,
    Spread,
    SpuriousVelocity,
}

impl PlotKind {
    fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }
}

/// The folder of one run, with the places of its files. No other process can
/// write into it as a run while this lives.
#[derive(Debug, Clone)]
pub struct RunFolder {
    path: PathBuf,
    _lock: Option<Arc<File>>,
}

impl RunFolder {
    /// Takes the folder of a new run, and makes it where there is none. What an
    /// earlier run has left in it stays until [`Self::clear`].
    ///
    /// # Errors
    /// When the folder holds anything and `overwrite` is not given, when it
    /// holds files but no run, when it is no folder, cannot be made, or is
    /// being written by another process.
    pub fn take(path: impl Into<PathBuf>, overwrite: bool) -> OutputResult<Self> {
        let path = path.into();
        if path.symlink_metadata().is_ok() && !path.is_dir() {
            return Err(OutputError::NotAFolder(path));
        }
        if path.is_dir() && !is_empty(&path)? {
            if !overwrite {
                return Err(OutputError::Occupied(path));
            }
            if !is_run(&path)? {
                return Err(OutputError::NotARun(path));
            }
        }
        fs::create_dir_all(&path).map_err(OutputError::file("create the folder", &path))?;
        Self::lock(path)
    }

    /// Whether a new run would remove or rewrite a file.
    pub fn replaces(&self, file: &Path) -> bool {
        let paths = [file, &self.path].map(|path| path.canonicalize().ok());
        let [Some(file), Some(folder)] = paths else { return false };
        file.parent() == Some(&folder) && is_made_by_a_run(&name_of(&file))
    }

    /// Removes what an earlier run has left: only the files that a run makes,
    /// by their names; whatever else lies there stays. Makes the subfolders.
    ///
    /// # Errors
    /// When a file cannot be removed or a folder not be made.
    pub fn clear(&self) -> OutputResult<()> {
        remove_run(&self.path)?;
        self.make_subfolders()
    }

    /// Whether a run has begun in it: its scene is there.
    pub fn is_begun(&self) -> bool {
        self.scene().exists()
    }

    /// Gives up a folder in which a run could not begin: what it has made goes, and the folder, too, if that was all.
    pub fn give_up(&self) {
        // What cannot be removed stays: the run has failed for another reason.
        let _ = remove_run(&self.path);
        for folder in FOLDERS.map(|name| self.path.join(name)).iter().chain([&self.path]) {
            let _ = fs::remove_dir(folder);
        }
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
        let run = Self::lock(path)?;
        run.make_subfolders()?;
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

    fn make_subfolders(&self) -> OutputResult<()> {
        for name in FOLDERS {
            let folder = self.path.join(name);
            fs::create_dir_all(&folder).map_err(OutputError::file("create the folder", &folder))?;
        }
        Ok(())
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

    /// The plot of the `index`-th measure of a kind.
    pub fn plot(&self, kind: PlotKind, index: usize) -> PathBuf {
        self.file(&format!("{}.png", numbered(&kind.name(), index)))
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

/// Whether a run has written into a folder, or would have if nothing had stopped it.
pub(crate) fn is_run(folder: &Path) -> OutputResult<bool> {
    let [summary, series] = SIGNS.map(|sign| folder.join(sign));
    if Summary::read(&summary).is_ok() || series::begins(&series) {
        return Ok(true);
    }
    let checkpoints = folder.join(FOLDERS[0]);
    if !checkpoints.is_dir() {
        return Ok(false);
    }
    // Many programs have checkpoints: they must be a run's, or at least nothing else may be there.
    let inner = entries(&checkpoints)?;
    let all = entries(folder)?;
    let made = |path: &PathBuf| is_made_by_a_run(&name_of(path));
    Ok(match inner.is_empty() {
        true => all.iter().all(made),
        false => inner.iter().any(|path| is_checkpoint(&name_of(path))),
    })
}

fn remove_run(folder: &Path) -> OutputResult<()> {
    let mut paths = entries(folder)?;
    // What shows that this is a run goes last: an interrupted removal can be taken up again.
    paths.sort_by_key(|path| SIGNS.contains(&name_of(path).as_str()));
    for path in paths {
        let kind = path.symlink_metadata().map_err(OutputError::file("inspect", &path))?;
        match (name_of(&path).as_str(), kind.is_dir()) {
            ("checkpoints", true) => remove_files(&path, is_checkpoint)?,
            ("frames", true) => remove_files(&path, is_frame)?,
            // A link is removed, never followed.
            (name, false) if is_made_by_a_run(name) => remove(&path)?,
            _ => {}
        }
    }
    Ok(())
}

fn remove_files(folder: &Path, which: fn(&str) -> bool) -> OutputResult<()> {
    let paths = entries(folder)?;
    paths.iter().filter(|path| which(&name_of(path)) && !path.is_dir()).try_for_each(|path| remove(path))
}

/// Removes a file.
pub(crate) fn remove(path: &Path) -> OutputResult<()> {
    fs::remove_file(path).map_err(OutputError::file("remove", path))
}

/// The last part of a path.
pub(crate) fn name_of(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// What lies in a folder.
pub(crate) fn entries(folder: &Path) -> OutputResult<Vec<PathBuf>> {
    let unread = || OutputError::file("read the folder", folder);
    let entries = fs::read_dir(folder).map_err(unread())?;
    entries.map(|entry| Ok(entry.map_err(unread())?.path())).collect()
}

fn remove_unfinished(folder: &Path) -> OutputResult<()> {
    remove_files(folder, |name| name.starts_with(UNFINISHED_PREFIX))
}

/// Whether a run gives this name to anything at the top of its folder.
fn is_made_by_a_run(name: &str) -> bool {
    FILES.contains(&name)
        || FOLDERS.contains(&name)
        || name.starts_with(UNFINISHED_PREFIX)
        || [".png", ".svg"].iter().any(|ending| name.strip_suffix(ending).is_some_and(is_plot))
}

/// Whether this is `NAME` of a plot, or `NAME-2` and so on.
fn is_plot(name: &str) -> bool {
    let plain = name.trim_end_matches(|letter: char| letter.is_ascii_digit());
    let plain = if plain.len() < name.len() { plain.strip_suffix('-').unwrap_or(name) } else { name };
    PlotKind::from_str(plain, false).is_ok()
}

/// Whether a run gives this name to a checkpoint: a whole one, one of a crash, a damaged or an unfinished one.
fn is_checkpoint(name: &str) -> bool {
    let whole = name.strip_suffix(".damaged").unwrap_or(name);
    let plain = whole.strip_prefix("crash-").unwrap_or(whole);
    step_of(plain) == Some("meniscus") || (name.starts_with('.') && name.ends_with(".unfinished"))
}

/// Whether a run gives this name to anything among its frames.
fn is_frame(name: &str) -> bool {
    name == "index.json"
        || name.starts_with(UNFINISHED_PREFIX)
        || matches!(step_of(name), Some("png" | "vtp"))
}

/// The ending of a name such as `step-000000012.png`.
fn step_of(name: &str) -> Option<&str> {
    let (number, ending) = name.strip_prefix("step-")?.split_once('.')?;
    (number.len() >= 9 && number.bytes().all(|digit| digit.is_ascii_digit())).then_some(ending)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The folder of a new run that has begun.
    fn taken(path: impl Into<PathBuf>, overwrite: bool) -> OutputResult<RunFolder> {
        let run = RunFolder::take(path, overwrite)?;
        run.clear()?;
        Ok(run)
    }

    #[test]
    fn a_new_folder_gets_its_subfolders_and_an_empty_one_is_taken() {
        let parent = tempfile::tempdir().unwrap();
        let run = taken(parent.path().join("a/b"), false).unwrap();
        assert!(run.checkpoints().is_dir() && run.frames().is_dir());
        let empty = parent.path().join("empty");
        fs::create_dir(&empty).unwrap();
        assert!(taken(&empty, false).is_ok());
        assert!(RunFolder::open(&empty).is_ok());
    }

    #[test]
    fn an_occupied_folder_is_refused_with_the_way_out() {
        let parent = tempfile::tempdir().unwrap();
        fs::write(parent.path().join("thesis.tex"), "dear").unwrap();
        let refusal = taken(parent.path(), false).unwrap_err().to_string();
        assert!(refusal.contains("--out") && refusal.contains("--overwrite"), "{refusal}");
        assert!(refusal.contains(&parent.path().display().to_string()));
        let refusal = taken(parent.path(), true).unwrap_err().to_string();
        assert!(refusal.contains("no earlier run"), "{refusal}");
        assert!(RunFolder::open(parent.path()).is_err());
    }

    #[test]
    fn overwriting_removes_the_run_and_nothing_else() {
        let parent = tempfile::tempdir().unwrap();
        let run = taken(parent.path().join("run"), false).unwrap();
        let made = [
            "frames/step-000000000.vtp",
            "frames/step-000000000.png",
            "frames/index.json",
            "checkpoints/step-000000060.meniscus",
            "checkpoints/crash-step-000000061.meniscus",
            "checkpoints/step-000000040.meniscus.damaged",
            "checkpoints/.step.unfinished",
            "laplace-pressure.png",
            "pinch-off-2.svg",
        ];
        let plots = PlotKind::value_variants().iter().map(|&kind| run.plot(kind, 2));
        plots.for_each(|plot| fs::write(plot, "old").unwrap());
        for name in FILES.iter().chain(&made) {
            fs::write(run.file(name), "old").unwrap();
        }
        for name in ["photo.png", "figure.svg", "film-cut.png", "frames/talk.png", "checkpoints/model.pt"] {
            fs::write(run.file(name), "mine").unwrap();
        }
        let names = |folder: &Path| {
            let mut names: Vec<_> = entries(folder).unwrap().iter().map(|path| name_of(path)).collect();
            names.sort();
            names
        };
        let again = RunFolder::take(path_of(run), true).unwrap();
        assert!(again.summary().exists(), "nothing goes before the new run has anything to write");
        again.clear().unwrap();
        assert_eq!(names(again.path()), ["checkpoints", "figure.svg", "film-cut.png", "frames", "photo.png"]);
        assert_eq!(names(&again.frames()), ["talk.png"]);
        assert_eq!(names(&again.checkpoints()), ["model.pt"]);
    }

    #[test]
    fn checkpoints_of_another_program_are_no_run() {
        let parent = tempfile::tempdir().unwrap();
        let other = parent.path().join("checkpoints");
        fs::create_dir(&other).unwrap();
        fs::write(parent.path().join("train.py"), "mine").unwrap();
        assert!(RunFolder::take(parent.path(), true).is_err());
        fs::write(other.join("model.pt"), "dear").unwrap();
        assert!(RunFolder::take(parent.path(), true).is_err());
        fs::write(other.join("step-000000060.meniscus"), "a run's").unwrap();
        assert!(RunFolder::take(parent.path(), true).is_ok());
    }

    #[test]
    fn files_of_the_same_names_are_no_run() {
        let parent = tempfile::tempdir().unwrap();
        for (name, text) in
            [("series.csv", "a,b\n1,2\n"), ("summary.json", "{}"), ("film.png", "mine"), ("scene.toml", "")]
        {
            fs::write(parent.path().join(name), text).unwrap();
            let refusal = RunFolder::take(parent.path(), true).unwrap_err().to_string();
            assert!(refusal.contains("no earlier run"), "{name}: {refusal}");
        }
        fs::write(parent.path().join("series.csv"), "step,time [s]\n").unwrap();
        assert!(RunFolder::take(parent.path(), true).is_ok());
    }

    #[test]
    fn a_folder_that_was_taken_for_nothing_goes() {
        let parent = tempfile::tempdir().unwrap();
        let run = RunFolder::take(parent.path().join("run"), false).unwrap();
        run.give_up();
        assert!(!run.path().exists());
        let run = taken(parent.path().join("run"), false).unwrap();
        run.write_scene("a scene").unwrap();
        fs::write(run.file("notes.txt"), "mine").unwrap();
        run.give_up();
        let left: Vec<_> = entries(run.path()).unwrap().iter().map(|path| name_of(path)).collect();
        assert_eq!(left, ["notes.txt"]);
    }

    #[cfg(unix)]
    #[test]
    fn a_linked_folder_is_unlinked_not_emptied() {
        let parent = tempfile::tempdir().unwrap();
        let precious = parent.path().join("precious");
        fs::create_dir(&precious).unwrap();
        fs::write(precious.join("data"), "dear").unwrap();
        let run = taken(parent.path().join("run"), false).unwrap();
        fs::remove_dir(run.frames()).unwrap();
        std::os::unix::fs::symlink(&precious, run.frames()).unwrap();
        taken(path_of(run), true).unwrap();
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
        let run = taken(parent.path().join("run"), false).unwrap();
        for refused in [taken(run.path(), true), RunFolder::open(run.path())] {
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
        let refusal = taken(&file, true).unwrap_err().to_string();
        assert!(refusal.contains("is not a folder"), "{refusal}");
    }
}
