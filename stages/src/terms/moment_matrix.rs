//! The moment matrix: how complete a particle's neighbourhood is.

use crate::contact::Contact;
use crate::fields;
use crate::record::FlowState;
use meniscus_engine::lanes::Lanes;
use meniscus_engine::pairs::{Columns, PairTerm, Powers};
use meniscus_engine::store::Write;
use meniscus_engine::wiring::Wiring;

/// L_a = sum_b V_b g_ab e_ab (x) (r_b - r_a), images included (equation (21)).
pub struct MomentMatrix {
    moment: [Write<f64>; 3],
}

impl MomentMatrix {
    /// Writes L_rr, L_rz and L_zz.
    pub fn new(wiring: &mut Wiring) -> Self {
        MomentMatrix { moment: fields::MOMENT.map(|field| wiring.write(field)) }
    }
}

impl<R: FlowState> PairTerm<R, Contact<R::Scalar>> for MomentMatrix {
    type Sum = [Lanes<R::Scalar>; 3];
    const OUTPUTS: usize = 3;

    #[inline(always)]
    fn zero(&self) -> [Lanes<R::Scalar>; 3] {
        [Lanes::ZERO; 3]
    }

    #[inline(always)]
    fn add(&self, _: &R, _: &R, pair: &Contact<R::Scalar>, sum: &mut [Lanes<R::Scalar>; 3]) {
        let weight = pair.area_kernel;
        let (r, z) = (weight * pair.dr, weight * pair.dz);
        sum[0] = r.mul_add(pair.dr, sum[0]);
        sum[1] = r.mul_add(pair.dz, sum[1]);
        sum[2] = z.mul_add(pair.dz, sum[2]);
    }

    #[inline(always)]
    fn finish(&self, _: &R, sum: [Lanes<R::Scalar>; 3], results: &mut [Lanes<R::Scalar>]) {
        results.copy_from_slice(&sum);
    }

    fn operations(&self) -> u64 {
        8
    }

    /// Pure numbers.
    fn powers(&self, powers: &mut Powers) {
        powers.extend([0; 3]);
    }

    fn outputs(&self, columns: &mut Columns) {
        columns.extend(self.moment.map(Some));
    }
}
