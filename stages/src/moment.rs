//! The moment matrix of one particle, and of eight: their eigenvalues and anisotropy.

use meniscus_engine::lanes::Lanes;

/// A symmetric 2 x 2 matrix, rows and columns in the order r, z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// L_rr
    pub rr: f64,
    /// L_rz
    pub rz: f64,
    /// L_zz
    pub zz: f64,
}

impl Moment {
    /// L from the components rr, rz and zz of I - L.
    #[inline]
    pub fn of_deficiency([rr, rz, zz]: [f64; 3]) -> Moment {
        Moment { rr: 1.0 - rr, rz: -rz, zz: 1.0 - zz }
    }

    /// Whether both eigenvalues are at least `least`, without a root: trace and determinant of
    /// L - least are those of a matrix without negative eigenvalues.
    #[inline]
    pub fn eigenvalues_at_least(&self, least: f64) -> bool {
        let (rr, zz) = (self.rr - least, self.zz - least);
        (rr + zz >= 0.0) & (rr * zz - self.rz * self.rz >= 0.0)
    }

    /// Sum of the diagonal.
    #[inline]
    pub fn trace(&self) -> f64 {
        self.rr + self.zz
    }

    /// Half the difference of the eigenvalues over their mean: zero for a neighbourhood without a direction.
    #[inline]
    pub fn anisotropy(&self) -> f64 {
        let (difference, shear) = (self.rr - self.zz, 2.0 * self.rz);
        (difference * difference + shear * shear).sqrt() / self.trace()
    }

    /// Whether the anisotropy exceeds a bound, without root or division.
    #[inline]
    pub fn is_anisotropic(&self, bound: f64) -> bool {
        let (difference, shear, most) = (self.rr - self.zz, 2.0 * self.rz, bound * self.trace());
        difference * difference + shear * shear > most * most
    }

    /// L v.
    #[inline]
    pub fn apply(&self, [r, z]: [f64; 2]) -> [f64; 2] {
        [self.rr * r + self.rz * z, self.rz * r + self.zz * z]
    }
}

/// Above zero where both eigenvalues of one of eight matrices, in the order rr, rz, zz, are at least `least`, as
/// [`Moment::eigenvalues_at_least`] has it up to rounding; else not, nor where one is no number.
#[inline(always)]
pub fn eigenvalue_margin([rr, rz, zz]: [Lanes; 3], least: f64) -> Lanes {
    let least = Lanes::splat(least);
    let (rr, zz) = (rr - least, zz - least);
    // Zero is enough: what little is added lifts it, and no other value, above zero.
    (rr + zz).min(rz.neg_mul_add(rz, rr * zz)) + Lanes::splat(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With quarters nothing is rounded: trace and determinant of many of these are zero exactly.
    #[test]
    fn eight_matrices_are_judged_as_one() {
        const LEAST: f64 = 0.75;
        let quarters: [f64; 8] = std::array::from_fn(|k| 0.25 * k as f64);
        let mut enough = 0;
        for rr in quarters {
            for rz in quarters {
                let [rr_lanes, rz_lanes] = [rr, -rz].map(Lanes::splat);
                let margin = eigenvalue_margin([rr_lanes, rz_lanes, Lanes::load(&quarters)], LEAST);
                for (margin, zz) in margin.to_array().into_iter().zip(quarters) {
                    let is_enough = Moment { rr, rz: -rz, zz }.eigenvalues_at_least(LEAST);
                    assert_eq!(margin > 0.0, is_enough, "{rr} {rz} {zz}");
                    enough += usize::from(is_enough);
                }
            }
        }
        assert!((1..256).contains(&enough), "{enough} of 512");
        let [one, none] = [1.0, f64::NAN].map(Lanes::splat);
        for moment in [[none, one, one], [one, none, one], [one, one, none], [none; 3]] {
            assert!(!eigenvalue_margin(moment, LEAST).to_array().into_iter().any(|margin| margin > 0.0));
        }
    }

    #[test]
    fn eigenvalues_and_anisotropy() {
        // Eigenvalues 1 and 3.
        let moment = Moment { rr: 2.0, rz: 1.0, zz: 2.0 };
        assert!(moment.eigenvalues_at_least(0.999) && !moment.eigenvalues_at_least(1.001));
        assert_eq!(moment.anisotropy(), 0.5);
        assert!(moment.is_anisotropic(0.499) && !moment.is_anisotropic(0.501));
        assert_eq!(Moment::of_deficiency([-1.0, -1.0, -1.0]), moment);
    }
}
