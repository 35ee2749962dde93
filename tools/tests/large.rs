//! A checkpoint of one gigabyte: header and clock are told at once, statistics take little memory.
//!
//! ```text
//! cargo test --release -p meniscus --test large -- --ignored --nocapture
//! ```
#![cfg(target_os = "linux")]

use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use meniscus_engine::checkpoint::{Checkpoint, Clock, Column, Data, Role, write};

const PARTICLES: usize = 5_000_000;
const COLUMNS: usize = 26;

/// What a command has cost.
#[derive(Debug)]
struct Cost {
    processor: Duration,
    elapsed: Duration,
    /// Most memory held, KiB.
    memory: u64,
}

/// Processor time of all children that have ended, from the clock ticks (10 ms) that the system counts.
fn children() -> Duration {
    let stat = fs::read_to_string("/proc/self/stat").unwrap();
    let fields: Vec<&str> = stat.rsplit(')').next().unwrap().split_whitespace().collect();
    let ticks: u64 = [13, 14].map(|field: usize| fields[field].parse::<u64>().unwrap()).iter().sum();
    Duration::from_millis(10 * ticks)
}

fn inspect(arguments: &[&str]) -> Cost {
    let (before, start) = (children(), Instant::now());
    let mut command = Command::new(env!("CARGO_BIN_EXE_meniscus"));
    let mut child = command.arg("inspect").args(arguments).stdout(Stdio::null()).spawn().unwrap();
    let mut memory = 0;
    while child.try_wait().unwrap().is_none() {
        let status = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let held = line.and_then(|line| line.trim().trim_end_matches(" kB").parse().ok());
        memory = memory.max(held.unwrap_or(0));
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(child.wait().unwrap().success());
    let cost = Cost { elapsed: start.elapsed(), processor: children() - before, memory };
    println!("inspect {}: {cost:?}", arguments[0]);
    cost
}

fn write_large(path: &Path) {
    let column = |number: usize| Column {
        name: format!("field_{number}"),
        symbol: "f".to_owned(),
        unit: "1".to_owned(),
        about: "A field.".to_owned(),
        role: Role::State,
        data: Data::F64((0..PARTICLES).map(|i| (i * (number + 1)) as f64).collect()),
    };
    let columns = (0..COLUMNS).map(column).collect();
    let clock = Clock { step: 7, time: 1e-6, ..Clock::default() };
    let checkpoint =
        Checkpoint { clock, scene: "title = \"large\"".to_owned(), revision: String::new(), columns };
    let start = Instant::now();
    write(path, &checkpoint).unwrap();
    println!("written in {:?}, flushed to the disk", start.elapsed());
}

#[test]
#[ignore = "writes a gigabyte"]
fn a_gigabyte_is_told_at_once_and_streamed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("step-000000007.meniscus");
    write_large(&path);
    let length = fs::metadata(&path).unwrap().len();
    println!("{length} bytes");
    let path = path.to_str().unwrap();
    let summary = inspect(&[path]);
    assert!(summary.processor <= Duration::from_millis(100));
    let verified = inspect(&["verify", path]);
    assert!(verified.memory < 50 << 10);
    let fields = inspect(&["fields", path]);
    assert!(fields.memory < 50 << 10);
    println!(
        "statistics at {:.2} GB/s, checksums included",
        2e-9 * length as f64 / fields.elapsed.as_secs_f64()
    );
    inspect(&["fields", path, "field_3"]);
}
