//! The viscous force: the divergence of the mean stress of both particles of a pair.

use crate::contact::Contact;
use crate::fields;
use crate::geometry::Geometry;
use crate::record::DeformationState;
use meniscus_engine::lanes::Lanes;
use meniscus_engine::pairs::{Columns, PairTerm, Powers};
use meniscus_engine::store::Write;
use meniscus_engine::wiring::Wiring;

/// ```text
/// rho_a dU_a/dt = sum_b w_ab (tau_a + tau_b)/2 g_ab e_ab - 2 mu U_r,a/R_a^2 e_r
/// rho_a dE_a/dt = sum_b w_ab (tau_a e_ab . U_b + tau_b e_ab . U_a)/2 g_ab
/// ```
/// with tau = mu (grad U + grad U^T) from the records; where Parshikov's weights hold, plus
/// (tau_rr e_r + tau_rz e_z)/R_a and its power. The bulk viscosity is 2/3 mu: tau is that of the
/// whole rate of deformation, not of its deviator alone. The pair force is antisymmetric, rigid motions have no stress,
/// and beyond the surface there is nothing to pull: it is free of traction. Tried and worse (`cases/viscous-drop`): the central force along e_ab (Monaghan & Gingold), that
/// along U_b - U_a (Morris), and tau L^{-1} for tau.
pub struct Viscosity<G> {
    geometry: G,
    /// mu, Pa s.
    viscosity: f64,
    force: [Write<f64>; 2],
    power: Option<Write<f64>>,
}

impl<G: Geometry> Viscosity<G> {
    /// Writes the force density of a viscosity in Pa s and, with the energy equation, its power density.
    pub fn new(wiring: &mut Wiring, geometry: G, viscosity: f64, with_energy: bool) -> Self {
        let force = fields::VISCOUS_FORCE.map(|field| wiring.write(field));
        let power = with_energy.then(|| wiring.write(&fields::VISCOUS_POWER));
        Viscosity { geometry, viscosity, force, power }
    }
}

/// tau/mu times a vector.
#[inline(always)]
fn traction<R: DeformationState>(
    record: &R,
    r: Lanes<R::Scalar>,
    z: Lanes<R::Scalar>,
) -> [Lanes<R::Scalar>; 2] {
    let rate = record.deformation();
    let [rr, zz] = [rate.rr + rate.rr, rate.zz + rate.zz];
    [rr.mul_add(r, rate.shear * z), rate.shear.mul_add(r, zz * z)]
}

impl<R: DeformationState, G: Geometry> PairTerm<R, Contact<R::Scalar>> for Viscosity<G> {
    type Sum = [Lanes<R::Scalar>; 3];
    const OUTPUTS: usize = 3;

    #[inline(always)]
    fn zero(&self) -> [Lanes<R::Scalar>; 3] {
        [Lanes::ZERO; 3]
    }

    #[inline(always)]
    fn add(&self, a: &R, b: &R, pair: &Contact<R::Scalar>, sum: &mut [Lanes<R::Scalar>; 3]) {
        let (r, z) = (pair.weight_kernel * pair.dr, pair.weight_kernel * pair.dz);
        let ([a_r, a_z], [b_r, b_z]) = (traction(a, r, z), traction(b, r, z));
        sum[0] += a_r + b_r;
        sum[1] += a_z + b_z;
        if self.power.is_some() {
            let (a, b) = (a.flow(), b.flow());
            sum[2] +=
                a_r.mul_add(b.velocity_r, a_z * b.velocity_z) + b_r.mul_add(a.velocity_r, b_z * a.velocity_z);
        }
    }

    #[inline(always)]
    fn finish(&self, a: &R, sum: [Lanes<R::Scalar>; 3], results: &mut [Lanes<R::Scalar>]) {
        let flow = a.flow();
        let inverse_radius = self.geometry.inverse_radius(a);
        let hoop = Lanes::splat(2.0) * flow.velocity_r * inverse_radius * inverse_radius;
        // The harmonic-mean weights hold this part of the divergence already.
        let [open_r, open_z] = traction(a, inverse_radius - self.geometry.hoop_force(a), Lanes::ZERO);
        let (mean, viscosity) = (Lanes::HALF, Lanes::splat(self.viscosity));
        results[0] = viscosity * (mean.mul_add(sum[0], open_r) - hoop);
        results[1] = viscosity * mean.mul_add(sum[1], open_z);
        results[2] = viscosity * mean.mul_add(sum[2], open_r * flow.velocity_r + open_z * flow.velocity_z);
    }

    fn operations(&self) -> u64 {
        22 + if self.power.is_some() { 8 } else { 0 }
    }

    /// A second derivative.
    fn powers(&self, powers: &mut Powers) {
        powers.extend([-2; 3]);
    }

    fn outputs(&self, columns: &mut Columns) {
        columns.extend(self.force.map(Some));
        columns.push(self.power);
    }
}
