//! `meniscus study` and `meniscus verify` as users call them.

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

/// A very coarse drop that moves for a moment.
const DROP: &str = r#"format = 1
title = "A very coarse drop"
[parameters]
radius = "2.5 um"
particle_size = "400 nm"
[liquid]
density = "1000 kg/m3"
surface_tension = "0.074 N/m"
[[body]]
shape = { sphere = { radius = "radius" } }
[particles]
size = "particle_size"
[run]
until = "100 ns"
[[measure]]
laplace-pressure = { radius = "radius" }
"#;

fn meniscus(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let command = Command::new(env!("CARGO_BIN_EXE_meniscus")).args(arguments).current_dir(folder).output();
    let Output { status, stdout, stderr } = command.unwrap();
    let [out, error] = [stdout, stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
    (status.code(), out + &error)
}

#[test]
fn a_study_leaves_its_table_plot_and_page() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("drop.toml"), DROP).unwrap();
    let arguments = [
        "study",
        "drop.toml",
        "--vary",
        "particle_size=400 nm,radius/8",
        "--vary",
        "method.theta=.5,.6",
        "--out",
        "out",
    ];
    let (code, said) = meniscus(folder.path(), &arguments);
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("laplace-pressure") && said.contains("in all"), "{said}");
    assert!(!said.contains(" 0.0 "), "small costs have digits: {said}");
    let out = folder.path().join("out");
    for file in ["study.csv", "study.json", "study.png", "study.svg", "study.html", "runs/run-4/summary.json"]
    {
        assert!(out.join(file).is_file(), "{file}");
    }
    assert!(!out.join("runs/run-1/particles.pvd").exists());
    let table = fs::read_to_string(out.join("study.csv")).unwrap();
    assert_eq!(table.lines().count(), 5, "{table}");
    assert!(table.starts_with("particle_size,method.theta,laplace-pressure,"), "{table}");
    assert_eq!(table.matches(",done\n").count(), 4, "{table}");
    let page = fs::read_to_string(out.join("study.html")).unwrap();
    assert_eq!(page.matches("<circle").count(), 6, "two lines of two points, and their marks in the legend");
    let (code, said) = meniscus(folder.path(), &arguments);
    assert_eq!(code, Some(2), "{said}");
    // What a smaller study does not replace goes; what is the user's own stays.
    let (plain, _) = DROP.split_once("[[measure]]").unwrap();
    fs::write(folder.path().join("plain.toml"), plain).unwrap();
    let fewer = ["study", "plain.toml", "--vary", "particle_size=400 nm", "--out", "out", "--overwrite"];
    for own in ["notes.txt", "runs/run-4/mine.txt"] {
        fs::write(out.join(own), "mine").unwrap();
    }
    let (code, said) = meniscus(folder.path(), &fewer);
    assert_eq!(code, Some(0), "{said}");
    assert!(!out.join("study.png").exists() && !out.join("runs/run-2").exists());
    assert!(out.join("notes.txt").exists() && !out.join("runs/run-4/summary.json").exists());
    assert!(out.join("runs/run-1/summary.json").exists() && out.join("runs/run-4/mine.txt").exists());
    // Files of the same names are no study, nor are other runs.
    let other = folder.path().join("other");
    fs::create_dir_all(&other).unwrap();
    fs::rename(out.join("runs/run-1"), other.join("drop")).unwrap();
    fs::rename(&other, folder.path().join("runs")).unwrap();
    fs::write(folder.path().join("study.json"), "mine").unwrap();
    let (code, said) = meniscus(folder.path(), &[&fewer[..4], &["--out", ".", "--overwrite"]].concat());
    assert!(code == Some(2) && said.contains("no earlier run"), "{said}");
    assert!(folder.path().join("runs/drop/summary.json").exists());
}

#[test]
fn bad_input_is_refused_before_anything_runs() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("drop.toml"), DROP).unwrap();
    for arguments in [
        &["study", "drop.toml"][..],
        &["study", "drop.toml", "--vary", "particle_size"],
        &["study", "drop.toml", "--vary", "particle_size=400 nm,1 kg"],
        &["study", "drop.toml", "--vary", "radius=1 um", "--set", "radius=2 um"],
        &["study", "drop.toml", "--vary", "particle_size=400 nm,1e-30 m"],
        &["study", "drop.toml", "--vary", "output.colour_by=speed,mood"],
        &["study", "missing.toml", "--vary", "radius=1 um"],
        &["verify"],
        &["verify", "--level", "best"],
    ] {
        let (code, said) = meniscus(folder.path(), arguments);
        assert_eq!(code, Some(2), "{arguments:?}: {said}");
        assert!(!folder.path().join("runs").exists());
    }
}

#[test]
fn what_was_done_before_a_scene_that_cannot_start_is_kept() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("drop.toml"), DROP).unwrap();
    let shapes = r#"body.0.shape={ sphere = { radius = "radius" } },
        { polygon = { points = [["1 um", "0 um"], ["5 um", "4 um"], ["5 um", "4.0001 um"]] } }"#;
    let (code, said) = meniscus(folder.path(), &["study", "drop.toml", "--vary", shapes, "--out", "out"]);
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("cannot be filled") && said.contains("interrupted after 1 of 2 runs"), "{said}");
    let table = fs::read_to_string(folder.path().join("out/study.csv")).unwrap();
    assert_eq!(table.matches(",done\n").count(), 1, "{table}");
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_is_marked_and_doubts_are_told_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("drop.toml"), DROP).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_meniscus"));
    command.args(["study", "drop.toml", "--vary", "run.until=100 ns,1 s,2 s", "--out", "out", "--quiet"]);
    command.args(["--set", "liquid.sound_speed=50 m/s", "--threads", "1"]).current_dir(path);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let rows =
        || fs::read_to_string(path.join("out/runs/run-2/series.csv")).map_or(0, |text| text.lines().count());
    while rows() < 3 && child.try_wait().unwrap().is_none() {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let Output { status, stdout, stderr } = child.wait_with_output().unwrap();
    let [out, error] = [stdout, stderr].map(|text| String::from_utf8_lossy(&text).into_owned());
    assert_eq!(status.code(), Some(130), "{error}");
    assert!(error.contains("interrupted after 1 of 3 runs"), "{error}");
    assert_eq!(error.matches('⚠').count(), 1, "{error}");
    assert_eq!(out.matches("interrupted").count(), 1, "{out}");
    let table = fs::read_to_string(path.join("out/study.csv")).unwrap();
    assert!(table.contains(",done\n") && table.ends_with(",interrupted\n"), "{table}");
    let page = fs::read_to_string(path.join("out/study.html")).unwrap();
    assert!(page.contains("interrupted after 1 of 3 runs"), "{page}");
}

#[test]
fn what_a_run_cannot_tell_is_said_with_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let scene = DROP.replace("laplace-pressure = { radius", "oscillation = { mode = 2, radius");
    fs::write(folder.path().join("drop.toml"), scene).unwrap();
    for options in [&["--out", "out"][..], &["--out", "quiet", "--quiet"]] {
        let arguments = ["study", "drop.toml", "--vary", "method.theta=.5,.6"];
        let (code, said) = meniscus(folder.path(), &[&arguments, options].concat());
        assert_eq!(code, Some(0), "{said}");
        for run in ["1/2 run-1", "2/2 run-2"] {
            assert!(said.contains(&format!("{run}: `frequency` cannot be told: ")), "{said}");
        }
    }
}

#[test]
fn a_run_that_a_measure_does_not_apply_to_keeps_its_columns() {
    let folder = tempfile::tempdir().unwrap();
    let scene = DROP.replace("laplace-pressure = { radius", "oscillation = { mode = 2, radius");
    fs::write(folder.path().join("drop.toml"), scene).unwrap();
    // Too viscous to oscillate, the second has no exact values.
    let viscosities = "liquid.viscosity=0 Pa s,0.5 Pa s";
    let arguments = ["study", "drop.toml", "--vary", viscosities, "--out", "out", "--quiet"];
    let (code, said) = meniscus(folder.path(), &arguments);
    assert_eq!(code, Some(0), "{said}");
    let page = fs::read_to_string(folder.path().join("out/study.html")).unwrap();
    let cells = |row: &str| row.matches("</td>").count() + row.matches("</th>").count();
    let rows: Vec<usize> = page.split("<tr>").skip(1).map(cells).collect();
    assert!(rows.len() == 3 && rows.iter().all(|cells| *cells == rows[0]), "{rows:?}\n{page}");
}
