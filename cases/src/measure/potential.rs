//! The motion of an inviscid drop that starts at rest as a spheroid, at any amplitude: potential flow.

use crate::scene::legendre;
use faer::Mat;
use faer::linalg::solvers::SolveLstsq;
use std::f64::consts::PI;

/// Even Legendre polynomials of the surface and the potential: up to degree 18.
const MODES: usize = 10;
/// Gauss points between equator and pole: twice as many as modes, so that products of modes do not alias.
const POINTS: usize = 20;
/// Longest step in capillary times: the fastest mode has an angular frequency of 78.
const STEP: f64 = 0.01;

/// Heights z/s of the points, their weights, and at each point what every polynomial has there.
pub struct PotentialDrop {
    height: [f64; POINTS],
    weight: [f64; POINTS],
    /// P_n at a point.
    value: [[f64; MODES]; POINTS],
    /// dP_n/d(cos theta) at a point.
    slope: [[f64; MODES]; POINTS],
}

/// Coefficients of the surface s = sum c_n P_n, and those of the potential on it.
type State = [[f64; MODES]; 2];

fn degree(mode: usize) -> f64 {
    2.0 * mode as f64
}

impl Default for PotentialDrop {
    fn default() -> Self {
        let (mut height, mut weight) = ([0.0; POINTS], [0.0; POINTS]);
        for k in 0..POINTS {
            // The positive zeros of P_2N by Newton's method.
            let mut x = (PI * (k as f64 + 0.75) / (2.0 * POINTS as f64 + 0.5)).cos();
            for _ in 0..8 {
                let [value, slope] = legendre(2 * POINTS, x);
                x -= value / slope;
            }
            let slope = legendre(2 * POINTS, x)[1];
            height[k] = x;
            weight[k] = 2.0 / ((1.0 - x * x) * slope * slope);
        }
        let at = |part: usize| height.map(|x| std::array::from_fn(|mode| legendre(2 * mode, x)[part]));
        PotentialDrop { height, weight, value: at(0), slope: at(1) }
    }
}

impl PotentialDrop {
    /// Means over the volume of s^2 P_2(cos theta), in units of the square of the radius R of the sphere of the
    /// same volume, at ever later times in units of sqrt(rho R^3/sigma), for a spheroid whose half-axis along the
    /// axis of symmetry is `aspect_ratio` times the other one, and whose flow is (-r, 2 z) times half the `speed`,
    /// in units of sqrt(sigma/(rho R)) at a distance R. Good to 1e-6 where the drop stays between aspect ratios of
    /// 0.6 and 1.6; NaN where it stretches out of reach of the polynomials.
    pub fn moments(&self, (aspect_ratio, speed): (f64, f64), times: &[f64]) -> Vec<f64> {
        let radial = aspect_ratio.cbrt().recip();
        let axial = aspect_ratio * radial;
        let shape =
            self.height.map(|x| ((x / axial).powi(2) + (1.0 - x * x) / radial.powi(2)).sqrt().recip());
        let potential = std::array::from_fn(|k| 0.5 * speed * shape[k].powi(2) * self.value[k][1]);
        let (mut state, mut now) = ([self.project(&shape), self.project(&potential)], 0.0);
        let moment = |time: &f64| {
            let steps = ((time - now) / STEP).ceil().max(1.0);
            for _ in 0..steps as usize {
                state = self.runge_kutta(&state, (time - now) / steps);
            }
            now = *time;
            self.moment(&state[0])
        };
        times.iter().map(moment).collect()
    }

    fn project(&self, values: &[f64; POINTS]) -> [f64; MODES] {
        std::array::from_fn(|mode| {
            let sum: f64 = (0..POINTS).map(|k| self.weight[k] * self.value[k][mode] * values[k]).sum();
            (2.0 * degree(mode) + 1.0) * sum
        })
    }

    /// Mean of s^2 P_2 over the volume.
    fn moment(&self, surface: &[f64; MODES]) -> f64 {
        let (mut moment, mut volume) = (0.0, 0.0);
        for k in 0..POINTS {
            let s = dot(surface, &self.value[k]);
            moment += self.weight[k] * self.value[k][1] * s.powi(5) / 5.0;
            volume += self.weight[k] * s.powi(3) / 3.0;
        }
        moment / volume
    }

    /// The potential sum b_n s^n P_n that has the given values on the surface.
    fn harmonics(&self, radius: &[f64; POINTS], potential: &[f64; POINTS]) -> [f64; MODES] {
        let matrix = Mat::from_fn(POINTS, MODES, |k, mode| {
            self.weight[k].sqrt() * radius[k].powi(2 * mode as i32) * self.value[k][mode]
        });
        let right = Mat::from_fn(POINTS, 1, |k, _| self.weight[k].sqrt() * potential[k]);
        let solution = matrix.qr().solve_lstsq(&right);
        std::array::from_fn(|mode| solution[(mode, 0)])
    }

    /// The surface moves with the liquid; on it Bernoulli's law holds with the pressure sigma kappa.
    fn rates(&self, [surface, potential]: &State) -> State {
        let radius: [f64; POINTS] = std::array::from_fn(|k| dot(surface, &self.value[k]));
        let harmonics = self.harmonics(&radius, &std::array::from_fn(|k| dot(potential, &self.value[k])));
        let (mut rise, mut change) = ([0.0; POINTS], [0.0; POINTS]);
        for k in 0..POINTS {
            let (s, x) = (radius[k], self.height[k]);
            let (mut outward, mut along) = (0.0, 0.0);
            for (mode, harmonic) in harmonics.iter().enumerate() {
                let power = harmonic * s.powi(2 * mode as i32 - 1);
                outward += degree(mode) * power * self.value[k][mode];
                along += power * self.slope[k][mode];
            }
            // Derivatives by theta: that by cos theta times -sin theta, and Legendre's equation for the second.
            let sine = (1.0 - x * x).sqrt();
            let slope = dot(surface, &self.slope[k]);
            let second = x * slope
                - (0..MODES)
                    .map(|n| degree(n) * (degree(n) + 1.0) * surface[n] * self.value[k][n])
                    .sum::<f64>();
            let first = -sine * slope;
            let length = (s * s + first * first).sqrt();
            let curvature =
                (s * s + 2.0 * first * first - s * second) / length.powi(3) + (s + x * slope) / (s * length);
            let square = outward * outward + (sine * along).powi(2);
            rise[k] = outward - sine * sine * slope * along / s;
            change[k] = outward * rise[k] - 0.5 * square - (curvature - 2.0);
        }
        [self.project(&rise), self.project(&change)]
    }

    fn runge_kutta(&self, state: &State, step: f64) -> State {
        let along = |rates: &State, part: f64| -> State {
            std::array::from_fn(|half| {
                std::array::from_fn(|mode| state[half][mode] + part * step * rates[half][mode])
            })
        };
        let first = self.rates(state);
        let second = self.rates(&along(&first, 0.5));
        let third = self.rates(&along(&second, 0.5));
        let fourth = self.rates(&along(&third, 1.0));
        let mean: State = std::array::from_fn(|half| {
            std::array::from_fn(|n| {
                (first[half][n] + 2.0 * (second[half][n] + third[half][n]) + fourth[half][n]) / 6.0
            })
        });
        along(&mean, 1.0)
    }
}

fn dot(one: &[f64; MODES], other: &[f64; MODES]) -> f64 {
    one.iter().zip(other).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Time of the n-th return to the longest shape, by a parabola through three values.
    fn returns(aspect_ratio: f64, until: f64) -> Vec<f64> {
        let times: Vec<f64> = (0..=(until / STEP) as usize).map(|k| k as f64 * STEP).collect();
        let values = PotentialDrop::default().moments((aspect_ratio, 0.0), &times);
        let highest = |k: &usize| values[*k] > values[k - 1] && values[*k] >= values[k + 1];
        let vertex = |k: usize| {
            let bend = values[k - 1] - 2.0 * values[k] + values[k + 1];
            times[k] + 0.5 * STEP * (values[k - 1] - values[k + 1]) / bend
        };
        (1..times.len() - 1).filter(highest).map(vertex).collect()
    }

    /// To second order in the amplitude epsilon of P_2, Tsamopoulos and Brown (1983) have the frequency
    /// sqrt(8) (1 - 34409/58800 epsilon^2).
    #[test]
    fn a_small_amplitude_slows_as_expanded() {
        let epsilon = |aspect_ratio: f64| (aspect_ratio - 1.0) / (1.0 + 0.5 * aspect_ratio);
        let coefficient = |aspect_ratio: f64| {
            let period = returns(aspect_ratio, 2.3)[0] * 8f64.sqrt() / (2.0 * PI);
            (1.0 - 1.0 / period) / epsilon(aspect_ratio).powi(2)
        };
        // The next order is linear in the aspect ratio.
        let (one, two) = (coefficient(1.02), coefficient(1.04));
        let limit = one + (one - two) * epsilon(1.02) / (epsilon(1.04) - epsilon(1.02));
        assert!((limit - 34409.0 / 58800.0).abs() < 0.001, "{limit}");
    }

    /// A small drop in motion swings harmonically: s^2 P_2 has the mean 3/5 of the amplitude of P_2.
    #[test]
    fn a_slight_motion_is_a_harmonic() {
        let (speed, times) = (1e-3, [0.3, 0.7, 2.0]);
        let found = PotentialDrop::default().moments((1.0, speed), &times);
        for (time, found) in times.iter().zip(found) {
            let exact = 0.6 * speed / 8f64.sqrt() * (8f64.sqrt() * time).sin();
            assert!((found - exact).abs() < 1e-3 * 0.6 * speed / 8f64.sqrt(), "{time}: {found} {exact}");
        }
    }

    /// Found by the same method with twelve modes, and with other steps.
    #[test]
    fn a_large_amplitude_comes_back_late() {
        let found = returns(1.5, 9.5);
        let exact = [1.0406835, 2.0813875, 3.1220574, 4.1627485].map(|p| p * 2.0 * PI / 8f64.sqrt());
        for (found, exact) in found.iter().zip(exact) {
            assert!((found / exact - 1.0).abs() < 2e-6, "{found} {exact}");
        }
        assert_eq!(found.len(), 4);
    }
}
