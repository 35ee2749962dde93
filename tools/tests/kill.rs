//! Runs that are killed at any moment, and resumed: nothing of their results may tell.
//!
//! `cargo test` kills a few times. Two thousand kills, with all that is checked here:
//!
//! ```text
//! MENISCUS_KILLS=2000 cargo test --release -p meniscus --test kill -- --nocapture
//! ```
#![cfg(unix)]

use std::ffi::OsString;
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant, SystemTime};

/// Some hundred particles that move; a checkpoint every few steps, so that many kills hit the writing of one. Its
/// pictures show more and more from one to the next.
const DROP: &str = r#"format = 1
title = "A drop that is killed"
[liquid]
density = "1000 kg/m3"
surface_tension = "0.074 N/m"
[[body]]
shape = { sphere = { radius = "1 um" } }
velocity = { r = "-0.1 m/s * r/(1 um)", z = "0.2 m/s * z/(1 um)" }
[particles]
size = "100 nm"
[run]
until = "40 ns"
steps = 150
[output]
frames = 8
series_every = 5
checkpoint_every = 4
[[measure]]
oscillation = { mode = 2, radius = "1 um" }
"#;

const KILLS: usize = 15;

struct Scene {
    folder: tempfile::TempDir,
}

impl Scene {
    fn new(text: &str) -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("drop.toml"), text).unwrap();
        Scene { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn start(&self, arguments: &[&str], threads: usize) -> Child {
        let mut command = Command::new(env!("CARGO_BIN_EXE_meniscus"));
        command.args(arguments).args(["--quiet", "--threads", &threads.to_string()]);
        command.current_dir(self.folder.path()).stdout(Stdio::null()).stderr(Stdio::null());
        command.spawn().unwrap()
    }

    /// Starts or resumes a run, whichever its folder allows.
    fn carry_on(&self, run: &str, threads: usize) -> Child {
        // Killed before it wrote its scene, a run leaves nothing to resume.
        match self.path(run).join("scene.toml").exists() {
            true => self.start(&["resume", run], threads),
            false => self.start(&["run", "drop.toml", "--out", run, "--overwrite"], threads),
        }
    }
}

/// Numbers at random, from a seed.
struct Random(u64);

impl Random {
    fn from_clock() -> Self {
        let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap();
        Random(now.as_nanos() as u64 | 1)
    }

    fn below(&mut self, limit: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % limit
    }
}

fn signal(child: &Child, signal: &str) {
    Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
}

fn files_of(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = fs::read_dir(folder).unwrap().map(|file| file.unwrap().path()).collect();
    files.sort();
    files
}

/// What must not tell of an interruption: the last checkpoint and the series byte for byte, and the
/// summary without what depends on the machine.
fn results(run: &Path) -> (Vec<u8>, Vec<u8>, serde_json::Value) {
    let checkpoints = files_of(&run.join("checkpoints"));
    assert!(checkpoints.len() <= 3 && !unfinished(run), "{checkpoints:?}");
    let summary = fs::read_to_string(run.join("summary.json")).unwrap();
    let mut summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let costs =
        ["wall_seconds", "cpu_seconds", "threads", "ns_per_particle_step", "core_ns_per_particle_step"];
    for cost in costs.iter().chain(&["stages"]) {
        assert!(summary.as_object_mut().unwrap().remove(*cost).is_some(), "{cost}");
    }
    let checkpoint = fs::read(checkpoints.last().unwrap()).unwrap();
    (checkpoint, fs::read(run.join("series.csv")).unwrap(), summary)
}

/// The frames and their lists, byte for byte: they must not tell of it either.
fn frames(run: &Path) -> Vec<(OsString, Vec<u8>)> {
    let mut files = files_of(&run.join("frames"));
    files.push(run.join("particles.pvd"));
    files.iter().map(|file| (file.file_name().unwrap().to_owned(), fs::read(file).unwrap())).collect()
}

/// Asserts that a run has the frames of another one.
fn assert_same_frames(run: &Path, other: &Path) {
    for (found, expected) in frames(run).iter().zip(&frames(other)) {
        assert!(found == expected, "{}: {:?} differs from {:?}", run.display(), found.0, expected.0);
    }
    assert_eq!(frames(run).len(), frames(other).len());
}

fn unfinished(run: &Path) -> bool {
    let files = fs::read_dir(run.join("checkpoints"));
    files.is_ok_and(|files| {
        files.into_iter().any(|file| file.unwrap().file_name().to_string_lossy().ends_with(".unfinished"))
    })
}

#[test]
fn a_killed_run_ends_as_an_uninterrupted_one() {
    let wanted = std::env::var("MENISCUS_KILLS").map_or(KILLS, |kills| kills.parse().unwrap());
    let scene = Scene::new(DROP);
    let mut random = Random::from_clock();
    println!("seed {}", random.0);
    let started = Instant::now();
    let whole = scene.start(&["run", "drop.toml", "--out", "whole"], 1).wait().unwrap();
    assert!(whole.success());
    let duration = started.elapsed().as_micros() as u64;
    let expected = results(&scene.path("whole"));

    let (mut kills, mut in_writes, mut runs, mut placing) = (0, 0, 0, 0);
    while kills < wanted {
        let run = format!("killed-{runs}");
        // Until a run comes to its end it is killed again and again, on one and two threads.
        loop {
            let mut child = scene.carry_on(&run, 1 + kills % 2);
            if kills < wanted {
                sleep(Duration::from_micros(random.below(duration / 3)));
                child.kill().unwrap();
            }
            let status = child.wait().unwrap();
            if status.signal().is_none() {
                assert!(status.success(), "{run}: {status}");
                break;
            }
            kills += 1;
            in_writes += usize::from(unfinished(&scene.path(&run)));
            placing += usize::from(!scene.path(&run).join("series.csv").exists());
        }
        runs += 1;
        let found = results(&scene.path(&run));
        assert!(found.0 == expected.0, "{run}: the last checkpoint differs");
        assert!(found.1 == expected.1, "{run}: the series differs");
        assert_eq!(found.2, expected.2, "{run}: the summary differs");
        assert_same_frames(&scene.path(&run), &scene.path("whole"));
        fs::remove_dir_all(scene.path(&run)).unwrap();
    }
    println!(
        "{kills} kills of {runs} runs, {in_writes} within the writing of a checkpoint, {placing} before \
         the particles were placed: all ended like the uninterrupted one"
    );
}

/// As if the run had been killed long after a checkpoint, when its pictures showed more already.
#[test]
fn frames_made_again_are_those_of_an_uninterrupted_run() {
    let scene = Scene::new(&DROP.replace("every = 4", "every = 60"));
    for run in ["whole", "killed"] {
        assert!(scene.start(&["run", "drop.toml", "--out", run], 1).wait().unwrap().success());
    }
    let checkpoints = files_of(&scene.path("killed/checkpoints"));
    for late in &checkpoints[1..] {
        fs::remove_file(late).unwrap();
    }
    assert!(scene.start(&["resume", "killed"], 1).wait().unwrap().success());
    assert_same_frames(&scene.path("killed"), &scene.path("whole"));
}

/// Waits until something is so, or the run has ended.
fn wait_for(child: &mut Child, condition: impl Fn() -> bool) {
    let started = Instant::now();
    while !condition() {
        assert!(child.try_wait().unwrap().is_none(), "the run has ended before its time");
        assert!(started.elapsed() < Duration::from_secs(60), "the run does not get there");
        sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_running_scene_checkpoints_and_goes_on() {
    let endless = DROP.replace("until = \"40 ns\"\nsteps = 150", "until = \"1 s\"");
    let scene = Scene::new(&endless.replace("every = 4", "every = 0"));
    let mut child = scene.start(&["run", "drop.toml", "--out", "run"], 1);
    let count = || fs::read_dir(scene.path("run/checkpoints")).map_or(0, Iterator::count);
    let series = scene.path("run/series.csv");
    wait_for(&mut child, || fs::read_to_string(&series).is_ok_and(|text| text.lines().count() > 3));
    let before = count();
    signal(&child, "-USR1");
    wait_for(&mut child, || count() > before);
    let refused = scene.start(&["resume", "run"], 1).wait().unwrap();
    assert_eq!(refused.code(), Some(2), "a run that goes on is not resumed");
    signal(&child, "-INT");
    assert_eq!(child.wait().unwrap().code(), Some(130));
}
