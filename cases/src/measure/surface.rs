//! The energy of a free surface: from its measured deformation where it is nearly a sphere, else its area.

use super::exact::Drop;
use super::free_surface;
use super::motion::mass_sum;
use super::observe::Particles;
use crate::assemble::Physics;
use crate::scene::{Measure, Scene};
use meniscus_engine::lanes::Lanes;
use meniscus_engine::store::Store;
use std::f64::consts::PI;

/// How the energy of a scene's surface is found.
pub(super) enum Surface {
    /// One drop that is measured as a sphere: exact to second order of its deformation.
    Sphere(Drop),
    /// Any other: the area between the points where particles have found it, good to some 1e-3.
    Free,
}

impl Surface {
    /// `None` where there is no surface tension, or nothing tells where the surface lies.
    pub(super) fn of(scene: &Scene, physics: &Physics, store: &Store) -> Option<Self> {
        if scene.liquid.surface_tension <= 0.0 {
            return None;
        }
        let alone = scene.bodies.len() == 1 && scene.domain.origin == 0.0 && scene.domain.period.is_none();
        let radius = scene.measures.iter().find_map(|measure| match measure {
            Measure::LaplacePressure { radius, .. } | Measure::Oscillation { radius, .. } => Some(*radius),
            _ => None,
        });
        match radius.filter(|_| alone) {
            Some(radius) => Some(Surface::Sphere(Drop::of(&scene.liquid, radius))),
            None => free_surface::area(store, physics).map(|_| Surface::Free),
        }
    }

    /// Energy in J.
    pub(super) fn energy(
        &self,
        (physics, store): (&Physics, &Store),
        particles: &Particles,
        measures: &[Measure],
        amplitudes: &[Vec<f64>],
    ) -> f64 {
        match self {
            Surface::Sphere(drop) => energy_of_sphere(drop, particles, measures, amplitudes),
            Surface::Free => physics.surface_tension * free_surface::area(store, physics).unwrap_or(f64::NAN),
        }
    }
}

/// Of the sphere of the liquid's volume, and of the measured deformations of it.
fn energy_of_sphere(
    drop: &Drop,
    particles: &Particles,
    measures: &[Measure],
    amplitudes: &[Vec<f64>],
) -> f64 {
    let (volume, _) = mass_sum(particles.r.len(), |eight| {
        let density = Lanes::load_or(&particles.density[eight.clone()], 1.0);
        [Lanes::ONE / density, Lanes::load_or(&particles.mass[eight], 0.0)]
    });
    let sphere = (36.0 * PI * volume * volume).cbrt();
    let deformation = |(measure, amplitude): (&Measure, &Vec<f64>)| match *measure {
        Measure::Oscillation { mode, .. } => drop.deformation_energy(mode, deformation(mode, amplitude[0])),
        _ => 0.0,
    };
    let deformed: f64 = measures.iter().zip(amplitudes).map(deformation).sum();
    drop.surface_tension * sphere + deformed
}

/// epsilon of R (1 + epsilon P_n) from the moment of the solid harmonic: A_n = 3 epsilon/(2 n + 1).
fn deformation(mode: u32, amplitude: f64) -> f64 {
    amplitude * (2.0 * f64::from(mode) + 1.0) / 3.0
}
