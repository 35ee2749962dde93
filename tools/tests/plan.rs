//! `plan` beside what the run then does.

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

/// A drop whose run takes a second or two: the trial sees a part of it.
const DROP: &str = r#"format = 1
title = "A drop"
[parameters]
radius = "1 um"
[liquid]
density = "1000 kg/m3"
surface_tension = "0.074 N/m"
[[body]]
shape = { sphere = { radius = "radius" } }
velocity = { r = "-0.1 m/s * r/radius", z = "0.2 m/s * z/radius" }
[particles]
size = "30 nm"
[run]
until = "600 ns"
[output]
frames = 2
"#;

fn meniscus(folder: &Path, arguments: &[&str]) -> String {
    let output =
        Command::new(env!("CARGO_BIN_EXE_meniscus")).args(arguments).current_dir(folder).output().unwrap();
    let [said, error] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
    assert!(output.status.success(), "{arguments:?}\n{said}{error}");
    said
}

/// What follows "about " in the one line that holds a text.
fn about<'a>(plan: &'a str, text: &str) -> &'a str {
    let line = plan.lines().find(|line| line.starts_with("about ") && line.contains(text));
    let line = line.unwrap_or_else(|| panic!("no line tells `{text}` in\n{plan}"));
    line.trim_start_matches("about ").split(text).next().unwrap()
}

/// Seconds of "2 min 10 s" or "850 ms".
fn seconds(text: &str) -> f64 {
    let words: Vec<&str> = text.split_whitespace().collect();
    let units = [("ms", 1e-3), ("s", 1.0), ("min", 60.0), ("h", 3600.0)];
    let value = |pair: &[&str]| {
        let unit = units.iter().find(|(name, _)| *name == pair[1]);
        pair[0].parse::<f64>().unwrap() * unit.unwrap_or_else(|| panic!("{text}")).1
    };
    words.chunks(2).map(value).sum()
}

#[test]
fn a_plan_foretells_steps_and_time_and_writes_nothing() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    fs::write(folder.join("drop.toml"), DROP).unwrap();
    let plan = meniscus(folder, &["plan", "drop.toml", "--threads", "1"]);
    assert!(plan.contains("(measured over ") && plan.contains("are placed"), "{plan}");
    assert_eq!(fs::read_dir(folder).unwrap().count(), 1);
    meniscus(folder, &["run", "drop.toml", "--threads", "1", "--quiet", "--out", "run"]);
    let summary = fs::read_to_string(folder.join("run/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();

    let steps = about(&plan, " steps to").chars().filter(char::is_ascii_digit).collect::<String>();
    let (steps, taken) = (steps.parse::<f64>().unwrap(), summary["steps"].as_f64().unwrap());
    assert!((steps / taken - 1.0).abs() < 0.02, "{steps} steps were foretold, {taken} were taken");
    // Idle machines come within a quarter; other work on this one may begin or end in between.
    let (told, took) = (seconds(about(&plan, " on 1 thread")), summary["wall_seconds"].as_f64().unwrap());
    assert!(told > took / 3.0 && told < took * 3.0, "{told} s were foretold, the run took {took} s");
}

#[test]
fn a_plan_of_few_steps_tells_how_far_they_go_and_draws_no_later_pictures() {
    let place = tempfile::tempdir().unwrap();
    fs::write(place.path().join("drop.toml"), DROP).unwrap();
    let plan = |set: &str| {
        let settings = ["--set", "particles.size=60 nm", "--set", "output.frames=40", "--set", set];
        meniscus(place.path(), &[&["plan", "drop.toml", "--threads", "1"], &settings[..]].concat())
    };
    let pictures = |plan: &str| {
        let (_, after) = plan.split_once(" for the steps, ").unwrap();
        seconds(after.split(" for pictures").next().unwrap())
    };
    let (whole, few) = (plan("run.steps=1000000"), plan("run.steps=12"));
    assert!(whole.contains(" steps to 600.0 ns"), "{whole}");
    assert!(few.contains("about 12 steps to ") && !few.contains("to 600.0 ns"), "{few}");
    // One picture instead of 41.
    assert!(pictures(&few) < pictures(&whole) / 4.0, "{few}{whole}");
}

#[cfg(unix)]
#[test]
fn a_plan_that_nobody_reads_is_no_error_and_one_that_cannot_be_written_is() {
    let place = tempfile::tempdir().unwrap();
    fs::write(place.path().join("drop.toml"), DROP).unwrap();
    let plan = |output: Stdio| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_meniscus"));
        command.args(["plan", "drop.toml", "--threads", "1"]).current_dir(place.path());
        command.stdout(output).stderr(Stdio::piped()).spawn().unwrap()
    };
    let mut child = plan(Stdio::piped());
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success() && output.stderr.is_empty(), "{output:?}");
    if let Ok(full) = fs::OpenOptions::new().write(true).open("/dev/full") {
        let output = plan(full.into()).wait_with_output().unwrap();
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{error}");
        assert!(error.contains("cannot write the output"), "{error}");
    }
}
