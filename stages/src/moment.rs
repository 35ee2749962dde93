//! The moment matrix of one particle: its eigenvalues and anisotropy.

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
    pub fn of_lack([rr, rz, zz]: [f64; 3]) -> Moment {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvalues_and_anisotropy() {
        // Eigenvalues 1 and 3.
        let moment = Moment { rr: 2.0, rz: 1.0, zz: 2.0 };
        assert!(moment.eigenvalues_at_least(0.999) && !moment.eigenvalues_at_least(1.001));
        assert_eq!(moment.anisotropy(), 0.5);
        assert!(moment.is_anisotropic(0.499) && !moment.is_anisotropic(0.501));
        assert_eq!(Moment::of_lack([-1.0, -1.0, -1.0]), moment);
    }
}
