//! The balance of tension: its deficit, what surface forces lack of its pull, at the ends of every piece of the contour. (Neither the
//! paper nor method.md has the factor f.)
//!
//! Ghosts push with the Laplace pressure P on A = 2 V bw, the part of a particle's surroundings that is
//! empty, and the tangential pressure adds -V (I - L) grad_s P (method.md, section 10, T). Both together are the
//! pressure's force on the contour if for any function phi of the place on the surface
//!
//!   sum_b R_b [A_b P_b phi_b + V_b (I - L_b) grad_s (P phi)_b] = ∮ R n P phi ds, R the distance from the axis:
//!
//! the pair sums of neighbours cancel, those across the edge are what L lacks. With R n P ds = sigma (n_r n ds -
//! R dt) the right side is what tension does, without P: it pulls along the tangent t at the ends of a piece
//! (Popinet and Zaleski 1999), and the parts of a rim add up to the whole whatever lies between.
//! Particles at rest keep that within .2 %; where the flow has drawn the packing out, A is wrong by up to fifteen per
//! cent, and so is the momentum that a film's edge gains. So surface forces become larger by f. Each time it is the f
//! before and a part of what is lacking with that at each corner x_k of the contour, both handed to the particles around:
//!
//!   f(x) = sum_k W(x - x_k)/N(x_k) times them, W a kernel a few particles wide and N the sum of W l, l = A . n + kappa
//!   t V (I - L) t the length of contour above a particle, kappa its curvature.
//!
//! Across the surface f is a pressure that ghosts lack, and acts like theirs: along the A of each, on the strain rate
//! (`ghost_coupling`), and with a gradient along the surface (`TangentialPressure`). Along the surface
//! f is a force on A . n. (With |A| f in the direction of f a drop at rest was driven.
//! P there is a pressure P_ref and a part in 20 000, which f takes back; what A has along the surface was left over, most
//! of it at the poles, and the vortices that it drove had 9e-6 of the capillary velocity after twenty capillary times,
//! with 35 particles to the radius, and grew. It is 5e-7 now.)
//!
//! What is handed on is not quite what acts: A differs from particle to particle, and f with it. Found anew each time, without
//! looking at what the f before did, films with 25 and 50 particles to the thickness gained .4 and .7 % too little; so they do .02 and
//! .2 %. The f before is handed on, too, not kept: kept by each particle it becomes as rough as the particles are mixed. Then a drop
//! that swings loses twice as much, and fast collisions win 1 % in the mean instead of .4 and 12 % at most.
//!
//! Forces are those of P - P_ref; what the reference does not do on the right side is -P_ref n ds. The contour is the
//! polygon through the feet, the places on the surface next to the boundary particles.

use crate::contour::{Contour, Deficit, SurfaceParticle};
use crate::equation_of_state::Packing;
use crate::fields;
use crate::moment::Moment;
use crate::reference_pressure::FIRST_REFERENCE;
use crate::rows::PackedState;
use crate::surface::{BOUNDARY, for_surface};
use crate::surface_interval::COMPUTED;
use meniscus_engine::field::clear;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Read, Update, bytes_of};
use meniscus_engine::wiring::Wiring;

/// Steps between two times that f is found, more where the curvature is computed less often.
const INTERVAL: u64 = 16;

/// The stage finds f; it must follow the curvature, which finds feet and tangents.
pub struct TensionBalance {
    packing: Packing,
    /// sigma, N/m.
    tension: f64,
    position: [Read<f64>; 2],
    surface: Read<u32>,
    offset: [Read<f64>; 2],
    tangent: [Read<f64>; 2],
    support_deficiency: [Read<f64>; 3],
    weight: [Read<f64>; 2],
    pressure: Read<f64>,
    slope: Read<f64>,
    reference: Read<f64>,
    deficit: [Update<f64>; 3],
    numbers: Vec<u32>,
    particles: Vec<SurfaceParticle>,
    contour: Contour,
    found: Vec<Deficit>,
}

impl TensionBalance {
    /// Finds f in steps in which the curvature is computed, for a surface tension in N/m.
    pub fn new(wiring: &mut Wiring, packing: Packing, tension: f64) -> Self {
        wiring.stage("tension-balance");
        let deficit =
            [&fields::TENSION_DEFICIT_R, &fields::TENSION_DEFICIT_Z, &fields::TENSION_DEFICIT_SLOPE];
        TensionBalance {
            packing,
            tension,
            position: fields::POSITION.map(|field| wiring.read(field)),
            surface: wiring.read(&fields::SURFACE),
            offset: fields::SURFACE_OFFSET.map(|field| wiring.read(field)),
            tangent: fields::SURFACE_TANGENT.map(|field| wiring.read(field)),
            support_deficiency: fields::SUPPORT_DEFICIENCY.map(|field| wiring.read(field)),
            weight: fields::GHOST_WEIGHT.map(|field| wiring.read(field)),
            pressure: wiring.read(&fields::LAPLACE_PRESSURE),
            slope: wiring.read(&fields::LAPLACE_SLOPE),
            reference: wiring.read(&fields::REFERENCE_PRESSURE),
            deficit: deficit.map(|field| wiring.update(field)),
            numbers: Vec::new(),
            particles: Vec::new(),
            contour: Contour::default(),
            found: Vec::new(),
        }
    }

    /// Takes up the particles that have a surface next to them and a Laplace pressure: spray has none.
    fn gather(&mut self, world: &World) {
        let [r, z] = self.position.map(|field| world.store.read(field));
        let [offset_r, offset_z] = self.offset.map(|field| world.store.read(field));
        let [tangent_r, tangent_z] = self.tangent.map(|field| world.store.read(field));
        let [weight_r, weight_z] = self.weight.map(|field| world.store.read(field));
        let [rr, rz, zz] = self.support_deficiency.map(|field| world.store.read(field));
        let (packed, surface) = (PackedState(&world.rows), world.store.read(self.surface));
        let (pressure, slope) = (world.store.read(self.pressure), world.store.read(self.slope));
        let reference = world.store.read(self.reference);
        let [deficit_r, deficit_z, deficit_slope] = self.deficit.map(|field| world.store.read(field));
        let first_reference = world.clock.number(FIRST_REFERENCE);
        let Packing { largest_size, domain, .. } = self.packing;
        self.numbers.clear();
        for_surface(&surface, |i| {
            if (tangent_r[i], tangent_z[i]) != (0.0, 0.0) && pressure[i] != 0.0 {
                self.numbers.push(i as u32);
            }
        });
        self.particles.clear();
        self.particles.extend(self.numbers.iter().map(|&i| {
            let i = i as usize;
            let size = packed.size(i);
            let foot = [r[i] + offset_r[i], z[i] + offset_z[i]];
            let tangent = [tangent_r[i], tangent_z[i]];
            let nearest = 0.1 * size.min(largest_size);
            let ring = ((r[i] + domain.origin) / (foot[0] + domain.origin).max(nearest)).clamp(0.5, 1.5);
            let volume = size * size * ring;
            let missing = Moment { rr: rr[i], rz: rz[i], zz: zz[i] };
            SurfaceParticle {
                is_boundary: surface[i] == BOUNDARY,
                size: size.min(largest_size),
                foot,
                tangent,
                ghost: [2.0 * volume * weight_r[i], 2.0 * volume * weight_z[i]],
                deep: missing.apply(tangent).map(|deep| volume * deep),
                pressure: pressure[i],
                slope: slope[i],
                reference: first_reference + reference[i],
                deficit: Deficit { f: [deficit_r[i], deficit_z[i]], slope: deficit_slope[i] },
            }
        }));
    }

    /// f at the feet of all particles taken up.
    fn measure(&mut self) {
        let Packing { largest_size, domain, .. } = self.packing;
        self.contour.gather(&self.particles, largest_size, &domain, self.tension);
        self.contour.deficit(&self.particles, &mut self.found);
    }

    fn store_deficit(&self, world: &World) {
        let mut columns = self.deficit.map(|field| world.store.write(field));
        columns.iter_mut().for_each(|column| clear(&mut column[..]));
        for (&i, Deficit { f: [r, z], slope }) in self.numbers.iter().zip(&self.found) {
            for (column, value) in columns.iter_mut().zip([r, z, slope]) {
                column[i as usize] = *value;
            }
        }
    }
}

impl Stage for TensionBalance {
    fn name(&self) -> &'static str {
        "tension-balance"
    }

    fn bytes(&self) -> usize {
        let own = bytes_of(&self.numbers) + bytes_of(&self.particles) + bytes_of(&self.found);
        own + self.contour.bytes()
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        let clock = &world.clock;
        if clock.mark(COMPUTED) == clock.time && clock.step.is_multiple_of(INTERVAL) {
            self.gather(world);
            self.measure();
            self.store_deficit(world);
        }
        Ok(())
    }
}
