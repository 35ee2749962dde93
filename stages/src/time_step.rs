//! The time step: the longest that is stable for every particle.

use crate::bad_state::BadState;
use crate::fields;
use crate::rows::PackedState;
use crate::sound_speed::SoundSpeed;
use crate::viscosity::evening_rate;
use meniscus_engine::clock::Clock;
use meniscus_engine::group::{Around, Chunk, ChunkStage, Partial};
use meniscus_engine::lanes::{Lanes, WIDTH};
use meniscus_engine::parallel::{self, larger};
use meniscus_engine::pipeline::{Fault, World};
use meniscus_engine::store::Read;
use meniscus_engine::wiring::Wiring;
use std::f64::consts::PI;

/// A step this much shorter than the acoustic one at rest is a blow-up, not a step.
const VANISHING: f64 = 1e-4;

/// Distance from the axis, in particle sizes, of the innermost particles of a regular packing.
pub(crate) const INNERMOST: f64 = 0.43;

/// The part of a full support with which a particle's contacts bound the step as those of all others do.
const ATTACHED: f64 = 0.0625;

/// How many times longer than the one before a step may be: where spray lets go of everyone's, forces of the step
/// before would count for several times as much.
const LONGER: f64 = 1.5;

/// How many times longer than at rest a step may be before the motion itself bounds it.
const UNBOUND: f64 = 10.0;

/// Limits of the time step.
#[derive(Clone, Copy, Debug)]
pub struct Courant {
    /// Courant number.
    pub number: f64,
    /// Sound speed at rest or the fastest flow, whichever is larger, m/s.
    pub speed: f64,
    /// Particle size at the start, m.
    pub particle_size: f64,
    /// Distance of the scene's origin from the axis, m.
    pub origin: f64,
}

/// The stage.
pub struct TimeStep {
    courant: Courant,
    bad_state: BadState,
    radius: Read<f64>,
    velocity: [Read<f64>; 2],
    strain_rate: Read<f64>,
    density: Read<f64>,
    mass: Read<f64>,
    sound_speed: SoundSpeed,
    /// I - L, rr and zz, where there are ghosts.
    deficiency: Option<[Read<f64>; 2]>,
}

impl TimeStep {
    /// States the acoustic bound. It must follow all that changes the strain rate or states a bound. `with_ghosts` it lets
    /// go of particles that are alone.
    pub fn new(
        wiring: &mut Wiring,
        courant: Courant,
        constant_sound_speed: Option<f64>,
        with_ghosts: bool,
    ) -> Self {
        wiring.stage("time-step");
        let deficiency = [&fields::SUPPORT_DEFICIENCY_RR, &fields::SUPPORT_DEFICIENCY_ZZ];
        TimeStep {
            courant,
            bad_state: BadState::new(wiring, "time-step", courant.origin),
            radius: wiring.read(&fields::RADIUS),
            velocity: fields::VELOCITY.map(|field| wiring.read(field)),
            strain_rate: wiring.read(&fields::STRAIN_RATE),
            density: wiring.read(&fields::DENSITY),
            mass: wiring.read(&fields::MASS),
            deficiency: with_ghosts.then(|| deficiency.map(|field| wiring.read(field))),
            sound_speed: SoundSpeed::new(wiring, constant_sound_speed),
        }
    }

    /// The particle that sets the viscous bound.
    fn most_viscous(&self, world: &World) -> usize {
        let packed = PackedState(&world.rows);
        let [r, density] = [self.radius, self.density].map(|field| world.store.read(field));
        with_largest(r.len(), |i| evening_rate(packed.area(i), r[i] + self.courant.origin, density[i]))
    }
}

/// In how many steps as long as the last one the fastest particle moves no farther than a distance in m; velocities in
/// m/s, and bounds as in [`Clock::steps_within`].
pub(crate) fn steps_to_move(clock: &Clock, [u, w]: [&[f64]; 2], distance: f64, bounds: [u64; 2]) -> u64 {
    clock.steps_within(distance / fastest([u, w]), bounds)
}

/// The greatest speed, m/s.
fn fastest([u, w]: [&[f64]; 2]) -> f64 {
    parallel::maximum(u.len(), |i| u[i] * u[i] + w[i] * w[i]).sqrt()
}

/// The particle with the largest value.
fn with_largest(particles: usize, value: impl Fn(usize) -> f64) -> usize {
    (0..particles).max_by(|&a, &b| value(a).total_cmp(&value(b))).unwrap_or(0)
}

impl ChunkStage for TimeStep {
    fn name(&self) -> &'static str {
        "time-step"
    }

    /// dt = CFL min D/sqrt(C^2 + (4 D d eps/dt)^2) (method.md, section 6), for a ring nearer to the axis than
    /// .43 D times (R/(.43 D))^2: its own hoop terms, P/(rho R) and U_r/R, swing with C/R and grow by
    /// (C dt/R)^2/4 a step, which the pressure diffusion of the contacts must outweigh. (The innermost rings of
    /// a regular packing lie at .43 D.) Here the largest (CFL/dt)^2.
    ///
    /// Spray becomes ever smaller on its way outward, D^2 with 1/R, and would hold the steps of all. With ghosts a ring that
    /// nobody touches, nor its own image, has its hoop terms alone: R takes the place of D, but no more than D at the start. (The swing is
    /// damped by the ghost with C/R, and stable up to C dt/R = .88. Without ghosts it would grow.) With the first ATTACHED of a
    /// full support D comes back. What flies so fast that it moves by more than its support in a step may pass through other spray.
    ///
    /// A gas without heat that moves as a whole has neither C nor d eps/dt. Where so little bounds a step no particle
    /// moves farther than a particle's size at the start.
    fn chunk(&self, _: &Around, chunk: &Chunk) -> Partial {
        let (strain_rate, sound_speed) = (chunk.read(self.strain_rate), self.sound_speed.of(chunk));
        let [r, density, mass] = [self.radius, self.density, self.mass].map(|field| chunk.read(field));
        let (origin, two_pi) = (Lanes::splat(self.courant.origin), Lanes::splat(2.0 * PI));
        let innermost = Lanes::splat(INNERMOST * INNERMOST);
        let deficiency = self.deficiency.map(|fields| fields.map(|field| chunk.read(field)));
        let at_start = Lanes::splat(self.courant.particle_size.powi(-2));
        // Whoever has half the area of the start or more needs no closer look.
        let small = Lanes::splat(2.0 * self.courant.speed.powi(2)) * at_start;
        let (mut largest, mut all) = (Lanes::ZERO, Lanes::ZERO);
        for first in (0..chunk.len()).step_by(WIDTH) {
            let eight = first..chunk.len().min(first + WIDTH);
            let load = |column: &[f64], fill| Lanes::load_or(&column[eight.clone()], fill);
            // Whoever fills up the last eight is large, and far from the axis.
            let radius = load(&r, 1e150) + origin;
            // 1/D^2 and (R/D)^2.
            let inverse = two_pi * radius * load(&density, 1.0) / load(&mass, 1e300);
            let distance = radius * radius * inverse;
            let inverse_length = if (distance - innermost).all_positive() {
                inverse
            } else {
                let near = (distance / innermost).min(Lanes::ONE);
                inverse / (near * near)
            };
            let (strain, sound_speed) =
                (Lanes::splat(4.0) * load(&strain_rate, 0.0), sound_speed.of(eight.clone()));
            let rate_of =
                |inverse_length: Lanes| (sound_speed * sound_speed).mul_add(inverse_length, strain * strain);
            let mut rate = rate_of(inverse_length);
            if let Some([rr, zz]) = &deficiency
                && !(small - rate).all_positive()
            {
                // tr L/2 is one for a full support.
                let support = Lanes::ONE - Lanes::HALF * (load(rr, 0.0) + load(zz, 0.0));
                let attached = (support * Lanes::splat(1.0 / ATTACHED)).max(Lanes::ZERO).min(Lanes::ONE);
                let alone = (inverse / distance).max(at_start).min(inverse_length);
                let relaxed = rate_of(attached.mul_add(inverse_length - alone, alone));
                rate = rate.select_greater(small, relaxed, rate);
            }
            largest = largest.max(rate);
            all += rate;
        }
        // No maximum hides a NaN: the sum has it as well.
        let largest = largest.to_array().into_iter().fold(0.0, f64::max);
        [if all.sum().is_nan() { f64::NAN } else { largest }, 0.0]
    }

    fn combine(&self, [left, _]: Partial, [right, _]: Partial) -> Partial {
        [larger(left, right), 0.0]
    }

    fn finish(&mut self, world: &mut World, [largest, _]: Partial) -> Result<(), Fault> {
        let at_rest = self.courant.number * self.courant.particle_size / self.courant.speed;
        let (before, stable) = (world.clock.previous_step_size, self.courant.number / largest.sqrt());
        let stable = if stable > UNBOUND * at_rest {
            let [u, w] = self.velocity.map(|field| world.store.read(field));
            stable.min(self.courant.particle_size / fastest([&u, &w]))
        } else {
            stable
        };
        // Neither hides a NaN.
        let acoustic = if before > 0.0 && stable > LONGER * before { LONGER * before } else { stable };
        world.clock.limit("acoustic", acoustic);
        let step_size = world.clock.bound().map_or(acoustic, |bound| bound.step_size);
        if step_size > VANISHING * at_rest {
            return Ok(());
        }
        // A particle whose state is bad spoils its neighbours' rates: it comes first.
        if let Some(fault) = self.bad_state.first(world) {
            return Err(fault);
        }
        let strain_rate = world.store.read(self.strain_rate);
        let strains_most = with_largest(strain_rate.len(), |i| strain_rate[i].abs());
        if acoustic > VANISHING * at_rest {
            // The motion is sound: another stage's bound leaves no step, as of a liquid far too viscous.
            let (bound, worst, way_out) = match world.clock.bound().map_or("", |bound| bound.reason) {
                "viscous" => (
                    "viscous time step",
                    self.most_viscous(world),
                    ": lower the viscosity or enlarge the particles",
                ),
                // It is the same for all particles: none of them sets it.
                "surface tension" => {
                    ("capillary time step", strains_most, ": raise the sound speed or enlarge the particles")
                }
                _ => ("time step", strains_most, ""),
            };
            let note = format!(" s (at least {:.3e} s is needed{way_out})", VANISHING * at_rest);
            return Err(Fault { note, ..self.bad_state.fault(world, worst, bound, step_size) });
        }
        Err(self.bad_state.fault(world, strains_most, "strain_rate", strain_rate[strains_most]))
    }

    /// What moves the particles needs the step.
    fn ends_group(&self) -> bool {
        true
    }
}
