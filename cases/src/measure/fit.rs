//! A damped oscillation fitted to a series by least squares.

use super::viscous::Mode;
use faer::Mat;
use faer::linalg::solvers::SolveLstsq;
use std::f64::consts::PI;

/// A(t) = e^(-g t) (a cos w t + b sin w t) + c.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oscillation {
    /// w in rad/s.
    pub angular_frequency: f64,
    /// g in 1/s.
    pub damping: f64,
    /// a, b and c in the unit of the series.
    pub coefficients: [f64; 3],
    /// Root mean square of what the fit leaves over, relative to that of the series about c.
    pub residual: f64,
}

impl Oscillation {
    /// Value of the fit at a time in s.
    pub fn at(&self, time: f64) -> f64 {
        let [a, b, c] = self.coefficients;
        let (sine, cosine) = (self.angular_frequency * time).sin_cos();
        (-self.damping * time).exp() * (a * cosine + b * sine) + c
    }

    /// Frequency in Hz.
    pub fn frequency(&self) -> f64 {
        self.angular_frequency / (2.0 * PI)
    }

    /// What one period adds to the exponent of the decay: g T.
    pub fn damping_per_period(&self) -> f64 {
        self.damping / self.frequency()
    }
}

/// The search starts at the best of so many frequencies within 30 % of the expected one.
const CANDIDATES: i32 = 31;
const RANGE: f64 = 0.3;
/// Iterations at most; five or so are usual.
const ITERATIONS: usize = 60;

/// Fits a damped oscillation to values at times (s) by Gauss-Newton, from an expected one. `None` for fewer
/// than 8 values, less than one period, or values that are no oscillation.
pub fn oscillation(times: &[f64], values: &[f64], mode: Mode) -> Option<Oscillation> {
    let expected = mode.angular_frequency;
    let [first, .., last] = times else {
        return None;
    };
    let long_enough = times.len() >= 8 && (last - first) * expected >= 2.0 * PI;
    if !long_enough || !values.iter().chain(times).all(|v| v.is_finite()) {
        return None;
    }
    // Phases instead of times, and values of order one: every unknown is then of order one, too.
    let largest = values.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    if largest == 0.0 {
        return None;
    }
    let problem = Problem {
        phases: times.iter().map(|t| t * expected).collect(),
        values: values.iter().map(|v| v / largest).collect(),
    };
    let best = problem.search(mode.decay / expected)?;
    let residual = problem.square(best).sqrt() / problem.spread(best.linear[2]);
    Some(Oscillation {
        angular_frequency: best.frequency * expected,
        damping: best.damping * expected,
        coefficients: best.linear.map(|c| c * largest),
        residual,
    })
}

struct Problem {
    phases: Vec<f64>,
    values: Vec<f64>,
}

/// Unknowns, with frequency and damping relative to the expected frequency.
#[derive(Clone, Copy)]
struct Guess {
    frequency: f64,
    damping: f64,
    linear: [f64; 3],
}

impl Problem {
    fn search(&self, damping: f64) -> Option<Guess> {
        let start = (0..CANDIDATES).filter_map(|k| {
            let offset = RANGE * (2.0 * f64::from(k) / f64::from(CANDIDATES - 1) - 1.0);
            self.linear(1.0 + offset, damping)
        });
        let mut best = start.min_by(|a, b| self.square(*a).total_cmp(&self.square(*b)))?;
        for _ in 0..ITERATIONS {
            let [frequency, damping] = self.step(best)?;
            let Some(better) = self.shortened(best, frequency, damping) else {
                break;
            };
            best = better;
            if frequency.abs() + damping.abs() < 1e-14 {
                break;
            }
        }
        (best.frequency > 0.0).then_some(best)
    }

    /// The best guess along a step, which is halved until it helps.
    fn shortened(&self, from: Guess, frequency: f64, damping: f64) -> Option<Guess> {
        let square = self.square(from);
        (0..20).find_map(|halvings| {
            let part = 0.5f64.powi(halvings);
            let guess = self.linear(from.frequency + part * frequency, from.damping + part * damping)?;
            (self.square(guess) < square).then_some(guess)
        })
    }

    /// The coefficients that fit best with the given frequency and damping.
    fn linear(&self, frequency: f64, damping: f64) -> Option<Guess> {
        let matrix = Mat::from_fn(self.phases.len(), 3, |row, column| {
            basis(self.phases[row], frequency, damping)[column]
        });
        let right = Mat::from_fn(self.values.len(), 1, |row, _| self.values[row]);
        let solution = matrix.qr().solve_lstsq(&right);
        let linear = [solution[(0, 0)], solution[(1, 0)], solution[(2, 0)]];
        linear.iter().all(|c| c.is_finite()).then_some(Guess { frequency, damping, linear })
    }

    /// Gauss-Newton step of frequency and damping; the linear unknowns move along.
    fn step(&self, guess: Guess) -> Option<[f64; 2]> {
        let matrix = Mat::from_fn(self.phases.len(), 5, |row, column| {
            let phase = self.phases[row];
            let [cosine, sine, one] = basis(phase, guess.frequency, guess.damping);
            let [a, b, _] = guess.linear;
            match column {
                0 => phase * (b * cosine - a * sine),
                1 => -phase * (a * cosine + b * sine),
                2 => cosine,
                3 => sine,
                _ => one,
            }
        });
        let right = Mat::from_fn(self.values.len(), 1, |row, _| self.rest(guess, row));
        let solution = matrix.qr().solve_lstsq(&right);
        let step = [solution[(0, 0)], solution[(1, 0)]];
        step.iter().all(|s| s.is_finite()).then_some(step)
    }

    fn rest(&self, guess: Guess, row: usize) -> f64 {
        let [cosine, sine, one] = basis(self.phases[row], guess.frequency, guess.damping);
        let [a, b, c] = guess.linear;
        self.values[row] - a * cosine - b * sine - c * one
    }

    fn square(&self, guess: Guess) -> f64 {
        (0..self.values.len()).map(|row| self.rest(guess, row).powi(2)).sum()
    }

    fn spread(&self, centre: f64) -> f64 {
        let squares = self.values.iter().map(|v| (v - centre).powi(2));
        squares.sum::<f64>().sqrt()
    }
}

fn basis(phase: f64, frequency: f64, damping: f64) -> [f64; 3] {
    let decay = (-damping * phase).exp();
    let (sine, cosine) = (frequency * phase).sin_cos();
    [decay * cosine, decay * sine, 1.0]
}
