//! Growth and decay fitted to a series by least squares.

use faer::Mat;
use faer::linalg::solvers::SolveLstsq;

/// Iterations at most.
const ITERATIONS: usize = 60;

/// q in 1/s of c1 e^(q t) + c2 e^(-p q t) + c3 with a given p, fitted by Gauss-Newton to values at times (s) from
/// an expected rate; `None` for fewer than 8 values or none that grow. (The constant is the packing's own part in
/// what is measured: particles at rest don't lie evenly, either.)
pub fn fit(times: &[f64], values: &[f64], (expected, p): (f64, f64)) -> Option<f64> {
    if times.len() < 8 {
        return None;
    }
    // Phases from the first row on: every unknown is then of order one.
    let phases: Vec<f64> = times.iter().map(|t| (t - times[0]) * expected).collect();
    let largest = values.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    let values: Vec<f64> = values.iter().map(|v| v / largest).collect();
    let mut rate = 1.0;
    for _ in 0..ITERATIONS {
        let basis = |phase: f64| [(rate * phase).exp(), (-p * rate * phase).exp(), 1.0];
        let [grows, decays, level] = linear(&phases, &values, basis)?;
        let matrix = Mat::from_fn(phases.len(), 4, |row, column| {
            let [up, down, one] = basis(phases[row]);
            [phases[row] * (grows * up - p * decays * down), up, down, one][column]
        });
        let right = Mat::from_fn(phases.len(), 1, |row, _| {
            let [up, down, _] = basis(phases[row]);
            values[row] - grows * up - decays * down - level
        });
        let step: f64 = matrix.qr().solve_lstsq(&right)[(0, 0)];
        if !step.is_finite() {
            return None;
        }
        // Half the rate at most: a wild first step must not leave the region of growth.
        rate += step.clamp(-0.5 * rate, 0.5 * rate);
        if step.abs() < 1e-12 {
            break;
        }
    }
    Some(rate * expected)
}

/// Slope of a straight line through values at places by least squares; `None` for fewer than 2 places.
pub fn slope(places: &[f64], values: &[f64]) -> Option<f64> {
    let count = places.len() as f64;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / count;
    let (middle, level) = (mean(places), mean(values));
    let (rise, run) = places.iter().zip(values).fold((0.0, 0.0), |(rise, run), (x, y)| {
        (rise + (x - middle) * (y - level), run + (x - middle) * (x - middle))
    });
    (run > 0.0).then(|| rise / run)
}

fn linear(phases: &[f64], values: &[f64], basis: impl Fn(f64) -> [f64; 3]) -> Option<[f64; 3]> {
    let matrix = Mat::from_fn(phases.len(), 3, |row, column| basis(phases[row])[column]);
    let right = Mat::from_fn(values.len(), 1, |row, _| values[row]);
    let solution = matrix.qr().solve_lstsq(&right);
    let all = [0, 1, 2].map(|row| solution[(row, 0)]);
    all.iter().all(|c| c.is_finite()).then_some(all)
}
