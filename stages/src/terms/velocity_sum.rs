//! The velocity gradient before it is divided by the moment matrix.

use crate::contact::Contact;
use crate::fields;
use crate::record::FlowState;
use meniscus_engine::lanes::Lanes;
use meniscus_engine::pairs::{Columns, PairTerm};
use meniscus_engine::store::Write;
use meniscus_engine::wiring::Wiring;

/// T_a = sum_b V_b (U_b - U_a) (x) g_ab e_ab, images included; T L^{-1} is the velocity gradient,
/// exact for a linear field (method.md, section 10).
pub struct VelocitySum {
    sum: [Write<f64>; 4],
}

impl VelocitySum {
    /// Writes the four components.
    pub fn new(wiring: &mut Wiring) -> Self {
        VelocitySum { sum: fields::VELOCITY_SUM.map(|field| wiring.write(field)) }
    }
}

impl<R: FlowState> PairTerm<R, Contact<R::Scalar>> for VelocitySum {
    type Sum = [Lanes<R::Scalar>; 4];
    const OUTPUTS: usize = 4;

    #[inline(always)]
    fn zero(&self) -> [Lanes<R::Scalar>; 4] {
        [Lanes::ZERO; 4]
    }

    #[inline(always)]
    fn add(&self, a: &R, b: &R, pair: &Contact<R::Scalar>, sum: &mut [Lanes<R::Scalar>; 4]) {
        let (a, b) = (a.flow(), b.flow());
        let weight = pair.area_kernel;
        let (r, z) = (weight * pair.dr, weight * pair.dz);
        let (du, dw) = (b.velocity_r - a.velocity_r, b.velocity_z - a.velocity_z);
        sum[0] = du.mul_add(r, sum[0]);
        sum[1] = du.mul_add(z, sum[1]);
        sum[2] = dw.mul_add(r, sum[2]);
        sum[3] = dw.mul_add(z, sum[3]);
    }

    #[inline(always)]
    fn finish(&self, _: &R, sum: [Lanes<R::Scalar>; 4], results: &mut [Lanes<R::Scalar>]) {
        results.copy_from_slice(&sum);
    }

    fn operations(&self) -> u64 {
        12
    }

    fn outputs(&self, columns: &mut Columns) {
        columns.extend(self.sum.map(Some));
    }
}
