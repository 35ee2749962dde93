//! Integrate: velocities, densities and positions after the time step.

use crate::bad_state::{BadState, is_sound};
use crate::fields;
use meniscus_engine::group::{Around, Chunk, ChunkStage, Partial};
use meniscus_engine::lanes::{Lanes, WIDTH};
use meniscus_engine::pipeline::{Fault, World};
use meniscus_engine::store::{Read, Update};
use meniscus_engine::wiring::Wiring;
use std::f64::consts::{PI, SQRT_2};

/// Distance from the axis, in particle sizes, at which a ring has closed: it comes no nearer. Hardly anything that flows comes so near;
/// spray does, and its hoop strain would end the run, or its small radius the progress of all (`time_step`). One that crosses the
/// axis in a single step is a blow-up.
pub(crate) const CLOSED: f64 = 0.1;

/// How velocities are brought forward.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// Explicit Euler, as the paper has it (method.md, section 6).
    Euler,
    /// Adams-Bashforth for all but the dissipative part, which like the density takes an Euler step
    /// (method.md, section 10, "One traversal a step").
    AdamsBashforth,
}

/// The stage.
pub struct Integrate {
    /// Distance of the scene's origin from the axis, m.
    origin: f64,
    bad_state: BadState,
    position: [Update<f64>; 2],
    velocity: [Update<f64>; 2],
    density: Update<f64>,
    previous: Option<[Update<f64>; 2]>,
    force: [Read<f64>; 2],
    /// None where it is part of the force.
    dissipation: Option<[Read<f64>; 2]>,
    strain_rate: Read<f64>,
    energy: Option<(Update<f64>, Read<f64>)>,
    mass: Read<f64>,
    step: Step,
}

impl Integrate {
    /// Moves the particles by one step; `origin` is the distance of the scene's origin from the axis in m.
    /// The dissipative force may be one apart.
    pub fn new(
        wiring: &mut Wiring,
        scheme: Scheme,
        origin: f64,
        (with_dissipation, with_energy): (bool, bool),
    ) -> Self {
        wiring.stage("integrate");
        let two_step = scheme == Scheme::AdamsBashforth;
        Integrate {
            origin,
            bad_state: BadState::new(wiring, "integrate", origin),
            position: fields::POSITION.map(|field| wiring.update(field)),
            velocity: fields::VELOCITY.map(|field| wiring.update(field)),
            density: wiring.update(&fields::DENSITY),
            previous: two_step.then(|| fields::PREVIOUS_ACCELERATION.map(|field| wiring.update(field))),
            force: fields::FORCE.map(|field| wiring.read(field)),
            dissipation: with_dissipation.then(|| fields::DISSIPATION.map(|field| wiring.read(field))),
            strain_rate: wiring.read(&fields::STRAIN_RATE),
            energy: with_energy.then(|| (wiring.update(&fields::TOTAL_ENERGY), wiring.read(&fields::POWER))),
            mass: wiring.read(&fields::MASS),
            step: Step::default(),
        }
    }

    /// E += dt dE/dt, an Euler step like the density's.
    fn advance_energy(&self, chunk: &Chunk) {
        let Some((energy, power)) = self.energy else { return };
        let (power, density) = (chunk.read(power), chunk.read(self.density));
        let mut energy = chunk.write(energy);
        for ((energy, power), density) in energy.iter_mut().zip(&*power).zip(&*density) {
            *energy += self.step.length * power / density;
        }
    }

    /// Moves the particles of a chunk; the first one that went bad, if any, and no less than how far (m) any of them
    /// moved.
    fn advance(&self, chunk: &Chunk) -> (Option<usize>, f64) {
        let [force_r, force_z] = self.force.map(|field| chunk.read(field));
        let dissipation = self.dissipation.map(|fields| fields.map(|field| chunk.read(field)));
        let (strain_rate, mass) = (chunk.read(self.strain_rate), chunk.read(self.mass));
        let [mut r, mut z] = self.position.map(|field| chunk.write(field));
        let [mut u, mut w] = self.velocity.map(|field| chunk.write(field));
        let mut density = chunk.write(self.density);
        let mut previous = self.previous.map(|fields| fields.map(|field| chunk.write(field)));

        let origin = self.origin;
        let step = &self.step;
        let (mut bad, mut farthest) = (None, Lanes::ZERO);
        for first in (0..chunk.len()).step_by(WIDTH) {
            let eight = first..chunk.len().min(first + WIDTH);
            let before = Lanes::load_or(&density[eight.clone()], 1.0);
            let inverse = Lanes::ONE / before;
            let component = |force: &[f64], dissipation: Option<&[f64]>, previous: Option<&mut [f64]>| {
                let of = |force: &[f64]| Lanes::load_or(&force[eight.clone()], 0.0) * inverse;
                let dissipation = dissipation.map_or(Lanes::ZERO, of);
                step.change(of(force), dissipation, previous.map(|previous| &mut previous[eight.clone()]))
            };
            let (dissipation_r, dissipation_z) = match &dissipation {
                Some([r, z]) => (Some(&r[..]), Some(&z[..])),
                None => (None, None),
            };
            let (previous_r, previous_z) = match &mut previous {
                Some([r, z]) => (Some(&mut r[..]), Some(&mut z[..])),
                None => (None, None),
            };
            let du = component(&force_r, dissipation_r, previous_r);
            let dw = component(&force_z, dissipation_z, previous_z);
            let (new_u, moved_r) = step.advance(&mut r[eight.clone()], &mut u[eight.clone()], du);
            let radius = Lanes::load_or(&r[eight.clone()], 1.0) + Lanes::splat(origin);
            // R < CLOSED D with D^2 = m/(2 pi R rho).
            let closed = Lanes::splat(CLOSED * CLOSED) * Lanes::load_or(&mass[eight.clone()], 0.0);
            let open = Lanes::splat(2.0 * PI) * radius * radius * radius * before;
            let new_u = closed.select_greater(open, new_u.max(Lanes::ZERO), new_u);
            new_u.store(&mut u[eight.clone()]);
            let moved_r = if (open - closed).all_positive() {
                moved_r
            } else {
                let placed = Lanes::load_or(&r[eight.clone()], 0.0);
                for k in eight.clone() {
                    let least = (CLOSED * CLOSED * mass[k] / (2.0 * PI * density[k])).cbrt();
                    if r[k] + origin > 0.0 {
                        r[k] = r[k].max(least - origin);
                    }
                }
                moved_r + (Lanes::load_or(&r[eight.clone()], 0.0) - placed)
            };
            let (new_w, moved_z) = step.advance(&mut z[eight.clone()], &mut w[eight.clone()], dw);
            farthest = farthest.max(length_at_most(moved_r, moved_z));
            let strain = step.dt * Lanes::load_or(&strain_rate[eight.clone()], 0.0);
            let new_density = before * (-strain).exp();
            new_density.store(&mut density[eight.clone()]);
            // One test for all: the sum is finite where every part is.
            let sum = new_density + new_u + new_w + Lanes::load_or(&z[eight.clone()], 0.0);
            let least = new_density.min(radius).min(Lanes::splat(f64::MAX) - sum.abs());
            if !least.all_positive() && bad.is_none() {
                bad = eight.into_iter().find(|&k| !is_sound([density[k], u[k], w[k], z[k], r[k]], origin));
            }
        }
        (bad, farthest.to_array().into_iter().fold(0.0, f64::max))
    }
}

/// The length of a vector, or up to 8 % more.
#[inline(always)]
fn length_at_most(r: Lanes, z: Lanes) -> Lanes {
    let (r, z) = (r.abs(), z.abs());
    r.min(z).mul_add(Lanes::splat(SQRT_2 - 1.0), r.max(z))
}

/// One step's factors.
#[derive(Clone, Copy, Default)]
struct Step {
    /// dt in seconds.
    length: f64,
    /// The same in every lane.
    dt: Lanes,
    now: Lanes,
    before: Lanes,
}

impl Step {
    /// dt [(1 + q) a_w^n - q a_w^{n-1} + a_d^n]; notes a_w^n for the next step.
    #[inline(always)]
    fn change(&self, force: Lanes, dissipation: Lanes, previous: Option<&mut [f64]>) -> Lanes {
        let acceleration = match previous {
            Some(previous) => {
                let before = Lanes::load_or(previous, 0.0);
                force.store(previous);
                self.now * force - self.before * before
            }
            None => force,
        };
        self.dt * (acceleration + dissipation)
    }

    /// x += dt (U^n + U^{n+1})/2 and U += change; the new velocity, and how far that is.
    #[inline(always)]
    fn advance(&self, position: &mut [f64], velocity: &mut [f64], change: Lanes) -> (Lanes, Lanes) {
        let before = Lanes::load_or(velocity, 0.0);
        let moved = self.dt * (before + Lanes::HALF * change);
        (Lanes::load_or(position, 0.0) + moved).store(position);
        (before + change).store(velocity);
        (before + change, moved)
    }
}

impl ChunkStage for Integrate {
    fn name(&self) -> &'static str {
        "integrate"
    }

    fn prepare(&mut self, world: &mut World) -> Result<(), Fault> {
        let Some(bound) = world.clock.bound() else { return Ok(()) };
        let dt = bound.step_size;
        let before = world.clock.previous_step_size;
        let q = if self.previous.is_some() && before > 0.0 { dt / (2.0 * before) } else { 0.0 };
        self.step =
            Step { length: dt, dt: Lanes::splat(dt), now: Lanes::splat(1.0 + q), before: Lanes::splat(q) };
        Ok(())
    }

    /// Number of the first particle that went bad, or infinity; how far any particle moved, m.
    fn chunk(&self, _: &Around, chunk: &Chunk) -> Partial {
        self.advance_energy(chunk);
        let (bad, farthest) = self.advance(chunk);
        [bad.map_or(f64::INFINITY, |k| (chunk.start + k) as f64), farthest]
    }

    fn combine(&self, left: Partial, right: Partial) -> Partial {
        [left[0].min(right[0]), left[1].max(right[1])]
    }

    fn finish(&mut self, world: &mut World, [bad, farthest]: Partial) -> Result<(), Fault> {
        world.neighbours.note_motion(farthest);
        if bad == f64::INFINITY { Ok(()) } else { Err(self.bad_state.of(world, bad as usize)) }
    }
}
