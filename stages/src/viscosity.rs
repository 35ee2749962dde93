//! Viscosity: its force joins the other dissipative ones and bounds the time step.

use crate::fields;
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Add, Read};
use meniscus_engine::wiring::Wiring;

/// The fastest rate at which viscosity evens out velocities between neighbours, over mu/(rho D^2): somewhat more
/// than the largest eigenvalue of the force in a disordered drop.
const FASTEST: f64 = 8.0;

/// Largest dt times that rate. The rate of deformation is predicted from the step before: stable up to 0.9.
const LARGEST: f64 = 0.7;

/// The viscous force takes an Euler step with
///
/// ```text
/// dt <= 0.7/(8 mu/(rho D^2) + mu/(rho R^2))
/// ```
///
/// (the hoop force, of the present velocity, is stable up to dt 2 mu/(rho R^2) = 2).
pub struct Viscosity {
    viscosity: f64,
    origin: f64,
    radius: Read<f64>,
    density: Read<f64>,
    size: Read<f64>,
    force: [(Read<f64>, Add<f64>); 2],
    power: Option<(Read<f64>, Add<f64>)>,
}

impl Viscosity {
    /// `viscosity` is mu in Pa s, `origin` the distance of the scene's origin from the axis in m.
    pub fn new(wiring: &mut Wiring, viscosity: f64, origin: f64, with_energy: bool) -> Self {
        wiring.stage("viscosity");
        let mut join = |part, whole| (wiring.read(part), wiring.add(whole));
        let force = [
            join(&fields::VISCOUS_FORCE_R, &fields::DISSIPATION_R),
            join(&fields::VISCOUS_FORCE_Z, &fields::DISSIPATION_Z),
        ];
        let power = with_energy.then(|| join(&fields::VISCOUS_POWER, &fields::POWER));
        let [radius, density, size] =
            [&fields::RADIUS, &fields::DENSITY, &fields::SIZE].map(|field| wiring.read(field));
        Viscosity { viscosity, origin, radius, density, size, force, power }
    }

    fn longest_step(&self, world: &World) -> f64 {
        let [r, density, size] = [self.radius, self.density, self.size].map(|field| world.store.read(field));
        let (r, density, size) = (&r[..], &density[..], &size[..]);
        let fastest = parallel::maximum(r.len(), |i| {
            let radius = r[i] + self.origin;
            (FASTEST / (size[i] * size[i]) + 1.0 / (radius * radius)) / density[i]
        });
        LARGEST / (self.viscosity * fastest)
    }
}

impl Stage for Viscosity {
    fn name(&self) -> &'static str {
        "viscosity"
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        for (part, whole) in self.force.into_iter().chain(self.power) {
            let (part, mut whole) = (world.store.read(part), world.store.write(whole));
            parallel::for_chunks(part.len(), (&part[..], &mut whole[..]), |_, (part, whole)| {
                whole.iter_mut().zip(part).for_each(|(whole, part)| *whole += part);
            });
        }
        let longest = self.longest_step(world);
        world.clock.limit("viscous", longest);
        Ok(())
    }
}
