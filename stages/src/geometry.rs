//! Axisymmetry: the weights and hoop terms of the schemes. Besides, viscosity and a ring's contact with its own image have
//! terms of theirs (`terms/viscosity.rs`, `image_contact.rs`).

use crate::record::FlowState;
use meniscus_engine::lanes::{Lanes, Scalar};

/// What a scheme computes once per particle: 1/R_a, and whether it is far from the axis.
#[derive(Clone, Copy, Debug)]
pub struct AxisState<T: Scalar = f64> {
    /// 1/R_a, 1/m.
    pub inverse_radius: Lanes<T>,
    /// One where the harmonic-mean weights hold, zero where Parshikov's do.
    pub far: Lanes<T>,
}

/// How far particles see each other (method.md, section 1).
#[derive(Clone, Copy, Debug)]
pub struct Support {
    /// Smoothing length over the sum of two particles' sizes.
    pub theta: f64,
    /// Largest particle size for which the support grows, in the rows' unit of length.
    pub largest_size: f64,
}

impl Support {
    /// H_ab = 2 theta (D_a + D_b).
    #[inline(always)]
    pub fn of_pair<T: Scalar>(self, size_a: Lanes<T>, size_b: Lanes<T>) -> Lanes<T> {
        let largest = Lanes::splat(self.largest_size);
        Lanes::splat(2.0 * self.theta) * (size_a.min(largest) + size_b.min(largest))
    }
}

/// How a pair is weighted and which hoop terms a particle has.
pub trait Geometry: Copy + Send + Sync {
    /// Floating-point operations of [`Geometry::factor`], counted as a pair term's.
    const OPERATIONS: u64;

    /// What is computed once per particle.
    fn prepare<R: FlowState>(&self, a: &R) -> AxisState<R::Scalar>;

    /// w_ab/V_b of method.md, sections 3 and 4.
    fn factor<R: FlowState>(&self, own: &AxisState<R::Scalar>, a: &R, b: &R) -> Lanes<R::Scalar>;

    /// The factor of P_a in the radial force, 1/R_a or zero, in 1/m.
    fn hoop_force<R: FlowState>(&self, a: &R) -> Lanes<R::Scalar>;

    /// 1/R_a, the factor of U_r in the strain rate, in 1/m.
    fn inverse_radius<R: FlowState>(&self, a: &R) -> Lanes<R::Scalar> {
        self.prepare(a).inverse_radius
    }
}

/// The conservative harmonic-mean scheme for all particles, without images
/// (equations (16) to (18); method.md, section 10, "The axis, later").
#[derive(Clone, Copy, Debug)]
pub struct HarmonicMean {
    /// Distance of the scene's origin from the axis, m.
    pub origin: f64,
}

/// The paper's scheme: harmonic mean for R > K h, Parshikov's with images nearer to the axis
/// (method.md, sections 3 and 4).
#[derive(Clone, Copy, Debug)]
pub struct NearAxisParshikov {
    /// Distance of the scene's origin from the axis, m.
    pub origin: f64,
    /// K.
    pub axis_factor: f64,
    /// That of pairs.
    pub support: Support,
}

/// Parshikov's scheme for all particles (equations (8) to (10)).
#[derive(Clone, Copy, Debug)]
pub struct Parshikov {
    /// Distance of the scene's origin from the axis, m.
    pub origin: f64,
}

#[inline(always)]
fn axis_state<R: FlowState>(origin: f64, a: &R, far: Lanes<R::Scalar>) -> AxisState<R::Scalar> {
    AxisState { inverse_radius: Lanes::ONE / a.radius(origin), far }
}

/// w_ab/V_b = 2 R_b (R_a + R_b)/(2 R_a R_b) = 1 + R_b/R_a, nothing for an image.
#[inline(always)]
fn harmonic_mean<T: Scalar>(own: &AxisState<T>, radius_b: Lanes<T>) -> Lanes<T> {
    let factor = radius_b.mul_add(own.inverse_radius, Lanes::ONE);
    radius_b.select_greater(Lanes::ZERO, factor, Lanes::ZERO)
}

impl Geometry for HarmonicMean {
    const OPERATIONS: u64 = 3;

    #[inline(always)]
    fn prepare<R: FlowState>(&self, a: &R) -> AxisState<R::Scalar> {
        axis_state(self.origin, a, Lanes::ONE)
    }
    #[inline(always)]
    fn factor<R: FlowState>(&self, own: &AxisState<R::Scalar>, a: &R, b: &R) -> Lanes<R::Scalar> {
        harmonic_mean(own, b.radius_near(a, self.origin))
    }
    #[inline(always)]
    fn hoop_force<R: FlowState>(&self, a: &R) -> Lanes<R::Scalar> {
        self.inverse_radius(a)
    }
}

impl Geometry for NearAxisParshikov {
    const OPERATIONS: u64 = 3;

    /// Far is R_a > K h, h that of a pair of equals.
    #[inline(always)]
    fn prepare<R: FlowState>(&self, a: &R) -> AxisState<R::Scalar> {
        let radius = a.radius(self.origin);
        let size = a.flow().size;
        let near = Lanes::splat(0.5 * self.axis_factor) * self.support.of_pair(size, size);
        axis_state(self.origin, a, radius.select_greater(near, Lanes::ONE, Lanes::ZERO))
    }
    #[inline(always)]
    fn factor<R: FlowState>(&self, own: &AxisState<R::Scalar>, a: &R, b: &R) -> Lanes<R::Scalar> {
        let factor = harmonic_mean(own, b.radius_near(a, self.origin));
        own.far.select_greater(Lanes::ZERO, factor, Lanes::splat(2.0))
    }
    #[inline(always)]
    fn hoop_force<R: FlowState>(&self, a: &R) -> Lanes<R::Scalar> {
        let own = self.prepare(a);
        own.far * own.inverse_radius
    }
}

impl Geometry for Parshikov {
    const OPERATIONS: u64 = 0;

    #[inline(always)]
    fn prepare<R: FlowState>(&self, a: &R) -> AxisState<R::Scalar> {
        axis_state(self.origin, a, Lanes::ZERO)
    }
    #[inline(always)]
    fn factor<R: FlowState>(&self, _: &AxisState<R::Scalar>, _: &R, _: &R) -> Lanes<R::Scalar> {
        Lanes::splat(2.0)
    }
    #[inline(always)]
    fn hoop_force<R: FlowState>(&self, _: &R) -> Lanes<R::Scalar> {
        Lanes::ZERO
    }
}
