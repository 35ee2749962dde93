//! The area of the surface: what the ghosts' weights lack of the contour's length.
//!
//! Ghosts push with the Laplace pressure P on A = 2 V bw, the part of a particle's surroundings that is
//! empty, and the tangential pressure adds -V (I - L) grad_s P (method.md, section 10, T). Both together are the
//! pressure's force on the contour, sum (P A + V (I - L) grad_s P) = ∮ n P ds, if for any function phi of
//! the place on the surface
//!
//!   sum_b R_b [A_b phi_b + V_b (I - L_b) grad_s phi_b] = ∮ R n phi ds,   R the distance from the axis:
//!
//! the pair sums of neighbours cancel, those across the edge are what L lacks. Particles at rest
//! keep that within .2 %; where the flow has drawn the packing out, A is wrong by several per cent, and so is
//! the momentum that a film's edge gains. So A becomes A + |A| delta with the delta(x) that makes the
//! sums equal for phi = W(x - x_b)/R_b, a kernel a few particles wide. The contour is the
//! polygon through the feet, the places on the surface next to the boundary particles.

use crate::contour::{Contour, SurfaceParticle};
use crate::equation_of_state::Packing;
use crate::fields;
use crate::moment::Moment;
use crate::surface::{BOUNDARY, for_surface};
use crate::surface_interval::COMPUTED;
use meniscus_engine::field::clear;
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Add, Read, Update, bytes_of};
use meniscus_engine::wiring::Wiring;

/// Part of the way to a newly found delta that is gone each time: where the surface is rough delta is noise, and
/// taken at once it would drive the roughness on.
const RELAXATION: f64 = 0.1;

/// The stage. It must follow the curvature, which finds feet and tangents, and corrects the weights of
/// ghosts before they are used.
pub struct SurfaceArea {
    packing: Packing,
    position: [Read<f64>; 2],
    size: Read<f64>,
    surface: Read<u32>,
    offset: [Read<f64>; 2],
    tangent: [Read<f64>; 2],
    lack_of_support: [Read<f64>; 3],
    weight: [Add<f64>; 2],
    lack: [Update<f64>; 2],
    numbers: Vec<u32>,
    particles: Vec<SurfaceParticle>,
    contour: Contour,
    found: Vec<[f64; 2]>,
}

impl SurfaceArea {
    /// Computes delta whenever the curvature is computed.
    pub fn new(wiring: &mut Wiring, packing: Packing) -> Self {
        wiring.stage("surface-area");
        let support = [&fields::SUPPORT_LACK_RR, &fields::SUPPORT_LACK_RZ, &fields::SUPPORT_LACK_ZZ];
        SurfaceArea {
            packing,
            position: [wiring.read(&fields::RADIUS), wiring.read(&fields::AXIAL)],
            size: wiring.read(&fields::SIZE),
            surface: wiring.read(&fields::SURFACE),
            offset: [wiring.read(&fields::SURFACE_OFFSET_R), wiring.read(&fields::SURFACE_OFFSET_Z)],
            tangent: [wiring.read(&fields::SURFACE_TANGENT_R), wiring.read(&fields::SURFACE_TANGENT_Z)],
            lack_of_support: support.map(|field| wiring.read(field)),
            weight: [wiring.add(&fields::GHOST_WEIGHT_R), wiring.add(&fields::GHOST_WEIGHT_Z)],
            lack: [wiring.update(&fields::AREA_LACK_R), wiring.update(&fields::AREA_LACK_Z)],
            numbers: Vec::new(),
            particles: Vec::new(),
            contour: Contour::default(),
            found: Vec::new(),
        }
    }

    /// Takes up the particles that have a surface next to them.
    fn gather(&mut self, world: &World) {
        let [r, z] = self.position.map(|field| world.store.read(field));
        let [offset_r, offset_z] = self.offset.map(|field| world.store.read(field));
        let [tangent_r, tangent_z] = self.tangent.map(|field| world.store.read(field));
        let [weight_r, weight_z] = self.weight.map(|field| world.store.write(field));
        let [rr, rz, zz] = self.lack_of_support.map(|field| world.store.read(field));
        let (size, surface) = (world.store.read(self.size), world.store.read(self.surface));
        let Packing { largest_size, domain, .. } = self.packing;
        self.numbers.clear();
        for_surface(&surface, |i| {
            if (tangent_r[i], tangent_z[i]) != (0.0, 0.0) {
                self.numbers.push(i as u32);
            }
        });
        self.particles.clear();
        self.particles.extend(self.numbers.iter().map(|&i| {
            let i = i as usize;
            let foot = [r[i] + offset_r[i], z[i] + offset_z[i]];
            let tangent = [tangent_r[i], tangent_z[i]];
            let nearest = 0.5 * size[i].min(largest_size);
            let ring = ((r[i] + domain.origin) / (foot[0] + domain.origin).max(nearest)).clamp(0.5, 1.5);
            let area = size[i] * size[i] * ring;
            let missing = Moment { rr: rr[i], rz: rz[i], zz: zz[i] }.apply(tangent);
            SurfaceParticle {
                is_boundary: surface[i] == BOUNDARY,
                size: size[i].min(largest_size),
                foot,
                tangent,
                area: [weight_r[i], weight_z[i]].map(|weight| 2.0 * area * weight),
                missing: missing.map(|missing| area * missing),
            }
        }));
    }

    /// delta at the feet of all particles taken up.
    fn measure(&mut self) {
        let Packing { largest_size, domain, .. } = self.packing;
        self.contour.gather(&self.particles, largest_size, &domain);
        let (contour, particles) = (&self.contour, &self.particles[..]);
        self.found.clear();
        self.found.resize(particles.len(), [0.0; 2]);
        parallel::for_chunks_of(64, particles.len(), &mut self.found[..], |start, found| {
            for (k, found) in found.iter_mut().enumerate() {
                *found = contour.lack(&particles[start + k]);
            }
        });
    }

    /// Goes part of the way to what was found.
    fn store_lack(&self, world: &World) {
        for (axis, field) in self.lack.into_iter().enumerate() {
            let mut lack = world.store.write(field);
            let before = self.numbers.iter().map(|&i| lack[i as usize]);
            let before: &[f64] = world.arena.alloc_slice_fill_iter(before);
            clear(&mut lack[..]);
            for ((&i, found), before) in self.numbers.iter().zip(&self.found).zip(before) {
                lack[i as usize] = before + RELAXATION * (found[axis] - before);
            }
        }
    }
}

impl Stage for SurfaceArea {
    fn name(&self) -> &'static str {
        "surface-area"
    }

    fn bytes(&self) -> usize {
        let own = bytes_of(&self.numbers) + bytes_of(&self.particles) + bytes_of(&self.found);
        own + self.contour.bytes()
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        if world.clock.mark(COMPUTED) == world.clock.time {
            self.gather(world);
            self.measure();
            self.store_lack(world);
        }
        let surface = world.store.read(self.surface);
        let [lack_r, lack_z] = self.lack.map(|field| world.store.write(field));
        let [mut weight_r, mut weight_z] = self.weight.map(|field| world.store.write(field));
        let columns = (&mut weight_r[..], &mut weight_z[..]);
        parallel::for_chunks(lack_r.len(), columns, |start, (weight_r, weight_z)| {
            for_surface(&surface[start..start + weight_r.len()], |k| {
                let length = (weight_r[k] * weight_r[k] + weight_z[k] * weight_z[k]).sqrt();
                weight_r[k] += length * lack_r[start + k];
                weight_z[k] += length * lack_z[start + k];
            });
        });
        Ok(())
    }
}
