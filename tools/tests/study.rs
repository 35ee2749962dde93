//! `meniscus study` and `meniscus verify` as users call them.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

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
    let out = folder.path().join("out");
    for file in ["study.csv", "study.json", "study.png", "study.svg", "study.html", "runs/run-4/summary.json"]
    {
        assert!(out.join(file).is_file(), "{file}");
    }
    assert!(!out.join("runs/run-1/particles.pvd").exists());
    let table = fs::read_to_string(out.join("study.csv")).unwrap();
    assert_eq!(table.lines().count(), 5, "{table}");
    assert!(table.starts_with("particle_size,method.theta,laplace-pressure,"), "{table}");
    let page = fs::read_to_string(out.join("study.html")).unwrap();
    assert_eq!(page.matches("<circle").count(), 6, "two lines of two points, and their marks in the legend");
    let (code, said) = meniscus(folder.path(), &arguments);
    assert_eq!(code, Some(2), "{said}");
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
        &["study", "missing.toml", "--vary", "radius=1 um"],
        &["verify"],
        &["verify", "--level", "best"],
    ] {
        let (code, said) = meniscus(folder.path(), arguments);
        assert_eq!(code, Some(2), "{arguments:?}: {said}");
        assert!(!folder.path().join("runs").exists());
    }
}
