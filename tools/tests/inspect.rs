//! What `meniscus inspect` tells of checkpoints that runs have written.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

use meniscus_engine::checkpoint::{FORMAT_VERSION, read};

/// Two drops of 1 um and 0.5 um, the smaller one above, moving apart.
const DROPS: &str = r#"format = 1
title = "Two drops"
[liquid]
density = "1000 kg/m3"
surface_tension = "0.074 N/m"
[[body]]
shape = { sphere = { radius = "1 um" } }
[[body]]
shape = { sphere = { radius = "0.5 um", centre = "3 um" } }
velocity = { z = "2 m/s" }
[particles]
size = "100 nm"
[run]
until = "1 us"
steps = 20
[output]
frames = 0
"#;

/// The folder of a run of the two drops, made once for all tests.
fn run() -> &'static PathBuf {
    static RUN: OnceLock<(tempfile::TempDir, PathBuf)> = OnceLock::new();
    let (_, run) = RUN.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("drops.toml"), DROPS).unwrap();
        let run = folder.path().join("run");
        let scene = folder.path().join("drops.toml");
        let [scene, out] = [&scene, &run].map(|path| path.to_str().unwrap());
        let output = meniscus(&["run", scene, "--out", out, "--quiet", "--threads", "1"]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        (folder, run)
    });
    run
}

fn meniscus(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_meniscus")).args(arguments).output().unwrap()
}

fn said(arguments: &[&str]) -> String {
    let output = meniscus(&[&["inspect"], arguments].concat());
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {error}");
    String::from_utf8(output.stdout).unwrap()
}

fn json(arguments: &[&str]) -> serde_json::Value {
    serde_json::from_str(&said(&[arguments, &["--json"]].concat())).unwrap()
}

#[test]
fn a_diagnosis_finds_both_drops() {
    let run = run().to_str().unwrap();
    let diagnosis = json(&["diagnose", run]);
    let drops = diagnosis["drops"].as_array().unwrap();
    assert_eq!(drops.len(), 2);
    for (drop, (radius, velocity, centre)) in drops.iter().zip([(1e-6, 0.0, 0.0), (0.5e-6, 2.0, 3e-6)]) {
        let number = |name: &str| drop[name].as_f64().unwrap();
        assert!((number("radius") / radius - 1.0).abs() < 1e-3, "{drop}");
        assert!((number("mass") / number("volume") - 1000.0).abs() < 5.0, "{drop}");
        assert!((number("velocity_z") - velocity).abs() < 0.02, "{drop}");
        assert!((number("centre_z") - centre).abs() < 0.05e-6, "{drop}");
    }
    let particles: i64 = drops.iter().map(|drop| drop["particles"].as_i64().unwrap()).sum();
    let neighbours = diagnosis["neighbours"].as_object().unwrap();
    assert_eq!(neighbours.values().map(|count| count.as_i64().unwrap()).sum::<i64>(), particles);
    let surface = diagnosis["surface_particles"].as_i64().unwrap();
    assert!(surface > 20 && surface < particles / 2, "{surface}");
    assert_eq!(diagnosis["beyond_axis"], 0);
    let nearest = diagnosis["nearest_distance"]["mean"].as_f64().unwrap();
    assert!((0.8..1.1).contains(&nearest), "{nearest}");
    let reasons: Vec<&str> = diagnosis["bounds"]
        .as_array()
        .unwrap()
        .iter()
        .map(|bound| bound["reason"].as_str().unwrap())
        .collect();
    assert!(reasons.contains(&"acoustic") && reasons.contains(&"surface tension"), "{reasons:?}");
    let totals = diagnosis["totals"].as_array().unwrap();
    let total = |name: &str| totals.iter().find(|total| total["name"] == name).unwrap()["value"].as_f64();
    let volume = 4.0 / 3.0 * std::f64::consts::PI * (1e-18 + 0.125e-18);
    assert!((total("mass").unwrap() / (1000.0 * volume) - 1.0).abs() < 1e-3);
    assert!(total("kinetic energy").unwrap() > 0.0);
    let surface = 0.074 * 4.0 * std::f64::consts::PI * (1e-12 + 0.25e-12);
    assert!((total("surface energy").unwrap() / surface - 1.0).abs() < 0.01, "{totals:?}");
    assert!(diagnosis["missing"].as_array().unwrap().is_empty(), "{}", diagnosis["missing"]);
    let text = said(&["diagnose", run]);
    assert!(text.contains("2 drops") && text.contains("neighbours") && text.contains("time step"), "{text}");
}

#[test]
fn the_summary_names_the_stages() {
    let summary = json(&[run().to_str().unwrap()]);
    assert_eq!(summary["title"], "Two drops");
    let stages = summary["stages"].as_array().unwrap();
    assert!(stages.iter().any(|stage| stage == "integrate"), "{stages:?}");
    assert_eq!(summary["scalars"]["steps bound by acoustic"], 20.0);
}

#[test]
fn pressures_are_whole() {
    let run = run().to_str().unwrap();
    let top = json(&["top", run, "pressure", "--count", "1"]);
    // Twice the tension over the smaller radius, and some for the motion.
    let pressure = top["particles"][0]["pressure"].as_f64().unwrap();
    assert!((2.5e5..5e5).contains(&pressure), "{pressure}");
    let near = json(&["where", run, "r < 2*size and z > 2 um", "--count", "1000"]);
    assert!(near["particles"].as_array().unwrap().len() > 5);
}

#[test]
fn what_follows_from_fields_is_one_of_them() {
    let run = run().to_str().unwrap();
    let fields = json(&["fields", run, "density", "pressure", "speed", "size"]);
    let of = |name: &str| fields.as_array().unwrap().iter().find(|field| field["name"] == name).unwrap();
    // 2 sigma/R of the larger drop at least, and the smaller one's speed.
    assert!(of("pressure")["maximum"].as_f64().unwrap() > 1.4e5, "{fields}");
    assert!((of("speed")["maximum"].as_f64().unwrap() - 2.0).abs() < 0.2, "{fields}");
    assert_eq!(of("size")["histogram"]["bins"].as_array().unwrap().len(), 20);
    let summary = json(&[run, "--field", "pressure"]);
    assert_eq!(summary["fields"][0]["unit"], "Pa");
    assert!(said(&[run, "--csv", "--field", "speed"]).contains("speed,,m/s,derived"));
}

#[test]
fn bad_ranges_and_targets_are_refused_by_name() {
    let run = run().to_str().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let picture = folder.path().join("a.png");
    let picture = picture.to_str().unwrap();
    for range in
        [&["--low", "1", "--high", "0"][..], &["--low", "nan"], &["--high", "inf"], &["--high", "-1"]]
    {
        let output = meniscus(&[&["inspect", "render", run, "speed", picture], range].concat());
        assert_eq!(output.status.code(), Some(2), "{range:?}");
    }
    said(&["render", run, "speed", picture, "--low=-1"]);
    for name in ["no/a.csv", "no/a.vtp", "no/a.npy"] {
        let target = folder.path().join(name);
        let output = meniscus(&["inspect", "export", run, target.to_str().unwrap()]);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(error.contains(name) && !error.contains("unfinished"), "{error}");
    }
    if cfg!(target_os = "linux") {
        for arguments in [&["export", run, "/proc/a.csv"][..], &["render", run, "speed", "/proc/a.png"]] {
            let output = meniscus(&[&["inspect"][..], arguments].concat());
            let error = String::from_utf8(output.stderr).unwrap();
            assert!(output.status.code() == Some(2) && error.contains("choose another"), "{error}");
        }
    }
    let grouped = said(&["where", run, "(z > 2 um or r < 0.2 um) and not (r > 0.3 um)"]);
    assert!(grouped.contains("particles"), "{grouped}");
}

#[test]
fn a_summary_that_is_no_text_is_damaged() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("checkpoints")).unwrap();
    fs::write(folder.path().join("summary.json"), [0xff, 0xfe]).unwrap();
    let output = meniscus(&["inspect", "verify", folder.path().to_str().unwrap()]);
    let told = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(told.starts_with("DAMAGED") && told.contains("summary.json"), "{told}");
    // What cannot be read at all is no damage.
    let file = folder.path().join("summary.json");
    fs::remove_file(&file).unwrap();
    let output = meniscus(&["inspect", "verify", file.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(2));
}

#[test]
fn pictures_show_one_side_or_both() {
    let folder = tempfile::tempdir().unwrap();
    let width = |side: &str| {
        let path = folder.path().join(format!("{side}.png"));
        let name = path.to_str().unwrap();
        said(&["render", run().to_str().unwrap(), "speed", name, "--side", side]);
        let bytes = fs::read(path).unwrap();
        assert!(bytes.starts_with(b"\x89PNG"));
        bytes.len()
    };
    assert_ne!(width("one"), width("both"));
}

#[test]
fn a_reader_that_goes_is_no_error() {
    for arguments in [&["fields"][..], &["diagnose"], &["where"], &["verify"]] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_meniscus"));
        command.arg("inspect").args(arguments).arg(run());
        if arguments == ["where"] {
            command.args(["r > 0", "--count", "100000"]);
        }
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success() && output.stderr.is_empty(), "{arguments:?} {output:?}");
    }
}

#[test]
fn a_crash_is_explained() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("drop.toml");
    fs::write(&scene, DROPS).unwrap();
    let out = folder.path().join("run");
    let [scene, out] = [&scene, &out].map(|path| path.to_str().unwrap());
    let broken = meniscus(&[
        "run",
        scene,
        "--out",
        out,
        "--set",
        "run.steps=1000",
        "--set",
        "liquid.sound_speed=40 m/s",
        "--set",
        "body.0.velocity.r=-2000 m/s * r/(1 um)",
        "--set",
        "body.0.velocity.z=-2000 m/s * z/(1 um)",
    ]);
    assert_eq!(broken.status.code(), Some(1));
    let files = fs::read_dir(format!("{out}/checkpoints")).unwrap();
    let mut files = files.map(|file| file.unwrap().path().display().to_string());
    let crash = files.find(|file| file.contains("crash-")).unwrap();
    // Who names the folder is told of the crash first.
    let text = said(&[out]);
    let told = text.lines().next().unwrap();
    assert!(told.starts_with("BROKE DOWN"), "{text}");
    assert_eq!(text, said(&[&crash]));
    for part in
        [" of particle ", " in stage ", " at step ", "last good step is ", " neighbours", " from the axis"]
    {
        assert!(told.contains(part), "no `{part}` in {told}");
    }
    // The run's own words name the same particle.
    let error = String::from_utf8_lossy(&broken.stderr);
    let particle = told.split(" of particle ").nth(1).unwrap().split(' ').next().unwrap();
    assert!(error.contains(&format!("of particle {particle} at")), "{error}\n{told}");
    let diagnosis = json(&["diagnose", out]);
    assert!(diagnosis["crash"].as_str().unwrap().contains(" in stage "));
    assert!(json(&["fields", out]).as_array().unwrap().iter().any(|field| field["role"] == "derived"));
    // A run goes on from its last whole checkpoint, not from where it broke down: it comes there again.
    let before = fs::read(&crash).unwrap();
    let again = meniscus(&["resume", out]);
    let error = String::from_utf8_lossy(&again.stderr);
    assert_eq!(again.status.code(), Some(1), "{error}");
    let start = error.lines().find(|line| line.starts_with("continues from")).unwrap();
    assert!(start.contains("checkpoints/step-"), "{start}");
    assert!(error.contains(&format!("of particle {particle} at")), "{error}");
    assert!(fs::read(&crash).unwrap() == before);
    // A checkpoint beyond the crash is of a run that came through: it counts.
    let start = start.trim_start_matches("continues from ");
    fs::copy(start, format!("{out}/checkpoints/step-000099999.meniscus")).unwrap();
    assert!(!said(&[out]).contains("BROKE DOWN"));
}

/// A file of every released format comes out in the newest one, with all its bits; nothing else is touched.
#[test]
fn old_formats_are_converted() {
    let golden = |version: u32| {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../engine/tests-data");
        PathBuf::from(folder).join(format!("checkpoint-v{version}.meniscus"))
    };
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    for version in 1..=FORMAT_VERSION {
        let (old, new) = (golden(version), file(&format!("{version}.meniscus")));
        let told = said(&["convert", old.to_str().unwrap(), &new]);
        assert_eq!(told.contains("already"), version == FORMAT_VERSION, "{told}");
        assert_eq!(read(new.as_ref()).unwrap(), read(&old).unwrap());
        assert!(fs::read(new).unwrap() == fs::read(golden(FORMAT_VERSION)).unwrap());
    }
    let run = run().to_str().unwrap();
    let copy = file("run.meniscus");
    let told = json(&["convert", run, &copy]);
    assert_eq!(told["file"], *copy);
    assert_eq!(told["format"], FORMAT_VERSION);
    assert!(meniscus(&["inspect", "diff", run, &copy]).status.success());

    let refused = |from: &str, to: &str, why: &str| {
        let output = meniscus(&["inspect", "convert", from, to]);
        let error = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.code() == Some(2) && error.contains(why), "{error}");
    };
    let golden = golden(1).to_str().unwrap().to_owned();
    let before = fs::read(&copy).unwrap();
    refused(&golden, &copy, "--overwrite");
    assert!(fs::read(&copy).unwrap() == before);
    assert!(meniscus(&["inspect", "convert", &golden, &copy, "--overwrite"]).status.success());
    assert!(fs::read(&copy).unwrap() == fs::read(&golden).unwrap());
    // A header of a later version, as every version ends it with its checksum.
    let mut newer = fs::read(&golden).unwrap();
    newer[8] = FORMAT_VERSION as u8 + 1;
    let checksum = xxhash_rust::xxh3::xxh3_64(&newer[..4088]);
    newer[4088..4096].copy_from_slice(&checksum.to_le_bytes());
    fs::write(file("newer.meniscus"), newer).unwrap();
    let told = format!("found format version {}", FORMAT_VERSION + 1);
    refused(&file("newer.meniscus"), &file("none.meniscus"), &told);
    assert!(!PathBuf::from(file("none.meniscus")).exists());
}

/// The example of a reader in Python sees what `inspect` sees, and so does numpy in an exported array.
#[test]
fn python_reads_checkpoints_and_arrays() {
    let numpy = Command::new("python3").args(["-c", "import numpy"]).output();
    if !numpy.is_ok_and(|output| output.status.success()) {
        eprintln!("SKIPPED: python3 with numpy is not installed, so the reader in Python is not tested");
        return;
    }
    let run = run().to_str().unwrap();
    let summary = json(&[run]);
    let file = summary["file"].as_str().unwrap();
    let reader = concat!(env!("CARGO_MANIFEST_DIR"), "/../engine/src/checkpoint/read_checkpoint.py");
    let python = |arguments: &[&str]| -> serde_json::Value {
        let output = Command::new("python3").args(arguments).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let told = python(&[reader, file, "--json"]);
    for (name, other) in
        [("step", "step"), ("time", "time"), ("step_size", "step_size"), ("revision", "revision")]
    {
        assert_eq!(told[name], summary[other]);
    }
    assert_eq!(told["numbers"], summary["scalars"]);
    let fields = json(&["fields", run]);
    assert_eq!(told["fields"].as_object().unwrap().len(), fields.as_array().unwrap().len());
    for field in fields.as_array().unwrap() {
        let other = &told["fields"][field["name"].as_str().unwrap()];
        for part in ["unit", "role", "minimum", "maximum"] {
            assert_eq!(other[part], field[part], "{field}");
        }
        assert_eq!(other["particles"], summary["particles"]);
    }
    let folder = tempfile::tempdir().unwrap();
    let array = folder.path().join("drops.npy");
    said(&["export", run, array.to_str().unwrap()]);
    let script = "import json, numpy, sys; a = numpy.load(sys.argv[1]); \
                  print(json.dumps({n: float(a[n].max()) for n in a.dtype.names}))";
    let loaded = python(&["-c", script, array.to_str().unwrap()]);
    for field in fields.as_array().unwrap() {
        assert_eq!(loaded[field["name"].as_str().unwrap()], field["maximum"]);
    }
}
