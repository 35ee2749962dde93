//! The contact of two particles: distance, kernel gradient, weight and the Riemann star state, evaluated
//! once per pair for all terms.

use crate::geometry::{AxisState, Geometry, Support};
use crate::record::{DeformationState, FlowState, ShockRecord};
use meniscus_engine::lanes::{Lanes, Scalar};
use meniscus_engine::pairs::Interaction;
use std::f64::consts::PI;

/// One evaluated pair, seen from a. Vectors point from a to b.
#[derive(Clone, Copy, Debug)]
pub struct Contact<T: Scalar = f64> {
    /// r_b - r_a, m.
    pub dr: Lanes<T>,
    /// z_b - z_a, m.
    pub dz: Lanes<T>,
    /// 1 - |d|/H, zero beyond the support radius.
    pub inside: Lanes<T>,
    /// V_b g_ab/|d|, 1/m2: the plain weight of a neighbour.
    pub area_kernel: Lanes<T>,
    /// w_ab g_ab/|d|, 1/m2: the scheme's weight of a neighbour.
    pub weight_kernel: Lanes<T>,
    /// (U* - U_a) . e_ab times the distance, m2/s.
    pub rise: Lanes<T>,
    /// The part of P* that the pressures give, Pa.
    pub pressure: Lanes<T>,
    /// The part of P* that the velocity jump gives, Pa.
    pub dissipation: Lanes<T>,
}

/// Two particles before their contact is known: what comes before roots and divisions, and their results, which
/// nothing here waits for.
#[derive(Clone, Copy, Debug)]
pub struct Approach<T: Scalar, B> {
    /// r_b - r_a, m.
    dr: Lanes<T>,
    /// z_b - z_a, m.
    dz: Lanes<T>,
    /// |d|, m.
    distance: Lanes<T>,
    /// (U_b - U_a) . d, m2/s.
    jump: Lanes<T>,
    /// A reconstruction under way.
    begun: B,
    /// Z_a and Z_b, kg/(m2 s).
    impedances: (Lanes<T>, Lanes<T>),
    /// V_b, m2.
    area: Lanes<T>,
    /// H, m.
    support: Lanes<T>,
    /// (Z_a + Z_b)|d|, kg/(m s).
    impedance_distance: Lanes<T>,
    /// One over the product of both.
    inverse: Lanes<T>,
}

/// How velocities are brought to the contact.
pub trait Reconstruction<R: FlowState>: Copy + Send + Sync {
    /// Floating-point operations of all functions, counted as a pair term's.
    const OPERATIONS: u64;

    /// What is computed of a pair a neighbour ahead.
    type Begun: Copy;

    /// Begins with a pair. `squares` are d_r^2, d_r d_z and d_z^2, `jump` is (U_b - U_a) . d.
    fn begin(&self, a: &R, b: &R, squares: [Lanes<R::Scalar>; 3], jump: Lanes<R::Scalar>) -> Self::Begun;

    /// Steps from a and b towards the contact along d, times the distance, and the jump that
    /// P* feels, times the distance, all in m2/s.
    fn reconstruct(
        &self,
        begun: &Self::Begun,
        jump: Lanes<R::Scalar>,
        inverse_distance: Lanes<R::Scalar>,
    ) -> Rises<R::Scalar>;

    /// Z_a and Z_b of the waves that leave the contact, kg/(m2 s): those of sound if not said otherwise.
    /// `jump` is (U_b - U_a) . d in m2/s, `distance` |d| in m.
    #[inline(always)]
    fn impedances(
        &self,
        a: &R,
        b: &R,
        _jump: Lanes<R::Scalar>,
        _distance: Lanes<R::Scalar>,
    ) -> (Lanes<R::Scalar>, Lanes<R::Scalar>) {
        (a.flow().impedance, b.flow().impedance)
    }
}

/// What a reconstruction gives, all times the distance (m2/s).
#[derive(Clone, Copy, Debug)]
pub struct Rises<T: Scalar = f64> {
    /// (u_L - u_a) . d
    pub left: Lanes<T>,
    /// (u_R - u_a) . d
    pub right: Lanes<T>,
    /// The jump in P*.
    pub jump: Lanes<T>,
}

/// The first-order flux: the particles' own velocities meet at the contact (equations (19), (20)).
#[derive(Clone, Copy, Debug)]
pub struct FirstOrder;

impl<R: FlowState> Reconstruction<R> for FirstOrder {
    const OPERATIONS: u64 = 0;
    type Begun = ();

    #[inline(always)]
    fn begin(&self, _: &R, _: &R, _: [Lanes<R::Scalar>; 3], _: Lanes<R::Scalar>) {}

    #[inline(always)]
    fn reconstruct(&self, _: &(), jump: Lanes<R::Scalar>, _: Lanes<R::Scalar>) -> Rises<R::Scalar> {
        Rises { left: Lanes::ZERO, right: jump, jump }
    }
}

/// The first-order flux with waves that may be shocks. Where a contact closes with the speed J, the state
/// behind each of its two waves moves with about J/2 relative to the particle: with the shock adiabat
/// D = C + s u the impedance is rho (C + s J/2), exact for two equal states (Dukowicz 1985). Without it a
/// cold gas would have no resistance at all.
#[derive(Clone, Copy, Debug)]
pub struct Shock {
    /// s.
    pub slope: f64,
}

impl<T: Scalar> Reconstruction<ShockRecord<T>> for Shock {
    const OPERATIONS: u64 = 6;
    type Begun = ();

    #[inline(always)]
    fn begin(&self, _: &ShockRecord<T>, _: &ShockRecord<T>, _: [Lanes<T>; 3], _: Lanes<T>) {}

    #[inline(always)]
    fn reconstruct(&self, _: &(), jump: Lanes<T>, _: Lanes<T>) -> Rises<T> {
        Rises { left: Lanes::ZERO, right: jump, jump }
    }

    #[inline(always)]
    fn impedances(
        &self,
        a: &ShockRecord<T>,
        b: &ShockRecord<T>,
        jump: Lanes<T>,
        distance: Lanes<T>,
    ) -> (Lanes<T>, Lanes<T>) {
        let rise = Lanes::splat(0.5 * self.slope) * (-jump).max(Lanes::ZERO) / distance;
        // Keeps a cold gas at rest from dividing by zero; far below the impedance of anything that flows.
        let least = Lanes::splat(T::TINY.sqrt());
        let of = |record: &ShockRecord<T>| record.density.mul_add(rise, record.flow().impedance).max(least);
        (of(a), of(b))
    }
}

/// MUSCL on the velocity along the pair axis with van Leer's limiter (method.md, section 10, "Low dissipation"), and a
/// jump in P* that returns to the plain one where the flow is not smooth ("Coalescence, later"). With the plain jump J,
/// the reconstructed one J_r and x = J_r/J, P* feels
///
///   J_s + beta (J - J_s),  J_s = J_r min(1, 3 |x|),  beta = min(1, sharpness |x^2 J_s|).
///
/// x tells how rough the flow is, as limiters tell by the ratio of slopes (van Leer 1979): where they find an
/// extreme it is one, in a wave with the number k it is (k d)^2/12, d the distance of neighbours. Without the factor 3 |x|
/// J_r damps a wave by about C d^3 k^4/48, one of 18 particle sizes on a drop by a fifth in a period, not by a fifteenth; with |x| itself,
/// which takes more away, it is a thirtieth, but what a swing leaves of short waves lives longer, and after fifty periods a drop's frequency
/// and damping have changed by more. And beta has a viscosity of about sharpness |x^2 J_s| C H/16 where the flow is fast: fast smooth flow
/// hardly feels it, and rough flow at once. (`cases/oscillating-drop` has the figures.)
#[derive(Clone, Copy, Debug)]
pub struct Limited {
    /// 4000/C, s/m: how fast the plain jump returns where the flow is rough.
    pub sharpness: f64,
}

impl<R: DeformationState> Reconstruction<R> for Limited {
    const OPERATIONS: u64 = 37;
    type Begun = Halves<R::Scalar>;

    #[inline(always)]
    fn begin(
        &self,
        a: &R,
        b: &R,
        [dr_dr, dr_dz, dz_dz]: [Lanes<R::Scalar>; 3],
        jump: Lanes<R::Scalar>,
    ) -> Halves<R::Scalar> {
        // d . grad U . d needs the symmetric part of the gradient alone.
        let along = |record: &R| {
            let g = record.deformation();
            dr_dr.mul_add(g.rr, dr_dz.mul_add(g.shear, dz_dz * g.zz))
        };
        // van Leer's mean of x = 2 grad U . d - jump and y = jump is x y / (grad U . d) where x y > 0.
        let (along_a, along_b) = (along(a), along(b));
        let beyond = |along: Lanes<R::Scalar>| along + along - jump;
        let (beyond_a, beyond_b) = (beyond(along_a), beyond(along_b));
        let (product_a, product_b) = (beyond_a * jump, beyond_b * jump);
        let smallest = Lanes::splat(R::Scalar::TINY);
        let safe = |product: Lanes<R::Scalar>, along| product.select_greater(smallest, along, Lanes::ONE);
        let (safe_a, safe_b) = (safe(product_a, along_a), safe(product_b, along_b));
        Halves {
            a: product_a.select_greater(smallest, beyond_a * safe_b, Lanes::ZERO),
            b: product_b.select_greater(smallest, beyond_b * safe_a, Lanes::ZERO),
            factor: Lanes::HALF / (safe_a * safe_b),
        }
    }

    #[inline(always)]
    fn reconstruct(
        &self,
        halves: &Halves<R::Scalar>,
        jump: Lanes<R::Scalar>,
        inverse_distance: Lanes<R::Scalar>,
    ) -> Rises<R::Scalar> {
        // J_r/J.
        let part = (halves.a + halves.b).neg_mul_add(halves.factor, Lanes::ONE);
        let step = jump * halves.factor;
        let rough = (Lanes::splat(ROUGH) * part.abs()).min(Lanes::ONE);
        let smooth = rough * part * jump;
        let sharpness = Lanes::splat(self.sharpness) * inverse_distance;
        let beta = (sharpness * (part * part) * smooth.abs()).min(Lanes::ONE);
        Rises {
            left: halves.a * step,
            right: halves.b.neg_mul_add(step, jump),
            jump: beta.mul_add(jump - smooth, smooth),
        }
    }
}

/// Flow counts as rough where J_r is one part in so many of J.
const ROUGH: f64 = 3.0;

/// The limited half-steps from both particles over the jump, before they are multiplied by their common factor.
#[derive(Clone, Copy, Debug)]
pub struct Halves<T: Scalar> {
    a: Lanes<T>,
    b: Lanes<T>,
    factor: Lanes<T>,
}

/// The acoustic Riemann problem on the pair axis with a scheme's weights.
#[derive(Clone, Copy, Debug)]
pub struct ContactProblem<G, F> {
    /// Weights and hoop terms.
    pub geometry: G,
    /// Who sees whom.
    pub support: Support,
    /// How velocities are brought to the contact.
    pub reconstruction: F,
}

/// 140/pi of the Wendland C2 kernel's derivative (method.md, section 1).
pub(crate) const KERNEL: f64 = 140.0 / PI;

/// Operations of a contact without its weight and reconstruction.
const OPERATIONS: u64 = 50;

impl<R: FlowState, G: Geometry, F: Reconstruction<R>> Interaction<R> for ContactProblem<G, F> {
    type Pair = Contact<R::Scalar>;
    type Own = AxisState<R::Scalar>;
    type Approach = Approach<R::Scalar, F::Begun>;

    #[inline(always)]
    fn prepare(&self, a: &R) -> AxisState<R::Scalar> {
        self.geometry.prepare(a)
    }

    fn operations(&self) -> u64 {
        OPERATIONS + G::OPERATIONS + F::OPERATIONS
    }

    #[inline(always)]
    fn approach(&self, record_a: &R, record_b: &R) -> Self::Approach {
        let (a, b) = (record_a.flow(), record_b.flow());
        let (dr, dz) = (a.r.to(b.r), a.z.to(b.z));
        let (dr_dr, dz_dz) = (dr * dr, dz * dz);
        // A particle is its own neighbour where a list is filled up: its distance must not divide by zero.
        let square = (dr_dr + dz_dz).max(Lanes::splat(R::Scalar::LEAST));
        let distance = square.sqrt();
        let (du, dw) = (b.velocity_r - a.velocity_r, b.velocity_z - a.velocity_z);
        let jump = du.mul_add(dr, dw * dz);
        let begun = self.reconstruction.begin(record_a, record_b, [dr_dr, dr * dz, dz_dz], jump);
        let impedances = self.reconstruction.impedances(record_a, record_b, jump, distance);
        let support = self.support.of_pair(a.size, b.size);
        let impedance_distance = (impedances.0 + impedances.1) * distance;
        // One division gives all inverses.
        let inverse = Lanes::ONE / (support * impedance_distance);
        let area = b.size * b.size;
        Approach { dr, dz, distance, jump, area, begun, impedances, support, impedance_distance, inverse }
    }

    #[inline(always)]
    fn evaluate(
        &self,
        record_a: &R,
        own: &AxisState<R::Scalar>,
        record_b: &R,
        approach: &Self::Approach,
    ) -> Contact<R::Scalar> {
        let (a, b) = (record_a.flow(), record_b.flow());
        let &Approach { dr, dz, distance, jump, area, support, impedance_distance, inverse, .. } = approach;
        let (impedance_a, impedance_b) = approach.impedances;
        let inverse_support = inverse * impedance_distance;
        let inverse_impedance_distance = inverse * support;
        let inverse_impedance = inverse_impedance_distance * distance;
        let inverse_distance = inverse_impedance_distance * (impedance_a + impedance_b);
        let rises = self.reconstruction.reconstruct(&approach.begun, jump, inverse_distance);

        let inside = distance.neg_mul_add(inverse_support, Lanes::ONE).max(Lanes::ZERO);
        let inverse_square = inverse_support * inverse_support;
        let scale = Lanes::splat(0.5 * KERNEL) * (record_a.kernel_scale() + record_b.kernel_scale());
        let kernel = scale * inverse_square * inverse_square * (inside * inside * inside);

        // Equations (19) and (20), the velocities relative to U_a.
        let carried = impedance_a.mul_add(rises.left, impedance_b * rises.right);
        let pushed = (a.pressure - b.pressure) * distance;
        let resistance = impedance_a * impedance_b * inverse_impedance_distance;
        let area_kernel = area * kernel;
        Contact {
            dr,
            dz,
            inside,
            area_kernel,
            weight_kernel: area_kernel * self.geometry.factor(own, record_a, record_b),
            rise: (carried + pushed) * inverse_impedance,
            pressure: b.pressure.mul_add(impedance_a, a.pressure * impedance_b) * inverse_impedance,
            dissipation: -(resistance * rises.jump),
        }
    }
}
