//! The exact motion of a free spheroid of an incompressible liquid under a central force.

/// Semi-axes and strain rate of the flow (A z, -A r/2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spheroid {
    /// Semi-axis across the axis of symmetry in m.
    pub radial: f64,
    /// Semi-axis along it in m.
    pub axial: f64,
    /// A in 1/s.
    pub shear: f64,
    /// B^2 of the central force in 1/s2.
    pub stiffness: f64,
}

/// Steps of the Runge-Kutta method from one time to the next at least.
const STEPS: usize = 64;

impl Spheroid {
    /// Semi-axes [radial, axial] at ever later times in s, starting at t = 0.
    pub fn at_times(&self, times: &[f64]) -> Vec<[f64; 2]> {
        let (mut state, mut now) = ([self.radial, self.axial, self.shear], 0.0);
        let advance = |time: &f64| {
            let step = (time - now) / STEPS as f64;
            for _ in 0..STEPS {
                state = self.runge_kutta(state, step);
            }
            now = *time;
            [state[0], state[1]]
        };
        times.iter().map(advance).collect()
    }

    /// b' = -b A/2, a' = a A, A' = 2 C/a^2 - A^2 - B^2 with C = (3/4 A^2 + 3/2 B^2)/(2/b^2 + 1/a^2).
    fn rates(&self, [radial, axial, shear]: [f64; 3]) -> [f64; 3] {
        let square = shear * shear;
        let pressure =
            (0.75 * square + 1.5 * self.stiffness) / (2.0 / (radial * radial) + 1.0 / (axial * axial));
        let strain = 2.0 * pressure / (axial * axial) - square - self.stiffness;
        [-0.5 * radial * shear, axial * shear, strain]
    }

    fn runge_kutta(&self, state: [f64; 3], step: f64) -> [f64; 3] {
        let along = |rates: [f64; 3], part: f64| {
            let moved = |k: usize| state[k] + part * step * rates[k];
            [moved(0), moved(1), moved(2)]
        };
        let first = self.rates(state);
        let second = self.rates(along(first, 0.5));
        let third = self.rates(along(second, 0.5));
        let fourth = self.rates(along(third, 1.0));
        let mean = |k: usize| (first[k] + 2.0 * second[k] + 2.0 * third[k] + fourth[k]) / 6.0;
        along([mean(0), mean(1), mean(2)], 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_free_spheroid_stretches_as_it_must() {
        let sphere = Spheroid { radial: 1.0, axial: 1.0, shear: 1.0, stiffness: 0.0 };
        let [radial, axial] = sphere.at_times(&[0.0, 0.5, 1.0])[2];
        assert!((axial - 2.132540).abs() < 1e-6 && (radial - 0.684781).abs() < 1e-6, "{axial} {radial}");
    }

    #[test]
    fn a_central_force_brings_it_back() {
        let sphere = Spheroid { radial: 1.0, axial: 1.0, shear: 1.0, stiffness: 1.0 };
        for time in [2.439755, 4.649887, 7.089642] {
            let times: Vec<f64> = (0..=100).map(|k| f64::from(k) * time / 100.0).collect();
            let [radial, axial] = sphere.at_times(&times)[100];
            assert!((axial - radial).abs() < 1e-5, "{time}: {axial} {radial}");
        }
    }
}
