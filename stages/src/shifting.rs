//! Shifting: particles give way to crowding where the packing has become uneven.

use crate::fields;
use crate::integrate::CLOSED;
use crate::moment::Moment;
use crate::surface::{BOUNDARY, INSIDE, NEAR_BOUNDARY};
use crate::surface_corrections::INVERTIBLE;
use meniscus_engine::lanes::{Lanes, WIDTH};
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Read, Update};
use meniscus_engine::wiring::Wiring;

/// Largest shift in one step, in particle sizes.
const CAP: f64 = 0.01;

/// Anisotropy of the moment matrix at which shifting sets in, and at which it has its full strength. In a
/// settled packing 97 of 100 interior particles stay below .045, in a violent flow half lie above .06.
const UNEVEN: [f64; 2] = [0.05, 0.1];
/// Distance from the axis, in particle sizes, below which shifting sets in, and at which it has its full
/// strength: a ring that closes on the axis has no neighbour there that would hold it off.
const CLOSING: [f64; 2] = [0.42, 0.35];

/// Rate of deformation, over the slowest that matters in the scene, that needs no shift.
const GENTLE: f64 = 0.03;

/// Strength of the shifting.
#[derive(Clone, Copy, Debug)]
pub struct Strength {
    /// Coefficient, 1 to 5.
    pub coefficient: f64,
    /// Greatest speed that scales the shift, m/s.
    pub speed: f64,
    /// The scene's slowest rate of deformation that matters, 1/s: one over its capillary time.
    pub rate: f64,
    /// Smoothing length parameter.
    pub theta: f64,
    /// Distance of the scene's origin from the axis, m.
    pub origin: f64,
    /// Whether all particles shift with the greatest speed, not only where it is needed and as fast as needed.
    pub everywhere: bool,
}

/// dr = -coefficient u dt H grad C, at most 0.01 D; without the normal component at the boundary and
/// without its outward part near it (method.md, sections 10 and 12). u is H times what the particle's rate of
/// deformation exceeds a gentle flow's by (the greatest speed where the scene computes none). Off the
/// boundary a particle shifts only where the packing has become uneven or a ring closes on the axis. So a
/// drop that swings gently keeps its packing, and with it its frequency, which shifting everywhere would
/// lower, and a drop at rest stays at rest.
///
/// A flow without surface tension has no such frequency, and keeps its shape better if all particles shift all
/// the time with the greatest speed, also outwards from below the surface: of shifts to and fro the surface would
/// let through the inward ones alone, and the liquid would shrink.
pub struct Shifting {
    strength: Strength,
    size: Read<f64>,
    crowding: [Read<f64>; 2],
    moment: [Read<f64>; 3],
    deformation: Option<[Read<f64>; 3]>,
    surface: Read<u32>,
    weight: [Read<f64>; 2],
    position: [Update<f64>; 2],
    carrying: Option<Carrying>,
}

/// A particle that shifts takes up the velocity of the flow at its new place, U += dr . grad U (the transport by
/// the shift in Lagrangian-Eulerian form; Sun et al. 2019): with its old one it would stir the flow, and the
/// contacts turn that into heat. The axial momentum that this brings in is taken off again in proportion to what
/// each particle took up.
struct Carrying {
    velocity: [Update<f64>; 2],
    velocity_sum: [Read<f64>; 4],
    mass: Read<f64>,
}

impl Carrying {
    fn new(wiring: &mut Wiring) -> Self {
        let sum = [
            &fields::VELOCITY_SUM_RR,
            &fields::VELOCITY_SUM_RZ,
            &fields::VELOCITY_SUM_ZR,
            &fields::VELOCITY_SUM_ZZ,
        ];
        Carrying {
            velocity: [wiring.update(&fields::VELOCITY_R), wiring.update(&fields::VELOCITY_Z)],
            velocity_sum: sum.map(|field| wiring.read(field)),
            mass: wiring.read(&fields::MASS),
        }
    }

    /// Carries velocities along the shifts of all particles.
    fn run(&self, world: &World, moment: [Read<f64>; 3], shifts: &mut [[f64; 2]]) {
        let store = &world.store;
        let [rr, rz, zz] = moment.map(|field| store.read(field));
        let sum = self.velocity_sum.map(|field| store.read(field));
        let mass = store.read(self.mass);
        let [mut u, mut w] = self.velocity.map(|field| store.write(field));
        let body = |start: usize, (u, w, shifts): Columns, len: usize| {
            let (mut momentum, mut scale) = (0.0, 0.0);
            for k in 0..len {
                let i = start + k;
                let moment = Moment { rr: rr[i], rz: rz[i], zz: zz[i] };
                if !moment.eigenvalues_at_least(INVERTIBLE) {
                    shifts[k] = [0.0; 2];
                    continue;
                }
                let gradient = moment.solve(std::array::from_fn(|c| sum[c][i]));
                let [dr, dz] = shifts[k];
                let change = [dr * gradient[0] + dz * gradient[1], dr * gradient[2] + dz * gradient[3]];
                u[k] += change[0];
                w[k] += change[1];
                shifts[k] = change;
                momentum += mass[i] * change[1];
                scale += mass[i] * change[1].abs();
            }
            (momentum, scale)
        };
        let add = |a: (f64, f64), b: (f64, f64)| (a.0 + b.0, a.1 + b.1);
        let columns = (&mut u[..], &mut w[..], &mut *shifts);
        let (momentum, scale) = parallel::fold_chunks(mass.len(), columns, &body, &add);
        if scale > 0.0 {
            let excess = momentum / scale;
            parallel::for_chunks(mass.len(), (&mut w[..], &*shifts), |_, (w, changes)| {
                for (w, change) in w.iter_mut().zip(changes) {
                    *w -= excess * change[1].abs();
                }
            });
        }
    }
}

type Columns<'a> = (&'a mut [f64], &'a mut [f64], &'a mut [[f64; 2]]);

impl Shifting {
    /// Shifts after the step; `with_deformation` where the scene computes rates of deformation, `carrying` where
    /// velocities go along.
    pub fn new(wiring: &mut Wiring, strength: Strength, with_deformation: bool, carrying: bool) -> Self {
        wiring.stage("shifting");
        let moment = [&fields::MOMENT_RR, &fields::MOMENT_RZ, &fields::MOMENT_ZZ];
        let deformation = [&fields::DEFORMATION_RR, &fields::DEFORMATION_SHEAR, &fields::DEFORMATION_ZZ];
        Shifting {
            strength,
            size: wiring.read(&fields::SIZE),
            crowding: [wiring.read(&fields::CROWDING_R), wiring.read(&fields::CROWDING_Z)],
            moment: moment.map(|field| wiring.read(field)),
            deformation: with_deformation.then(|| deformation.map(|field| wiring.read(field))),
            surface: wiring.read(&fields::SURFACE),
            weight: [wiring.read(&fields::GHOST_WEIGHT_R), wiring.read(&fields::GHOST_WEIGHT_Z)],
            position: [wiring.update(&fields::RADIUS), wiring.update(&fields::AXIAL)],
            carrying: carrying.then(|| Carrying::new(wiring)),
        }
    }
}

/// From zero at the first bound to one at the second.
fn ramp(value: f64, [from, to]: [f64; 2]) -> f64 {
    ((value - from) / (to - from)).clamp(0.0, 1.0)
}

/// What is left of a shift at or near the surface, given the outward direction.
fn along_surface(shift: [f64; 2], outward: [f64; 2], surface: u32) -> [f64; 2] {
    let length = (outward[0] * outward[0] + outward[1] * outward[1]).sqrt();
    if surface == INSIDE || length == 0.0 {
        return shift;
    }
    let normal = [outward[0] / length, outward[1] / length];
    let out = shift[0] * normal[0] + shift[1] * normal[1];
    let removed = if surface == BOUNDARY { out } else { out.max(0.0) };
    [shift[0] - removed * normal[0], shift[1] - removed * normal[1]]
}

impl Stage for Shifting {
    fn name(&self) -> &'static str {
        "shifting"
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        let Some(bound) = world.clock.bound() else {
            return Ok(());
        };
        let store = &world.store;
        let size = store.read(self.size);
        let [crowding_r, crowding_z] = self.crowding.map(|field| store.read(field));
        let surface = store.read(self.surface);
        let [rr, rz, zz] = self.moment.map(|field| store.read(field));
        let deformation = self.deformation.map(|fields| fields.map(|field| store.read(field)));
        let [weight_r, weight_z] = self.weight.map(|field| store.read(field));
        let [mut r, mut z] = self.position.map(|field| store.write(field));
        let Strength { coefficient, speed, rate, theta, origin, everywhere } = self.strength;
        let carried = if self.carrying.is_some() { size.len() } else { 0 };
        let shifts = world.arena.alloc_slice_fill_copy(carried, [0.0; 2]);
        let noted = self.carrying.as_ref().map(|_| &mut *shifts);
        parallel::for_chunks(size.len(), (&mut r[..], &mut z[..], noted), |start, (r, z, mut noted)| {
            let mut quiet = false;
            // Most particles need no shift: eight of them are tested at once for it.
            let is_quiet = |k: usize, r: &[f64]| {
                let eight = start + k..start + k + WIDTH;
                let load = |column: &[f64]| Lanes::load(&column[eight.clone()]);
                let (rr, rz, zz, size) = (load(&rr), load(&rz), load(&zz), load(&size));
                let (difference, shear) = (rr - zz, rz + rz);
                let most = Lanes::splat(0.99 * UNEVEN[0]) * (rr + zz);
                let uneven = difference.mul_add(difference, shear.mul_add(shear, -(most * most)));
                let radius = Lanes::load(&r[k..]) + Lanes::splat(origin);
                let closing = Lanes::splat(1.01 * CLOSING[0]).mul_add(size, -radius);
                let inside = surface[eight].iter().fold(true, |all, code| all & (*code != BOUNDARY));
                inside && (-(uneven.max(closing))).all_positive()
            };
            for k in 0..r.len() {
                if k % WIDTH == 0 {
                    quiet = !everywhere && r.len() - k >= WIDTH && is_quiet(k, r);
                }
                if quiet {
                    continue;
                }
                let i = start + k;
                let radius = r[k] + origin;
                let support = 4.0 * theta * size[i];
                let needed = if everywhere || surface[i] == BOUNDARY {
                    1.0
                } else {
                    let moment = Moment { rr: rr[i], rz: rz[i], zz: zz[i] };
                    if !moment.is_anisotropic(UNEVEN[0]) && radius >= CLOSING[0] * size[i] {
                        continue;
                    }
                    ramp(moment.anisotropy(), UNEVEN).max(ramp(radius / size[i], CLOSING))
                };
                let speed = match &deformation {
                    Some([rr, shear, zz]) => {
                        let square = rr[i] * rr[i] + zz[i] * zz[i] + 0.5 * shear[i] * shear[i];
                        (support * (square.sqrt() - GENTLE * rate).max(0.0)).min(speed)
                    }
                    None => speed,
                };
                let factor = needed * coefficient * speed * bound.step_size * support;
                let shift = [-factor * crowding_r[i], -factor * crowding_z[i]];
                let outwards = everywhere && surface[i] == NEAR_BOUNDARY;
                let shift = match outwards {
                    true => shift,
                    false => along_surface(shift, [weight_r[i], weight_z[i]], surface[i]),
                };
                let length = (shift[0] * shift[0] + shift[1] * shift[1]).sqrt();
                let keep = if length > CAP * size[i] { CAP * size[i] / length } else { 1.0 };
                // A shift must not carry a particle to the axis.
                let room = (radius - CLOSED * size[i]).max(0.0);
                let shift = [(keep * shift[0]).max(-0.5 * room), keep * shift[1]];
                r[k] += shift[0];
                z[k] += shift[1];
                if let Some(noted) = &mut noted {
                    noted[k] = shift;
                }
            }
        });
        if let Some(carrying) = &self.carrying {
            carrying.run(world, self.moment, shifts);
        }
        Ok(())
    }
}
