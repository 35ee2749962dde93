//! What each part of the physics costs: the same drop with one thing more from row to row, and the same ring
//! of liquid far from the axis and on it. `cargo bench -p meniscus-benches --bench cost_of_physics`.
//!
//! The scenes take turns, so that whatever else the machine does hits all of them alike; differences are those
//! of the least times.

use comfy_table::{CellAlignment, Table, presets};
use meniscus_benches::physics::{Variant, scenes};
use meniscus_benches::{advance, one_thread, start};
use meniscus_cases::simulation::Simulation;
use std::time::Instant;

/// Particles per radius: two thousand in the drop.
const RESOLUTION: &str = "resolution=35";
/// Steps that are timed at once: several lists and curvatures.
const STEPS: u64 = 60;
/// How often every scene has its turn.
const TURNS: usize = 81;

struct Measured {
    variant: Variant,
    simulation: Simulation,
    /// Nanoseconds per particle and step, one a turn.
    samples: Vec<f64>,
}

impl Measured {
    fn take_turn(&mut self) {
        let start = Instant::now();
        advance(&mut self.simulation, STEPS);
        let particle_steps = self.simulation.world.store.len() as f64 * STEPS as f64;
        self.samples.push(start.elapsed().as_nanos() as f64 / particle_steps);
    }

    fn stages(&self) -> Vec<&'static str> {
        self.simulation.costs().iter().map(|cost| cost.stage).collect()
    }

    fn least(&self) -> f64 {
        self.samples.iter().copied().fold(f64::INFINITY, f64::min)
    }

    fn median(&self) -> f64 {
        let mut sorted = self.samples.clone();
        sorted.sort_by(f64::total_cmp);
        sorted[sorted.len() / 2]
    }
}

fn main() {
    let measured = one_thread().install(|| {
        let begin = |(variant, scene)| {
            let mut simulation = start(&scene);
            advance(&mut simulation, STEPS);
            Measured { variant, simulation, samples: Vec::new() }
        };
        let mut measured: Vec<Measured> = scenes(&[RESOLUTION]).into_iter().map(begin).collect();
        for _ in 0..TURNS {
            measured.iter_mut().for_each(Measured::take_turn);
        }
        measured
    });
    println!("One thread; nanoseconds per particle and step in {TURNS} turns of {STEPS} steps");
    println!("{}", table(&measured));
}

fn table(measured: &[Measured]) -> Table {
    let mut table = Table::new();
    table.load_style(presets::UTF8_BORDERS_ONLY).set_header([
        "scene",
        "stages more",
        "particles",
        "mirrored",
        "least",
        "median",
        "more",
    ]);
    let mut before: Option<&Measured> = None;
    for row in measured.iter() {
        let before = before.replace(row).filter(|_| !row.variant.first);
        let known = before.map_or(Vec::new(), Measured::stages);
        let more: Vec<&str> = row.stages().into_iter().filter(|stage| !known.contains(stage)).collect();
        table.add_row([
            row.variant.name.to_owned(),
            more.join("\n"),
            row.simulation.world.store.len().to_string(),
            row.simulation.world.neighbours.images().len().to_string(),
            format!("{:.1}", row.least()),
            format!("{:.1}", row.median()),
            before.map_or(String::new(), |before| format!("{:+.1}", row.least() - before.least())),
        ]);
    }
    for column in table.column_iter_mut().skip(2) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}
