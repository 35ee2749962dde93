//! The gradient of the particle concentration, against which shifting moves particles.

use crate::contact::Contact;
use crate::fields;
use crate::record::FlowState;
use meniscus_engine::lanes::Lanes;
use meniscus_engine::pairs::{Columns, PairTerm};
use meniscus_engine::store::Write;
use meniscus_engine::wiring::Wiring;

/// sum_b [1 + 0.2 ((1 - q)/(1 - q_D))^12] V_b g_ab e_ab: the gradient of the particle concentration with a
/// term that keeps particles from pairing: that of Monaghan, 0.2 (W_ab/W(D))^4 (method.md, section 12, after Sun
/// et al. 2017), with (1 - q)^3, which rises about as steeply as the kernel where neighbours lie and is at hand, for W. Without
/// such a term some fast collisions (`cases/drop-collision-capillary/hard.toml`) break down or creep on with tiny
/// steps.
pub struct ConcentrationGradient {
    /// 1/(1 - q_D)^3.
    inverse_regular: f64,
    gradient: [Write<f64>; 2],
}

impl ConcentrationGradient {
    /// Writes the two components; `theta` is the smoothing length over the sum of two particles' sizes.
    pub fn new(wiring: &mut Wiring, theta: f64) -> Self {
        let gradient = fields::CONCENTRATION_GRADIENT.map(|field| wiring.write(field));
        // Two equal particles at their regular distance D lie at q = 1/(4 theta).
        let inside = (1.0 - 1.0 / (4.0 * theta)).max(0.1);
        ConcentrationGradient { inverse_regular: inside.powi(-3), gradient }
    }
}

impl<R: FlowState> PairTerm<R, Contact<R::Scalar>> for ConcentrationGradient {
    type Sum = [Lanes<R::Scalar>; 2];
    const OUTPUTS: usize = 2;

    #[inline(always)]
    fn zero(&self) -> [Lanes<R::Scalar>; 2] {
        [Lanes::ZERO; 2]
    }

    #[inline(always)]
    fn add(&self, _: &R, _: &R, pair: &Contact<R::Scalar>, sum: &mut [Lanes<R::Scalar>; 2]) {
        let ratio = pair.inside * pair.inside * pair.inside * Lanes::splat(self.inverse_regular);
        let square = ratio * ratio;
        let factor = Lanes::splat(0.2).mul_add(square * square, Lanes::ONE);
        let weight = factor * pair.area_kernel;
        sum[0] = weight.mul_add(pair.dr, sum[0]);
        sum[1] = weight.mul_add(pair.dz, sum[1]);
    }

    #[inline(always)]
    fn finish(&self, _: &R, sum: [Lanes<R::Scalar>; 2], results: &mut [Lanes<R::Scalar>]) {
        results.copy_from_slice(&sum);
    }

    fn operations(&self) -> u64 {
        12
    }

    fn outputs(&self, columns: &mut Columns) {
        columns.extend(self.gradient.map(Some));
    }
}
