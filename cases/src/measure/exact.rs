//! Exact solutions for drops of an inviscid liquid in vacuum.

use crate::scene::Liquid;
use std::f64::consts::PI;

/// A drop by radius (m), density (kg/m3) and surface tension (N/m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drop {
    /// Radius at rest in m.
    pub radius: f64,
    /// Density in kg/m3.
    pub density: f64,
    /// Surface tension in N/m.
    pub surface_tension: f64,
}

impl Drop {
    /// A drop of a scene's liquid, with its radius in m.
    pub fn of(liquid: &Liquid, radius: f64) -> Self {
        Drop { radius, density: liquid.density, surface_tension: liquid.surface_tension }
    }

    /// Pressure inside the drop at rest in Pa: 2 sigma/R (Laplace).
    pub fn laplace_pressure(&self) -> f64 {
        2.0 * self.surface_tension / self.radius
    }

    /// sqrt(sigma/(rho R)) in m/s.
    pub fn capillary_velocity(&self) -> f64 {
        (self.surface_tension / (self.density * self.radius)).sqrt()
    }

    /// Angular frequency in rad/s of small oscillations in mode n (Rayleigh):
    /// omega^2 = n (n - 1) (n + 2) sigma/(rho R^3).
    pub fn angular_frequency(&self, mode: u32) -> f64 {
        let n = f64::from(mode);
        let stiffness = n * (n - 1.0) * (n + 2.0);
        stiffness.sqrt() * self.capillary_velocity() / self.radius
    }

    /// Energy in J that the surface of a sphere gains by the deformation R (1 + epsilon P_n), to second
    /// order: 2 pi sigma R^2 (n - 1)(n + 2)/(2 n + 1) epsilon^2.
    pub fn deformation_energy(&self, mode: u32, epsilon: f64) -> f64 {
        let n = f64::from(mode);
        let area = 2.0 * PI * self.radius * self.radius * epsilon * epsilon;
        self.surface_tension * area * (n - 1.0) * (n + 2.0) / (2.0 * n + 1.0)
    }
}
