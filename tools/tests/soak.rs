//! A long run: neither its memory nor what a step costs may grow.
//!
//! `cargo test` takes some thousand steps. A million, with the figures printed:
//!
//! ```text
//! MENISCUS_STEPS=1000000 cargo test --release -p meniscus --test soak -- --nocapture
//! ```
#![cfg(target_os = "linux")]

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Some hundred particles in motion that lasts, with every kind of output that goes on for ever.
const DROP: &str = r#"format = 1
title = "A drop that oscillates for long"
[liquid]
density = "1000 kg/m3"
surface_tension = "0.074 N/m"
[[body]]
shape = { sphere = { radius = "1 um" } }
velocity = { r = "-0.1 m/s * r/(1 um)", z = "0.2 m/s * z/(1 um)" }
[particles]
size = "80 nm"
[run]
until = "1 s"
[output]
frames = 0
[[measure]]
oscillation = { mode = 2, radius = "1 um" }
"#;

const STEPS: u64 = 20_000;
/// Parts of the run that are compared, and samples of the step's time in each.
const WINDOWS: u64 = 10;
const SAMPLES: u64 = 20;
/// How much larger, relative, memory and the time of a step may be in the last window than in the second.
struct Limits {
    memory: f64,
    time: f64,
}

const LONG: Limits = Limits { memory: 0.03, time: 0.1 };
/// A short run still fills the history of its observations, and each of its windows is over in so short a
/// time that something else on the same core may slow all of it.
const SHORT: Limits = Limits { memory: 0.1, time: 1.0 };

/// What one window has shown.
struct Window {
    /// kB at its end.
    resident: f64,
    /// Processor time of a step in us, sorted samples.
    times: Vec<f64>,
    /// s
    wall: f64,
}

impl Window {
    fn quantile(&self, part: f64) -> f64 {
        self.times[(part * (self.times.len() - 1) as f64).round() as usize]
    }
}

/// Resident size in kB.
fn resident(child: &Child) -> f64 {
    let status = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
    line.trim().trim_end_matches(" kB").parse().unwrap()
}

/// Processor time in s of all threads, so that what else the machine does hardly counts.
fn processor_time(child: &Child) -> f64 {
    let tasks = fs::read_dir(format!("/proc/{}/task", child.id())).unwrap();
    let time = |task: std::io::Result<fs::DirEntry>| -> Option<f64> {
        // A thread that writes a checkpoint may have gone by now.
        let told = fs::read_to_string(task.ok()?.path().join("schedstat")).ok()?;
        told.split(' ').next()?.parse().ok()
    };
    tasks.filter_map(time).sum::<f64>() * 1e-9
}

/// The step of the last whole row of a series.
fn last_step(series: &Path) -> u64 {
    use std::io::{Read, Seek, SeekFrom};
    let mut end = String::new();
    let read = fs::File::open(series).and_then(|mut file| {
        let length = file.metadata()?.len();
        file.seek(SeekFrom::Start(length.saturating_sub(2000)))?;
        file.read_to_string(&mut end)
    });
    let rows = read.ok().and_then(|_| end.rsplit_once('\n')).map_or("", |(rows, _)| rows);
    rows.lines().last().and_then(|row| row.split(',').next()?.parse().ok()).unwrap_or(0)
}

/// Waits for a step; none where the run has ended.
fn wait_for(child: &mut Child, series: &Path, step: u64) -> Option<u64> {
    loop {
        match last_step(series) {
            reached if reached >= step => return Some(reached),
            _ if child.try_wait().unwrap().is_some() => return None,
            _ => sleep(Duration::from_micros(300)),
        }
    }
}

#[test]
fn a_long_run_stays_as_it_is() {
    let steps = std::env::var("MENISCUS_STEPS").map_or(STEPS, |steps| steps.parse().unwrap());
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("drop.toml"), DROP).unwrap();
    // The windows' ends are to be seen while the run goes on.
    let beyond = format!("run.steps={}", steps + steps / 100);
    let every = format!("output.checkpoint_every={}", steps / 100);
    let mut child = Command::new(env!("CARGO_BIN_EXE_meniscus"))
        .args(["run", "drop.toml", "--out", "run", "--quiet", "--threads", "1"])
        .args(["--set", &beyond, "--set", &every])
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let series = folder.path().join("run/series.csv");
    let mut windows = Vec::new();
    let mut before = (wait_for(&mut child, &series, 1).unwrap(), processor_time(&child));
    for window in 0..WINDOWS {
        let started = Instant::now();
        let mut times = Vec::new();
        for sample in 1..=SAMPLES {
            let end = steps * (window * SAMPLES + sample) / (WINDOWS * SAMPLES);
            let step = wait_for(&mut child, &series, end).unwrap();
            let now = (step, processor_time(&child));
            if step > before.0 {
                times.push((now.1 - before.1) * 1e6 / (step - before.0) as f64);
            }
            before = now;
        }
        times.sort_by(f64::total_cmp);
        let wall = started.elapsed().as_secs_f64();
        windows.push(Window { resident: resident(&child), times, wall });
    }
    assert!(child.wait().unwrap().success());

    println!(
        "{steps} steps in {WINDOWS} windows: resident size; processor time of a step: best tenth, median, worst tenth; steps per second of wall time"
    );
    for window in &windows {
        let [best, median, worst] = [0.1, 0.5, 0.9].map(|part| window.quantile(part));
        let rate = (steps / WINDOWS) as f64 / window.wall;
        println!("{} kB; {best:.2} {median:.2} {worst:.2} us; {rate:.0}/s", window.resident);
    }
    let (second, last) = (&windows[1], &windows[WINDOWS as usize - 1]);
    let growth = last.resident / second.resident - 1.0;
    // The best tenth: what else the machine does makes steps slower, never faster.
    let [drift, median] = [0.1, 0.5].map(|part| last.quantile(part) / second.quantile(part) - 1.0);
    println!(
        "from the second window to the last: memory {:+.2} %, time of a step {:+.2} % (median {:+.2} %)",
        1e2 * growth,
        1e2 * drift,
        1e2 * median
    );
    let limits = if steps < 1_000_000 { SHORT } else { LONG };
    assert!(growth < limits.memory, "memory grows: {growth}");
    assert!(drift < limits.time, "steps become slower: {drift}");
}
