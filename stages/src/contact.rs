//! The contact of two particles: distance, kernel gradient, weight and the Riemann star state, evaluated
//! once per pair for all terms.

use crate::geometry::Geometry;
use crate::record::{FlowState, GradientState};
use meniscus_engine::lanes::Lanes;
use meniscus_engine::pairs::Interaction;
use std::f64::consts::PI;

/// One evaluated pair, seen from a. Vectors point from a to b.
#[derive(Clone, Copy, Debug)]
pub struct Contact {
    /// r_b - r_a, m.
    pub dr: Lanes,
    /// z_b - z_a, m.
    pub dz: Lanes,
    /// g_ab/|d|: times (dr, dz) it is the kernel gradient, 1/m4.
    pub kernel: Lanes,
    /// w_ab of the scheme, m2.
    pub weight: Lanes,
    /// (U* - U_a) . e_ab times the distance, m2/s.
    pub rise: Lanes,
    /// The part of P* that the pressures give, Pa.
    pub pressure: Lanes,
    /// The part of P* that the velocity jump gives, Pa.
    pub dissipation: Lanes,
}

/// How velocities are brought to the contact.
pub trait Reconstruction<R>: Copy + Send + Sync {
    /// Half-steps from a and b towards the contact along d, times the distance, and the jump that
    /// P* feels, times the distance, all in m2/s. `jump` is (U_b - U_a) . d.
    fn reconstruct(
        &self,
        a: &R,
        b: &R,
        d: (Lanes, Lanes),
        jump: Lanes,
        inverse_distance: Lanes,
    ) -> Rises;
}

/// What a reconstruction gives, all times the distance (m2/s).
#[derive(Clone, Copy, Debug)]
pub struct Rises {
    /// (u_L - u_a) . d
    pub left: Lanes,
    /// (u_R - u_a) . d
    pub right: Lanes,
    /// The jump in P*.
    pub jump: Lanes,
}

/// The first-order flux: the particles' own velocities meet at the contact (equations (19), (20)).
#[derive(Clone, Copy, Debug)]
pub struct FirstOrder;

impl<R> Reconstruction<R> for FirstOrder {
    #[inline(always)]
    fn reconstruct(&self, _: &R, _: &R, _: (Lanes, Lanes), jump: Lanes, _: Lanes) -> Rises {
        Rises {
            left: Lanes::ZERO,
            right: jump,
            jump,
        }
    }
}

/// MUSCL on the velocity along the pair axis with van Leer's limiter (method.md, section 10, "Low
/// dissipation"), and a jump in P* that returns to the plain one where the flow is not smooth
/// ("Coalescence, later").
#[derive(Clone, Copy, Debug)]
pub struct Limited {
    /// 300/C, s/m: how fast the plain jump returns as the reconstructed one grows.
    pub sharpness: f64,
}

impl<R: GradientState> Reconstruction<R> for Limited {
    #[inline(always)]
    fn reconstruct(
        &self,
        a: &R,
        b: &R,
        (dr, dz): (Lanes, Lanes),
        jump: Lanes,
        inverse_distance: Lanes,
    ) -> Rises {
        let along = |record: &R| {
            let g = record.gradient();
            let r = dr.mul_add(g.rr, dz * g.rz);
            let z = dr.mul_add(g.zr, dz * g.zz);
            r.mul_add(dr, z * dz)
        };
        // van Leer's mean of x = 2 grad U . d - jump and y = jump is x y / (grad U . d) where x y > 0.
        let (along_a, along_b) = (along(a), along(b));
        let product = |along: Lanes| (along + along - jump) * jump;
        let (product_a, product_b) = (product(along_a), product(along_b));
        let smallest = Lanes::splat(1e-200);
        let safe = |product: Lanes, along| product.select_greater(smallest, along, Lanes::ONE);
        let (safe_a, safe_b) = (safe(product_a, along_a), safe(product_b, along_b));
        let inverse = Lanes::HALF / (safe_a * safe_b);
        let half_a = product_a.select_greater(smallest, product_a * safe_b * inverse, Lanes::ZERO);
        let half_b = product_b.select_greater(smallest, product_b * safe_a * inverse, Lanes::ZERO);

        let reconstructed = jump - half_a - half_b;
        let roughness =
            (Lanes::splat(self.sharpness) * inverse_distance * reconstructed.abs()).min(Lanes::ONE);
        Rises {
            left: half_a,
            right: jump - half_b,
            jump: roughness.mul_add(jump - reconstructed, reconstructed),
        }
    }
}

/// The acoustic Riemann problem on the pair axis with a scheme's weights.
#[derive(Clone, Copy, Debug)]
pub struct ContactProblem<G, F> {
    /// Weights and hoop terms.
    pub geometry: G,
    /// How velocities are brought to the contact.
    pub reconstruction: F,
}

/// 140/pi of the Wendland C2 kernel's derivative (method.md, section 1).
const KERNEL: f64 = 140.0 / PI;

impl<R: FlowState, G: Geometry, F: Reconstruction<R>> Interaction<R> for ContactProblem<G, F> {
    type Pair = Contact;

    #[inline(always)]
    fn evaluate(&self, record_a: &R, record_b: &R) -> Contact {
        let (a, b) = (record_a.flow(), record_b.flow());
        let (dr, dz) = (b.r - a.r, b.z - a.z);
        // A particle is its own neighbour where a list is filled up: its distance must not divide by zero.
        let square = dr.mul_add(dr, dz * dz).max(Lanes::splat(f64::MIN_POSITIVE));
        let distance = square.sqrt();
        let support = a.reach + b.reach;
        let impedance = a.impedance + b.impedance;

        // One division gives the three inverses.
        let support_impedance = support * impedance;
        let inverse = Lanes::ONE / (support_impedance * distance);
        let inverse_distance = inverse * support_impedance;
        let inverse_support = inverse * distance * impedance;
        let inverse_impedance = inverse * distance * support;

        let inside = distance
            .neg_mul_add(inverse_support, Lanes::ONE)
            .max(Lanes::ZERO);
        let inverse_square = inverse_support * inverse_support;
        let scale =
            Lanes::splat(0.5 * KERNEL) * (record_a.kernel_scale() + record_b.kernel_scale());
        let kernel = scale * inverse_square * inverse_square * (inside * inside * inside);

        let (du, dw) = (b.velocity_r - a.velocity_r, b.velocity_z - a.velocity_z);
        let jump = du.mul_add(dr, dw * dz);
        let rises =
            self.reconstruction
                .reconstruct(record_a, record_b, (dr, dz), jump, inverse_distance);

        // Equations (19) and (20), the velocities relative to U_a.
        let carried = a.impedance.mul_add(rises.left, b.impedance * rises.right);
        let pushed = (a.pressure - b.pressure) * distance;
        let resistance = a.impedance * b.impedance * inverse_impedance;
        Contact {
            dr,
            dz,
            kernel,
            weight: self.geometry.weight(a, b),
            rise: (carried + pushed) * inverse_impedance,
            pressure: b.pressure.mul_add(a.impedance, a.pressure * b.impedance) * inverse_impedance,
            dissipation: -(resistance * rises.jump * inverse_distance),
        }
    }
}
