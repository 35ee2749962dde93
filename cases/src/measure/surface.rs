//! The energy of a free surface: from its measured deformation where it is nearly a sphere, else its area.

use super::exact::Drop;
use super::free_surface;
use super::motion::mass_sum;
use super::observe::Particles;
use crate::assemble::Physics;
use crate::region::Region;
use crate::scene::{Measure, Scene};
use crate::shape::Shape;
use meniscus_engine::lanes::Lanes;
use meniscus_engine::store::Store;
use std::f64::consts::PI;

/// Heights on which a shape is compared with a sphere.
const LINES: usize = 32;
/// Part of the radius by which a surface may differ from a sphere's whose energy is taken from its deformation.
const NEARLY: f64 = 0.15;

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
            Measure::LaplacePressure { radius, .. } | Measure::Oscillation { radius, .. } => {
                is_nearly_sphere(&scene.bodies[0].shape, *radius).then_some(*radius)
            }
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

/// Whether a shape's surface lies near that of a sphere about its middle, as looked at on some heights.
fn is_nearly_sphere(shape: &Shape, radius: f64) -> bool {
    let [_, _, bottom, top] = shape.bounds();
    (0..LINES).all(|line| {
        let z = (top - bottom) * ((line as f64 + 0.5) / LINES as f64 - 0.5);
        let chords: Vec<[f64; 2]> = shape.chords(0.5 * (bottom + top) + z).iter().collect();
        matches!(chords[..], [[low, r]] if low <= 1e-9 * radius && (r.hypot(z) / radius - 1.0).abs() < NEARLY)
    })
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
    let mut modes = Vec::new();
    let deformation = |(measure, amplitude): (&Measure, &Vec<f64>)| match *measure {
        // A mode that is measured twice is deformed once.
        Measure::Oscillation { mode, .. } if !modes.contains(&mode) => {
            modes.push(mode);
            drop.deformation_energy(mode, deformation(mode, amplitude[0]))
        }
        _ => 0.0,
    };
    let deformed: f64 = measures.iter().zip(amplitudes).map(deformation).sum();
    drop.surface_tension * sphere + deformed
}

/// epsilon of R (1 + epsilon P_n) from the moment of the solid harmonic: A_n = 3 epsilon/(2 n + 1).
fn deformation(mode: u32, amplitude: f64) -> f64 {
    amplitude * (2.0 * f64::from(mode) + 1.0) / 3.0
}

#[cfg(test)]
mod tests {
    use crate::measure::Observer;
    use crate::scene::parse;
    use crate::simulation::{Simulation, to_the_end};

    /// Energy of the surface at the start, over that of a sphere of 1 mm radius.
    fn energy(shape: &str, measures: &str) -> f64 {
        let text = format!(
            "format = 1\n[liquid]\ndensity = \"1000 kg/m3\"\nsurface_tension = \"72 mN/m\"\n[[body]]\nshape = {{ {shape} }}\n\
             [particles]\nsize = \"0.15 mm\"\n[run]\nuntil = \"15 ms\"\n{measures}"
        );
        let scene = parse("drop.toml", &text, &[]).unwrap();
        let simulation = Simulation::new(&scene, &mut to_the_end).unwrap();
        let observer = Observer::new(&scene, &simulation);
        let column =
            observer.quantities().iter().position(|quantity| quantity.name == "surface energy").unwrap();
        observer.observe(&simulation)[column] / (0.072 * 4e-6 * std::f64::consts::PI)
    }

    #[test]
    fn a_surface_has_one_energy_however_it_is_measured() {
        let spheroid = "spheroid = { radial = \"0.95 mm\", axial = \"1.108 mm\" }";
        let mode = "[[measure]]\noscillation = { mode = 2, radius = \"1 mm\" }\n";
        let once = energy(spheroid, mode);
        assert!(once > 1.002, "{once}");
        assert_eq!(energy(spheroid, &mode.repeat(2)), once);
        let twin = [-0.9, 0.9]
            .map(|centre| format!("{{ sphere = {{ radius = \"1 mm\", centre = \"{centre} mm\" }} }}"));
        let twin = format!("union = [{}]", twin.join(", "));
        let mode = mode.replace("1 mm", "1.26 mm");
        assert_eq!(energy(&twin, &mode), energy(&twin, ""));
    }
}
