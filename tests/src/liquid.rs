//! A disordered block of liquid with a free surface, and one step of an assembled pipeline over it.

use crate::reference::{Medium, Particle, Weights};
use meniscus_cases::assemble::{Assembly, Physics, assemble};
use meniscus_cases::scene::{AxisTreatment, Flux, Method, ReferencePressure, Scheme};
use meniscus_engine::clock::Clock;
use meniscus_engine::neighbours::Domain;
use meniscus_engine::pipeline::{Pipeline, World};
use meniscus_stages::equation_of_state::Linear;
use std::f64::consts::PI;

/// Particle size of the block in m.
pub const SIZE: f64 = 1e-6;
/// Sound speed in m/s.
pub const SOUND_SPEED: f64 = 100.0;
/// Density at rest in kg/m3.
pub const DENSITY: f64 = 1000.0;

/// A reproducible sequence of numbers between -1 and 1.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// A sequence for a seed.
    pub fn new(seed: u64) -> Self {
        Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// The next number.
    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// A method that leaves nothing but pair sums and ghosts: no tension, no correction, no reference.
pub fn bare_method() -> Method {
    Method {
        reference_pressure: ReferencePressure::None,
        kernel_correction: false,
        tangential_pressure: false,
        strain_correction: false,
        colour_guard: 0.0,
        momentum_correction: false,
        ..Method::defaults()
    }
}

/// The block's physics with the given method, without surface tension.
pub fn physics(method: Method) -> Physics {
    Physics {
        method,
        equation: Linear {
            sound_speed: SOUND_SPEED,
            reference_density: DENSITY,
        },
        surface_tension: 0.0,
        domain: Domain {
            origin: 0.0,
            period: None,
        },
        particle_size: SIZE,
        shifting_speed: 1.0,
    }
}

/// What the physics means for the reference equations.
pub fn medium(physics: &Physics) -> Medium {
    let method = &physics.method;
    Medium {
        sound_speed: physics.equation.sound_speed,
        rest_density: physics.equation.reference_density,
        theta: method.theta,
        largest_size: 2.0 * physics.particle_size,
        origin: physics.domain.origin,
        period: physics.domain.period.map(|(_, length)| length),
        weights: match (method.scheme, method.axis) {
            (Scheme::Parshikov, _) => Weights::Parshikov,
            (_, AxisTreatment::Conservative) => Weights::HarmonicMean,
            (_, AxisTreatment::Parshikov) => Weights::NearAxis(method.axis_factor),
        },
        reconstructed: method.flux == Flux::Reconstructed,
    }
}

/// A lattice of `rows` by `columns` particles from radius `start` on, every one moved by up to
/// `disorder` (both in particle sizes), at rest.
pub fn block([rows, columns]: [usize; 2], start: f64, disorder: f64, random: &mut Random) -> Vec<Particle> {
    let mut particles = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let r = start + row as f64 + disorder * random.next();
            let z = 0.5 + column as f64 + disorder * random.next();
            let radius = SIZE * r.abs().max(0.02);
            particles.push(Particle {
                position: [radius, SIZE * z],
                density: DENSITY,
                mass: DENSITY * 2.0 * PI * radius * SIZE * SIZE,
                kernel_scale: 1.0,
                ..Particle::default()
            });
        }
    }
    particles
}

/// Gives particles velocities, densities, masses and gradients at random.
pub fn stir(particles: &mut [Particle], random: &mut Random) {
    for particle in particles {
        particle.velocity = [random.next(), random.next()];
        particle.density *= 1.0 + 0.01 * random.next();
        particle.mass *= 1.0 + 0.3 * random.next();
        particle.gradient =
            [(); 2].map(|()| [(); 2].map(|()| random.next() / SIZE));
    }
}

/// A pipeline over particles that a test has placed.
pub struct Block {
    /// The particles.
    pub world: World,
    pipeline: Pipeline,
}

/// The names of the velocity gradient's columns.
pub const GRADIENT: [[&str; 2]; 2] = [["gradient_rr", "gradient_rz"], ["gradient_zr", "gradient_zz"]];

impl Block {
    /// Assembles the pipeline and sets the columns; those that it does not have are left out.
    ///
    /// # Panics
    /// If the pipeline cannot be assembled.
    pub fn new(physics: &Physics, particles: &[Particle]) -> Self {
        let Assembly {
            wiring, pipeline, ..
        } = assemble(physics).expect("a pipeline");
        let mut store = wiring.allocate(particles.len());
        let identity: Vec<u32> = (0..particles.len() as u32).collect();
        store.set("identity", &identity);
        let mut set = |name: &str, value: &dyn Fn(&Particle) -> f64| {
            store.set(name, &particles.iter().map(value).collect::<Vec<f64>>());
        };
        set("radius", &|p| p.position[0]);
        set("axial", &|p| p.position[1]);
        set("velocity_r", &|p| p.velocity[0]);
        set("velocity_z", &|p| p.velocity[1]);
        set("density", &|p| p.density);
        set("mass", &|p| p.mass);
        set("reference_pressure", &|p| p.reference_pressure);
        set("kernel_scale", &|p| p.kernel_scale);
        for i in 0..2 {
            for j in 0..2 {
                set(GRADIENT[i][j], &|p| p.gradient[i][j]);
            }
        }
        Block {
            world: World::new(store, Clock::default()),
            pipeline,
        }
    }

    /// One step without the start stages, which would change what the test has set.
    ///
    /// # Panics
    /// If the step fails.
    pub fn step(&mut self) {
        if let Err(fault) = self.pipeline.step(&mut self.world) {
            panic!("{fault}");
        }
    }

    /// A column in the order in which the particles were given; `None` if the pipeline has none.
    pub fn find(&self, name: &str) -> Option<Vec<f64>> {
        let store = &self.world.store;
        let values = store.by_name::<f64>(name)?;
        let identity = store.by_name::<u32>("identity")?;
        let mut ordered = vec![0.0; values.len()];
        for (&value, &identity) in values.iter().zip(identity.iter()) {
            ordered[identity as usize] = value;
        }
        Some(ordered)
    }

    /// A column that must be there, in the order in which the particles were given.
    ///
    /// # Panics
    /// If there is none.
    pub fn column(&self, name: &str) -> Vec<f64> {
        self.find(name).unwrap_or_else(|| panic!("no column `{name}`"))
    }

    /// The field `surface` in the order in which the particles were given.
    ///
    /// # Panics
    /// If there is none.
    pub fn surface(&self) -> Vec<u32> {
        let store = &self.world.store;
        let values = store.by_name::<u32>("surface").expect("a column");
        let identity = store.by_name::<u32>("identity").expect("a column");
        let mut ordered = vec![0; values.len()];
        for (&value, &identity) in values.iter().zip(identity.iter()) {
            ordered[identity as usize] = value;
        }
        ordered
    }
}

/// Every choice of weights: scheme and axis treatment.
pub const WEIGHTS: [(Scheme, AxisTreatment); 3] = [
    (Scheme::HarmonicMean, AxisTreatment::Conservative),
    (Scheme::HarmonicMean, AxisTreatment::Parshikov),
    (Scheme::Parshikov, AxisTreatment::Conservative),
];

/// Both fluxes.
pub const FLUXES: [Flux; 2] = [Flux::Reconstructed, Flux::FirstOrder];
