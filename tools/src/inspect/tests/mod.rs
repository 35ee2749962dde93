//! The command as its user sees it: output, verdicts and mistakes.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Parser;
use meniscus_engine::checkpoint::{Checkpoint, Clock, Column, Data, Role, file_name, write};

use super::at::length;
use super::failure::{Failure, Verdict};
use super::{Arguments, execute};

mod numbers;
mod whole;

#[derive(Parser)]
struct Command {
    #[command(flatten)]
    inspect: Arguments,
}

fn parse(arguments: &[&str]) -> Result<Arguments, clap::Error> {
    let words = std::iter::once(&"inspect").chain(arguments);
    Command::try_parse_from(words).map(|command| command.inspect)
}

fn inspect(arguments: &[&str]) -> (String, Result<Verdict, Failure>) {
    let mut output = Vec::new();
    let result = execute(&parse(arguments).unwrap(), &mut output);
    (String::from_utf8(output).unwrap(), result)
}

fn good(arguments: &[&str]) -> String {
    let (output, result) = inspect(arguments);
    assert_eq!(result.unwrap(), Verdict::Good, "{output}");
    output
}

fn column(name: &str, unit: &str, data: Data) -> Column {
    Column {
        name: name.to_owned(),
        symbol: name[..1].to_owned(),
        unit: unit.to_owned(),
        about: format!("The {name}."),
        role: Role::State,
        data,
    }
}

/// Four particles on a line along the axis.
fn sample() -> Checkpoint {
    let column_of = |name, unit, values: [f64; 4]| column(name, unit, Data::F64(values.into()));
    Checkpoint {
        clock: Clock { step: 12, time: 2.5e-6, step_size: 1e-9, scalars: vec![("gauge".to_owned(), 0.5)] },
        scene: "title = \"A line\"\n".to_owned(),
        revision: "0123abc".to_owned(),
        columns: vec![
            column_of("radius", "m", [1e-6; 4]),
            column_of("axial", "m", [0.0, 1e-6, 2e-6, 3e-6]),
            column_of("mass", "kg", [2.0; 4]),
            column_of("velocity_r", "m/s", [1.0, 1.0, 1.0, 1.0]),
            column_of("velocity_z", "m/s", [1.0, 2.0, 3.0, -4.0]),
            column_of("density", "kg/m3", [1000.0, f64::NAN, 998.0, 999.0]),
            column("identity", "", Data::U32(vec![10, 11, 12, 13])),
        ],
    }
}

/// The run folder and its checkpoint's path.
fn run_folder() -> (tempfile::TempDir, String, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("checkpoints")).unwrap();
    let file = folder.path().join("checkpoints").join(file_name(12));
    write(&file, &sample()).unwrap();
    let name = folder.path().to_str().unwrap().to_owned();
    (folder, name, file)
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

#[test]
fn all_forms_of_the_command_are_understood() {
    for right in [
        &["file"][..],
        &["file", "--json"],
        &["file", "--field", "a", "--field", "b", "--csv"],
        &["file", "--at", "-1 um,2", "--json"],
        &["fields", "file", "a", "b", "--csv"],
        &["at", "file", "-1 um", "2", "--count", "3", "--fields", "a,b"],
        &["top", "file", "speed", "--smallest"],
        &["where", "file", "r < 1 um"],
        &["render", "file", "speed", "a.png", "--low", "-1", "--high", "1"],
        &["render", "file", "speed", "a.png", "--high", "1"],
        &["export", "file", "a.npy"],
        &["diagnose", "file", "--json"],
        &["verify", "a", "b"],
        &["diff", "a", "b", "--tolerance", "1e-3"],
    ] {
        parse(right).unwrap();
    }
    for wrong in [
        &[][..],
        &["file", "--json", "--csv"],
        &["file", "--at", "1"],
        &["fields", "file", "--json", "--csv"],
        &["at", "file", "1"],
        &["at", "file", "1 km", "2"],
        &["render", "file", "speed", "a.png", "--low", "nan"],
        &["verify"],
        &["diff", "a"],
        &["diff", "a", "b", "--tolerance", "-1"],
    ] {
        assert_eq!(parse(wrong).unwrap_err().exit_code(), 2, "{wrong:?}");
    }
}

#[test]
fn a_run_folder_shows_its_newest_checkpoint() {
    let (_folder, run, file) = run_folder();
    let older = Checkpoint::default();
    write(&file.with_file_name(file_name(3)), &older).unwrap();
    let output = good(&[&run]);
    for part in [
        "scene       A line",
        "step        12",
        "time        2.5e-6 s",
        "gauge = 0.5",
        "particles   4",
        "revision    0123abc, format 1",
        "checksums   good",
        "mass        8 kg",
        "momentum z  4 kg m/s",
        "kinetic energy 34 J",
    ] {
        assert!(output.contains(part), "no `{part}` in\n{output}");
    }
    let words = |name: &str| -> Vec<String> {
        let line = output.lines().find(|line| line.trim_start().starts_with(name));
        line.unwrap().split_whitespace().map(str::to_owned).collect()
    };
    assert_eq!(words("density "), ["density", "kg/m3", "998", "1000", "999", "1", "state"]);
    let inner = file.parent().unwrap();
    assert_eq!(good(&[text(inner)]), output);
}

#[test]
fn one_field_and_one_place_are_shown_to_scripts() {
    let (_folder, run, _) = run_folder();
    let json: serde_json::Value =
        serde_json::from_str(&good(&[&run, "--field", "density", "--field", "axial", "--json"])).unwrap();
    let fields = json["fields"].as_array().unwrap();
    assert_eq!(fields.len(), 2);
    assert_eq!((&fields[0]["name"], &fields[0]["mean"]), (&"density".into(), &999.0.into()));
    assert_eq!(fields[0]["non_finite"], 1);
    assert_eq!(json["totals"][1]["value"], 4.0);
    let csv = good(&[&run, "--field", "axial", "--csv"]);
    assert!(csv.lines().nth(1).unwrap().starts_with("axial,a,m,state,0.0,3e-6,"), "{csv}");
    assert_eq!(csv.lines().count(), 2);
    assert_eq!(good(&[&run, "--csv"]).lines().count(), 8);
    let json: serde_json::Value =
        serde_json::from_str(&good(&[&run, "--at", "0,2.2um", "--field", "mass", "--json"])).unwrap();
    assert_eq!(json["particles"][0]["particle"], 12);
    assert_eq!(json["particles"][0]["mass"], 2.0);
    let message = inspect(&[&run, "--field", "tension"]).1.unwrap_err().to_string();
    assert!(message.contains("`pressure`") && message.contains("`density`"));
}

#[test]
fn fields_come_with_their_statistics() {
    let (_folder, run, _) = run_folder();
    let output = good(&["fields", &run]);
    let density = output.lines().find(|line| line.contains("density"));
    let words: Vec<&str> = density.unwrap().split_whitespace().collect();
    assert_eq!(words, ["density", "d", "kg/m3", "998", "1000", "999", "0.816497", "1"]);
    assert!(!output.contains('█'));
    let output = good(&["fields", &run, "axial"]);
    assert!(output.contains('█') && output.contains("The axial."));
    assert!(output.contains("maximum at particle 13, r = 1e-6 m, z = 3e-6 m"), "{output}");
    assert!(!output.contains("density"), "{output}");
    let speeds = good(&["fields", &run, "speed"]);
    assert!(speeds.contains("speed") && speeds.contains("magnitude of the velocity"), "{speeds}");
    let (_, result) = inspect(&["fields", &run, "pressure"]);
    assert!(result.unwrap_err().to_string().contains("scene"), "a pressure needs the equation of state");
    let (_, result) = inspect(&["fields", &run, "tension"]);
    let message = result.unwrap_err().to_string();
    assert!(message.contains("`pressure`") && message.contains("`density`"));
    let csv = good(&["fields", &run, "--csv", "axial"]);
    let mut lines = csv.lines();
    assert!(lines.next().unwrap().starts_with("name,symbol,unit,role"));
    assert!(lines.next().unwrap().starts_with("axial,a,m,state,0.0,"));
}

#[test]
fn the_nearest_particle_is_shown() {
    let (_folder, run, _) = run_folder();
    let json = |arguments: &[&str]| -> serde_json::Value {
        serde_json::from_str(&good(&[arguments, &["--json"]].concat())).unwrap()
    };
    let found = json(&["at", &run, "0", "2.2um"]);
    assert_eq!(found["particles"][0]["particle"], 12);
    assert_eq!(found["units"]["distance"], "m");
    let csv = good(&["at", &run, "1", "1", "--fields", "velocity_z", "--csv", "--count", "2"]);
    let mut lines = csv.lines();
    assert_eq!(lines.next().unwrap(), "particle,distance,radius,axial,velocity_z");
    assert!(lines.next().unwrap().ends_with(",1e-6,3e-6,-4.0"), "{csv}");
    assert_eq!(lines.count(), 1);
}

#[test]
fn extremes_and_conditions_choose_particles() {
    let (_folder, run, _) = run_folder();
    let chosen = |arguments: &[&str]| -> Vec<u64> {
        let output = good(&[arguments, &["--json"]].concat());
        let json: serde_json::Value = serde_json::from_str(&output).unwrap();
        let particles = json["particles"].as_array().unwrap();
        particles.iter().map(|particle| particle["particle"].as_u64().unwrap()).collect()
    };
    assert_eq!(chosen(&["top", &run, "velocity_z", "--count", "2"]), [12, 11]);
    assert_eq!(chosen(&["top", &run, "velocity_z", "--smallest", "--count", "1"]), [13]);
    assert_eq!(chosen(&["top", &run, "velocity_z", "--magnitude", "--count", "1"]), [13]);
    assert_eq!(chosen(&["top", &run, "speed", "--count", "1"]), [13]);
    assert_eq!(chosen(&["top", &run, "density", "--count", "1"]), [11], "no number comes first");
    assert_eq!(chosen(&["where", &run, "density < 999.5 kg/m3 and z < 2.5 um"]), [12]);
    assert_eq!(chosen(&["where", &run, "density != density or speed > 4 m/s"]), [11, 13]);
    let text = good(&["where", &run, "mass > 1 kg", "--count", "3"]);
    assert!(text.starts_with("4 of 4 particles, the first 3:"), "{text}");
    assert!(good(&["where", &run, "mass > 3 kg"]).starts_with("0 of 4 particles"));
    let (_, result) = inspect(&["where", &run, "mass > 1 m"]);
    let told = result.unwrap_err().told();
    assert!(told.contains("cannot compare a mass and a length") || told.contains("cannot compare"), "{told}");
}

#[test]
fn lengths_are_read_with_their_units() {
    assert!((length("2.5 µm").unwrap() - 2.5e-6).abs() < 1e-20);
    assert!((length(" -1e-3mm").unwrap() + 1e-6).abs() < 1e-20);
    for wrong in ["", "a", "1 km", "inf", "1 é", "1,2"] {
        assert!(length(wrong).is_err(), "{wrong}");
    }
}

#[test]
fn machines_can_read_the_output() {
    let (_folder, run, _) = run_folder();
    let json: serde_json::Value = serde_json::from_str(&good(&[&run, "--json"])).unwrap();
    assert_eq!(json["step"], 12);
    assert_eq!(json["whole"], true);
    let json: serde_json::Value = serde_json::from_str(&good(&["fields", &run, "--json"])).unwrap();
    assert_eq!(json[5]["non_finite"], 1);
    assert_eq!(json[1]["maximum_at"]["particle"], 13);
    let json: serde_json::Value = serde_json::from_str(&good(&["verify", &run, "--json"])).unwrap();
    assert_eq!(json[0]["whole"], true);
}

#[test]
fn exports_are_not_written_over_one_another() {
    let (folder, run, _) = run_folder();
    for name in ["a.vtp", "a.csv", "a.npy"] {
        let path = folder.path().join(name);
        good(&["export", &run, text(&path)]);
        let bytes = fs::read(&path).unwrap();
        assert!(!bytes.is_empty());
        let (_, result) = inspect(&["export", &run, text(&path)]);
        assert!(result.unwrap_err().to_string().contains("--overwrite"));
        good(&["export", &run, text(&path), "--overwrite"]);
        assert_eq!(fs::read(&path).unwrap(), bytes);
    }
    let csv = fs::read_to_string(folder.path().join("a.csv")).unwrap();
    assert_eq!(csv.lines().nth(2).unwrap(), "1e-6,1e-6,2.0,1.0,2.0,NaN,11");
    // 4 records of 6 doubles and an index behind a head whose length is a multiple of 64.
    let array = fs::read(folder.path().join("a.npy")).unwrap();
    assert!(array.starts_with(b"\x93NUMPY\x01\x00") && (array.len() - 4 * 52).is_multiple_of(64));
    for wrong in ["a.xls", "a"] {
        let path = folder.path().join(wrong);
        assert!(inspect(&["export", &run, text(&path)]).1.is_err());
        assert!(!path.exists());
    }
    assert!(inspect(&["render", &run, "axial", "a.gif"]).1.is_err());
    let taken = folder.path().join("a.png");
    fs::create_dir(&taken).unwrap();
    let taken = inspect(&["render", &run, "axial", text(&taken), "--overwrite"]).1;
    assert!(taken.unwrap_err().to_string().contains("choose another name"));
}
