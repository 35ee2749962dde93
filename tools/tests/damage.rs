//! Files that are damaged or foreign, disks that are full, folders that cannot be written or vanish: one
//! clear message each, and nothing that was written before is lost.
#![cfg(unix)]

use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use xxhash_rust::xxh3::xxh3_64;

const DROP: &str = r#"format = 1
[liquid]
density = "1000 kg/m3"
surface_tension = "0.074 N/m"
[[body]]
shape = { sphere = { radius = "1 um" } }
[particles]
size = "100 nm"
[run]
until = "1 s"
steps = 60
[output]
frames = 0
checkpoint_every = 20
"#;

struct Place {
    folder: tempfile::TempDir,
}

impl Place {
    /// A folder with a run of sixty steps, of which the checkpoints after 20, 40 and 60 are kept.
    fn with_run() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("drop.toml"), DROP).unwrap();
        let place = Place { folder };
        place.expect(0, &["run", "drop.toml", "--out", "run"]);
        place
    }

    fn checkpoint(&self, step: u64) -> PathBuf {
        self.folder.path().join(format!("run/checkpoints/step-{step:09}.meniscus"))
    }

    fn command(&self, program: &Path, arguments: &[&str]) -> Command {
        let mut command = Command::new(program);
        command.args(arguments).args(["--quiet", "--threads", "1"]).current_dir(self.folder.path());
        command
    }

    fn meniscus(&self, arguments: &[&str]) -> Command {
        self.command(Path::new(env!("CARGO_BIN_EXE_meniscus")), arguments)
    }

    /// Runs, checks the exit code, and gives back what was said.
    fn expect(&self, code: i32, arguments: &[&str]) -> String {
        said(code, &self.meniscus(arguments).output().unwrap())
    }

    /// All files of the run's checkpoints with their bytes.
    fn checkpoints(&self) -> Vec<(PathBuf, Vec<u8>)> {
        let files = fs::read_dir(self.folder.path().join("run/checkpoints")).unwrap();
        let mut files: Vec<PathBuf> = files.map(|file| file.unwrap().path()).collect();
        files.sort();
        files.into_iter().map(|path| (path.clone(), fs::read(path).unwrap())).collect()
    }
}

fn said(code: i32, output: &Output) -> String {
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(code), "{error}");
    // Long lines are wrapped for the terminal.
    error.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ")
}

fn flip(path: &Path, byte: usize) {
    let mut bytes = fs::read(path).unwrap();
    bytes[byte] ^= 4;
    fs::write(path, bytes).unwrap();
}

#[test]
fn a_damaged_checkpoint_is_passed_over() {
    let place = Place::with_run();
    let whole = fs::read(place.checkpoint(60)).unwrap();
    flip(&place.checkpoint(60), 9000);
    let shortened = fs::read(place.checkpoint(40)).unwrap();
    fs::write(place.checkpoint(40), &shortened[..5000]).unwrap();
    let told = place.expect(0, &["resume", "run"]);
    assert!(told.contains("passed over") && told.contains("step-000000060.meniscus.damaged"), "{told}");
    assert!(told.contains("continues from") && told.contains("step-000000020"), "{told}");
    assert!(fs::read(place.checkpoint(60)).unwrap() == whole, "the steps were taken again");
    assert_eq!(place.checkpoints().len(), 5, "damaged files stay for a look");
}

#[test]
fn without_any_whole_checkpoint_nothing_is_touched() {
    let place = Place::with_run();
    for step in [20, 40, 60] {
        flip(&place.checkpoint(step), 9000);
    }
    let before = place.checkpoints();
    let told = place.expect(2, &["resume", "run"]);
    assert!(told.contains("found no valid checkpoint among 3 files"), "{told}");
    assert!(place.checkpoints() == before);
}

#[test]
fn results_without_checkpoints_are_not_overwritten() {
    let place = Place::with_run();
    let run = place.folder.path().join("run");
    place.checkpoints().iter().for_each(|(path, _)| fs::remove_file(path).unwrap());
    let results = || ["series.csv", "summary.json"].map(|name| fs::read(run.join(name)).ok());
    // A run that was killed has no summary yet.
    for step in ["with a summary", "without one"] {
        let before = results();
        let told = place.expect(2, &["resume", "run"]);
        assert!(told.contains("no checkpoint any more") && told.contains("--out DIR"), "{step}: {told}");
        assert!(results() == before);
        fs::remove_file(run.join("summary.json")).ok();
    }
    // Nothing has been recorded before the first step.
    fs::remove_file(run.join("series.csv")).unwrap();
    place.expect(0, &["resume", "run"]);
}

#[test]
fn newer_formats_and_other_byte_orders_are_refused() {
    let place = Place::with_run();
    let whole = fs::read(place.checkpoint(60)).unwrap();
    let mut newer = whole.clone();
    newer[8] = 9;
    let checksum = xxh3_64(&newer[..4088]);
    newer[4088..4096].copy_from_slice(&checksum.to_le_bytes());
    let mut swapped = whole;
    swapped[4088..4096].reverse();
    for (bytes, sentence) in [(newer, "format version 9"), (swapped, "most significant byte first")] {
        fs::write(place.checkpoint(60), bytes).unwrap();
        let before = place.checkpoints();
        let told = place.expect(2, &["resume", "run"]);
        assert!(told.contains(sentence) && told.contains("step-000000060"), "{told}");
        assert!(place.checkpoints() == before);
    }
}

#[test]
fn a_series_that_is_damaged_or_missing_is_told() {
    let place = Place::with_run();
    let series = place.folder.path().join("run/series.csv");
    let whole = fs::read_to_string(&series).unwrap();
    fs::write(&series, format!("{whole}what is this?\n")).unwrap();
    let told = place.expect(2, &["resume", "run", "--steps", "80"]);
    assert!(told.contains("series.csv") && told.contains("remove it to go on"), "{told}");
    fs::remove_file(&series).unwrap();
    let told = place.expect(0, &["resume", "run", "--steps", "80"]);
    assert!(told.contains("is missing: the series begins anew at step 60"), "{told}");
}

#[test]
fn a_series_that_lacks_rows_is_refused() {
    let place = Place::with_run();
    let series = place.folder.path().join("run/series.csv");
    let whole = fs::read_to_string(&series).unwrap();
    let lines: Vec<&str> = whole.split_inclusive('\n').collect();
    let inner = [&lines[..3], &lines[4..]].concat().concat();
    for (text, hole) in [(lines[..4].concat(), "20 and 70"), (inner, "10 and 30")] {
        fs::write(&series, &text).unwrap();
        let told = place.expect(2, &["resume", "run", "--steps", "80"]);
        assert!(told.contains("series.csv") && told.contains(&format!("between steps {hole}")), "{told}");
        assert!(fs::read_to_string(&series).unwrap() == text);
        let scene = fs::read_to_string(place.folder.path().join("run/scene.toml")).unwrap();
        assert!(scene.contains("steps = 60"), "the end stays as it was: {scene}");
        let mut verify = Command::new(env!("CARGO_BIN_EXE_meniscus"));
        let output = verify.args(["inspect", "verify", "run"]).current_dir(place.folder.path()).output();
        let output = output.unwrap();
        let listed = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.code() == Some(1) && listed.contains(&format!("steps {hole} are")), "{listed}");
    }
    fs::write(&series, lines[0]).unwrap();
    let told = place.expect(0, &["resume", "run", "--steps", "80"]);
    assert!(told.contains("the series begins anew"), "{told}");
}

#[test]
fn a_checkpoint_of_another_scene_is_refused() {
    let place = Place::with_run();
    let scene = place.folder.path().join("run/scene.toml");
    let text = fs::read_to_string(&scene).unwrap();
    fs::write(&scene, text.replace("1000 kg/m3", "900 kg/m3")).unwrap();
    let before = place.checkpoints();
    let told = place.expect(2, &["resume", "run", "--steps", "80"]);
    assert!(told.contains("another scene") && told.contains("scene.toml"), "{told}");
    assert!(place.checkpoints() == before);
    // How far a run goes makes no other scene.
    fs::write(&scene, text.replace("steps = 60", "steps = 70")).unwrap();
    place.expect(0, &["resume", "run", "--steps", "80"]);
}

/// A limit on the length of files stands for a full disk: writes fail in the middle of a checkpoint.
#[test]
fn a_full_disk_leaves_what_was_there() {
    let place = Place::with_run();
    let before = place.checkpoints();
    let limited = "trap '' XFSZ; ulimit -f 40; exec \"$0\" \"$@\"";
    let program = env!("CARGO_BIN_EXE_meniscus");
    let arguments = ["-c", limited, program, "resume", "run", "--steps", "100"];
    let output = place.command(Path::new("sh"), &arguments).output().unwrap();
    let told = said(1, &output);
    assert!(told.contains("cannot write the checkpoint") && told.contains("free space"), "{told}");
    assert!(place.checkpoints() == before, "no file is changed, and no debris is left");
    place.expect(0, &["resume", "run", "--steps", "100"]);
    assert!(place.checkpoint(100).exists());
}

#[test]
fn a_folder_that_cannot_be_written_is_named() {
    let place = Place::with_run();
    let before = place.checkpoints();
    let root = place.folder.path();
    // Root may write anywhere: somebody else has to try, with a program that they can reach. Another process copies it: while
    // this one held it open to write, a test beside that starts a program would hand it on, and nobody could run it.
    let program = root.join("meniscus");
    let copied = Command::new("cp").arg(env!("CARGO_BIN_EXE_meniscus")).arg(&program).status().unwrap();
    assert!(copied.success());
    let allow = |path: &Path, mode| fs::set_permissions(path, fs::Permissions::from_mode(mode)).unwrap();
    let is_root = fs::metadata("/proc/self").is_ok_and(|own| std::os::unix::fs::MetadataExt::uid(&own) == 0);
    allow(root, 0o755);
    allow(&root.join("run"), 0o555);
    allow(&root.join("run/checkpoints"), 0o555);
    for arguments in [&["resume", "run", "--steps", "80"][..], &["run", "drop.toml", "--out", "run/inner"]] {
        let mut command = place.command(&program, arguments);
        if is_root {
            command.uid(65534).gid(65534);
        }
        let output = command.output().unwrap();
        let error = String::from_utf8_lossy(&output.stderr);
        assert!(matches!(output.status.code(), Some(1 | 2)), "{error}");
        assert!(error.contains("ermission denied") && error.contains("run"), "{error}");
    }
    allow(&root.join("run"), 0o755);
    allow(&root.join("run/checkpoints"), 0o755);
    assert!(place.checkpoints() == before);
}

#[test]
fn a_folder_that_vanishes_is_told() {
    let place = Place::with_run();
    let mut command = place.meniscus(&["resume", "run", "--steps", "1000000"]);
    let child = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let started = Instant::now();
    // Any later checkpoint will do: each of them lies there for a moment only, until three newer ones are written.
    let newest = || {
        fs::read_dir(place.folder.path().join("run/checkpoints"))
            .unwrap()
            .map(|file| file.unwrap().path())
            .max()
    };
    while newest().unwrap() <= place.checkpoint(60) {
        assert!(started.elapsed() < Duration::from_secs(60), "the run does not get there");
        std::thread::sleep(Duration::from_millis(5));
    }
    let run = place.folder.path().join("run");
    fs::rename(&run, place.folder.path().join("elsewhere")).unwrap();
    let told = said(1, &child.wait_with_output().unwrap());
    assert!(told.contains("run/checkpoints") && told.contains("check that the path"), "{told}");
    assert_eq!(told.matches("cannot").count(), 1, "{told}");
    let mut verify = Command::new(env!("CARGO_BIN_EXE_meniscus"));
    let verified = verify.args(["inspect", "verify", "elsewhere"]).current_dir(place.folder.path()).output();
    assert!(verified.unwrap().status.success(), "what was written before is whole");
}
