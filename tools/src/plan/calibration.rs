//! What a run would cost, from a short piece of it: filled, and run for a while.

use std::time::{Duration, Instant};

use meniscus_cases::measure::Observer;
use meniscus_cases::scene::Scene;
use meniscus_cases::simulation::{Simulation, to_the_end};

use crate::failure::Failure;
use crate::memory;
use crate::run;

/// Elapsed time of a trial of steps.
const TRIAL: Duration = Duration::from_secs(1);
/// Steps that a trial takes at least, however long they last, after those that warm it up.
const LEAST: u64 = 20;
const WARM_UP: u64 = 10;

/// What was measured, and what it makes the whole run cost.
pub(super) struct Calibration {
    /// The scene where the trial has left it.
    pub(super) simulation: Simulation,
    /// Time steps.
    pub(super) steps: u64,
    /// Time that they reach, s: the scene's end, or an earlier one where it runs for fewer steps than that takes.
    pub(super) end: f64,
    /// Length of a step at the end of the trial, s.
    pub(super) step_size: f64,
    /// Seconds to fill the bodies.
    pub(super) start_seconds: f64,
    /// Seconds of a step, with the observations of the series.
    pub(super) step_seconds: f64,
    /// Seconds of all pictures.
    pub(super) picture_seconds: f64,
    /// Seconds that the measurement took.
    pub(super) measured: f64,
}

impl Calibration {
    /// Seconds of the whole run.
    pub(super) fn seconds(&self) -> f64 {
        self.start_seconds + self.step_seconds * self.steps as f64 + self.picture_seconds
    }
}

/// Fills the scene and runs pieces of it. Nothing is written.
pub(super) fn calibrate(scene: &Scene) -> Result<Calibration, Failure> {
    memory::check(scene)?;
    let begun = Instant::now();
    let mut simulation = Simulation::new(scene, &mut to_the_end)?;
    let start_seconds = begun.elapsed().as_secs_f64();
    let trial = Trial::run(scene, &mut simulation)?;
    let clock = &simulation.world.clock;
    let left = ((scene.until - clock.time).max(0.0) / trial.step_size).ceil() as u64;
    let whole = clock.step + left;
    let steps = whole.min(scene.steps.unwrap_or(u64::MAX));
    let ahead = steps.saturating_sub(clock.step) as f64 * trial.step_size;
    let end = if steps < whole { (clock.time + ahead).min(scene.until) } else { scene.until };
    let picture_seconds = pictures(scene, &simulation, end)?;
    Ok(Calibration {
        steps,
        end,
        step_size: trial.step_size,
        start_seconds,
        step_seconds: trial.step_seconds,
        picture_seconds,
        measured: begun.elapsed().as_secs_f64(),
        simulation,
    })
}

/// Seconds of all pictures up to a time in s. The first one costs more: it finds its fonts.
fn pictures(scene: &Scene, simulation: &Simulation, end: f64) -> Result<f64, Failure> {
    if scene.output.frames == 0 || !scene.output.picture {
        return Ok(0.0);
    }
    let draw = || -> Result<f64, Failure> {
        let begun = Instant::now();
        run::rehearse_picture(scene, simulation).map_err(Failure::on_the_way)?;
        Ok(begun.elapsed().as_secs_f64())
    };
    let later = (end / scene.until * scene.output.frames as f64).floor();
    Ok(draw()? + draw()? * later)
}

/// A piece of a run.
struct Trial {
    step_seconds: f64,
    /// Mean length of its later steps, s.
    step_size: f64,
}

impl Trial {
    fn run(scene: &Scene, simulation: &mut Simulation) -> Result<Self, Failure> {
        let observer = Observer::new(scene, simulation);
        let every = run::observed_every(scene);
        let mut begun = Instant::now();
        let (mut middle, mut steps) = ((0, 0.0), 0);
        loop {
            let clock = &simulation.world.clock;
            if run::is_over(scene, clock.step, clock.time) && clock.step > 0 {
                break;
            }
            if clock.step == WARM_UP {
                (begun, steps) = (Instant::now(), 0);
            }
            if begun.elapsed() < TRIAL / 2 {
                middle = (clock.step, clock.time);
            }
            if steps >= LEAST && begun.elapsed() > TRIAL {
                break;
            }
            let step = simulation.step();
            step.map_err(|fault| Failure::on_the_way(format!("the trial broke down: {fault}")))?;
            if simulation.world.clock.step.is_multiple_of(every) {
                observer.observe(simulation);
            }
            steps += 1;
        }
        let clock = &simulation.world.clock;
        let later = ((clock.step - middle.0) as f64, clock.time - middle.1);
        Ok(Trial {
            step_seconds: begun.elapsed().as_secs_f64() / steps.max(1) as f64,
            step_size: if later.0 > 0.0 { later.1 / later.0 } else { clock.previous_step_size },
        })
    }
}
