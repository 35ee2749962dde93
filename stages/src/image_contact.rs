//! The contact of a ring with its own image beyond the axis.

use crate::contact::{FirstOrder, KERNEL, Limited, Shock};
use crate::geometry::Support;
use crate::record::{DeformationState, FlowState, ShockRecord};
use meniscus_engine::lanes::{Lanes, Scalar};

/// What the velocity jump to the image gives. The harmonic-mean weight of a ring's own image is zero, so no pair damps
/// what a ring does by itself.
///
/// The force is radial and works on nothing but the ring itself, whose total energy it leaves: what motion loses becomes
/// heat. Axial momentum is not touched.
pub trait ImageContact<R: FlowState>: Copy + Send + Sync {
    /// The radial density of the dissipative force, N/m3, with what the contact adds to `force`. Coordinates begin at the
    /// axis.
    fn add_image_force(&self, a: &R, support: Support, force: Lanes<R::Scalar>) -> Lanes<R::Scalar>;
}

/// Distance to the image, support radius, and 1 - |d|/H or zero.
#[inline(always)]
fn image<R: FlowState>(a: &R, support: Support) -> [Lanes<R::Scalar>; 3] {
    let (distance, size) = (a.coordinate() + a.coordinate(), a.flow().size);
    let support = support.of_pair(size, size);
    [distance, support, (Lanes::ONE - distance / support).max(Lanes::ZERO)]
}

/// Without a reconstruction and without shocks, which is the paper's method, nothing.
impl<R: FlowState> ImageContact<R> for FirstOrder {
    #[inline(always)]
    fn add_image_force(&self, _: &R, _: Support, force: Lanes<R::Scalar>) -> Lanes<R::Scalar> {
        force
    }
}

/// rho dU_r/dt += 2 V g(2 R) q with q = rho (C + s |U_r|) |U_r| where U_r < 0: the dissipative part of P* at the contact
/// with the image, weighted like Parshikov's pairs. Nothing else would stop a cold gas before it has crossed the axis.
impl<T: Scalar> ImageContact<ShockRecord<T>> for Shock {
    #[inline(always)]
    fn add_image_force(&self, a: &ShockRecord<T>, support: Support, force: Lanes<T>) -> Lanes<T> {
        let [distance, support, inside] = image(a, support);
        let closing = (-a.flow().velocity_r).max(Lanes::ZERO);
        let excess = (a.density * closing).mul_add(Lanes::splat(self.slope), a.flow().impedance) * closing;
        let inverse = inside / (support * support);
        let kernel = Lanes::splat(KERNEL) * inside * inverse * inverse;
        let area = a.flow().size * a.flow().size;
        ((area + area) * kernel * distance).mul_add(excess, force)
    }
}

/// rho dU_r/dt += -rho C J/2 (1 - R/h)^2/R for R < h.
///
/// A ring's own hoop terms, P/(rho R) and U_r/R, swing with C/R. So the hoop pressure becomes that of the contact with the
/// image, as P* is for pairs. In the acoustic Riemann problem (equation (19)) of two equal states that part with the jump J it
/// is P - rho C J/2. The image has -U_r, 2 R away: J = 2 U_r less van Leer's mean of x = 2 G - J and J on either side
/// ([`Limited`]), where G = 2 R dU_r/dr. That leaves J/2 = U_r (U_r/R - dU_r/dr)/(dU_r/dr), or U_r where dU_r/dr is of the
/// other sign or less than half of U_r/R: a flow that is linear in R feels nothing. The last factor lets go of an image that
/// leaves the support: both see each other up to 2 h.
impl<R: DeformationState> ImageContact<R> for Limited {
    #[inline(always)]
    fn add_image_force(&self, a: &R, support: Support, force: Lanes<R::Scalar>) -> Lanes<R::Scalar> {
        let [_, _, inside] = image(a, support);
        let (rate, slope) = (a.flow().velocity_r / a.coordinate(), a.deformation().rr);
        let both = (slope + slope - rate) * rate;
        let safe = both.select_greater(Lanes::ZERO, slope, Lanes::ONE);
        let rough = both.select_greater(Lanes::ZERO, rate * (rate - slope) / safe, rate);
        (a.flow().impedance * rough).neg_mul_add(inside * inside, force)
    }
}
