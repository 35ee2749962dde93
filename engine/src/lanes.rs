//! Eight particles side by side: the SIMD arithmetic of stages and pair passes. In these, where registers of 512 bits are not
//! to be had, four; with single precision twice as many.
//!
//! Everything whose rounding depends on the instruction set lives here: [`Lanes::mul_add`] is one
//! rounding where the build has fused multiply-add and two where it has not. Results are therefore
//! identical for any number of threads and between builds for AVX2 and AVX-512, which both have it, but not
//! between those and a build without.

mod rows;
mod scalar;

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};
use wide::f64x8;

pub use rows::{
    COORDINATE, Packed, Row, RowPart, RowTable, SINGLES, SLOTS, SingleRow, Slots, THIRDS, WHOLE,
    with_second_third_turned,
};
pub use scalar::{Double, Four, PLACE_STEP, Scalar, Vector, place};

/// Number of particles that one [`Lanes`] of double precision holds, and of those whose lists lie side by side.
pub const WIDTH: usize = 8;

/// The instruction set of the lanes in this build; that of the architecture's first processors where it has
/// a wider one that was not asked for.
pub const INSTRUCTION_SET: &str = if cfg!(target_feature = "avx512f") {
    "AVX-512"
} else if cfg!(all(target_feature = "avx2", target_feature = "fma")) {
    "AVX2"
} else {
    std::env::consts::ARCH
};

/// Eight numbers, or as many as T has side by side, one a particle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(transparent)]
pub struct Lanes<T: Scalar = f64>(T::Vector);

/// Places on an axis, one a particle: what slots hold of them is known here alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Places<T: Scalar = f64>(Lanes<T>);

impl<T: Scalar> Places<T> {
    /// The places in a slot.
    #[inline(always)]
    pub fn of_slot(slot: Lanes<T>) -> Self {
        Places(slot)
    }

    /// How far the others lie ahead.
    #[inline(always)]
    pub fn to(self, others: Self) -> Lanes<T> {
        Lanes(T::displacement(self.0.0, others.0.0))
    }

    /// The coordinates of these places, from those of near ones.
    #[inline(always)]
    pub fn coordinates(self, near: Self, near_coordinates: Lanes<T>) -> Lanes<T> {
        Lanes(T::coordinate(self.0.0, near.0.0, near_coordinates.0))
    }
}

impl<T: Scalar> Lanes<T> {
    /// Zero in every lane.
    pub const ZERO: Self = Lanes(T::Vector::ZERO);
    /// One in every lane.
    pub const ONE: Self = Lanes(T::Vector::ONE);
    /// One half in every lane.
    pub const HALF: Self = Lanes(T::Vector::HALF);

    /// The same value in every lane.
    #[inline(always)]
    pub fn splat(value: f64) -> Self {
        Lanes(T::Vector::splat(T::nearest(value)))
    }

    /// self * factor + addend.
    #[inline(always)]
    pub fn mul_add(self, factor: Self, addend: Self) -> Self {
        Lanes(self.0.mul_add(factor.0, addend.0))
    }

    /// addend - self * factor.
    #[inline(always)]
    pub fn neg_mul_add(self, factor: Self, addend: Self) -> Self {
        Lanes(self.0.neg_mul_add(factor.0, addend.0))
    }

    /// Square root.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        Lanes(self.0.sqrt())
    }

    /// Absolute value.
    #[inline(always)]
    pub fn abs(self) -> Self {
        Lanes(self.0.abs())
    }

    /// The larger of two values; which one is taken of a value and a NaN is not defined.
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        Lanes(self.0.max(other.0))
    }

    /// The smaller of two values; which one is taken of a value and a NaN is not defined.
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        Lanes(self.0.min(other.0))
    }

    /// `yes` where `self > threshold`, else `no`.
    #[inline(always)]
    pub fn select_greater(self, threshold: Self, yes: Self, no: Self) -> Self {
        Lanes(self.0.select_greater(threshold.0, yes.0, no.0))
    }
}

impl Lanes<f32> {
    /// The values as an array.
    #[inline(always)]
    pub fn to_array(self) -> [f32; SINGLES] {
        self.0.to_array()
    }
}

impl Lanes<Four> {
    /// The four values as an array.
    #[inline(always)]
    pub fn to_array(self) -> [f64; WIDTH / 2] {
        self.0.to_array()
    }
}

impl Lanes {
    /// The eight values as an array.
    #[inline(always)]
    pub fn to_array(self) -> [f64; WIDTH] {
        self.0.to_array()
    }

    /// Reads eight values from the start of a slice.
    ///
    /// # Panics
    /// If the slice holds fewer than eight values.
    #[inline(always)]
    pub fn load(values: &[f64]) -> Self {
        Lanes(f64x8::new(values[..WIDTH].try_into().expect("eight values")))
    }

    /// The exponential function.
    #[inline(always)]
    pub fn exp(self) -> Self {
        Lanes(self.0.exp())
    }

    /// Sine and cosine.
    #[inline(always)]
    pub fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = self.0.sin_cos();
        (Lanes(sine), Lanes(cosine))
    }

    /// Writes as many values as `values` takes, eight at most.
    #[inline(always)]
    pub fn store(self, values: &mut [f64]) {
        let all = self.to_array();
        match values.first_chunk_mut::<WIDTH>() {
            Some(eight) => *eight = all,
            None => values.copy_from_slice(&all[..values.len()]),
        }
    }

    /// Reads up to eight values; lanes beyond the slice's end hold `fill`.
    #[inline(always)]
    pub fn load_or(values: &[f64], fill: f64) -> Self {
        match values.first_chunk::<WIDTH>() {
            Some(eight) => Lanes(f64x8::new(*eight)),
            None => {
                let mut all = [fill; WIDTH];
                all[..values.len()].copy_from_slice(values);
                Lanes(f64x8::new(all))
            }
        }
    }

    /// One bit for every lane that is below the other's, lane 0 the lowest.
    #[inline(always)]
    pub fn less_bits(self, other: Lanes) -> u32 {
        self.0.simd_lt(other.0).to_bitmask()
    }

    /// Whether every lane is above zero; false for a NaN.
    #[inline(always)]
    pub fn all_positive(self) -> bool {
        self.0.simd_gt(f64x8::ZERO).all()
    }

    /// The first `count` lanes, zero in the others.
    #[inline(always)]
    pub fn keep_first(self, count: usize) -> Self {
        const LANE: f64x8 = f64x8::new([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
        Lanes(LANE.simd_lt(f64x8::splat(count as f64)).select(self.0, f64x8::ZERO))
    }

    /// Sum over the lanes in a fixed order: ((0+1)+(2+3)) + ((4+5)+(6+7)).
    #[inline(always)]
    pub fn sum(self) -> f64 {
        let v = self.to_array();
        ((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[5]) + (v[6] + v[7]))
    }
}

/// The chosen of eight numbers first, in their order; bit k of `chosen` stands for number k. What follows
/// them is not defined.
#[cfg(target_feature = "avx512f")]
#[inline(always)]
pub fn pack(numbers: &[u32; WIDTH], chosen: u32) -> [u32; WIDTH] {
    use std::arch::x86_64::*;
    // SAFETY: the load reads the 32 bytes that the array holds; avx512f is enabled at build time.
    unsafe {
        let all = _mm512_castsi256_si512(_mm256_loadu_si256(numbers.as_ptr().cast()));
        let packed = _mm512_maskz_compress_epi32((chosen & 0xff) as __mmask16, all);
        std::mem::transmute::<__m256i, [u32; WIDTH]>(_mm512_castsi512_si256(packed))
    }
}

/// The chosen of eight numbers first, in their order; bit k of `chosen` stands for number k. What follows
/// them is not defined.
#[cfg(not(target_feature = "avx512f"))]
#[inline(always)]
pub fn pack(numbers: &[u32; WIDTH], chosen: u32) -> [u32; WIDTH] {
    let mut packed = [0; WIDTH];
    let mut length = 0;
    for (k, &number) in numbers.iter().enumerate() {
        packed[length] = number;
        length += ((chosen >> k) & 1) as usize;
    }
    packed
}

macro_rules! operator {
    ($trait:ident, $method:ident) => {
        impl<T: Scalar> $trait for Lanes<T> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Lanes(self.0.$method(other.0))
            }
        }
    };
}
operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl<T: Scalar> Neg for Lanes<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Lanes(-self.0)
    }
}

impl<T: Scalar> AddAssign for Lanes<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Scalar> SubAssign for Lanes<T> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packing_keeps_the_order() {
        let numbers = [10, 11, 12, 13, 14, 15, 16, 17];
        assert_eq!(pack(&numbers, 0b1010_0110)[..4], [11, 12, 15, 17]);
        assert_eq!(pack(&numbers, 0xff), numbers);
    }

    #[test]
    fn selection_and_sum() {
        let a = Lanes::load(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
        let picked = a.select_greater(Lanes::splat(4.5), Lanes::ONE, Lanes::ZERO);
        assert_eq!(picked.to_array(), [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]);
        assert_eq!(a.sum(), 36.0);
    }
}
