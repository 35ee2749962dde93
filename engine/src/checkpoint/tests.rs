//! Whatever is written comes back, and whatever is damaged is refused.

use std::fs;
use std::path::{Path, PathBuf};

use xxhash_rust::xxh3::xxh3_64;

use super::contents::Contents;
use super::header::{HEADER_LENGTH, Header, Section};
use super::*;

const GOLDEN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests-data/checkpoint-v1.meniscus");

fn column(name: &str, symbol: &str, unit: &str, role: Role, data: Data) -> Column {
    Column {
        name: name.to_owned(),
        symbol: symbol.to_owned(),
        unit: unit.to_owned(),
        about: format!("The {name} of a particle."),
        role,
        data,
    }
}

/// A checkpoint of three columns, one of them with awkward values.
fn sample(particles: u32) -> Checkpoint {
    let radius = (0..particles).map(|i| 0.25 * f64::from(i)).collect();
    let mut strain: Vec<f64> = (0..particles).map(|i| -f64::from(i)).collect();
    for (value, awkward) in strain.iter_mut().zip([f64::MIN_POSITIVE / 2.0, f64::INFINITY, -0.0]) {
        *value = awkward;
    }
    Checkpoint {
        clock: Clock {
            step: 1234,
            time: 1.5e-3,
            step_size: 2.5e-7,
            scalars: vec![("reference energy".to_owned(), 0.1)],
        },
        scene: "title = \"A drop at rest\"\nradius = \"2 µm\"\n".to_owned(),
        revision: "0123abc".to_owned(),
        columns: vec![
            column("radius", "r", "m", Role::State, Data::F64(radius)),
            column("strain", "ε", "", Role::Derived, Data::F64(strain)),
            column("identity", "i", "", Role::State, Data::U32((0..particles).rev().collect())),
        ],
    }
}

fn written(particles: u32) -> (tempfile::TempDir, PathBuf, Checkpoint) {
    let folder = tempfile::tempdir().unwrap();
    let checkpoint = sample(particles);
    let path = folder.path().join(file_name(checkpoint.clock.step));
    write(&path, &checkpoint).unwrap();
    (folder, path, checkpoint)
}

/// All checks of a reader, over bytes in memory.
fn check(bytes: &[u8]) -> Result<(), CheckpointError> {
    let path = Path::new("bytes");
    let header = &Header::decode(path, bytes, bytes.len() as u64)?;
    let contents = Contents { path, bytes, header };
    contents.preface()?;
    contents.verified_columns().map(|_| ())
}

/// The file's bytes, aligned as a reader has them.
fn aligned(path: &Path) -> rkyv::util::AlignedVec {
    let mut bytes = rkyv::util::AlignedVec::new();
    bytes.extend_from_slice(&fs::read(path).unwrap());
    bytes
}

#[test]
fn what_is_written_is_read() {
    for particles in [0, 1, 1000] {
        let (folder, path, checkpoint) = written(particles);
        assert_eq!(read(&path).unwrap(), checkpoint);
        assert_eq!(checkpoint.particles(), particles as usize);
        let left = fs::read_dir(folder.path()).unwrap().count();
        assert_eq!(left, 1, "nothing temporary stays behind");
    }
    let (_folder, path, mut checkpoint) = written(3);
    checkpoint.columns.clear();
    checkpoint.revision = "é".repeat(1000);
    write(&path, &checkpoint).unwrap();
    assert_eq!(read(&path).unwrap(), checkpoint, "replaces the old file");
    assert!(Mapped::open(&path).unwrap().columns().unwrap().is_empty());
}

#[test]
fn a_mapped_file_shows_the_same() {
    let (_folder, path, checkpoint) = written(1000);
    let mapped = Mapped::open(&path).unwrap();
    mapped.verify().unwrap();
    assert_eq!(mapped.clock(), &checkpoint.clock);
    assert_eq!(mapped.scene(), checkpoint.scene);
    assert_eq!(mapped.scene_hash(), xxh3_64(checkpoint.scene.as_bytes()));
    assert_eq!(mapped.revision(), checkpoint.revision);
    let views = mapped.columns().unwrap();
    for (view, column) in views.iter().zip(&checkpoint.columns) {
        assert_eq!(view.name(), column.name);
        assert_eq!(view.symbol(), column.symbol);
        assert_eq!(view.unit(), column.unit);
        assert_eq!(view.about(), column.about);
        assert_eq!(view.role(), column.role);
        assert_eq!(view.value(view.len()), None);
        let expected: Vec<f64> = match &column.data {
            Data::F64(values) => values.clone(),
            Data::U32(values) => values.iter().copied().map(f64::from).collect(),
        };
        assert!(view.values().eq(expected));
    }
}

#[test]
fn every_flipped_bit_is_noticed() {
    let (_folder, path, _) = written(500);
    let mut bytes = aligned(&path);
    check(&bytes).unwrap();
    let header = 0..8 * HEADER_LENGTH;
    let payload = 8 * (bytes.len() - HEADER_LENGTH) as u64;
    let mut state = 1_u64;
    let random = std::iter::repeat_with(|| {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1);
        8 * HEADER_LENGTH + ((state >> 32) % payload) as usize
    });
    let last = 8 * bytes.len() - 1;
    for bit in header.chain(random.take(5000)).chain([last]) {
        bytes[bit / 8] ^= 1 << (bit % 8);
        assert!(check(&bytes).is_err(), "bit {bit} went unnoticed");
        bytes[bit / 8] ^= 1 << (bit % 8);
    }
    check(&bytes).unwrap();
}

#[test]
fn damage_in_a_file_is_noticed_by_both_readers() {
    let (_folder, path, _) = written(500);
    let whole = fs::read(&path).unwrap();
    let verify = |path: &Path| Mapped::open(path).and_then(|mapped| mapped.verify());
    for place in [0, 9, 70, 4095, 4100, 8191, 8192, 9000, whole.len() - 1] {
        let mut bytes = whole.clone();
        bytes[place] ^= 16;
        fs::write(&path, &bytes).unwrap();
        assert!(read(&path).unwrap_err().is_damage());
        assert!(verify(&path).unwrap_err().is_damage());
    }
    for length in [0, 1, 4095, 4096, 4097, 8192, whole.len() - 1] {
        fs::write(&path, &whole[..length]).unwrap();
        assert!(read(&path).unwrap_err().is_damage());
        assert!(verify(&path).unwrap_err().is_damage());
    }
    fs::write(&path, [&whole[..], &[0]].concat()).unwrap();
    assert!(matches!(read(&path), Err(CheckpointError::Length { .. })));
}

#[test]
fn every_truncation_is_noticed() {
    let (_folder, path, _) = written(500);
    let bytes = aligned(&path);
    for length in 0..bytes.len() {
        assert!(check(&bytes[..length]).is_err(), "{length} bytes passed");
    }
}

#[test]
fn a_forged_header_is_refused_without_allocating() {
    let (_folder, path, _) = written(5);
    let original = fs::read(&path).unwrap();
    for length in [1 << 40, 1 << 62, u64::MAX - 5000, u64::MAX] {
        let section = Section { length, checksum: 0 };
        for (preface, columns) in [(section, Section::default()), (section, section)] {
            let header = Header { preface, columns, ..Header::default() };
            let forged = [&header.encode(), &original[HEADER_LENGTH..]].concat();
            fs::write(&path, forged).unwrap();
            assert!(matches!(read(&path), Err(CheckpointError::Length { .. })));
        }
    }
}

#[test]
fn a_header_that_contradicts_the_clock_is_refused() {
    let (_folder, path, _) = written(5);
    let bytes = fs::read(&path).unwrap();
    let mut header = Header::decode(&path, &bytes, bytes.len() as u64).unwrap();
    header.step += 1;
    fs::write(&path, [&header.encode(), &bytes[HEADER_LENGTH..]].concat()).unwrap();
    let error = read(&path).unwrap_err().to_string();
    assert!(error.contains("disagree about the step"), "{error}");
}

#[test]
fn a_table_that_is_none_is_not_written() {
    let (_folder, path, mut checkpoint) = written(5);
    let before = fs::read(&path).unwrap();
    checkpoint.columns[1].data = Data::F64(vec![0.0; 4]);
    let error = write(&path, &checkpoint).unwrap_err().to_string();
    assert!(error.contains("`strain` has 4 values, expected 5"), "{error}");
    checkpoint.columns[1] = checkpoint.columns[0].clone();
    let error = write(&path, &checkpoint).unwrap_err().to_string();
    assert!(error.contains("two columns named `radius`"), "{error}");
    assert_eq!(fs::read(&path).unwrap(), before);
}

#[test]
fn the_newest_whole_file_is_found() {
    let folder = tempfile::tempdir().unwrap();
    let error = newest_valid(folder.path()).unwrap_err();
    assert!(!error.is_damage(), "{error}");
    let mut checkpoint = sample(5);
    for step in [7, 80, 900, 12_345_678_901] {
        checkpoint.clock.step = step;
        write(&folder.path().join(file_name(step)), &checkpoint).unwrap();
    }
    fs::write(folder.path().join("step-+99.meniscus"), "no checkpoint").unwrap();
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

/// Files of released formats stay readable, and the same content gives the same bytes.
#[test]
fn the_golden_file_is_read() {
    assert_eq!(read(Path::new(GOLDEN)).unwrap(), sample(20));
    let (_folder, path, _) = written(20);
    assert_eq!(fs::read(path).unwrap(), fs::read(GOLDEN).unwrap());
}

#[test]
#[ignore = "writes the golden file: only for a new format version"]
fn write_the_golden_file() {
    write(Path::new(GOLDEN), &sample(20)).unwrap();
}
