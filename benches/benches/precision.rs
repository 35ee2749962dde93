//! What single precision in the pairs saves: the same drop in double and in mixed precision, on one thread.
//! `cargo bench -p meniscus-benches --bench precision`.
//!
//! The two take short turns, so that whatever else the machine does hits them alike. The ratio is the median of
//! those of two turns that followed each other.

use comfy_table::{CellAlignment, Table, presets};
use meniscus_benches::{advance, drop_of, one_thread, start};
use meniscus_cases::scene::Precision;
use meniscus_cases::simulation::Simulation;

/// What is compared, beside the whole step.
const STAGES: [&str; 2] = ["equation-of-state", "flux"];
/// Particles and steps of a turn: some ten milliseconds, in which the curvature is renewed several times.
const PARTICLE_STEPS: u64 = 200_000;
/// How often each has its turn.
const TURNS: usize = 151;

/// Nanoseconds per particle and step of the stages and of the step, turn by turn.
struct Measured {
    simulation: Simulation,
    turns: [Vec<f64>; STAGES.len() + 1],
}

impl Measured {
    fn new(particles: u64, precision: Precision) -> Self {
        let mut scene = drop_of(particles);
        scene.method.precision = precision;
        let mut simulation = start(&scene);
        advance(&mut simulation, 40);
        Measured { simulation, turns: Default::default() }
    }

    /// Seconds in the stages and in the whole step so far.
    fn spent(&self) -> [f64; STAGES.len() + 1] {
        let mut spent = [0.0; STAGES.len() + 1];
        for cost in self.simulation.costs() {
            spent[STAGES.len()] += cost.time.as_secs_f64();
            if let Some(k) = STAGES.iter().position(|stage| *stage == cost.stage) {
                spent[k] += cost.time.as_secs_f64();
            }
        }
        spent
    }

    fn take_turn(&mut self) {
        let particles = self.simulation.world.store.len() as u64;
        let steps = PARTICLE_STEPS.div_ceil(particles).max(4);
        let before = self.spent();
        advance(&mut self.simulation, steps);
        let after = self.spent();
        for ((turns, before), after) in self.turns.iter_mut().zip(before).zip(after) {
            turns.push(1e9 * (after - before) / (particles * steps) as f64);
        }
    }
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() {
    let mut table = Table::new();
    table.load_style(presets::UTF8_BORDERS_ONLY);
    table.set_header(["particles", "stage", "double", "mixed", "ratio"]);
    for particles in [2_000, 10_000, 100_000] {
        let [double, mixed] = one_thread().install(|| {
            let mut both =
                [Precision::Double, Precision::Mixed].map(|precision| Measured::new(particles, precision));
            for _ in 0..TURNS {
                both.iter_mut().for_each(Measured::take_turn);
            }
            both
        });
        for (k, stage) in STAGES.into_iter().chain(["whole step"]).enumerate() {
            let (double, mixed) = (&double.turns[k], &mixed.turns[k]);
            let ratio = median(mixed.iter().zip(double).map(|(mixed, double)| mixed / double));
            let [double, mixed] = [double, mixed].map(|turns| median(turns.iter().copied()));
            table.add_row([
                particles.to_string(),
                stage.to_owned(),
                format!("{double:.1}"),
                format!("{mixed:.1}"),
                format!("{ratio:.2}"),
            ]);
        }
    }
    for column in table.column_iter_mut() {
        column.set_cell_alignment(CellAlignment::Right);
    }
    println!("One thread; nanoseconds per particle and step, the medians of {TURNS} turns\n{table}");
}
