//! The energy of a free surface, where its shape is known to be nearly a sphere.

use super::exact::Drop;
use super::observe::Particles;
use crate::scene::{Measure, Scene};
use std::f64::consts::PI;

/// One drop that is measured as a sphere.
pub(super) struct Surface {
    drop: Drop,
}

impl Surface {
    /// `None` where there is no surface tension, or the shape of the liquid is not known.
    pub(super) fn of(scene: &Scene) -> Option<Self> {
        let alone = scene.bodies.len() == 1
            && scene.domain.origin == 0.0
            && scene.domain.period.is_none()
            && scene.liquid.surface_tension > 0.0;
        let radius = scene.measures.iter().find_map(|measure| match measure {
            Measure::LaplacePressure { radius, .. } | Measure::Oscillation { radius, .. } => Some(*radius),
            _ => None,
        });
        radius.filter(|_| alone).map(|radius| Surface { drop: Drop::of(&scene.liquid, radius) })
    }

    /// Energy in J of the sphere of the liquid's volume, and of the measured deformations of it.
    pub(super) fn energy(&self, particles: &Particles, measures: &[Measure], amplitudes: &[Vec<f64>]) -> f64 {
        let volumes = particles.mass.iter().zip(particles.density);
        let volume: f64 = volumes.map(|(mass, density)| mass / density).sum();
        let sphere = (36.0 * PI * volume * volume).cbrt();
        let deformation = |(measure, amplitude): (&Measure, &Vec<f64>)| match *measure {
            Measure::Oscillation { mode, .. } => {
                self.drop.deformation_energy(mode, deformation(mode, amplitude[0]))
            }
            _ => 0.0,
        };
        let deformed: f64 = measures.iter().zip(amplitudes).map(deformation).sum();
        self.drop.surface_tension * sphere + deformed
    }
}

/// epsilon of R (1 + epsilon P_n) from the moment of the solid harmonic: A_n = 3 epsilon/(2 n + 1).
fn deformation(mode: u32, amplitude: f64) -> f64 {
    amplitude * (2.0 * f64::from(mode) + 1.0) / 3.0
}
