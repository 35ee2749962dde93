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
