//! A checkpoint of one gigabyte: header and clock are told at once, statistics take little memory. A run of a
//! million particles: how much memory it takes at most.
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

fn cost_of(arguments: &[&str]) -> Cost {
    let (before, start) = (children(), Instant::now());
    let mut command = Command::new(env!("CARGO_BIN_EXE_meniscus"));
    let command = command.args(arguments).stdout(Stdio::null()).stderr(Stdio::null());
    let mut child = command.spawn().unwrap();
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
    println!("{}: {cost:?}", arguments[..2].join(" "));
    cost
}

fn inspect(arguments: &[&str]) -> Cost {
    cost_of(&[&["inspect"], arguments].concat())
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

/// A drop of a million particles that are placed, and run with checkpoints.
const MILLION: &str = r#"format = 1
title = "A drop of a million particles"
[liquid]
density = "1000 kg/m3"
surface_tension = "0.074 N/m"
[[body]]
shape = { sphere = { radius = "1 um" } }
velocity = { r = "-0.1 m/s * r/(1 um)", z = "0.2 m/s * z/(1 um)" }
[particles]
size = "1 um/797.9"
[run]
until = "1 s"
steps = 40
[output]
frames = 0
checkpoint_every = 20
"#;

/// From the first particle to the last checkpoint, the program itself included.
#[test]
#[ignore = "takes minutes"]
fn a_particle_takes_at_most_four_hundred_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, out) = (folder.path().join("million.toml"), folder.path().join("run"));
    fs::write(&scene, MILLION).unwrap();
    let cost = cost_of(&["run", scene.to_str().unwrap(), "--out", out.to_str().unwrap(), "--threads", "1"]);
    let bytes = 1024.0 * cost.memory as f64 / 1e6;
    println!("{bytes} bytes a particle");
    assert!(bytes <= 400.0);
}
