//! The command as its user sees it: output, verdicts and mistakes.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Parser;
use meniscus_engine::checkpoint::{Checkpoint, Clock, Column, Data, Role, file_name, write};

use super::failure::{Failure, Verdict};
use super::nearest::Place;
use super::print::number;
use super::statistics::{Histogram, Statistics};
use super::{Arguments, execute};

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

fn damage(file: &Path) {
    let mut bytes = fs::read(file).unwrap();
    let last = bytes.len() - 1;
    bytes[last] ^= 1;
    fs::write(file, bytes).unwrap();
}

#[test]
fn all_forms_of_the_command_are_understood() {
    parse(&["file"]).unwrap();
    parse(&["file", "--field", "a", "--field", "b", "--at", "-1 um,2"]).unwrap();
    parse(&["verify", "a", "b"]).unwrap();
    parse(&["diff", "a", "b", "--tolerance", "1e-3"]).unwrap();
    for wrong in [
        &[][..],
        &["file", "--json", "--csv"],
        &["file", "--at", "1"],
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
        "revision    0123abc",
        "checksums   good",
        "kinetic energy     34",
        "momentum z          4",
    ] {
        assert!(output.contains(part), "no `{part}` in\n{output}");
    }
    let density = output.lines().find(|line| line.contains("density"));
    let words: Vec<&str> = density.unwrap().split_whitespace().collect();
    assert_eq!(words, ["density", "d", "kg/m3", "998", "1000", "999", "0.816497", "1"]);
    assert!(!output.contains('█'));
    let inner = file.parent().unwrap();
    assert_eq!(good(&[text(inner)]), output);
}

#[test]
fn a_chosen_field_comes_alone_with_its_histogram() {
    let (_folder, run, _) = run_folder();
    let output = good(&[&run, "--field", "axial"]);
    assert!(output.contains('█') && output.contains("The axial."));
    assert!(!output.contains("density"), "{output}");
    let (_, result) = inspect(&[&run, "--field", "pressure"]);
    let message = result.unwrap_err().to_string();
    assert!(message.contains("`pressure`") && message.contains("`density`"));
}

#[test]
fn the_nearest_particle_is_shown() {
    let (_folder, run, _) = run_folder();
    let output = good(&[&run, "--at", "0,2.2um", "--json"]);
    let json: serde_json::Value = serde_json::from_str(&output).unwrap();
    assert_eq!(json["nearest"]["particle"], 2);
    let output = good(&[&run, "--at", "0,2.2um", "--field", "velocity_z"]);
    assert!(output.contains("index 2"), "{output}");
    let csv = good(&[&run, "--at", "1,1", "--field", "velocity_z", "--csv"]);
    assert_eq!(csv, "name,symbol,unit,value\nvelocity_z,v,m/s,-4.0\n");
}

#[test]
fn places_are_read_with_their_units() {
    let place: Place = "2.5 µm, -1e-3mm".parse().unwrap();
    assert!((place.radius - 2.5e-6).abs() < 1e-20 && (place.axial + 1e-6).abs() < 1e-20);
    for wrong in ["", "1", "1,", "a,b", "1 km,2", "inf,0", "1,2,3", "1 é,2"] {
        assert!(wrong.parse::<Place>().is_err(), "{wrong}");
    }
}

#[test]
fn machines_can_read_the_output() {
    let (_folder, run, file) = run_folder();
    let json: serde_json::Value = serde_json::from_str(&good(&[&run, "--json"])).unwrap();
    assert_eq!(json["step"], 12);
    assert_eq!(json["whole"], true);
    assert_eq!(json["fields"][5]["non_finite"], 1);
    assert_eq!(json["totals"][0]["value"], 8.0);
    let csv = good(&[text(&file), "--csv", "--field", "axial"]);
    let mut lines = csv.lines();
    assert!(lines.next().unwrap().starts_with("name,symbol,unit,role"));
    assert!(lines.next().unwrap().starts_with("axial,a,m,state,0.0,"));
}

#[test]
fn damage_and_bad_input_are_told_apart() {
    let (_folder, run, file) = run_folder();
    damage(&file);
    let (output, result) = inspect(&[&run]);
    assert!(output.contains("step        12") && output.contains("DAMAGED"));
    let damaged = format!("{:?}", Verdict::Bad.exit_code());
    let code = |result: Result<Verdict, Failure>| format!("{:?}", result.unwrap_err().exit_code());
    assert_eq!(code(result), damaged);
    let (_, result) = inspect(&["missing"]);
    assert_ne!(code(result), damaged);
    fs::remove_file(&file).unwrap();
    let (_, result) = inspect(&[&run]);
    assert_ne!(code(result), damaged);
}

#[test]
fn verify_names_each_file() {
    let (_folder, run, file) = run_folder();
    assert!(good(&["verify", &run, text(&file)]).contains("whole, step 12"));
    let other = file.with_file_name(file_name(13));
    write(&other, &sample()).unwrap();
    damage(&other);
    let (output, result) = inspect(&["verify", &run, "missing"]);
    assert_eq!(result.unwrap(), Verdict::Bad);
    assert_eq!(output.lines().count(), 3, "{output}");
    assert!(inspect(&["verify", "missing"]).1.is_err());
}

#[test]
fn diff_matches_by_identity() {
    let (_folder, run, file) = run_folder();
    let other = file.with_file_name("other");
    let mut changed = sample();
    for column in &mut changed.columns {
        match &mut column.data {
            Data::F64(values) => values.reverse(),
            Data::U32(values) => values.reverse(),
        }
    }
    write(&other, &changed).unwrap();
    let output = good(&["diff", &run, text(&other)]);
    assert!(output.contains("matched by identity"), "{output}");

    changed.columns[4].data = Data::F64(vec![-4.0, 3.0, 2.0, 1.5]);
    write(&other, &changed).unwrap();
    let (output, result) = inspect(&["diff", &run, text(&other), "--json"]);
    assert_eq!(result.unwrap(), Verdict::Bad);
    let json: serde_json::Value = serde_json::from_str(&output).unwrap();
    let field = &json["fields"][4];
    assert_eq!(field["largest"], 0.5);
    assert_eq!(field["root_mean_square"], 0.25);
    assert_eq!(field["first"]["particle"], 10);
    good(&["diff", &run, text(&other), "--tolerance", "0.125"]);
}

#[test]
fn diff_counts_what_only_one_file_has() {
    let (_folder, run, file) = run_folder();
    let other = file.with_file_name("other");
    let mut changed = sample();
    changed.columns.truncate(2);
    changed.columns[0].data = Data::F64(vec![1e-6; 3]);
    changed.columns[1].data = Data::F64(vec![0.0, f64::NAN, 2e-6]);
    changed.clock.step = 13;
    changed.clock.scalars.clear();
    write(&other, &changed).unwrap();
    let (output, result) = inspect(&["diff", &run, text(&other)]);
    assert_eq!(result.unwrap(), Verdict::Bad);
    for part in [
        "matched by order",
        "1 particles only in a",
        "field density only in a",
        "step 12 against 13",
        "gauge 0.5 against none",
        "inf",
    ] {
        assert!(output.contains(part), "no `{part}` in\n{output}");
    }
}

#[test]
fn numbers_are_short() {
    for (value, text) in [
        (0.0, "0"),
        (-12.0, "-12"),
        (0.5, "0.5"),
        (1.0 / 3.0, "0.333333"),
        (999.999_999_9, "1000"),
        (123_456.7, "123457"),
        (2.5e-6, "2.5e-6"),
        (-1e300, "-1e300"),
        (f64::NAN, "NaN"),
        (f64::NEG_INFINITY, "-inf"),
    ] {
        assert_eq!(number(value), text);
    }
}

#[test]
fn statistics_survive_awkward_values() {
    let huge = [f64::MAX, -f64::MAX, f64::INFINITY, f64::NAN];
    let statistics = Statistics::of(huge.into_iter());
    assert_eq!(statistics.non_finite, 2);
    let histogram = Histogram::of(huge.into_iter(), &statistics);
    assert_eq!(histogram.bins.first().unwrap().count, 1);
    assert_eq!(histogram.bins.last().unwrap().count, 1);
    let equal = Statistics::of([3.0; 5].into_iter());
    assert_eq!(equal.standard_deviation, Some(0.0));
    let histogram = Histogram::of([3.0; 5].into_iter(), &equal);
    assert_eq!(histogram.bins.len(), 1);
    assert_eq!(histogram.bins[0].count, 5);
    let none = Statistics::of([f64::NAN].into_iter());
    assert_eq!(none.mean, None);
    assert!(Histogram::of([f64::NAN].into_iter(), &none).bins.is_empty());
}
