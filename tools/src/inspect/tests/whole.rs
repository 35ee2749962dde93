//! Whether a file is whole, and where two of them part.

use super::*;

fn damage(file: &Path) {
    let mut bytes = fs::read(file).unwrap();
    let last = bytes.len() - 1;
    bytes[last] ^= 1;
    fs::write(file, bytes).unwrap();
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
fn verify_finds_files_that_do_not_belong_there() {
    let (_folder, run, file) = run_folder();
    let scene = Path::new(&run).join("scene.toml");
    fs::write(&scene, &sample().scene).unwrap();
    good(&["verify", &run]);
    fs::write(&scene, "title = \"Another\"\n").unwrap();
    let (output, result) = inspect(&["verify", &run]);
    assert!(result.unwrap() == Verdict::Bad && output.contains("another scene"), "{output}");
    fs::rename(&file, file.with_file_name(file_name(13))).unwrap();
    let (output, result) = inspect(&["verify", &run]);
    assert!(
        result.unwrap() == Verdict::Bad && output.contains("step 12") && output.contains("expected 13"),
        "{output}"
    );
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
