//! Exact solutions for drops in vacuum.

use super::viscous::{Mode, drop_mode};
use crate::scene::Liquid;
use std::f64::consts::PI;

/// A drop by radius (m), density (kg/m3), surface tension (N/m) and viscosity (Pa s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drop {
    /// Radius at rest in m.
    pub radius: f64,
    /// Density in kg/m3.
    pub density: f64,
    /// Surface tension in N/m.
    pub surface_tension: f64,
    /// Viscosity in Pa s.
    pub viscosity: f64,
}

impl Drop {
    /// A drop of a scene's liquid, with its radius in m.
    pub fn of(liquid: &Liquid, radius: f64) -> Self {
        let Liquid { density, surface_tension, viscosity, .. } = *liquid;
        Drop { radius, density, surface_tension, viscosity }
    }

    /// Pressure inside the drop at rest in Pa: 2 sigma/R (Laplace).
    pub fn laplace_pressure(&self) -> f64 {
        2.0 * self.surface_tension / self.radius
    }

    /// sqrt(sigma/(rho R)) in m/s.
    pub fn capillary_velocity(&self) -> f64 {
        (self.surface_tension / (self.density * self.radius)).sqrt()
    }

    /// Angular frequency in rad/s of small oscillations in mode n without viscosity (Rayleigh):
    /// omega^2 = n (n - 1) (n + 2) sigma/(rho R^3).
    pub fn angular_frequency(&self, mode: u32) -> f64 {
        let n = f64::from(mode);
        let stiffness = n * (n - 1.0) * (n + 2.0);
        stiffness.sqrt() * self.capillary_velocity() / self.radius
    }

    /// What the frequency of mode n is, over Rayleigh's, if sound travels at a finite speed in m/s. Inside the drop
    /// the potential is j_n(omega s/C) P_n(cos theta) then, where the incompressible one is s^n P_n, and Laplace's
    /// pressure at the surface gives
    /// ```text
    /// omega^2 = omega_Rayleigh^2 x j_n'(x)/(n j_n(x)), x = omega R/C
    /// x j_n'/j_n = n - x j_{n+1}/j_n = n - x^2/(2 n + 3) - ...
    /// ```
    /// NaN for sound that is slower than the motion.
    pub fn compressible_frequency_ratio(&self, mode: u32, sound_speed: f64) -> f64 {
        let n = f64::from(mode);
        let rayleigh = self.angular_frequency(mode) * self.radius / sound_speed;
        let stiffness = |x: f64| {
            let highest = mode + 40;
            let ratio = (mode..highest).rev().fold(0.0, |next, k| x / (2.0 * f64::from(k) + 3.0 - x * next));
            1.0 - x * ratio / n
        };
        // The right side falls with x: each round corrects by a part (omega R/C)^2 of what is left.
        (0..60).fold(1.0, |ratio, _| stiffness(rayleigh * ratio).sqrt())
    }

    /// Small oscillations in mode n with the drop's viscosity; `None` where it is too viscous to oscillate.
    pub fn mode(&self, mode: u32) -> Option<Mode> {
        drop_mode(mode, self.angular_frequency(mode), self.radius, self.viscosity / self.density)
    }

    /// Energy in J that the surface of a sphere gains by the deformation R (1 + epsilon P_n), to second
    /// order: 2 pi sigma R^2 (n - 1)(n + 2)/(2 n + 1) epsilon^2.
    pub fn deformation_energy(&self, mode: u32, epsilon: f64) -> f64 {
        let n = f64::from(mode);
        let area = 2.0 * PI * self.radius * self.radius * epsilon * epsilon;
        self.surface_tension * area * (n - 1.0) * (n + 2.0) / (2.0 * n + 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sound_of_finite_speed_slows_an_oscillation() {
        let drop = Drop { radius: 1e-6, density: 1000.0, surface_tension: 0.074, viscosity: 0.0 };
        for mode in [2, 3, 4] {
            let n = f64::from(mode);
            let speed = drop.angular_frequency(mode) * drop.radius;
            assert!((drop.compressible_frequency_ratio(mode, 1e6 * speed) - 1.0).abs() < 1e-12);
            let series = 1.0 - 0.5 * 0.01 / (n * (2.0 * n + 3.0));
            let ratio = drop.compressible_frequency_ratio(mode, 10.0 * speed);
            assert!((ratio - series).abs() < 2e-6, "{ratio} {series}");
        }
        // x = 1.2: j_2 and its derivative from their closed forms.
        let (x, step) = (1.2, 1e-4);
        let j2 = |x: f64| (3.0 / (x * x) - 1.0) * x.sin() / x - 3.0 * x.cos() / (x * x);
        let slope = (j2(x + step) - j2(x - step)) / (2.0 * step);
        let square = x * slope / (2.0 * j2(x));
        let speed = drop.angular_frequency(2) * drop.radius * square.sqrt() / x;
        let ratio = drop.compressible_frequency_ratio(2, speed);
        assert!((ratio - square.sqrt()).abs() < 1e-7, "{ratio} {square}");
    }
}
