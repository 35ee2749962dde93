//! Integrate: the time step, then velocities, densities and positions.

use crate::fields;
use meniscus_engine::lanes::{Lanes, WIDTH};
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Read, Update};
use meniscus_engine::wiring::Wiring;

/// A step this much shorter than the acoustic one at rest is a blow-up, not a step.
const VANISHING: f64 = 1e-4;

/// Distance from the axis, in particle sizes, of the innermost particles of a regular packing.
const INNERMOST: f64 = 0.43;

/// Distance from the axis, in particle sizes, at which a ring has closed. Nothing that flows comes so near;
/// spray without neighbours does, and its hoop strain would end the run.
pub(crate) const CLOSED: f64 = 0.05;

/// How velocities are brought forward.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// Explicit Euler, as the paper has it (method.md, section 6).
    Euler,
    /// Adams-Bashforth for all but the dissipative part, which like the density takes an Euler step
    /// (method.md, section 10, "One traversal a step").
    AdamsBashforth,
}

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
pub struct Integrate {
    courant: Courant,
    identity: Read<u32>,
    position: [Update<f64>; 2],
    velocity: [Update<f64>; 2],
    density: Update<f64>,
    previous: Option<[Update<f64>; 2]>,
    force: [Read<f64>; 2],
    dissipation: [Read<f64>; 2],
    strain_rate: Read<f64>,
    energy: Option<(Update<f64>, Read<f64>)>,
    size: Read<f64>,
    sound_speed: Read<f64>,
}

impl Integrate {
    /// Moves the particles by one step.
    pub fn new(wiring: &mut Wiring, scheme: Scheme, courant: Courant, with_energy: bool) -> Self {
        wiring.stage("integrate");
        let previous = [&fields::PREVIOUS_ACCELERATION_R, &fields::PREVIOUS_ACCELERATION_Z];
        let two_step = scheme == Scheme::AdamsBashforth;
        Integrate {
            courant,
            identity: wiring.read(&fields::IDENTITY),
            position: [wiring.update(&fields::RADIUS), wiring.update(&fields::AXIAL)],
            velocity: [wiring.update(&fields::VELOCITY_R), wiring.update(&fields::VELOCITY_Z)],
            density: wiring.update(&fields::DENSITY),
            previous: two_step.then(|| previous.map(|field| wiring.update(field))),
            force: [wiring.read(&fields::FORCE_R), wiring.read(&fields::FORCE_Z)],
            dissipation: [wiring.read(&fields::DISSIPATION_R), wiring.read(&fields::DISSIPATION_Z)],
            strain_rate: wiring.read(&fields::STRAIN_RATE),
            energy: with_energy.then(|| (wiring.update(&fields::TOTAL_ENERGY), wiring.read(&fields::POWER))),
            size: wiring.read(&fields::SIZE),
            sound_speed: wiring.read(&fields::SOUND_SPEED),
        }
    }

    /// dt = CFL min D/sqrt(C^2 + (4 D d eps/dt)^2) (method.md, section 6), for a ring nearer to the axis than
    /// .43 D times (R/(.43 D))^2: its own hoop terms, P/(rho R) and U_r/R, swing with C/R and grow by
    /// (C dt/R)^2/4 a step, which the pressure diffusion of the contacts must outweigh. (The innermost rings of
    /// a regular packing lie at .43 D.)
    fn acoustic_bound(&self, world: &World) -> f64 {
        let (size, sound_speed) = (world.store.read(self.size), world.store.read(self.sound_speed));
        let (strain_rate, r) = (world.store.read(self.strain_rate), world.store.write(self.position[0]));
        let columns = ((&size[..], &sound_speed[..]), (&strain_rate[..], &r[..]));
        let origin = Lanes::splat(self.courant.origin);
        type Columns<'a> = ((&'a [f64], &'a [f64]), (&'a [f64], &'a [f64]));
        let body = |_: usize, ((size, sound_speed), (strain_rate, r)): Columns, len: usize| {
            let (mut largest, mut all) = (Lanes::ZERO, Lanes::ZERO);
            for first in (0..len).step_by(WIDTH) {
                let load =
                    |column: &[f64], fill| Lanes::load_or(&column[first..len.min(first + WIDTH)], fill);
                let size = load(size, f64::MAX.sqrt());
                let (radius, innermost) = (load(r, f64::MAX) + origin, Lanes::splat(INNERMOST) * size);
                let length = if (radius - innermost).all_positive() {
                    size
                } else {
                    let near = (radius / innermost).abs().min(Lanes::ONE);
                    size * near * near
                };
                let strain = Lanes::splat(4.0) * length * load(strain_rate, 0.0);
                let sound_speed = load(sound_speed, 0.0);
                let rate = sound_speed.mul_add(sound_speed, strain * strain) / (length * length);
                largest = largest.max(rate);
                all += rate;
            }
            // No maximum hides a NaN: the sum has it as well.
            let largest = largest.to_array().into_iter().fold(0.0, f64::max);
            if all.sum().is_nan() { f64::NAN } else { largest }
        };
        let larger = |a: f64, b: f64| if a > b || a.is_nan() { a } else { b };
        let slowest = parallel::fold_chunks(size.len(), columns, &body, &larger);
        self.courant.number / slowest.sqrt()
    }

    fn choose_step(&self, world: &mut World) -> Result<f64, Fault> {
        let acoustic = self.acoustic_bound(world);
        world.clock.limit("acoustic", acoustic);
        let step_size = world.clock.bound().map_or(acoustic, |bound| bound.step_size);
        let at_rest = self.courant.number * self.courant.particle_size / self.courant.speed;
        if step_size > VANISHING * at_rest {
            return Ok(step_size);
        }
        // A particle whose state is bad spoils its neighbours' rates: it comes first.
        if let Some((i, quantity, value)) = self.bad_state(world) {
            return Err(self.fault(world, i, quantity, value));
        }
        let strain_rate = world.store.read(self.strain_rate);
        let larger = |&a: &usize, &b: &usize| strain_rate[a].abs().total_cmp(&strain_rate[b].abs());
        let worst = (0..strain_rate.len()).max_by(larger).unwrap_or(0);
        Err(self.fault(world, worst, "strain_rate", strain_rate[worst]))
    }

    /// The first particle whose density, velocity or position is no number or out of bounds.
    fn bad_state(&self, world: &World) -> Option<Bad> {
        let [r, z] = self.position.map(|field| world.store.write(field));
        let [u, w] = self.velocity.map(|field| world.store.write(field));
        let density = world.store.write(self.density);
        let state = |i: usize| [density[i], u[i], w[i], z[i], r[i]];
        let is_bad = |&i: &usize| !is_sound(state(i), self.courant.origin);
        (0..r.len()).find(is_bad).map(|i| name_bad(i, state(i)))
    }

    fn fault(&self, world: &World, i: usize, quantity: &'static str, value: f64) -> Fault {
        let [r, z] = self.position.map(|field| world.store.write(field)[i]);
        let particle = world.store.read(self.identity)[i];
        Fault { stage: "integrate", particle, quantity, value, r, z, step: world.clock.step }
    }

    /// E += dt dE/dt, an Euler step like the density's.
    fn advance_energy(&self, world: &World, dt: f64) {
        let Some((energy, power)) = self.energy else { return };
        let (power, density) = (world.store.read(power), world.store.write(self.density));
        let mut energy = world.store.write(energy);
        let columns = (&power[..], &density[..], &mut energy[..]);
        parallel::for_chunks(power.len(), columns, |_, (power, density, energy)| {
            for ((energy, power), density) in energy.iter_mut().zip(power).zip(density) {
                *energy += dt * power / density;
            }
        });
    }

    /// Moves all particles; the first one that went bad, if any.
    fn advance(&self, world: &World, dt: f64) -> Option<Bad> {
        let store = &world.store;
        let [force_r, force_z] = self.force.map(|field| store.read(field));
        let [dissipation_r, dissipation_z] = self.dissipation.map(|field| store.read(field));
        let (strain_rate, size) = (store.read(self.strain_rate), store.read(self.size));
        let [mut r, mut z] = self.position.map(|field| store.write(field));
        let [mut u, mut w] = self.velocity.map(|field| store.write(field));
        let mut density = store.write(self.density);
        let mut previous = self.previous.map(|fields| fields.map(|field| store.write(field)));
        let previous = previous.as_mut().map(|[r, z]| (&mut r[..], &mut z[..]));

        let before = world.clock.previous_step_size;
        let q = if previous.is_some() && before > 0.0 { dt / (2.0 * before) } else { 0.0 };
        let origin = self.courant.origin;
        let (force_r, force_z, strain_rate) = (&force_r[..], &force_z[..], &strain_rate[..]);
        let size = &size[..];
        let (dissipation_r, dissipation_z) = (&dissipation_r[..], &dissipation_z[..]);
        let step = Step { dt: Lanes::splat(dt), now: Lanes::splat(1.0 + q), before: Lanes::splat(q) };
        let body = |start: usize, columns: Columns, len: usize| {
            let ((r, z), (u, w), density, mut previous) = columns;
            let mut bad = None;
            for first in (0..len).step_by(WIDTH) {
                let eight = first..len.min(first + WIDTH);
                let here = start + eight.start..start + eight.end;
                let inverse = Lanes::ONE / Lanes::load_or(&density[eight.clone()], 1.0);
                let component = |force: &[f64], dissipation: &[f64], previous: Option<&mut [f64]>| {
                    let force = Lanes::load_or(&force[here.clone()], 0.0) * inverse;
                    let dissipation = Lanes::load_or(&dissipation[here.clone()], 0.0) * inverse;
                    step.change(force, dissipation, previous.map(|p| &mut p[eight.clone()]))
                };
                let (previous_r, previous_z) = match &mut previous {
                    Some((r, z)) => (Some(&mut **r), Some(&mut **z)),
                    None => (None, None),
                };
                let du = component(force_r, dissipation_r, previous_r);
                let dw = component(force_z, dissipation_z, previous_z);
                let new_u = step.advance(&mut r[eight.clone()], &mut u[eight.clone()], du);
                let radius = Lanes::load_or(&r[eight.clone()], 1.0) + Lanes::splat(origin);
                let closed = Lanes::splat(CLOSED) * Lanes::load_or(&size[here.clone()], 0.0);
                let new_u = closed.select_greater(radius, new_u.max(Lanes::ZERO), new_u);
                new_u.store(&mut u[eight.clone()]);
                let new_w = step.advance(&mut z[eight.clone()], &mut w[eight.clone()], dw);
                let strain = step.dt * Lanes::load_or(&strain_rate[here], 0.0);
                let new_density = Lanes::load_or(&density[eight.clone()], 1.0) * (-strain).exp();
                new_density.store(&mut density[eight.clone()]);
                // One test for all: the sum is finite where every part is.
                let sum = new_density + new_u + new_w + Lanes::load_or(&z[eight.clone()], 0.0);
                let least = new_density.min(radius).min(Lanes::splat(f64::MAX) - sum.abs());
                if !least.all_positive() && bad.is_none() {
                    let state = |k: usize| [density[k], u[k], w[k], z[k], r[k]];
                    let k = eight.clone().find(|&k| !is_sound(state(k), origin));
                    bad = k.map(|k| name_bad(start + k, state(k)));
                }
            }
            bad
        };
        let first = |a: Option<Bad>, b: Option<Bad>| a.or(b);
        let columns = ((&mut r[..], &mut z[..]), (&mut u[..], &mut w[..]), &mut density[..], previous);
        parallel::fold_chunks(force_r.len(), columns, &body, &first)
    }
}

/// One step's factors.
#[derive(Clone, Copy)]
struct Step {
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

    /// x += dt (U^n + U^{n+1})/2 and U += change; the new velocity.
    #[inline(always)]
    fn advance(&self, position: &mut [f64], velocity: &mut [f64], change: Lanes) -> Lanes {
        let before = Lanes::load_or(velocity, 0.0);
        let moved = self.dt * (before + Lanes::HALF * change);
        (Lanes::load_or(position, 0.0) + moved).store(position);
        (before + change).store(velocity);
        before + change
    }
}

/// A particle, the quantity that went bad, and its value.
type Bad = (usize, &'static str, f64);

type Pair<'a> = (&'a mut [f64], &'a mut [f64]);
type Columns<'a> = (Pair<'a>, Pair<'a>, &'a mut [f64], Option<Pair<'a>>);

fn is_sound([density, u, w, z, r]: [f64; 5], origin: f64) -> bool {
    (density + u + w + z).is_finite() && density > 0.0 && r + origin > 0.0
}

fn name_bad(i: usize, [density, u, w, z, r]: [f64; 5]) -> Bad {
    if !(density > 0.0 && density.is_finite()) {
        (i, "density", density)
    } else if !u.is_finite() {
        (i, "velocity_r", u)
    } else if !w.is_finite() {
        (i, "velocity_z", w)
    } else if !z.is_finite() {
        (i, "axial", z)
    } else {
        (i, "radius", r)
    }
}

impl Stage for Integrate {
    fn name(&self) -> &'static str {
        "integrate"
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        let dt = self.choose_step(world)?;
        self.advance_energy(world, dt);
        match self.advance(world, dt) {
            Some((i, quantity, value)) => Err(self.fault(world, i, quantity, value)),
            None => Ok(()),
        }
    }
}
