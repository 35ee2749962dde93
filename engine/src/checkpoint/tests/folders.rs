//! The checkpoints of one run beside each other.

use super::*;

/// A checkpoint after a number of steps.
fn at_step(step: u64) -> Checkpoint {
    let mut checkpoint = sample(5);
    checkpoint.clock.step = step;
    checkpoint
}

#[test]
fn a_file_of_another_step_than_its_name_tells_is_passed_over() {
    let folder = tempfile::tempdir().unwrap();
    for (name, step) in [(60, 60), (120, 90)] {
        write(&folder.path().join(file_name(name)), &at_step(step)).unwrap();
    }
    let (path, found, skipped) = newest_valid(folder.path()).unwrap();
    assert_eq!((path.file_name().unwrap().to_str(), found.clock.step), (Some(&*file_name(60)), 60));
    let reason = skipped[0].1.to_string();
    assert!(
        skipped[0].1.is_damage() && reason.contains("step 90") && reason.contains("expected 120"),
        "{reason}"
    );
    assert!(check_name(Path::new("mine.meniscus"), 90).is_ok());
    assert!(check_name(Path::new(&crash_file_name(9)), 90).is_err());
}

/// Damaged files must not push out whole ones.
#[test]
fn a_file_that_is_set_aside_counts_no_longer() {
    let folder = tempfile::tempdir().unwrap();
    for step in [60, 120, 180, 240] {
        write(&folder.path().join(file_name(step)), &at_step(step)).unwrap();
    }
    for step in [120, 180, 240] {
        fs::write(folder.path().join(file_name(step)), "cut off").unwrap();
    }
    let (path, _, skipped) = newest_valid(folder.path()).unwrap();
    for (damaged, _) in &skipped {
        let aside = set_aside(damaged).unwrap();
        assert!(aside.to_str().unwrap().ends_with(".meniscus.damaged"));
    }
    write(&folder.path().join(file_name(70)), &sample(5)).unwrap();
    keep_last(folder.path(), 3).unwrap();
    assert!(path.exists());
    assert_eq!(list(folder.path()).unwrap().len(), 2);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 5, "nothing is lost");
}

#[test]
fn the_newest_whole_file_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let error = newest_valid(folder.path()).unwrap_err();
    assert!(!error.is_damage(), "{error}");
    for step in [7, 80, 900, 12_345_678_901] {
        write(&folder.path().join(file_name(step)), &at_step(step)).unwrap();
    }
    fs::write(folder.path().join("step-+99.meniscus"), "no checkpoint").unwrap();
    let crash = folder.path().join(crash_file_name(99_999_999_999));
    fs::write(&crash, "nothing goes on from here").unwrap();
    assert_eq!(list(folder.path()).unwrap().len(), 4);
    assert_eq!(list_crashes(folder.path()).unwrap(), [(99_999_999_999, crash)]);
    let newest = folder.path().join(file_name(12_345_678_901));
    fs::write(&newest, "cut off").unwrap();
    let (path, found, skipped) = newest_valid(folder.path()).unwrap();
    assert_eq!(path, folder.path().join("step-000000900.meniscus"));
    assert_eq!(found.clock.step, 900);
    assert_eq!(skipped.len(), 1);
    assert_eq!(skipped[0].0, newest);
    for step in [7, 80, 900] {
        fs::write(folder.path().join(file_name(step)), "cut off").unwrap();
    }
    let error = newest_valid(folder.path()).unwrap_err();
    assert!(error.is_damage(), "{error}");
}

#[test]
fn only_the_last_files_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    for step in 0..5 {
        write(&folder.path().join(file_name(step)), &sample(2)).unwrap();
    }
    fs::write(folder.path().join(".xyz.unfinished"), "half").unwrap();
    fs::write(folder.path().join("notes.txt"), "mine").unwrap();
    keep_last(folder.path(), 2).unwrap();
    let steps = |found: Vec<(u64, PathBuf)>| found.into_iter().map(|(step, _)| step).collect();
    let left: Vec<u64> = steps(list(folder.path()).unwrap());
    assert_eq!(left, [3, 4]);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 3);
    keep_last(folder.path(), 0).unwrap();
    let left: Vec<u64> = steps(list(folder.path()).unwrap());
    assert_eq!(left, [4], "a run can always continue");
}

#[test]
fn a_missing_file_is_no_damage() {
    let folder = tempfile::tempdir().unwrap();
    for path in [folder.path().join("missing"), folder.path().to_path_buf()] {
        assert!(!read(&path).unwrap_err().is_damage());
    }
    assert!(write(&folder.path().join("missing/file"), &sample(1)).is_err());
}
