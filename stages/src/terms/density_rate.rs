//! Density rate: the volumetric strain rate from the contact velocities.

use crate::contact::Contact;
use crate::fields;
use crate::geometry::Geometry;
use crate::record::FlowState;
use meniscus_engine::lanes::Lanes;
use meniscus_engine::pairs::{Columns, PairTerm};
use meniscus_engine::store::Write;
use meniscus_engine::wiring::Wiring;

/// d eps_a/dt = sum_b w_ab (U* - U_a) . e_ab g_ab + U_r,a/R_a (equation (16); method.md, section 3).
pub struct DensityRate<G> {
    geometry: G,
    strain_rate: Write<f64>,
}

impl<G: Geometry> DensityRate<G> {
    /// Writes the strain rate.
    pub fn new(wiring: &mut Wiring, geometry: G) -> Self {
        DensityRate { geometry, strain_rate: wiring.write(&fields::STRAIN_RATE) }
    }
}

impl<R: FlowState, G: Geometry> PairTerm<R, Contact<R::Scalar>> for DensityRate<G> {
    type Sum = Lanes<R::Scalar>;
    const OUTPUTS: usize = 1;

    #[inline(always)]
    fn zero(&self) -> Lanes<R::Scalar> {
        Lanes::ZERO
    }

    #[inline(always)]
    fn add(&self, _: &R, _: &R, pair: &Contact<R::Scalar>, sum: &mut Lanes<R::Scalar>) {
        *sum = pair.weight_kernel.mul_add(pair.rise, *sum);
    }

    #[inline(always)]
    fn finish(&self, a: &R, sum: Lanes<R::Scalar>, results: &mut [Lanes<R::Scalar>]) {
        let flow = a.flow();
        results[0] = flow.velocity_r.mul_add(self.geometry.inverse_radius(a), sum);
    }

    fn operations(&self) -> u64 {
        2
    }

    fn outputs(&self, columns: &mut Columns) {
        columns.push(Some(self.strain_rate));
    }
}
