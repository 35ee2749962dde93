//! Energy rate: the work of the contact pressures.

use crate::contact::Contact;
use crate::fields;
use crate::geometry::Geometry;
use crate::record::FlowState;
use meniscus_engine::lanes::Lanes;
use meniscus_engine::pairs::{Columns, PairTerm};
use meniscus_engine::store::Write;
use meniscus_engine::wiring::Wiring;

/// rho_a dE_a/dt = -sum_b w_ab P* U* g_ab, with E the total specific energy (equation (18); method.md,
/// section 3); where Parshikov's weights hold, less P_a U_r,a/R_a (equation (10); section 4).
pub struct EnergyRate<G> {
    geometry: G,
    power: Write<f64>,
}

impl<G: Geometry> EnergyRate<G> {
    /// Writes the power density.
    pub fn new(wiring: &mut Wiring, geometry: G) -> Self {
        EnergyRate { geometry, power: wiring.write(&fields::POWER) }
    }
}

impl<R: FlowState, G: Geometry> PairTerm<R, Contact<R::Scalar>> for EnergyRate<G> {
    type Sum = Lanes<R::Scalar>;
    const OUTPUTS: usize = 1;

    #[inline(always)]
    fn zero(&self) -> Lanes<R::Scalar> {
        Lanes::ZERO
    }

    #[inline(always)]
    fn add(&self, a: &R, _: &R, pair: &Contact<R::Scalar>, sum: &mut Lanes<R::Scalar>) {
        let flow = a.flow();
        // U* . d, from what it rises above U_a . d.
        let carried = flow.velocity_r.mul_add(pair.dr, flow.velocity_z.mul_add(pair.dz, pair.rise));
        *sum -= pair.weight_kernel * (pair.pressure + pair.dissipation) * carried;
    }

    #[inline(always)]
    fn finish(&self, a: &R, sum: Lanes<R::Scalar>, results: &mut [Lanes<R::Scalar>]) {
        let flow = a.flow();
        let hoop = self.geometry.inverse_radius(a) - self.geometry.hoop_force(a);
        results[0] = sum - flow.pressure * flow.velocity_r * hoop;
    }

    fn operations(&self) -> u64 {
        8
    }

    fn outputs(&self, columns: &mut Columns) {
        columns.push(Some(self.power));
    }
}
