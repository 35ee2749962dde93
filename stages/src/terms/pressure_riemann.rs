//! The force of the contact pressures, in two parts if wanted: what pressures give and what velocity jumps give.

use crate::contact::Contact;
use crate::fields;
use crate::geometry::{Geometry, Support};
use crate::image_contact::ImageContact;
use crate::record::FlowState;
use meniscus_engine::lanes::Lanes;
use meniscus_engine::pairs::{Columns, PairTerm};
use meniscus_engine::store::Write;
use meniscus_engine::wiring::Wiring;

/// rho_a dU_a/dt = -sum_b w_ab P* g_ab e_ab + (P_a/R_a) e_r (equation (17); method.md, section 3).
/// The part of P* that comes from the velocity jump is summed apart: it is dissipative, and time integration
/// may treat it in another way. What a ring's contact with its own image gives belongs to it.
pub struct PressureRiemann<G, F> {
    geometry: G,
    /// Supports and contacts where rings have images.
    images: Option<(Support, F)>,
    force: [Write<f64>; 2],
    /// None where both parts are one force.
    dissipation: Option<[Write<f64>; 2]>,
}

impl<G: Geometry, F> PressureRiemann<G, F> {
    /// Writes the force density, and that of the dissipative part apart or with it. `images` where coordinates begin at the
    /// axis and pairs know of no images beyond it.
    pub fn new(wiring: &mut Wiring, geometry: G, images: Option<(Support, F)>, apart: bool) -> Self {
        PressureRiemann {
            geometry,
            images,
            force: fields::FORCE.map(|field| wiring.write(field)),
            dissipation: apart.then(|| fields::DISSIPATION.map(|field| wiring.write(field))),
        }
    }
}

impl<R, G, F> PairTerm<R, Contact<R::Scalar>> for PressureRiemann<G, F>
where
    R: FlowState,
    G: Geometry,
    F: ImageContact<R>,
{
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
        let [mut force_r, mut force_z, mut r, z] = sum;
        if let Some((support, contact)) = &self.images {
            r = contact.add_image_force(a, *support, r);
        }
        if self.dissipation.is_none() {
            (force_r, force_z) = (force_r + r, force_z + z);
        }
        let force_r = flow.pressure.mul_add(self.geometry.hoop_force(a), force_r);
        results[..4].copy_from_slice(&[force_r, force_z, r, z]);
    }

    fn operations(&self) -> u64 {
        10
    }

    fn outputs(&self, columns: &mut Columns) {
        columns.extend(self.force.map(Some));
        columns.extend(self.dissipation.map_or([None; 2], |fields| fields.map(Some)));
    }
}
