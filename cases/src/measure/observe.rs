//! What is observed of a run on its way: energies, momentum, extents, and what the scene's measures need.

use super::columns::{columns_of, with_index};
use super::exact::Drop;
use super::motion::{Motion, mass_sum};
use super::surface::Surface;
use super::{film, flow, free_surface, jet, large, neck, spread};
use crate::assemble::Physics;
use crate::scene::legendre;
use crate::scene::{Liquid, Measure, Scene};
use crate::simulation::Simulation;
use meniscus_engine::field::Field;
use meniscus_engine::parallel;
use meniscus_stages::fields;

/// Name and SI unit of what is observed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// Its name, unique in a run.
    pub name: String,
    /// Its SI unit; "1" for a plain number.
    pub unit: &'static str,
}

/// Observes a run. Sums run over the particles in their memory order, chunks in a fixed one: the same for any
/// number of threads, and for a resumed run.
pub struct Observer {
    physics: Physics,
    liquid: Liquid,
    origin: f64,
    surface: Option<Surface>,
    measures: Vec<Measure>,
}

/// Part of the drop's radius within which its pressure is measured, away from the surface's particles.
const CORE: f64 = 0.7;

const GENERAL: [(&str, &str); 12] = [
    ("time", "s"),
    ("step size", "s"),
    ("mass", "kg"),
    ("momentum z", "kg m/s"),
    ("momentum scale", "kg m/s"),
    ("kinetic energy", "J"),
    ("internal energy", "J"),
    ("rms velocity", "m/s"),
    ("largest r", "m"),
    ("smallest z", "m"),
    ("largest z", "m"),
    ("largest speed", "m/s"),
];

/// The particles' columns that observations need.
pub(super) struct Particles<'a> {
    pub(super) r: &'a [f64],
    pub(super) z: &'a [f64],
    pub(super) mass: &'a [f64],
    pub(super) density: &'a [f64],
    pub(super) velocity: [&'a [f64]; 2],
    /// Specific kinetic and internal energy, where the pressure depends on it.
    energy: Option<&'a [f64]>,
    /// Points of the surface, r and z in m, where something tells of them.
    pub(super) surface: Option<(Vec<f64>, Vec<f64>)>,
}

impl Particles<'_> {
    /// Specific internal energy in J/kg; 0 where the pressure does not depend on it.
    pub(super) fn internal_energy(&self, i: usize) -> f64 {
        let [u, w] = self.velocity.map(|velocity| velocity[i]);
        self.energy.map_or(0.0, |energy| energy[i] - 0.5 * (u * u + w * w))
    }
}

impl Observer {
    /// An observer of the scene's runs.
    pub fn new(scene: &Scene, simulation: &Simulation) -> Self {
        Observer {
            physics: simulation.physics.clone(),
            liquid: scene.liquid.clone(),
            origin: scene.domain.origin,
            surface: Surface::of(scene, &simulation.physics, &simulation.world.store),
            measures: scene.measures.clone(),
        }
    }

    /// What a row holds, in its order; `time` in s comes first.
    pub fn quantities(&self) -> Vec<Quantity> {
        let mut quantities: Vec<Quantity> =
            GENERAL.iter().map(|&(name, unit)| Quantity { name: name.to_owned(), unit }).collect();
        if self.surface.is_some() {
            quantities.push(Quantity { name: "surface energy".to_owned(), unit: "J" });
        }
        quantities.extend(with_index(&self.measures).flat_map(|(measure, index)| columns_of(measure, index)));
        quantities
    }

    /// One row about the present state.
    pub fn observe(&self, simulation: &Simulation) -> Vec<f64> {
        let store = &simulation.world.store;
        let column = |field: &Field<f64>| {
            let column = store.by_name::<f64>(field.description.name);
            column.expect("every pipeline moves particles of a mass and density")
        };
        let (r, z) = (column(&fields::RADIUS), column(&fields::AXIAL));
        let (mass, density) = (column(&fields::MASS), column(&fields::DENSITY));
        let velocity = (column(&fields::VELOCITY_R), column(&fields::VELOCITY_Z));
        let velocity: [&[f64]; 2] = [&velocity.0, &velocity.1];
        let energy = store.by_name::<f64>(fields::TOTAL_ENERGY.description.name);
        let particles = Particles {
            r: &r,
            z: &z,
            mass: &mass,
            density: &density,
            velocity,
            energy: energy.as_deref(),
            surface: free_surface::feet(store),
        };
        let clock = &simulation.world.clock;
        let mut row = vec![clock.time, clock.previous_step_size];
        self.observe_motion(&particles, &mut row);
        let (time, rms) = (clock.time, row[7]);
        let observe = |measure| self.observe_measure(&particles, measure, (time, rms));
        let of_measures: Vec<Vec<f64>> = self.measures.iter().map(observe).collect();
        if let Some(surface) = &self.surface {
            row.push(surface.energy((&self.physics, store), &particles, &self.measures, &of_measures));
        }
        row.extend(of_measures.into_iter().flatten());
        row
    }

    fn observe_motion(&self, particles: &Particles, row: &mut Vec<f64>) {
        let [u, w] = particles.velocity;
        let body = |start: usize, (), len: usize| {
            let mut motion = Motion::default();
            for i in start..start + len {
                let m = particles.mass[i];
                let square = u[i] * u[i] + w[i] * w[i];
                motion.mass += m;
                motion.momentum += m * w[i];
                motion.scale += (m * w[i]).abs();
                motion.kinetic += 0.5 * m * square;
                motion.compression += m * self.stored_energy(particles, i);
                motion.fastest_square = motion.fastest_square.max(square);
                let (r, z) = (particles.r[i], particles.z[i]);
                let [r_most, z_least, z_most] = motion.extents;
                motion.extents = [r_most.max(r), z_least.min(z), z_most.max(z)];
            }
            motion
        };
        let motion = parallel::fold_chunks(particles.r.len(), (), &body, &Motion::add);
        let Motion { mass, momentum, scale, kinetic, compression, fastest_square, extents } = motion;
        let rms = (2.0 * kinetic / mass).sqrt();
        row.extend([mass, momentum, scale, kinetic, compression, rms]);
        row.extend(extents);
        row.push(fastest_square.sqrt());
    }

    /// Specific internal energy in J/kg, or what compression alone has stored.
    fn stored_energy(&self, particles: &Particles, i: usize) -> f64 {
        match particles.energy {
            Some(_) => particles.internal_energy(i),
            None => self.compression_energy(particles.density[i]),
        }
    }

    /// The integral of P/rho^2 over the density from that at rest, in J/kg.
    fn compression_energy(&self, density: f64) -> f64 {
        let excess = (density - self.physics.reference_density) / self.physics.reference_density;
        // ln(1 + x) - x/(1 + x) = x^2/2 - 2 x^3/3 + 3 x^4/4 - ...: the series where it is exact to rounding, for there the
        // difference of both would cancel, and a logarithm takes long.
        let integral = if excess.abs() < 0.01 {
            let term = |sum: f64, k: i32| f64::from(k - 1) / f64::from(k) - excess * sum;
            excess * excess * (2..=9).rev().fold(0.0, term)
        } else {
            excess.ln_1p() - excess / (1.0 + excess)
        };
        self.physics.sound_speed.powi(2) * integral
    }

    /// The axial centre of mass of what lies within `reach` of a point of the axis: a drop may drift,
    /// and its shape is measured about where it is.
    fn centre_of_mass(&self, particles: &Particles, centre: f64, reach: f64) -> f64 {
        let (sum, mass) = mass_sum(particles.r.len(), |i| {
            let (r, z) = (particles.r[i] + self.origin, particles.z[i] - centre);
            let is_near = r * r + z * z < reach * reach;
            (particles.z[i], if is_near { particles.mass[i] } else { 0.0 })
        });
        if mass > 0.0 { sum / mass } else { centre }
    }

    fn observe_measure(&self, particles: &Particles, measure: &Measure, (time, rms): (f64, f64)) -> Vec<f64> {
        let place = |i: usize, centre: f64| {
            let (r, z) = (particles.r[i] + self.origin, particles.z[i] - centre);
            ((r * r + z * z).sqrt(), z)
        };
        let all = 0..particles.r.len();
        let near = self.physics.particle_size;
        match *measure {
            Measure::LaplacePressure { radius, centre } => {
                let inside = all.filter(|&i| place(i, centre).0 < CORE * radius);
                let (sum, mass) = inside.fold((0.0, 0.0), |(sum, mass), i| {
                    let m = particles.mass[i];
                    // The whole pressure, whatever part of it the forces leave out.
                    let energy = particles.internal_energy(i);
                    let pressure = self.physics.equation.pressure(particles.density[i], energy);
                    (sum + m * pressure, mass + m)
                });
                vec![sum / mass]
            }
            Measure::Oscillation { mode, radius, centre, .. } => {
                let centre = self.centre_of_mass(particles, centre, 2.0 * radius);
                let (sum, mass) = mass_sum(all.len(), |i| {
                    let (s, z) = place(i, centre);
                    let harmonic = if s > 0.0 {
                        (s / radius).powi(mode as i32) * legendre(mode as usize, z / s)[0]
                    } else {
                        0.0
                    };
                    (harmonic, particles.mass[i])
                });
                vec![sum / mass]
            }
            Measure::SpuriousVelocity { radius } => {
                vec![rms / Drop::of(&self.liquid, radius).capillary_velocity()]
            }
            Measure::GrowthRate { wavenumber, radius } => {
                jet::observe(particles, &self.physics, wavenumber, radius)
            }
            Measure::FilmRetraction { thickness } => film::observe(particles, &self.physics, thickness),
            Measure::MomentumDrift | Measure::EnergyDrift | Measure::EnergyGain => Vec::new(),
            Measure::LargeOscillation { radial, axial, speed } => {
                large::observe(particles, large::Start { radial, axial, speed })
            }
            Measure::Spread { .. } => spread::observe(particles),
            Measure::Coalescence { radius, other } => {
                // Of surfaces that meet at z = 0 the poles are farther away.
                let reach = radius.min(other);
                neck::observe(particles, [-0.5 * reach, 0.5 * reach], near)
            }
            Measure::PinchOff { .. } => neck::observe(particles, [f64::NEG_INFINITY, f64::INFINITY], near),
            Measure::SemiAxis { .. } => flow::observe_semi_axes(particles),
            Measure::PlateauDensity { dimensions, speed } => {
                flow::observe_plateau(particles, &self.physics, &self.liquid, (dimensions, speed, time))
            }
            Measure::ShockSpeed { speed, length } => {
                flow::observe_shock(particles, &self.physics, speed, length)
            }
        }
    }
}
