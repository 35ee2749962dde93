//! A disordered block of liquid with a free surface, and one step of an assembled pipeline over it.

use crate::drops::scene;
use crate::reference::{Medium, Particle, Weights};
use meniscus_cases::assemble::{Assembly, Physics, assemble};
use meniscus_cases::scene::{AxisTreatment, Flux, Method, Recoil, ReferencePressure, Scheme};
use meniscus_engine::clock::Clock;
use meniscus_engine::pipeline::{Pipeline, World};
use meniscus_stages::surface::NEAR_BOUNDARY;
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
    pub fn draw(&mut self) -> f64 {
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
        momentum_correction: Recoil::None,
        ..Method::defaults()
    }
}

/// A liquid with the block's constants; its body is not used.
const SCENE: &str = r#"format = 1
title = "A liquid"
[liquid]
density = "1000 kg/m3"
surface_tension = "0 N/m"
sound_speed = "100 m/s"
equation_of_state = "linear"
[[body]]
shape = { sphere = { radius = "10 um", centre = "0 m" } }
[particles]
size = "1 um"
[run]
until = "1 us"
"#;

/// The block's physics with the given method. The surface tension is too small to act, but keeps the
/// ghosts of the surface in the pipeline.
pub fn physics(method: Method) -> Physics {
    Physics { method, surface_tension: 1e-200, shifting_speed: 1.0, ..Physics::of(&scene(SCENE, &[])) }
}

/// What the physics means for the reference equations.
pub fn medium(physics: &Physics) -> Medium {
    let method = &physics.method;
    Medium {
        sound_speed: physics.sound_speed,
        rest_density: physics.reference_density,
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
        viscosity: physics.viscosity,
    }
}

/// A lattice of `rows` by `columns` particles from radius `start` on, every one moved by up to
/// `disorder` (both in particle sizes), at rest.
pub fn block([rows, columns]: [usize; 2], start: f64, disorder: f64, random: &mut Random) -> Vec<Particle> {
    let mut particles = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let r = start + row as f64 + disorder * random.draw();
            let z = 0.5 + column as f64 + disorder * random.draw();
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

/// Gives particles velocities, densities, masses and gradients at random, these of few bits, as contacts know them.
pub fn stir(particles: &mut [Particle], random: &mut Random) {
    for particle in particles {
        particle.velocity = [random.draw(), random.draw()];
        particle.density *= 1.0 + 0.01 * random.draw();
        particle.mass *= 1.0 + 0.3 * random.draw();
        particle.gradient = [(); 2].map(|()| [(); 2].map(|()| (16.0 * random.draw()).round() * 65536.0));
    }
}

/// A pipeline over particles that a test has placed.
pub struct Block {
    /// The particles.
    pub world: World,
    pipeline: Pipeline,
}

/// The columns of the rate of deformation: dU_r/dr, dU_r/dz + dU_z/dr, dU_z/dz.
pub const DEFORMATION: [&str; 3] = ["deformation_rr", "deformation_shear", "deformation_zz"];

impl Block {
    /// Assembles the pipeline and sets the columns; those of corrections may be lacking.
    ///
    /// # Panics
    /// If the pipeline cannot be assembled or lacks a column that it must have.
    pub fn new(physics: &Physics, particles: &[Particle]) -> Self {
        let Assembly { wiring, pipeline, .. } = assemble(physics).expect("a pipeline");
        let mut store = wiring.allocate(particles.len());
        store.keep_transients();
        let identity: Vec<u32> = (0..particles.len() as u32).collect();
        store.set("identity", &identity);
        let mut set = |name: &str, value: &dyn Fn(&Particle) -> f64| {
            store.set(name, &particles.iter().map(value).collect::<Vec<f64>>())
        };
        let needed = [
            set("radius", &|p| p.position[0]),
            set("axial", &|p| p.position[1]),
            set("velocity_r", &|p| p.velocity[0]),
            set("velocity_z", &|p| p.velocity[1]),
            set("density", &|p| p.density),
            set("mass", &|p| p.mass),
            set("reference_pressure", &|p| p.reference_pressure),
        ];
        assert_eq!(needed, [true; 7], "a column is missing");
        set("kernel_scale", &|p| p.kernel_scale);
        // A liquid without heat, where there is an energy equation.
        set("total_energy", &|p| 0.5 * (p.velocity[0].powi(2) + p.velocity[1].powi(2)));
        // The velocity's rise along a pair needs the symmetric part of the gradient alone.
        let deformation = [
            set(DEFORMATION[0], &|p| p.gradient[0][0]),
            set(DEFORMATION[1], &|p| p.gradient[0][1] + p.gradient[1][0]),
            set(DEFORMATION[2], &|p| p.gradient[1][1]),
        ];
        // Everyone counts as near the surface at first, so that what ghosts need is kept of all.
        store.set("surface", &vec![NEAR_BOUNDARY; particles.len()]);
        let reconstructs = physics.method.flux == Flux::Reconstructed;
        assert!(!reconstructs || deformation == [true; 3], "a column is missing");
        Block { world: World::new(store, Clock::default()), pipeline }
    }

    /// The stages that run once before the first step.
    ///
    /// # Panics
    /// If one fails.
    pub fn begin(&mut self) {
        if let Err(fault) = self.pipeline.begin(&mut self.world) {
            panic!("{fault}");
        }
    }

    /// One step; without [`Block::begin`] the start stages are left out, which would
    /// change what the test has set.
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
