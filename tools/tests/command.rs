//! The command as users call it: exit codes, what is written and what is not, resumed runs.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A drop of a few hundred particles that moves for some hundred steps.
const DROP: &str = r#"format = 1
title = "A coarse drop"
[parameters]
radius = "1 um"
[liquid]
density = "1000 kg/m3"
surface_tension = "0.074 N/m"
[[body]]
shape = { sphere = { radius = "radius" } }
velocity = { r = "-0.1 m/s * r/radius", z = "0.2 m/s * z/radius" }
[particles]
size = "90 nm"
[run]
until = "60 ns"
[output]
frames = 3
checkpoint_every = 60
[[measure]]
oscillation = { mode = 2, radius = "radius" }
[[measure]]
laplace-pressure = { radius = "radius" }
"#;

struct Place {
    folder: tempfile::TempDir,
}

impl Place {
    fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("drop.toml"), DROP).unwrap();
        Place { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn meniscus(&self, arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_meniscus"))
            .args(arguments)
            .current_dir(self.folder.path())
            .output()
            .unwrap()
    }

    /// Runs, and checks the exit code.
    fn expect(&self, code: i32, arguments: &[&str]) -> String {
        let output = self.meniscus(arguments);
        let said = said(&output);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}\n{said}");
        said
    }
}

fn said(output: &Output) -> String {
    let [out, error] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
    format!("{out}{error}")
}

/// Without the line breaks of long messages.
fn unwrapped(said: &str) -> String {
    said.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ")
}

fn summary(run: &Path) -> serde_json::Value {
    serde_json::from_str(&fs::read_to_string(run.join("summary.json")).unwrap()).unwrap()
}

fn newest(run: &Path) -> PathBuf {
    let files = fs::read_dir(run.join("checkpoints")).unwrap();
    let mut files: Vec<PathBuf> = files.map(|file| file.unwrap().path()).collect();
    files.sort();
    files.pop().unwrap()
}

#[test]
fn a_bad_scene_is_refused_before_anything_is_written() {
    let place = Place::new();
    for set in ["radius=-1 um", "method.scheme=none", "output.colour_by=mood", "nothing=1"] {
        let said = place.expect(2, &["run", "drop.toml", "--set", set]);
        assert!(!said.is_empty());
        assert!(!place.path("runs").exists(), "{set}");
    }
    let mixed = ["run", "drop.toml", "--set", "method.precision=mixed", "--set", "method.scheme=parshikov"];
    let said = place.expect(2, &mixed);
    assert!(said.contains("mixed precision") && said.contains("conservative"), "{said}");
    for command in ["plan", "run"] {
        let said = place.expect(2, &[command, "drop.toml", "--set", "output.colour_by=presure"]);
        assert!(said.contains("--set:1:") && said.contains("did you mean `pressure`?"), "{said}");
    }
    fs::write(place.path("binary.toml"), [0xff, 0xfe]).unwrap();
    let said = place.expect(2, &["run", "binary.toml"]);
    assert!(said.contains("save it in UTF-8"), "{said}");
    place.expect(2, &["run", "missing.toml"]);
    place.expect(2, &["run", "drop.toml", "--until", "3 kg"]);
    place.expect(2, &["plan", "missing.toml"]);
    place.expect(2, &["run"]);
    let said = unwrapped(&place.expect(2, &["resume", "nowhere"]));
    assert!(said.contains("no run in `nowhere`") && said.contains("name the folder of a run"), "{said}");
    assert!(!place.path("runs").exists());
}

#[test]
fn a_bad_value_is_blamed_on_its_option() {
    let place = Place::new();
    let run = ["run", "drop.toml"];
    for (option, value, found) in [
        ("--until", "3 kg", "`until` expects a time"),
        ("--until", "-1 s", "must be positive"),
        ("--steps", "-5", "must be a whole number from 1"),
        ("--threads", "-1", "-1 is not in 1..="),
        ("--threads", "65535", "or fewer, or leave it out"),
    ] {
        let said = unwrapped(&place.expect(2, &[&run[..], &[option, value]].concat()));
        assert!(said.contains(found) && said.contains(option) && !said.contains("--set"), "{said}");
        assert!(!said.contains("tip:"), "{said}");
    }
    let said = place.expect(2, &["study", "drop.toml", "--vary", "radius=1 um,-2 um"]);
    assert!(said.contains("[--vary:1:8]") && said.contains("radius=-2 um"), "{said}");
    for arguments in
        [&["at", "nowhere", "0", "0", "--count", "-1"][..], &["top", "nowhere", "r", "--count", "-1"]]
    {
        let said = place.expect(2, &[&["inspect"][..], arguments].concat());
        assert!(said.contains("-1 is not in 0..="), "{said}");
    }
    let said = place.expect(2, &["inspect", "diff", "a", "b", "--tolerance", "-1"]);
    assert!(said.contains("expected a number that is not negative"), "{said}");
    assert!(!place.path("runs").exists());
}

#[test]
fn a_run_leaves_all_its_results_and_is_not_overwritten() {
    let place = Place::new();
    let said = place.expect(0, &["run", "drop.toml"]);
    assert!(said.contains("sound speed") && said.contains("laplace-pressure"), "{said}");
    let run = place.path("runs/drop");
    for file in [
        "scene.toml",
        "summary.json",
        "series.csv",
        "particles.pvd",
        "laplace-pressure.png",
        "frames/step-000000000.png",
        "frames/step-000000000.vtp",
    ] {
        assert!(run.join(file).is_file(), "{file}");
    }
    let frames = fs::read_to_string(run.join("particles.pvd")).unwrap();
    assert_eq!(frames.matches("<DataSet").count(), 4, "{frames}");
    let summary = fs::read_to_string(run.join("summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["status"], "done");
    let version = place.expect(0, &["--version"]);
    let version = version.trim().strip_prefix("meniscus ").unwrap();
    assert_eq!(version.contains("(AVX-512)"), cfg!(target_feature = "avx512f"), "{version}");
    assert_eq!(summary["version"], version);
    // Less than a period has no frequency.
    assert_eq!(summary["measures"][0]["name"], "frequency");
    assert_eq!(summary["measures"][0]["value"], serde_json::Value::Null);
    let mut measures = summary["measures"].as_array().unwrap().iter();
    let pressure = measures.find(|measure| measure["name"] == "laplace-pressure").unwrap();
    let pressure = pressure["relative_error"].as_f64().unwrap();
    assert!(pressure.abs() < 0.1, "{pressure}");
    assert!(fs::read_dir(run.join("checkpoints")).unwrap().count() <= 3);
    let refusal = place.expect(2, &["run", "drop.toml"]);
    assert!(refusal.contains("--overwrite"), "{refusal}");
    let said = place.expect(0, &["run", "drop.toml", "--steps", "5", "--overwrite"]);
    assert!(said.contains("change of energy not known"), "one row tells of no change: {said}");
    place.expect(0, &["inspect", "verify", "runs/drop"]);
}

#[test]
fn a_resumed_run_ends_as_an_uninterrupted_one() {
    let place = Place::new();
    place.expect(0, &["run", "drop.toml", "--out", "whole", "--threads", "1"]);
    place.expect(0, &["run", "drop.toml", "--out", "cut", "--threads", "2", "--steps", "83"]);
    // The scene of the checkpoint says 83 steps; more are asked for than will be needed.
    place.expect(0, &["resume", "cut", "--steps", "100000"]);
    let (whole, cut) = (newest(&place.path("whole")), newest(&place.path("cut")));
    assert_eq!(whole.file_name(), cut.file_name());
    let paths = [whole, cut].map(|path| path.display().to_string());
    place.expect(0, &["inspect", "diff", &paths[0], &paths[1]]);
    let series = |run: &str| fs::read(place.path(run).join("series.csv")).unwrap();
    assert!(series("whole") == series("cut"));
    let frames = |run: &str| fs::read(place.path(run).join("particles.pvd")).unwrap();
    assert!(frames("whole") == frames("cut"));
    place.expect(2, &["resume", "nowhere"]);
    // What a step costs is that of the steps since.
    let summary = fs::read_to_string(place.path("cut/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let steps = summary["steps"].as_f64().unwrap() - 83.0;
    let particle_steps = summary["particles"].as_f64().unwrap() * steps;
    for stage in summary["stages"].as_array().unwrap() {
        let [seconds, nanoseconds] =
            ["seconds", "ns_per_particle_step"].map(|number| stage[number].as_f64().unwrap());
        assert!((nanoseconds * particle_steps - seconds * 1e9).abs() <= 1e-9 * seconds * 1e9, "{stage}");
    }
}

#[test]
fn a_resumed_run_knows_how_many_particles_there_were() {
    let place = Place::new();
    let fast =
        ["r=-40 m/s * r/radius", "z=40 m/s * z/radius"].map(|value| format!("body.0.velocity.{value}"));
    let set = ["--set", &fast[0], "--set", &fast[1]];
    place.expect(0, &[&["run", "drop.toml", "--out", "run", "--steps", "200"][..], &set].concat());
    let before = summary(&place.path("run"));
    assert_ne!(before["particles"], before["first_particles"]);
    place.expect(0, &["resume", "run", "--steps", "201"]);
    assert_eq!(summary(&place.path("run"))["first_particles"], before["first_particles"]);
}

#[test]
fn a_run_that_was_killed_on_its_way_to_a_new_end_goes_there() {
    let place = Place::new();
    place.expect(0, &["run", "drop.toml", "--out", "run", "--steps", "83"]);
    // So far a resumed run comes that is killed before its first checkpoint.
    let scene = place.path("run/scene.toml");
    let text = fs::read_to_string(&scene).unwrap();
    fs::write(&scene, text.replace("steps = 83", "steps = 125")).unwrap();
    place.expect(0, &["resume", "run"]);
    assert_eq!(summary(&place.path("run"))["steps"], 125);
    let said = place.expect(0, &["resume", "run"]);
    assert!(said.contains("has reached its last step"), "{said}");
}

#[test]
fn a_damaged_index_of_frames_is_told_and_loses_none() {
    let place = Place::new();
    place.expect(0, &["run", "drop.toml", "--out", "run", "--steps", "83"]);
    let (index, list) = (place.path("run/frames/index.json"), place.path("run/particles.pvd"));
    let (whole, before) = (fs::read(&index).unwrap(), fs::read(&list).unwrap());
    fs::write(&index, &whole[..whole.len() / 2]).unwrap();
    let said = place.expect(1, &["inspect", "verify", "run"]);
    assert!(said.contains("index.json`: no index of frames"), "{said}");
    let said = unwrapped(&place.expect(2, &["resume", "run", "--steps", "10000"]));
    assert!(said.contains("index.json") && said.contains("remove it"), "{said}");
    assert!(fs::read(&list).unwrap() == before);
    fs::remove_file(&index).unwrap();
    let said = place.expect(0, &["resume", "run", "--steps", "10000"]);
    assert!(said.contains("particles.pvd begins anew at step 83"), "{said}");
}

#[test]
fn an_end_that_has_passed_is_refused() {
    let place = Place::new();
    place.expect(0, &["run", "drop.toml", "--out", "run", "--steps", "83"]);
    let files = ["run/scene.toml", "run/summary.json", "run/series.csv"];
    let before = files.map(|name| fs::read(place.path(name)).unwrap());
    for (end, way_out) in [
        (["--steps", "10"], "end after 10 steps: choose more with --steps"),
        (["--until", "1 ns"], "choose a later time with --until"),
        // The steps that it was limited to are done as well.
        (["--until", "1 us"], "end after 83 steps: choose more with --steps"),
    ] {
        let said = unwrapped(&place.expect(2, &[&["resume", "run"][..], &end].concat()));
        assert!(said.contains("at step 83") && said.contains(way_out), "{said}");
        assert!(files.map(|name| fs::read(place.path(name)).unwrap()) == before, "{end:?}");
    }
    // The same end once more is no mistake.
    place.expect(0, &["resume", "run", "--steps", "83"]);
    place.expect(0, &["resume", "run", "--steps", "84"]);
}

/// A body with less area than a particle, which is found only when it is filled.
const SLIVER: &str =
    r#"body.0.shape={ polygon = { points = [["1 um", "0 um"], ["2 um", "1 um"], ["2 um", "1.0001 um"]] } }"#;

#[test]
fn an_earlier_run_stays_until_the_new_one_can_start() {
    let place = Place::new();
    place.expect(0, &["run", "drop.toml", "--out", "run", "--steps", "20"]);
    let before = summary(&place.path("run"));
    for (set, reason) in [
        ("particles.size=1e-30 m", "choose a particle size of"),
        (SLIVER, "`body.0` cannot be filled with particles: the"),
    ] {
        let said = place.expect(2, &["run", "drop.toml", "--out", "run", "--overwrite", "--set", set]);
        assert!(unwrapped(&said).contains(reason), "{said}");
        assert_eq!(summary(&place.path("run")), before);
        place.expect(2, &["run", "drop.toml", "--out", "new", "--set", set]);
        assert!(!place.path("new").exists());
    }
    place.expect(0, &["run", "drop.toml", "--out", "run", "--overwrite", "--steps", "21"]);
    assert_eq!(summary(&place.path("run"))["steps"], 21);
}

#[test]
fn a_scene_does_not_overwrite_itself() {
    let place = Place::new();
    place.expect(0, &["run", "drop.toml", "--out", "run", "--steps", "5"]);
    let run = place.path("run");
    let before = ["scene.toml", "series.csv"].map(|name| fs::read(run.join(name)).unwrap());
    for arguments in [["run", "run/scene.toml", "--out", "run"], ["run", "run/scene.toml", "--out", "./run/"]]
    {
        let said = unwrapped(&place.expect(2, &[&arguments[..], &["--steps", "6", "--overwrite"]].concat()));
        assert!(said.contains("`run/scene.toml` would be replaced") && said.contains("--out DIR"), "{said}");
    }
    assert_eq!(["scene.toml", "series.csv"].map(|name| fs::read(run.join(name)).unwrap()), before);
    place.expect(0, &["run", "drop.toml", "--out", "run", "--steps", "6", "--overwrite"]);
}

#[test]
fn what_a_measure_cannot_find_and_a_liquid_too_viscous_are_told() {
    let place = Place::new();
    let said = place.expect(0, &["run", "drop.toml", "--set", "measure.1.laplace-pressure.centre=8 um"]);
    assert!(said.contains("`laplace-pressure` cannot be told: no particles are where it looks"), "{said}");
    let viscous = ["run", "drop.toml", "--out", "viscous", "--set", "liquid.viscosity=1e3 Pa s"];
    let said = place.expect(1, &viscous);
    assert!(said.contains("viscous time step of particle") && said.contains("lower the viscosity"), "{said}");
    assert!(!said.contains("cost per particle and step") && !said.contains("NaN"), "{said}");
}

#[test]
fn a_blow_up_is_told_with_its_last_state() {
    let place = Place::new();
    // It closes on the axis with two thousand times its sound speed.
    let set = ["--set", "liquid.sound_speed=1 m/s", "--set", "body.0.velocity.r=-2 km/s * r/radius"];
    let arguments = [&["run", "drop.toml", "--out", "broken"][..], &set].concat();
    let output = place.meniscus(&arguments);
    let said = said(&output);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("in stage"), "{said}");
    let checkpoints = fs::read_dir(place.path("broken/checkpoints")).unwrap();
    let mut names = checkpoints.map(|file| file.unwrap().file_name().into_string().unwrap());
    assert!(names.any(|name| name.starts_with("crash-step-")));
    let summary = fs::read_to_string(place.path("broken/summary.json")).unwrap();
    assert!(summary.contains(r#""status": "failed""#), "{summary}");
}

#[cfg(target_os = "linux")]
#[test]
fn results_that_cannot_be_printed_are_no_success() {
    let place = Place::new();
    let full = fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_meniscus"))
        .args(["run", "drop.toml", "--steps", "2"])
        .current_dir(place.folder.path())
        .stdout(full)
        .output()
        .unwrap();
    let said = said(&output);
    assert!(output.status.code() == Some(1) && said.contains("cannot write the output"), "{said}");
    assert!(place.path("runs/drop/summary.json").exists());
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_stops_after_a_checkpoint() {
    let place = Place::new();
    let child = Command::new(env!("CARGO_BIN_EXE_meniscus"))
        .args(["run", "drop.toml", "--out", "run", "--until", "1 s", "--quiet"])
        .current_dir(place.folder.path())
        .spawn();
    let mut child = child.unwrap();
    let series = place.path("run/series.csv");
    let rows = || fs::read_to_string(&series).map_or(0, |text| text.lines().count());
    while rows() < 3 && child.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let kill = |signal: &str| {
        let identity = child.id().to_string();
        Command::new("kill").args([signal, &identity]).status().unwrap()
    };
    kill("-INT");
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let summary = fs::read_to_string(place.path("run/summary.json")).unwrap();
    assert!(summary.contains(r#""status": "interrupted""#), "{summary}");
    let newest = newest(&place.path("run")).display().to_string();
    place.expect(0, &["inspect", "verify", &newest]);
}

#[cfg(unix)]
#[test]
fn an_interruption_while_particles_are_placed_stops_and_keeps_what_is_there() {
    use std::io::{BufRead, BufReader};
    let place = Place::new();
    let interrupted = |out: &str, more: &[&str]| {
        let mut child = Command::new(env!("CARGO_BIN_EXE_meniscus"))
            .args(["run", "drop.toml", "--out", out, "--set", "particles.size=1.5 nm"])
            .args(more)
            .current_dir(place.folder.path())
            .stderr(std::process::Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stderr.take().unwrap()).lines().map(Result::unwrap);
        lines.find(|line| line.starts_with("results in")).unwrap();
        assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
        let told: Vec<String> = lines.filter(|line| !line.contains("placing particles:")).collect();
        assert_eq!(child.wait().unwrap().code(), Some(130));
        unwrapped(&told.join("\n"))
    };
    // A new folder holds the scene, with which the run begins anew.
    let told = interrupted("run", &[]);
    assert!(told.contains("were placed") && told.contains("`meniscus resume run`"), "{told}");
    assert!(!place.path("run/series.csv").exists() && place.path("run/scene.toml").exists());
    // In one that holds a run this stays.
    place.expect(0, &["run", "drop.toml", "--out", "earlier", "--steps", "2", "-q"]);
    let told = interrupted("earlier", &["--overwrite"]);
    assert!(told.contains("the earlier run in `earlier` stays"), "{told}");
    place.expect(0, &["inspect", "fields", "earlier"]);
}

#[test]
fn plans_and_completions_write_nothing() {
    let place = Place::new();
    let plan = place.expect(0, &["plan", "drop.toml", "--fields"]);
    for part in ["left out", "shifting", "time step", "particles of 90.0 nm", "read by integrate"] {
        assert!(plan.contains(part), "{part} is not in\n{plan}");
    }
    assert!(place.expect(0, &["inspect", "at", "--help"]).contains("less `domain.origin`"));
    assert!(place.expect(0, &["completions", "bash"]).contains("_meniscus"));
    assert_eq!(fs::read_dir(place.folder.path()).unwrap().count(), 1);
}
