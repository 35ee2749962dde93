//! Shifting: particles move down the gradient of their concentration where the packing has become uneven.

use crate::fields;
use crate::integrate::CLOSED;
use crate::moment::Moment;
use crate::rows::PackedState;
use crate::surface::BOUNDARY;
use meniscus_engine::clock::Clock;
use meniscus_engine::group::{Around, Chunk, ChunkStage, Partial};
use meniscus_engine::lanes::{Lanes, WIDTH};
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, World};
use meniscus_engine::store::{Read, Update, Write};
use meniscus_engine::wiring::Wiring;
use std::cell::Ref;

/// Largest shift in one step, in particle sizes.
const CAP: f64 = 0.01;

/// Anisotropy of the moment matrix at which shifting sets in, and at which it has its full strength. In a
/// settled packing 97 of 100 interior particles stay below .045, in a violent flow half lie above .06.
const UNEVEN: [f64; 2] = [0.05, 0.1];
/// Distance from the axis, in particle sizes, below which shifting sets in, and at which it has its full
/// strength: a ring that closes on the axis has no neighbour there that would hold it off.
const CLOSING: [f64; 2] = [0.42, 0.35];
/// The same for a ring that sticks to the axis: with wide supports the kernel's gradient at its image, so near, is next to
/// nothing, its neighbours push it on, and the whole scene waits for its steps. It moves outward whatever the gradient of
/// the concentration.
const STUCK: [f64; 2] = [0.35, 0.2];
/// Speed of that over the greatest one that scales shifts.
const LOOSENING: f64 = 0.1;

/// Rate of deformation, over the slowest that matters in the scene, that needs no shift.
const GENTLE: f64 = 0.03;

/// Strength of the shifting.
#[derive(Clone, Copy, Debug)]
pub struct Strength {
    /// Coefficient, 1 to 5.
    pub coefficient: f64,
    /// Steps from one shift to the next, which is as far as one in each of them would take the particles.
    pub interval: u64,
    /// Greatest speed that scales the shift, m/s.
    pub speed: f64,
    /// The scene's slowest rate of deformation that matters, 1/s: one over its capillary time.
    pub rate: f64,
    /// Smoothing length over the sum of two particles' sizes.
    pub theta: f64,
    /// Distance of the scene's origin from the axis, m.
    pub origin: f64,
    /// Whether all particles shift with the greatest speed, not only where it is needed and as fast as needed.
    pub everywhere: bool,
}

/// dr = -coefficient u dt H grad C, at most 0.01 D (method.md, sections 10 and 12). u is H times what the particle's rate of
/// deformation exceeds a gentle flow's by (the greatest speed where the scene computes none). A
/// particle shifts only where the packing has become uneven or a ring closes on the axis. So a
/// drop that swings gently keeps its packing, and with it its frequency, which shifting everywhere would
/// lower, and a drop at rest stays at rest.
///
/// Particles at the boundary go with the flow alone (and under surface tension give way to crowds, `BoundaryEvening`),
/// where section 10 lets them shift along the surface. What is along it the ghost's weight doesn't tell near the axis,
/// where it leans by twenty degrees: a part of what the missing side leaves of the gradient of the concentration drew the
/// ring at a pole inward wherever the flow was fast enough for shifts, its area grew, with it the curvature, and so the
/// flow. The poles of fine drops were thrown about. Along the tangent of the surface shifts do no such harm, but drops
/// that swing far lose more than without any.
///
/// Near the boundary section 10 leaves the outward part out, too. But particles shift to and fro there, and if the
/// inward shifts alone are let through, they draw the surface in and the pressure pushes it out again: drops that
/// swing far lost more by that, and fast collisions gained twice as much.
///
/// A flow without surface tension has no such frequency, and keeps its shape better if all particles shift all
/// the time with the greatest speed.
pub struct Shifting {
    strength: Strength,
    concentration_gradient: [Read<f64>; 2],
    moment: [Read<f64>; 3],
    deformation: Option<[Read<f64>; 3]>,
    surface: Read<u32>,
    position: [Update<f64>; 2],
    carrying: Option<Carrying>,
}

/// A particle that shifts takes up the velocity of the flow at its new place, U += dr . grad U (the transport by
/// the shift in Lagrangian-Eulerian form; Sun et al. 2019): with its old one it would stir the flow, and the
/// contacts turn that into heat. The axial momentum that this brings in is taken off again in proportion to what
/// each particle took up.
struct Carrying {
    velocity: [Update<f64>; 2],
    deformation: [Read<f64>; 3],
    rotation: Read<f64>,
    mass: Read<f64>,
    carried: (Write<f64>, Read<f64>),
}

impl Carrying {
    fn new(wiring: &mut Wiring) -> Self {
        Carrying {
            velocity: fields::VELOCITY.map(|field| wiring.update(field)),
            deformation: fields::DEFORMATION.map(|field| wiring.read(field)),
            rotation: wiring.read(&fields::ROTATION),
            mass: wiring.read(&fields::MASS),
            carried: (wiring.write(&fields::CARRIED_Z), wiring.read(&fields::CARRIED_Z)),
        }
    }

    /// Carries velocities along the shifts of a chunk, each asked for once; gives the axial momentum that comes in and the sum of its
    /// parts' magnitudes.
    fn carry(&self, chunk: &Chunk, mut shift: impl FnMut(usize) -> [f64; 2]) -> Partial {
        let [rr, shear, zz] = self.deformation.map(|field| chunk.read(field));
        let (rotation, mass) = (chunk.read(self.rotation), chunk.read(self.mass));
        let [mut u, mut w] = self.velocity.map(|field| chunk.write(field));
        let mut carried = chunk.write(self.carried.0);
        let (mut momentum, mut scale) = (0.0, 0.0);
        for k in 0..chunk.len() {
            let [dr, dz] = shift(k);
            u[k] += dr * rr[k] + dz * 0.5 * (shear[k] + rotation[k]);
            carried[k] = dr * 0.5 * (shear[k] - rotation[k]) + dz * zz[k];
            w[k] += carried[k];
            momentum += mass[k] * carried[k];
            scale += mass[k] * carried[k].abs();
        }
        [momentum, scale]
    }

    /// Takes the momentum off again that came in.
    fn balance(&self, world: &World, [momentum, scale]: Partial) {
        if scale > 0.0 {
            let excess = momentum / scale;
            let carried = world.store.read(self.carried.1);
            let mut w = world.store.write(self.velocity[1]);
            parallel::for_chunks(carried.len(), (&mut w[..], &carried[..]), |_, (w, carried)| {
                w.iter_mut().zip(carried).for_each(|(w, carried)| *w -= excess * carried.abs());
            });
        }
    }
}

impl Shifting {
    /// Shifts before the step; `with_deformation` where the scene computes rates of deformation, `carrying` where
    /// velocities go along.
    pub fn new(wiring: &mut Wiring, strength: Strength, with_deformation: bool, carrying: bool) -> Self {
        wiring.stage("shifting");
        Shifting {
            strength,
            concentration_gradient: fields::CONCENTRATION_GRADIENT.map(|field| wiring.read(field)),
            moment: fields::MOMENT.map(|field| wiring.read(field)),
            deformation: with_deformation.then(|| fields::DEFORMATION.map(|field| wiring.read(field))),
            surface: wiring.read(&fields::SURFACE),
            position: fields::POSITION.map(|field| wiring.update(field)),
            carrying: carrying.then(|| Carrying::new(wiring)),
        }
    }
}

/// From zero at the first bound to one at the second.
fn ramp(value: f64, [from, to]: [f64; 2]) -> f64 {
    ((value - from) / (to - from)).clamp(0.0, 1.0)
}

/// What decides on the shifts of a chunk.
struct Neighbourhoods<'a> {
    packed: PackedState<'a>,
    /// Number of the chunk's first particle.
    start: usize,
    surface: Ref<'a, [u32]>,
    moment: [Ref<'a, [f64]>; 3],
}

impl Neighbourhoods<'_> {
    fn moment(&self, k: usize) -> Moment {
        let [rr, rz, zz] = &self.moment;
        Moment { rr: rr[k], rz: rz[k], zz: zz[k] }
    }

    fn size(&self, k: usize) -> f64 {
        self.packed.size(self.start + k)
    }

    fn is_at_boundary(&self, k: usize) -> bool {
        self.surface[k] == BOUNDARY
    }

    /// Whether none of the eight particles from k on needs a shift; `r` are their distances from the axis.
    fn are_quiet(&self, k: usize, r: Lanes) -> bool {
        let load = |column: &[f64]| Lanes::load(&column[k..]);
        let [rr, rz, zz] = &self.moment;
        let (rr, rz, zz) = (load(rr), load(rz), load(zz));
        let (difference, shear) = (rr - zz, rz + rz);
        let most = Lanes::splat(0.99 * UNEVEN[0]) * (rr + zz);
        let uneven = difference.mul_add(difference, shear.mul_add(shear, -(most * most)));
        let area = self.packed.areas(self.start + k);
        let closing = Lanes::splat(1.01 * CLOSING[0] * 1.01 * CLOSING[0]).mul_add(area, -(r * r));
        (-(uneven.max(closing))).all_positive()
    }

    /// How much of its full strength a shift needs that far from the axis.
    fn need(&self, k: usize, radius: f64) -> f64 {
        if self.is_at_boundary(k) {
            return if radius < STUCK[0] * self.size(k) { 1.0 } else { 0.0 };
        }
        let moment = self.moment(k);
        if !moment.is_anisotropic(UNEVEN[0]) && radius >= CLOSING[0] * self.size(k) {
            return 0.0;
        }
        ramp(moment.anisotropy(), UNEVEN).max(ramp(radius / self.size(k), CLOSING))
    }
}

impl Shifting {
    fn is_due_at(&self, clock: &Clock) -> bool {
        clock.step.is_multiple_of(self.strength.interval)
    }

    /// The shift of a particle at a distance from the axis that needs some part of its full strength, in m.
    fn shift(
        &self,
        columns: &Columns,
        neighbourhoods: &Neighbourhoods,
        k: usize,
        (radius, needed): (f64, f64),
    ) -> [f64; 2] {
        let Strength { coefficient, speed: greatest, rate, theta, .. } = self.strength;
        let size = neighbourhoods.size(k);
        let support = 4.0 * theta * size;
        let speed = match &columns.deformation {
            Some([rr, shear, zz]) => {
                let square = rr[k] * rr[k] + zz[k] * zz[k] + 0.5 * shear[k] * shear[k];
                (support * (square.sqrt() - GENTLE * rate).max(0.0)).min(greatest)
            }
            None => greatest,
        };
        let needed = if neighbourhoods.is_at_boundary(k) { 0.0 } else { needed };
        let factor = needed * coefficient * speed * columns.duration * support;
        let [gradient_r, gradient_z] = &columns.concentration_gradient;
        let shift = [-factor * gradient_r[k], -factor * gradient_z[k]];
        let farthest = columns.farthest * size;
        let length = (shift[0] * shift[0] + shift[1] * shift[1]).sqrt();
        let keep = if length > farthest { farthest / length } else { 1.0 };
        // A shift must not carry a particle to the axis.
        let room = (radius - CLOSED * size).max(0.0);
        let stuck = ramp(radius / size, STUCK) * LOOSENING * greatest * columns.duration;
        let out = if stuck > 0.0 { (keep * shift[0]).max(stuck.min(farthest)) } else { keep * shift[0] };
        [out.max(-0.5 * room), keep * shift[1]]
    }
}

/// What a shift is made from.
struct Columns<'a> {
    concentration_gradient: [Ref<'a, [f64]>; 2],
    deformation: Option<[Ref<'a, [f64]>; 3]>,
    /// s
    duration: f64,
    /// In particle sizes.
    farthest: f64,
}

impl ChunkStage for Shifting {
    fn name(&self) -> &'static str {
        "shifting"
    }

    /// What shifts bring of momentum where all shift, else how far, m, any particle was shifted.
    fn chunk(&self, around: &Around, chunk: &Chunk) -> Partial {
        if !self.is_due_at(around.clock) {
            return Partial::default();
        }
        let Strength { origin, everywhere, interval, .. } = self.strength;
        // As far as particles shift, a step is as long as the one before.
        let duration = interval as f64 * around.clock.previous_step_size;
        let neighbourhoods = Neighbourhoods {
            packed: PackedState(around.rows),
            start: chunk.start,
            surface: chunk.read(self.surface),
            moment: self.moment.map(|field| chunk.read(field)),
        };
        let columns = Columns {
            concentration_gradient: self.concentration_gradient.map(|field| chunk.read(field)),
            deformation: self.deformation.map(|fields| fields.map(|field| chunk.read(field))),
            duration,
            farthest: CAP * interval as f64,
        };
        let [mut r, mut z] = self.position.map(|field| chunk.write(field));
        if everywhere {
            let mut shift = |k: usize| {
                let shift = self.shift(&columns, &neighbourhoods, k, (r[k] + origin, 1.0));
                r[k] += shift[0];
                z[k] += shift[1];
                shift
            };
            if let Some(carrying) = &self.carrying {
                return carrying.carry(chunk, shift);
            }
            (0..chunk.len()).for_each(|k| {
                shift(k);
            });
            return Partial::default();
        }
        let (mut quiet, mut farthest_square) = (false, 0.0_f64);
        for k in 0..chunk.len() {
            // Most particles need no shift: eight of them are tested at once for it.
            if k % WIDTH == 0 {
                let whole = chunk.len() - k >= WIDTH;
                quiet = whole && neighbourhoods.are_quiet(k, Lanes::load(&r[k..]) + Lanes::splat(origin));
            }
            let radius = r[k] + origin;
            let needed = if quiet { 0.0 } else { neighbourhoods.need(k, radius) };
            if needed > 0.0 {
                let shift = self.shift(&columns, &neighbourhoods, k, (radius, needed));
                r[k] += shift[0];
                z[k] += shift[1];
                farthest_square = farthest_square.max(shift[0] * shift[0] + shift[1] * shift[1]);
            }
        }
        [farthest_square.sqrt(), 0.0]
    }

    fn combine(&self, left: Partial, right: Partial) -> Partial {
        match self.strength.everywhere {
            true => [left[0] + right[0], left[1] + right[1]],
            false => [left[0].max(right[0]), 0.0],
        }
    }

    fn finish(&mut self, world: &mut World, found: Partial) -> Result<(), Fault> {
        if !self.is_due_at(&world.clock) {
            return Ok(());
        }
        // Where all shift nobody knows how far.
        world.neighbours.note_motion(if self.strength.everywhere { f64::INFINITY } else { found[0] });
        if let Some(carrying) = &self.carrying {
            carrying.balance(world, found);
        }
        Ok(())
    }
}
