//! Viscosity: its force joins the other dissipative ones and bounds the time step.

use crate::fields;
use crate::rows::PackedState;
use meniscus_engine::group::{Around, Chunk, ChunkStage, Partial};
use meniscus_engine::parallel::larger;
use meniscus_engine::pipeline::{Fault, World};
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
        let [radius, density] = [&fields::RADIUS, &fields::DENSITY].map(|field| wiring.read(field));
        Viscosity { viscosity, origin, radius, density, force, power }
    }
}

impl ChunkStage for Viscosity {
    fn name(&self) -> &'static str {
        "viscosity"
    }

    /// The fastest rate that bounds the step, over mu.
    fn chunk(&self, around: &Around, chunk: &Chunk) -> Partial {
        for (part, whole) in self.force.into_iter().chain(self.power) {
            let (part, mut whole) = (chunk.read(part), chunk.write(whole));
            whole.iter_mut().zip(&*part).for_each(|(whole, part)| *whole += part);
        }
        let [r, density] = [self.radius, self.density].map(|field| chunk.read(field));
        let packed = PackedState(around.rows);
        let fastest = (0..r.len()).fold(0.0, |fastest, i| {
            larger(fastest, evening_rate(packed.area(chunk.start + i), r[i] + self.origin, density[i]))
        });
        [fastest, 0.0]
    }

    fn combine(&self, left: Partial, right: Partial) -> Partial {
        [larger(left[0], right[0]), 0.0]
    }

    fn finish(&mut self, world: &mut World, [fastest, _]: Partial) -> Result<(), Fault> {
        world.clock.limit("viscous", LARGEST / (self.viscosity * fastest));
        Ok(())
    }
}

/// The rate that bounds the step for a particle, over mu: of its area (m2), distance from the axis (m) and density (kg/m3).
#[inline(always)]
pub(crate) fn evening_rate(area: f64, radius: f64, density: f64) -> f64 {
    (FASTEST / area + 1.0 / (radius * radius)) / density
}
