//! What a whole run has measured, against what is exact.

use super::columns::{columns_of, numbered, with_index};
use super::exact::Drop;
use super::fit::{self, Oscillation};
use super::history::History;
use super::spheroid::Spheroid;
use super::viscous::Mode;
use super::{bridge, energy, film, flow, jet, large, spread, thread};
use crate::scene::{Measure, Scene};
use std::f64::consts::PI;

/// Part of the motion that a fit may leave over before its frequency is doubtful.
const POOR_FIT: f64 = 0.3;

/// One measured number.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// What was measured.
    pub name: String,
    /// The measured value in `unit`; NaN where the run was too short.
    pub value: f64,
    /// SI unit; "1" for a plain number.
    pub unit: &'static str,
    /// The exact value, if there is one.
    pub reference: Option<f64>,
    /// Why there is no value, or none to trust: what a sentence says that begins with the name.
    pub doubt: Option<String>,
}

impl Outcome {
    /// (value - reference)/reference, where there are a value and a reference other than zero.
    pub fn relative_error(&self) -> Option<f64> {
        let reference = self.reference.filter(|reference| *reference != 0.0)?;
        Some((self.value - reference) / reference).filter(|error| error.is_finite())
    }

    pub(super) fn of(name: String, value: Option<f64>, unit: &'static str) -> Self {
        let outcome = Outcome { name, value: value.unwrap_or(f64::NAN), unit, reference: None, doubt: None };
        outcome.lacking(match value {
            None => "the run is too short",
            Some(_) => "no particles are where it looks; check its places and lengths",
        })
    }

    /// Why there is no value, if there is none.
    pub(super) fn lacking(mut self, why: &str) -> Self {
        if self.value.is_nan() {
            self.doubt = Some(format!("cannot be told: {why}"));
        }
        self
    }

    pub(super) fn against(mut self, reference: f64) -> Self {
        self.reference = Some(reference);
        self
    }
}

/// Everything that the scene's measures say about a run.
pub fn evaluate(scene: &Scene, history: &History) -> Vec<Outcome> {
    let outcomes = with_index(&scene.measures).map(|(measure, index)| {
        let columns: Vec<String> = columns_of(measure, index).into_iter().map(|column| column.name).collect();
        let column = columns.first().cloned().unwrap_or_default();
        let mut outcomes = match *measure {
            Measure::LaplacePressure { radius, .. } => {
                let exact = Drop::of(&scene.liquid, radius).laplace_pressure();
                // One row is no mean over a quarter of a run.
                let mean = moves(history).then(|| history.mean(&column, 0.75, 1.0));
                vec![Outcome::of("laplace-pressure".to_owned(), mean.flatten(), "Pa").against(exact)]
            }
            Measure::SpuriousVelocity { .. } => {
                let mean = |from, to| moves(history).then(|| history.mean(&column, from, to));
                let outcome =
                    |name: &str, value: Option<f64>| Outcome::of(name.to_owned(), value, "1").against(0.0);
                vec![
                    outcome("spurious-velocity", mean(0.9, 1.0).flatten()),
                    outcome("spurious-velocity-start", mean(0.0, 0.1).flatten()),
                ]
            }
            Measure::Oscillation { mode, radius, from, .. } => {
                let drop = Drop::of(&scene.liquid, radius);
                let slower = drop.compressible_frequency_ratio(mode, scene.derived_sound_speed());
                oscillation(history, &column, (drop.mode(mode), slower, from))
            }
            Measure::GrowthRate { wavenumber, radius } => {
                let sizes = (wavenumber, radius, scene.particle_size);
                let liquid = (&scene.liquid, scene.derived_sound_speed());
                jet::evaluate(history, &columns, liquid, sizes)
            }
            Measure::FilmRetraction { thickness } => {
                film::evaluate(history, &columns, &scene.liquid, thickness)
            }
            Measure::MomentumDrift => vec![momentum_drift(history)],
            Measure::EnergyDrift => vec![energy::drift(scene, history)],
            Measure::EnergyGain => vec![energy::gain(scene, history)],
            Measure::LargeOscillation { radial, axial, speed } => {
                let start = large::Start { radial, axial, speed };
                large::evaluate(history, &column, &scene.liquid, start)
            }
            Measure::Spread { radius, speed } => {
                spread::evaluate(history, &column, &scene.liquid, (radius, speed))
            }
            Measure::Coalescence { radius, other } => {
                let drops = bridge::Bridge { radius, other };
                bridge::evaluate(history, &column, &scene.liquid, drops)
            }
            Measure::PinchOff { radius, wavenumber, speed } => {
                let jet = thread::Jet { radius, wavenumber, speed };
                thread::evaluate(history, &column, &scene.liquid, (jet, scene.particle_size))
            }
            Measure::SemiAxis { radial, axial, shear, stiffness } => {
                let start = Spheroid { radial, axial, shear, stiffness };
                flow::evaluate_semi_axes(history, &columns, start)
            }
            Measure::PlateauDensity { dimensions, .. } => {
                flow::evaluate_plateau(history, &columns, &scene.liquid, dimensions)
            }
            Measure::ShockSpeed { speed, length } => {
                flow::evaluate_shock(history, &columns, &scene.liquid, (speed, length))
            }
        };
        outcomes.iter_mut().for_each(|outcome| outcome.name = numbered(&outcome.name, index));
        outcomes
    });
    outcomes.flatten().collect()
}

/// Frequency and damping, against the exact ones of a drop that oscillates at all; `slower` is what becomes of the
/// frequency at the scene's sound speed.
fn oscillation(
    history: &History,
    column: &str,
    (exact, slower, from): (Option<Mode>, f64, f64),
) -> Vec<Outcome> {
    let fit = exact.and_then(|exact| oscillation_fit(history, column, exact, from));
    let damping = fit.map(|fit| fit.damping_per_period());
    let residual = fit.map(|fit| fit.residual);
    let values = history.of(column);
    let why = match exact {
        None => "the drop is too viscous to oscillate",
        Some(_) if values.iter().any(|value| value.is_nan()) => {
            "no drop of about its radius is there all the time; check `radius` and `centre`"
        }
        Some(_) => "the run is too short: it takes a period, observed eight times at least",
    };
    let outcome = |name: &str, value, unit| Outcome::of(name.to_owned(), value, unit).lacking(why);
    let mut outcomes = vec![
        outcome("frequency", fit.map(|fit| fit.frequency()), "Hz"),
        outcome("damping-per-period", damping, "1"),
        outcome("compressible-frequency", fit.map(|fit| fit.frequency()), "Hz"),
        outcome("fit-residual", residual, "1"),
    ];
    if let Some(Mode { angular_frequency, decay }) = exact {
        outcomes[0].reference = Some(angular_frequency / (2.0 * PI));
        outcomes[1].reference = Some(2.0 * PI * decay / angular_frequency);
        // Sound slower than the motion leaves no oscillation to compare with.
        outcomes[2].reference =
            Some(slower * angular_frequency / (2.0 * PI)).filter(|exact| exact.is_finite());
    }
    if let Some(residual) = residual.filter(|residual| *residual > POOR_FIT) {
        let sentence = "is doubtful: what the fit of a damped oscillation leaves over is";
        outcomes[0].doubt = Some(format!("{sentence} {residual:.2} of the motion"));
    }
    outcomes
}

/// Largest distance of a series from its first value.
pub(super) fn largest_change(values: &[f64]) -> Option<f64> {
    let first = *values.first()?;
    values.get(1)?;
    Some(values.iter().fold(0.0, |most: f64, value| most.max((value - first).abs())))
}

/// Largest change of the axial momentum over the sum of |m U_z| at the start or, where the liquid starts at
/// rest, over the largest such sum.
fn momentum_drift(history: &History) -> Outcome {
    let scales = history.of("momentum scale");
    let largest = scales.iter().copied().fold(0.0, f64::max);
    let scale = scales.first().copied().map(|start| if start > 0.0 { start } else { largest });
    let scale = scale.filter(|scale| *scale > 0.0);
    let drift = largest_change(&history.of("momentum z")).zip(scale).map(|(change, scale)| change / scale);
    let outcome = Outcome::of("momentum-drift".to_owned(), drift, "1").against(0.0);
    if scale.is_none() { outcome.lacking("nothing moves") } else { outcome }
}

fn moves(history: &History) -> bool {
    history.of("time").last().is_some_and(|time| *time > 0.0)
}

/// The oscillation near an expected one that fits an observed quantity from a time in s on.
pub fn oscillation_fit(history: &History, column: &str, expected: Mode, from: f64) -> Option<Oscillation> {
    let (times, values) = (history.of("time"), history.of(column));
    let start = times.partition_point(|time| *time < from);
    fit::oscillation(times.get(start..)?, values.get(start..)?, expected)
}

/// Changes from the first observation to the last: of axial momentum, relative to the largest sum of its
/// magnitudes; of energy, relative to the first; of mass, relative to the first. NaN where unknown: all with
/// fewer than two observations, the energy also where surface tension acts on a liquid whose surface is not known.
pub fn conservation(scene: &Scene, history: &History) -> [f64; 3] {
    // What was observed once has not changed yet: that tells nothing.
    let change = |values: &[f64]| match values {
        [first, .., last] => (last - first, *first),
        _ => (f64::NAN, f64::NAN),
    };
    let scale = history.of("momentum scale");
    let scale = scale.iter().fold(0.0f64, |most, value| most.max(*value));
    let (momentum, _) = change(&history.of("momentum z"));
    let momentum = if momentum == 0.0 { 0.0 } else { momentum / scale };
    let energy = energy::energies(scene, history).map(|energy| change(&energy));
    let energy = energy.map_or(f64::NAN, |(change, scale)| change / scale);
    let (mass, mass_scale) = change(&history.of("mass"));
    [momentum, energy, mass / mass_scale]
}
