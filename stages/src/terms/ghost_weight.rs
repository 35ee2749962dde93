//! The weight of a particle's ghost: what the neighbours leave open of a closed surface.

use crate::contact::Contact;
use crate::fields;
use crate::geometry::Geometry;
use crate::record::FlowState;
use meniscus_engine::lanes::Lanes;
use meniscus_engine::pairs::{Columns, PairTerm};
use meniscus_engine::store::Write;
use meniscus_engine::wiring::Wiring;

/// bw_a = -(1/2) sum_b w_ab g_ab e_ab + e_r/(2 R_a): with a ghost of this weight a constant pressure
/// gives no force (equation (23); method.md, section 8). It points outwards.
pub struct GhostWeight<G> {
    geometry: G,
    weight: [Write<f64>; 2],
}

impl<G: Geometry> GhostWeight<G> {
    /// Writes the weight vector.
    pub fn new(wiring: &mut Wiring, geometry: G) -> Self {
        let weight = fields::GHOST_WEIGHT_SUM.map(|field| wiring.write(field));
        GhostWeight { geometry, weight }
    }
}

impl<R: FlowState, G: Geometry> PairTerm<R, Contact<R::Scalar>> for GhostWeight<G> {
    type Sum = [Lanes<R::Scalar>; 2];
    const OUTPUTS: usize = 2;

    #[inline(always)]
    fn zero(&self) -> [Lanes<R::Scalar>; 2] {
        [Lanes::ZERO; 2]
    }

    #[inline(always)]
    fn add(&self, _: &R, _: &R, pair: &Contact<R::Scalar>, sum: &mut [Lanes<R::Scalar>; 2]) {
        let weight = pair.weight_kernel;
        sum[0] -= weight * pair.dr;
        sum[1] -= weight * pair.dz;
    }

    #[inline(always)]
    fn finish(&self, a: &R, sum: [Lanes<R::Scalar>; 2], results: &mut [Lanes<R::Scalar>]) {
        results[0] = Lanes::HALF * (sum[0] + self.geometry.hoop_force(a));
        results[1] = Lanes::HALF * sum[1];
    }

    fn operations(&self) -> u64 {
        4
    }

    fn outputs(&self, columns: &mut Columns) {
        columns.extend(self.weight.map(Some));
    }
}
