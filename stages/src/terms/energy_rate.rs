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

impl<R: FlowState, G: Geometry> PairTerm<R, Contact> for EnergyRate<G> {
    type Sum = Lanes;
    const OUTPUTS: usize = 1;

    #[inline(always)]
    fn zero(&self) -> Lanes {
        Lanes::ZERO
    }

    #[inline(always)]
    fn add(&self, a: &R, _: &R, pair: &Contact, sum: &mut Lanes) {
        let flow = a.flow();
        // U* . d, from what it rises above U_a . d.
        let carried = flow.velocity_r.mul_add(pair.dr, flow.velocity_z.mul_add(pair.dz, pair.rise));
        *sum -= pair.weight_kernel * (pair.pressure + pair.dissipation) * carried;
    }

    #[inline(always)]
    fn finish(&self, a: &R, sum: Lanes, results: &mut [Lanes]) {
        let flow = a.flow();
        let hoop = self.geometry.inverse_radius(flow) - self.geometry.hoop_force(flow);
        results[0] = sum - flow.pressure * flow.velocity_r * hoop;
    }

    fn operations(&self) -> u64 {
        8
    }

    fn outputs(&self, columns: &mut Columns) {
        columns.push(Some(self.power));
    }
}
