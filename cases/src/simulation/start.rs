//! Before the clock starts: bodies are filled with particles, which get their initial velocities.

use super::{Simulation, StartError};
use crate::assemble::Physics;
use crate::packing::{PackingError, PackingOptions, pack};
use crate::region::Region;
use crate::scene::{Body, Scene};
use crate::shape::Endless;
use meniscus_engine::store::Store;
use meniscus_stages::fields;
use std::f64::consts::PI;
use std::ops::ControlFlow;

/// Told while bodies are filled: the part of it that is done, from 0 to 1. Says whether to go on.
pub type FillProgress<'a> = &'a mut dyn FnMut(f64) -> ControlFlow<()>;

/// What nobody follows goes on.
pub fn to_the_end(_: f64) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

impl Simulation {
    /// Fills the scene's bodies with particles and gives them their initial velocities (method.md, section 10,
    /// "Packing").
    ///
    /// # Errors
    /// A body that can't be filled, or a first state that is none; or it was not to go on.
    pub fn new(scene: &Scene, progress: FillProgress) -> Result<Self, StartError> {
        let physics = Physics::of(scene);
        let seeds = fill(scene, physics.equation.with_energy(), progress)?;
        let mut simulation = Simulation::of_count(&physics, seeds.r.len())?;
        seeds.place(&mut simulation.world.store);
        simulation.begin().map_err(StartError::FirstState)?;
        Ok(simulation)
    }
}

/// Particles before they are ones: the State that a scene gives them.
#[derive(Default)]
struct Seeds {
    r: Vec<f64>,
    z: Vec<f64>,
    velocity_r: Vec<f64>,
    velocity_z: Vec<f64>,
    mass: Vec<f64>,
    density: Vec<f64>,
    /// Empty where the equation of state needs none.
    total_energy: Vec<f64>,
}

impl Seeds {
    fn place(self, store: &mut Store) {
        let identity: Vec<u32> = (0..self.r.len() as u32).collect();
        store.set(fields::IDENTITY.description.name, &identity);
        for (field, values) in [
            (&fields::RADIUS, self.r),
            (&fields::AXIAL, self.z),
            (&fields::VELOCITY_R, self.velocity_r),
            (&fields::VELOCITY_Z, self.velocity_z),
            (&fields::MASS, self.mass),
            (&fields::DENSITY, self.density),
            (&fields::TOTAL_ENERGY, self.total_energy),
        ] {
            store.set(field.description.name, &values);
        }
    }
}

fn fill(scene: &Scene, with_energy: bool, progress: FillProgress) -> Result<Seeds, StartError> {
    let mut seeds = Seeds::default();
    let origin = scene.domain.origin;
    let extent = |body: &Body| {
        let [inner, outer, bottom, top] = body.shape.bounds();
        (outer - inner) * (top - bottom)
    };
    let (all, mut before) = (scene.bodies.iter().map(extent).sum::<f64>(), 0.0);
    for (k, body) in scene.bodies.iter().enumerate() {
        let options = PackingOptions {
            period: scene.domain.period,
            origin,
            volume: (origin > 0.0).then(|| body.shape.volume_about(origin)),
            ..PackingOptions::new(scene.particle_size)
        };
        let here = extent(body);
        let progress = &mut |part: f64| progress((before + part * here) / all);
        let packing = match scene.domain.period {
            Some(period) => pack(&Endless::new(&body.shape, period), &options, progress),
            None => pack(&body.shape, &options, progress),
        };
        let packing = packing.map_err(|source| match source {
            PackingError::Stopped => StartError::Stopped,
            source => StartError::Packing(scene.unfilled[k].because(source)),
        })?;
        before += here;
        let density = body.density.unwrap_or(scene.liquid.density);
        for ((r, z), area) in packing.r.into_iter().zip(packing.z).zip(packing.area) {
            let [velocity_r, velocity_z] = body.velocity.at(r, z);
            if with_energy {
                let kinetic = 0.5 * (velocity_r * velocity_r + velocity_z * velocity_z);
                seeds.total_energy.push(body.internal_energy.at(r, z) + kinetic);
            }
            seeds.r.push(r);
            seeds.z.push(z);
            seeds.velocity_r.push(velocity_r);
            seeds.velocity_z.push(velocity_z);
            seeds.mass.push(density * 2.0 * PI * (r + origin) * area);
            seeds.density.push(density);
        }
    }
    Ok(seeds)
}
