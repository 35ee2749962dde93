//! Axisymmetry: the weights and hoop terms of the schemes. It lives here and nowhere else.

use crate::record::Flow;
use meniscus_engine::lanes::Lanes;

/// How a pair is weighted and which hoop terms a particle has.
pub trait Geometry: Copy + Send + Sync {
    /// w_ab of method.md, sections 3 and 4, in m2.
    fn weight(&self, a: &Flow<Lanes>, b: &Flow<Lanes>) -> Lanes;

    /// The factor of P_a in the radial force, 1/R_a or zero, in 1/m.
    fn hoop_force(&self, a: &Flow<Lanes>) -> Lanes;

    /// 1/R_a, the factor of U_r in the strain rate, in 1/m.
    fn inverse_radius(&self, a: &Flow<Lanes>) -> Lanes;
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
}

/// Parshikov's scheme for all particles (equations (8) to (10)).
#[derive(Clone, Copy, Debug)]
pub struct Parshikov {
    /// Distance of the scene's origin from the axis, m.
    pub origin: f64,
}

/// w_ab = (m_b/(pi rho_b)) (R_a + R_b)/(2 R_a R_b) = V_b (1 + R_b/R_a), nothing for an image.
#[inline(always)]
fn harmonic_mean(origin: f64, a: &Flow<Lanes>, b: &Flow<Lanes>) -> Lanes {
    let radius_b = b.r + Lanes::splat(origin);
    let weight = b.area * radius_b.mul_add(inverse_radius(origin, a), Lanes::ONE);
    radius_b.select_greater(Lanes::ZERO, weight, Lanes::ZERO)
}

#[inline(always)]
fn inverse_radius(origin: f64, a: &Flow<Lanes>) -> Lanes {
    Lanes::ONE / (a.r + Lanes::splat(origin))
}

impl Geometry for HarmonicMean {
    #[inline(always)]
    fn weight(&self, a: &Flow<Lanes>, b: &Flow<Lanes>) -> Lanes {
        harmonic_mean(self.origin, a, b)
    }
    #[inline(always)]
    fn hoop_force(&self, a: &Flow<Lanes>) -> Lanes {
        inverse_radius(self.origin, a)
    }
    #[inline(always)]
    fn inverse_radius(&self, a: &Flow<Lanes>) -> Lanes {
        inverse_radius(self.origin, a)
    }
}

impl NearAxisParshikov {
    /// `far` where R_a > K h, `near` elsewhere; h = 2 theta D_a is the record's reach.
    #[inline(always)]
    fn choose(&self, a: &Flow<Lanes>, far: Lanes, near: Lanes) -> Lanes {
        let radius = a.r + Lanes::splat(self.origin);
        radius.select_greater(Lanes::splat(self.axis_factor) * a.reach, far, near)
    }
}

impl Geometry for NearAxisParshikov {
    #[inline(always)]
    fn weight(&self, a: &Flow<Lanes>, b: &Flow<Lanes>) -> Lanes {
        self.choose(a, harmonic_mean(self.origin, a, b), b.area + b.area)
    }
    #[inline(always)]
    fn hoop_force(&self, a: &Flow<Lanes>) -> Lanes {
        self.choose(a, inverse_radius(self.origin, a), Lanes::ZERO)
    }
    #[inline(always)]
    fn inverse_radius(&self, a: &Flow<Lanes>) -> Lanes {
        inverse_radius(self.origin, a)
    }
}

impl Geometry for Parshikov {
    #[inline(always)]
    fn weight(&self, _: &Flow<Lanes>, b: &Flow<Lanes>) -> Lanes {
        b.area + b.area
    }
    #[inline(always)]
    fn hoop_force(&self, _: &Flow<Lanes>) -> Lanes {
        Lanes::ZERO
    }
    #[inline(always)]
    fn inverse_radius(&self, a: &Flow<Lanes>) -> Lanes {
        inverse_radius(self.origin, a)
    }
}
