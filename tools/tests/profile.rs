//! `run --profile` and `resume --profile`: what they tell, that they change nothing, and the trace.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// A drop of some thousand particles: more than one chunk.
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
size = "25 nm"
[run]
until = "1 ms"
steps = 230
[output]
frames = 0
"#;

fn meniscus(folder: &Path, arguments: &[&str]) -> String {
    let output =
        Command::new(env!("CARGO_BIN_EXE_meniscus")).args(arguments).current_dir(folder).output().unwrap();
    let [said, error] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
    assert!(output.status.success(), "{arguments:?}\n{said}{error}");
    said
}

fn json(path: PathBuf) -> Value {
    serde_json::from_str(&fs::read_to_string(path).unwrap()).unwrap()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

#[test]
fn a_profile_tells_the_speed_of_every_stage_and_changes_nothing() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    fs::write(folder.join("drop.toml"), DROP).unwrap();
    meniscus(folder, &["run", "drop.toml", "--out", "plain", "--threads", "2"]);
    let said = meniscus(folder, &["run", "drop.toml", "--out", "profiled", "--threads", "2", "--profile"]);
    for part in ["imbalance", "pairs", "GB/s", "GFLOP/s", "flux"] {
        assert!(said.contains(part), "{part} is not in\n{said}");
    }

    // Nothing changes but what is told.
    let last = |run: &str| folder.join(run).join("checkpoints/step-000000230.meniscus");
    let paths = ["plain", "profiled"].map(|run| last(run).display().to_string());
    meniscus(folder, &["inspect", "diff", &paths[0], &paths[1]]);
    let series = |run: &str| fs::read(folder.join(run).join("series.csv")).unwrap();
    assert!(series("plain") == series("profiled"));
    let plain = json(folder.join("plain/summary.json"));
    assert!(plain.get("profile").is_none() && !folder.join("plain/profile.json").exists());

    let summary = json(folder.join("profiled/summary.json"));
    let particle_steps = number(&summary["particles"]) * number(&summary["steps"]);
    let stages = summary["profile"]["stages"].as_array().unwrap();
    assert_eq!(stages.len(), summary["stages"].as_array().unwrap().len());
    for stage in stages {
        let nanoseconds = number(&stage["ns_per_particle_step"]) * particle_steps;
        assert!((nanoseconds * 1e-9 / number(&stage["seconds"]) - 1.0).abs() < 1e-9, "{stage}");
        let busy = stage["busy"].as_array().unwrap();
        if !busy.is_empty() {
            let imbalance = number(&stage["imbalance"]);
            assert!(busy.len() == 2 && (1.0..=2.0).contains(&imbalance), "{stage}");
            let all: f64 = busy.iter().map(number).sum();
            // Of each call's time less than a nanosecond is cut off.
            assert!(all > 0.0 && all < 2.0 + 1e-3, "{stage}");
        }
    }
    let flux = stages.iter().find(|stage| stage["name"] == "flux").unwrap();
    assert!(!flux["busy"].as_array().unwrap().is_empty());
    let pairs = &flux["pairs"];
    let (each, speed) = (number(&pairs["per_particle_step"]), number(&pairs["per_nanosecond"]));
    let seconds = number(&flux["seconds"]);
    assert!((speed * seconds * 1e9 / (each * particle_steps) - 1.0).abs() < 1e-9, "{flux}");
    // 9.9 neighbours lie in a support of 2 D, more in a list with a skin and filled up.
    assert!((9.9..25.0).contains(&each), "{each} pairs a particle");
    // An index of 4 bytes, a neighbour's row of 64, and what is read and written of a particle itself.
    let bytes = number(&pairs["gigabytes_per_second"]) / speed;
    // A reconstructed contact with harmonic-mean weights, and the terms that this drop has.
    let operations = number(&pairs["gigaflops"]) / speed;
    let (contact, terms) = (50.0 + 3.0 + 37.0, [2.0, 10.0, 8.0, 4.0, 12.0]);
    // The gradient of the concentration is summed in every third step, from the first one on; lists are a little longer
    // in some than in others.
    let steps = number(&summary["steps"]);
    let gradient = 12.0 * (steps / 3.0).ceil() / steps;
    let expected = contact + terms.iter().sum::<f64>() + gradient;
    assert!((operations - expected).abs() < 0.01, "{operations} a pair, not {expected}");
    assert!(bytes > 68.0 && bytes < 68.0 + (64.0 + 8.0 * 24.0) / each, "{bytes} bytes a pair");
}

#[test]
fn a_trace_holds_the_first_steps_with_stages_and_chunks_within_them() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    fs::write(folder.join("drop.toml"), DROP).unwrap();
    meniscus(folder, &["run", "drop.toml", "--out", "run", "--threads", "2", "--profile"]);
    let trace = json(folder.join("run/profile.json"));
    let events = trace["traceEvents"].as_array().unwrap();
    let mut steps = Vec::new();
    let mut kinds: BTreeMap<&str, Vec<(f64, f64, &str)>> = BTreeMap::new();
    for event in events.iter().filter(|event| event["ph"] == "X") {
        let (kind, name) = (event["cat"].as_str().unwrap(), event["name"].as_str().unwrap());
        let (start, length) = (number(&event["ts"]), number(&event["dur"]));
        kinds.entry(kind).or_default().push((start, start + length, name));
        steps.extend(event["args"]["step"].as_u64());
    }
    assert_eq!(steps, (0..200).collect::<Vec<_>>(), "later steps are left out, each 1000th excepted");
    let names = events.iter().filter(|event| event["ph"] == "M").count();
    assert_eq!(names, 2, "both threads have a name");
    let within = |inner: (f64, f64), outer: (f64, f64)| inner.0 >= outer.0 && inner.1 <= outer.1 + 1e-3;
    for &(start, end, name) in &kinds["chunk"] {
        let mut stages = kinds["stage"].iter();
        let is_of = |group: &str| group.split(" + ").any(|stage| stage == name);
        let found = stages.find(|stage| is_of(stage.2) && within((start, end), (stage.0, stage.1)));
        assert!(found.is_some(), "a chunk of {name} at {start} lies in no stage or group of that name");
    }
    for &(start, end, name) in kinds["stage"].iter().filter(|stage| stage.2 != "outputs") {
        let found = kinds["step"].iter().any(|step| within((start, end), (step.0, step.1)));
        assert!(found, "{name} at {start} lies in no step");
    }
}

#[test]
fn a_run_that_goes_on_is_profiled_from_there() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path();
    fs::write(folder.join("drop.toml"), DROP).unwrap();
    meniscus(folder, &["run", "drop.toml", "--out", "whole", "--threads", "2"]);
    meniscus(folder, &["run", "drop.toml", "--out", "parts", "--threads", "2", "--steps", "100"]);
    let rest = ["resume", "parts", "--threads", "2", "--steps", "230", "--profile"];
    let said = meniscus(folder, &rest);
    for part in ["imbalance", "GFLOP/s", "flux"] {
        assert!(said.contains(part), "{part} is not in\n{said}");
    }
    let last = |run: &str| folder.join(run).join("checkpoints/step-000000230.meniscus");
    let paths = ["whole", "parts"].map(|run| last(run).display().to_string());
    meniscus(folder, &["inspect", "diff", &paths[0], &paths[1]]);

    let summary = json(folder.join("parts/summary.json"));
    let stages = summary["profile"]["stages"].as_array().unwrap();
    let flux = stages.iter().find(|stage| stage["name"] == "flux").unwrap();
    assert_eq!(flux["calls"], 130, "the stages of this part are told, not those of the part before");
    let nanoseconds = number(&flux["ns_per_particle_step"]) * number(&summary["particles"]) * 130.0;
    assert!((nanoseconds * 1e-9 / number(&flux["seconds"]) - 1.0).abs() < 1e-9, "{flux}");
    let trace = json(folder.join("parts/profile.json"));
    let events = trace["traceEvents"].as_array().unwrap();
    let steps: Vec<u64> = events.iter().filter_map(|event| event["args"]["step"].as_u64()).collect();
    assert_eq!(steps, (100..230).collect::<Vec<_>>());
}
