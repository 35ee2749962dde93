//! Counts the instructions of every stage under callgrind and compares them with those that were accepted:
//! `cargo instructions`, and `cargo instructions --accept` to accept what is counted.
//!
//! Times differ from run to run and from machine to machine; on one thread, with results that are the same bit
//! by bit, counts do not.

use comfy_table::{CellAlignment, Table, presets};
use meniscus_benches::budget::{BUDGET, Counts, excesses, gains};
use meniscus_benches::physics::{Variant, scenes};
use meniscus_benches::{advance, callgrind, one_thread, start};
use meniscus_cases::scene::Scene;
use meniscus_cases::simulation::Simulation;
use meniscus_engine::checkpoint;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::{Command, ExitCode, Stdio};

/// The accepted counts.
const ACCEPTED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/instructions.toml");
/// Steps that are counted: several lists and curvatures.
const STEPS: u64 = 40;
/// Six hundred particles, and flows that renew the lists within these steps.
const SETTINGS: [&str; 2] = ["resolution=20", "speed=10 m/s"];
const HEAD: &str = "# Instructions of each stage in 40 steps, written by `cargo instructions --accept`.\n\n";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let done = match arguments[..] {
        [] => measure().and_then(|found| compare(&found)),
        ["--accept"] => measure().and_then(|found| accept(&found)),
        // What runs under callgrind.
        ["--steps", scene, state] => take_steps(scene, Path::new(state)).map(|()| true),
        _ => Err("usage: cargo instructions [--accept]".to_owned()),
    };
    match done {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(problem) => {
            eprintln!("{problem}");
            ExitCode::from(2)
        }
    }
}

/// Counts all scenes and prints the counts per particle and step.
fn measure() -> Result<Counts, String> {
    if cfg!(target_feature = "avx512f") {
        return Err("valgrind knows no AVX-512: build with `cargo instructions`".to_owned());
    }
    let folder = tempfile::tempdir().map_err(|error| format!("no temporary folder: {error}"))?;
    let mut counts = Counts::new();
    let mut columns = Vec::new();
    for (variant, scene) in scenes(&SETTINGS) {
        // Filling the scene would take longer under callgrind than its steps: it is done out here.
        let simulation = one_thread().install(|| start(&scene));
        let state = folder.path().join("state");
        checkpoint::write(&state, &simulation.checkpoint(&scene)).map_err(|error| error.to_string())?;
        let stages = count(variant.name, &state, &folder.path().join("profile"))?;
        let particle_steps = (STEPS * simulation.world.store.len() as u64) as f64;
        println!("({}) {}", columns.len() + 1, variant.name);
        columns.push((particle_steps, stages.clone()));
        counts.insert(variant.name.to_owned(), stages);
    }
    println!("Instructions per particle and step\n{}", table(&columns));
    Ok(counts)
}

/// Runs this program under callgrind.
fn count(scene: &str, state: &Path, profile: &Path) -> Result<BTreeMap<String, u64>, String> {
    let program = std::env::current_exe().map_err(|error| format!("no way to this program: {error}"))?;
    let mut command = Command::new("valgrind");
    command.args(["--tool=callgrind", "--quiet", "--compress-strings=no", "--compress-pos=no"]);
    command.arg(format!("--callgrind-out-file={}", profile.display()));
    command.arg(program).args(["--steps", scene]).arg(state).stdout(Stdio::null());
    let status = command.status().map_err(|error| {
        format!("valgrind does not start: {error}; install it (apt-get install valgrind)")
    })?;
    if !status.success() {
        return Err(format!("`{scene}` broke down under valgrind: {status}"));
    }
    let profile = std::fs::read_to_string(profile).map_err(|error| format!("no profile: {error}"))?;
    let stages = callgrind::stages(&profile);
    if stages.is_empty() {
        return Err(format!("the profile of `{scene}` names no stage: are there symbols in the build?"));
    }
    Ok(stages)
}

fn take_steps(name: &str, state: &Path) -> Result<(), String> {
    let of_name = |(variant, scene): (Variant, Scene)| (variant.name == name).then_some(scene);
    let scene = scenes(&SETTINGS).into_iter().find_map(of_name).ok_or(format!("no scene `{name}`"))?;
    let state = checkpoint::read(state).map_err(|error| error.to_string())?;
    let mut simulation = Simulation::resume(&scene, &state).map_err(|error| error.to_string())?;
    one_thread().install(|| advance(&mut simulation, STEPS));
    Ok(())
}

/// A column a scene, with its particles times steps and its stages; a row a stage.
fn table(columns: &[(f64, BTreeMap<String, u64>)]) -> Table {
    let mut table = Table::new();
    let numbers = (1..=columns.len()).map(|number| format!("({number})"));
    table
        .load_style(presets::UTF8_BORDERS_ONLY)
        .set_header(std::iter::once("stage".to_owned()).chain(numbers));
    let stages: BTreeSet<&String> = columns.iter().flat_map(|(_, stages)| stages.keys()).collect();
    let row = |name: &str, count: &dyn Fn(&BTreeMap<String, u64>) -> Option<u64>| -> Vec<String> {
        let cell = |(particle_steps, stages): &(f64, BTreeMap<String, u64>)| {
            count(stages).map_or(String::new(), |count| format!("{:.1}", count as f64 / particle_steps))
        };
        std::iter::once(name.to_owned()).chain(columns.iter().map(cell)).collect()
    };
    for stage in stages {
        table.add_row(row(stage, &|stages| stages.get(stage).copied()));
    }
    table.add_row(row("all", &|stages| Some(stages.values().sum())));
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

fn accept(found: &Counts) -> Result<bool, String> {
    let text = toml::to_string(found).map_err(|error| error.to_string())?;
    std::fs::write(ACCEPTED, HEAD.to_owned() + &text)
        .map_err(|error| format!("{ACCEPTED} cannot be written: {error}"))?;
    println!("accepted in {ACCEPTED}");
    Ok(true)
}

/// Whether every count is within the budget; says which are not.
fn compare(found: &Counts) -> Result<bool, String> {
    let text = std::fs::read_to_string(ACCEPTED).map_err(|error| {
        format!("{ACCEPTED} cannot be read: {error}; `cargo instructions --accept` writes it")
    })?;
    let accepted: Counts = toml::from_str(&text)
        .map_err(|error| format!("{ACCEPTED}: {error}; `cargo instructions --accept` writes it anew"))?;
    for gain in gains(&accepted, found) {
        println!("{gain}; `cargo instructions --accept` keeps the gain");
    }
    let excesses = excesses(&accepted, found);
    let percent = 100.0 * BUDGET;
    if excesses.is_empty() {
        println!("Every stage is within {percent} % of what was accepted.");
        return Ok(true);
    }
    for excess in &excesses {
        eprintln!("OVER BUDGET: {excess}");
    }
    eprintln!(
        "A stage may take {percent} % more instructions than accepted. Find out what they do; where they are worth \
         it, or another compiler makes them, run `cargo instructions --accept` and commit {ACCEPTED}."
    );
    Ok(false)
}
