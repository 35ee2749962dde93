//! Eight particles side by side: the SIMD arithmetic of the pair passes.
//!
//! Everything whose rounding depends on the instruction set lives here: [`Lanes::mul_add`] is one
//! rounding where the build has fused multiply-add and two where it has not. Results are therefore
//! identical for any number of threads, but not between builds for different instruction sets.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};
use wide::f64x8;

/// Number of particles that one [`Lanes`] holds.
pub const WIDTH: usize = 8;

/// Eight `f64` values, one a particle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(transparent)]
pub struct Lanes(f64x8);

/// Eight slots of one particle, one cache line: what a pair pass loads of a neighbour.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Row(pub [f64; WIDTH]);

/// Four more slots of one particle, half a cache line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(32))]
pub struct HalfRow(pub [f64; WIDTH / 2]);

impl Default for Row {
    fn default() -> Self {
        Row([0.0; WIDTH])
    }
}

impl Lanes {
    /// Zero in every lane.
    pub const ZERO: Lanes = Lanes(f64x8::ZERO);
    /// One in every lane.
    pub const ONE: Lanes = Lanes(f64x8::ONE);
    /// One half in every lane.
    pub const HALF: Lanes = Lanes(f64x8::HALF);

    /// The same value in every lane.
    #[inline(always)]
    pub fn splat(value: f64) -> Self {
        Lanes(f64x8::splat(value))
    }

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

    /// self * factor + addend.
    #[inline(always)]
    pub fn mul_add(self, factor: Lanes, addend: Lanes) -> Self {
        Lanes(self.0.mul_add(factor.0, addend.0))
    }

    /// addend - self * factor.
    #[inline(always)]
    pub fn neg_mul_add(self, factor: Lanes, addend: Lanes) -> Self {
        Lanes(self.0.mul_neg_add(factor.0, addend.0))
    }

    /// The exponential function.
    #[inline(always)]
    pub fn exp(self) -> Self {
        Lanes(self.0.exp())
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
    pub fn max(self, other: Lanes) -> Self {
        Lanes(self.0.fast_max(other.0))
    }

    /// The smaller of two values; which one is taken of a value and a NaN is not defined.
    #[inline(always)]
    pub fn min(self, other: Lanes) -> Self {
        Lanes(self.0.fast_min(other.0))
    }

    /// `yes` where `self > threshold`, else `no`.
    #[inline(always)]
    pub fn select_greater(self, threshold: Lanes, yes: Lanes, no: Lanes) -> Self {
        Lanes(self.0.simd_gt(threshold.0).select(yes.0, no.0))
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

    /// Loads one row per lane and turns rows into slots: result\[s\] holds slot s of all eight rows.
    #[inline(always)]
    pub fn transpose(rows: [&Row; WIDTH]) -> [Lanes; WIDTH] {
        transpose(rows)
    }

    /// The same for half rows.
    #[inline(always)]
    pub fn transpose_half(rows: [&HalfRow; WIDTH]) -> [Lanes; WIDTH / 2] {
        transpose_half(rows)
    }
}

#[cfg(target_feature = "avx512f")]
#[inline(always)]
fn transpose(rows: [&Row; WIDTH]) -> [Lanes; WIDTH] {
    use std::arch::x86_64::*;
    // SAFETY: every row is 64 bytes, 64-byte aligned (repr(align(64))) and borrowed for the loads;
    // __m512d and f64x8 are both 64-byte vectors of eight f64; avx512f is enabled at build time.
    unsafe {
        let load = |k: usize| _mm512_load_pd(rows[k].0.as_ptr());
        let (r0, r1, r2, r3) = (load(0), load(1), load(2), load(3));
        let (r4, r5, r6, r7) = (load(4), load(5), load(6), load(7));
        let (a0, a1) = (_mm512_unpacklo_pd(r0, r1), _mm512_unpackhi_pd(r0, r1));
        let (a2, a3) = (_mm512_unpacklo_pd(r2, r3), _mm512_unpackhi_pd(r2, r3));
        let (a4, a5) = (_mm512_unpacklo_pd(r4, r5), _mm512_unpackhi_pd(r4, r5));
        let (a6, a7) = (_mm512_unpacklo_pd(r6, r7), _mm512_unpackhi_pd(r6, r7));
        const EVEN: i32 = 0x88;
        const ODD: i32 = 0xdd;
        let b0 = _mm512_shuffle_f64x2::<EVEN>(a0, a2);
        let b1 = _mm512_shuffle_f64x2::<EVEN>(a1, a3);
        let b2 = _mm512_shuffle_f64x2::<ODD>(a0, a2);
        let b3 = _mm512_shuffle_f64x2::<ODD>(a1, a3);
        let b4 = _mm512_shuffle_f64x2::<EVEN>(a4, a6);
        let b5 = _mm512_shuffle_f64x2::<EVEN>(a5, a7);
        let b6 = _mm512_shuffle_f64x2::<ODD>(a4, a6);
        let b7 = _mm512_shuffle_f64x2::<ODD>(a5, a7);
        let columns: [__m512d; WIDTH] = [
            _mm512_shuffle_f64x2::<EVEN>(b0, b4),
            _mm512_shuffle_f64x2::<EVEN>(b1, b5),
            _mm512_shuffle_f64x2::<EVEN>(b2, b6),
            _mm512_shuffle_f64x2::<EVEN>(b3, b7),
            _mm512_shuffle_f64x2::<ODD>(b0, b4),
            _mm512_shuffle_f64x2::<ODD>(b1, b5),
            _mm512_shuffle_f64x2::<ODD>(b2, b6),
            _mm512_shuffle_f64x2::<ODD>(b3, b7),
        ];
        std::mem::transmute::<[__m512d; WIDTH], [Lanes; WIDTH]>(columns)
    }
}

#[cfg(target_feature = "avx512f")]
#[inline(always)]
fn transpose_half(rows: [&HalfRow; WIDTH]) -> [Lanes; WIDTH / 2] {
    use std::arch::x86_64::*;
    // SAFETY: every half row is 32 bytes, 32-byte aligned and borrowed for the loads; __m512d and
    // f64x8 are both 64-byte vectors of eight f64; avx512f is enabled at build time.
    unsafe {
        let load = |k: usize| _mm256_load_pd(rows[k].0.as_ptr());
        let both = |i: usize, j: usize| _mm512_insertf64x4::<1>(_mm512_castpd256_pd512(load(i)), load(j));
        let (p0, p1, p2, p3) = (both(0, 2), both(1, 3), both(4, 6), both(5, 7));
        let (a0, a1) = (_mm512_unpacklo_pd(p0, p1), _mm512_unpackhi_pd(p0, p1));
        let (a2, a3) = (_mm512_unpacklo_pd(p2, p3), _mm512_unpackhi_pd(p2, p3));
        const EVEN: i32 = 0x88;
        const ODD: i32 = 0xdd;
        let columns: [__m512d; WIDTH / 2] = [
            _mm512_shuffle_f64x2::<EVEN>(a0, a2),
            _mm512_shuffle_f64x2::<EVEN>(a1, a3),
            _mm512_shuffle_f64x2::<ODD>(a0, a2),
            _mm512_shuffle_f64x2::<ODD>(a1, a3),
        ];
        std::mem::transmute::<[__m512d; WIDTH / 2], [Lanes; WIDTH / 2]>(columns)
    }
}

#[cfg(not(target_feature = "avx512f"))]
#[inline(always)]
fn transpose_half(rows: [&HalfRow; WIDTH]) -> [Lanes; WIDTH / 2] {
    std::array::from_fn(|slot| Lanes(f64x8::new(std::array::from_fn(|lane| rows[lane].0[slot]))))
}

#[cfg(not(target_feature = "avx512f"))]
#[inline(always)]
fn transpose(rows: [&Row; WIDTH]) -> [Lanes; WIDTH] {
    std::array::from_fn(|slot| Lanes(f64x8::new(std::array::from_fn(|lane| rows[lane].0[slot]))))
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
        impl $trait for Lanes {
            type Output = Lanes;
            #[inline(always)]
            fn $method(self, other: Lanes) -> Lanes {
                Lanes(self.0.$method(other.0))
            }
        }
    };
}
operator!(Add, add);
operator!(Sub, sub);
operator!(Mul, mul);
operator!(Div, div);

impl Neg for Lanes {
    type Output = Lanes;
    #[inline(always)]
    fn neg(self) -> Lanes {
        Lanes(-self.0)
    }
}

impl AddAssign for Lanes {
    #[inline(always)]
    fn add_assign(&mut self, other: Lanes) {
        *self = *self + other;
    }
}

impl SubAssign for Lanes {
    #[inline(always)]
    fn sub_assign(&mut self, other: Lanes) {
        *self = *self - other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn transpose_turns_rows_into_slots() {
        let rows: [Row; WIDTH] =
            std::array::from_fn(|row| Row(std::array::from_fn(|slot| (10 * row + slot) as f64)));
        let slots = Lanes::transpose(std::array::from_fn(|k| &rows[k]));
        for (slot, lanes) in slots.iter().enumerate() {
            let expected: [f64; WIDTH] = std::array::from_fn(|row| (10 * row + slot) as f64);
            assert_eq!(lanes.to_array(), expected);
        }
    }

    #[test]
    fn transpose_of_half_rows() {
        let rows: [HalfRow; WIDTH] =
            std::array::from_fn(|row| HalfRow(std::array::from_fn(|slot| (10 * row + slot) as f64)));
        let slots = Lanes::transpose_half(std::array::from_fn(|k| &rows[k]));
        for (slot, lanes) in slots.iter().enumerate() {
            let expected: [f64; WIDTH] = std::array::from_fn(|row| (10 * row + slot) as f64);
            assert_eq!(lanes.to_array(), expected);
        }
    }

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
