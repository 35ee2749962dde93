//! The force of the contact pressures, in two parts: what pressures give and what velocity jumps give.

use crate::contact::Contact;
use crate::fields;
use crate::geometry::Geometry;
use crate::record::FlowState;
use meniscus_engine::lanes::Lanes;
use meniscus_engine::pairs::{Columns, PairTerm};
use meniscus_engine::store::Write;
use meniscus_engine::wiring::Wiring;

/// rho_a dU_a/dt = -sum_b w_ab P* g_ab e_ab + (P_a/R_a) e_r (equation (17); method.md, section 3).
/// The part of P* that comes from the velocity jump is summed apart: it is dissipative, and the time
/// integration treats it by an explicit Euler step.
pub struct PressureRiemann<G> {
    geometry: G,
    force: [Write<f64>; 2],
    dissipation: [Write<f64>; 2],
}

impl<G: Geometry> PressureRiemann<G> {
    /// Writes both force densities.
    pub fn new(wiring: &mut Wiring, geometry: G) -> Self {
        PressureRiemann {
            geometry,
            force: [wiring.write(&fields::FORCE_R), wiring.write(&fields::FORCE_Z)],
            dissipation: [wiring.write(&fields::DISSIPATION_R), wiring.write(&fields::DISSIPATION_Z)],
        }
    }
}

impl<R: FlowState, G: Geometry> PairTerm<R, Contact<R::Scalar>> for PressureRiemann<G> {
    type Sum = [Lanes<R::Scalar>; 4];
    const OUTPUTS: usize = 4;

    #[inline(always)]
    fn zero(&self) -> [Lanes<R::Scalar>; 4] {
        [Lanes::ZERO; 4]
    }

    #[inline(always)]
    fn add(&self, _: &R, _: &R, pair: &Contact<R::Scalar>, sum: &mut [Lanes<R::Scalar>; 4]) {
        let weight = pair.weight_kernel;
        let (r, z) = (weight * pair.dr, weight * pair.dz);
        sum[0] = r.neg_mul_add(pair.pressure, sum[0]);
        sum[1] = z.neg_mul_add(pair.pressure, sum[1]);
        sum[2] = r.neg_mul_add(pair.dissipation, sum[2]);
        sum[3] = z.neg_mul_add(pair.dissipation, sum[3]);
    }

    #[inline(always)]
    fn finish(&self, a: &R, sum: [Lanes<R::Scalar>; 4], results: &mut [Lanes<R::Scalar>]) {
        let flow = a.flow();
        results[0] = flow.pressure.mul_add(self.geometry.hoop_force(a), sum[0]);
        results[1..4].copy_from_slice(&sum[1..4]);
    }

    fn operations(&self) -> u64 {
        10
    }

    fn outputs(&self, columns: &mut Columns) {
        columns.extend(self.force.map(Some));
        columns.extend(self.dissipation.map(Some));
    }
}
