//! What lanes are made of: numbers of double precision, or of single precision where that is enough.

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};
use wide::bytemuck::cast;
use wide::{f64x4, f64x8};

pub use widest::Double;
pub(super) use widest::Singles;
use widest::Steps;

/// Double precision, four side by side.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Four;

/// With registers of 512 bits, of which there are thirty-two.
#[cfg(target_feature = "avx512f")]
mod widest {
    pub use wide::{f32x16 as Singles, i32x16 as Steps};

    /// Double precision of pair passes: as many side by side as a register holds.
    pub type Double = f64;

    #[inline(always)]
    pub fn of_steps(steps: Steps) -> Singles {
        Singles::from_i32x16(steps)
    }
}

/// With narrower ones, of which there are sixteen: of eight pairs side by side most of what is computed would go to memory and back.
#[cfg(not(target_feature = "avx512f"))]
mod widest {
    pub use wide::{f32x8 as Singles, i32x8 as Steps};

    /// Double precision of pair passes: as many side by side as a register holds.
    pub type Double = super::Four;

    #[inline(always)]
    pub fn of_steps(steps: Steps) -> Singles {
        Singles::from_i32x8(steps)
    }
}

/// A kind of number of which several stand side by side in [`Lanes`](super::Lanes).
pub trait Scalar: Copy + Debug + Default + PartialEq + Send + Sync + 'static {
    /// Those that stand side by side.
    type Vector: Vector;

    /// The least number of full precision.
    const LEAST: f64;

    /// Less than any product of two numbers that matters; even its power of 3/2 has full precision.
    const TINY: f64;

    /// The nearest such number.
    fn nearest(value: f64) -> <Self::Vector as Vector>::Number;

    /// b - a of two places on an axis, as slots hold them.
    fn displacement(a: Self::Vector, b: Self::Vector) -> Self::Vector;

    /// The coordinates of places from those of near ones.
    fn coordinate(place: Self::Vector, near: Self::Vector, near_coordinate: Self::Vector) -> Self::Vector;
}

/// Places are lengths.
macro_rules! double {
    ($scalar:ident, $vector:ident) => {
        impl Scalar for $scalar {
            type Vector = $vector;
            const LEAST: f64 = f64::MIN_POSITIVE;
            const TINY: f64 = 1e-200;

            #[inline(always)]
            fn nearest(value: f64) -> f64 {
                value
            }

            #[inline(always)]
            fn displacement(a: $vector, b: $vector) -> $vector {
                b - a
            }

            #[inline(always)]
            fn coordinate(place: $vector, _: $vector, _: $vector) -> $vector {
                place
            }
        }
    };
}
double!(f64, f64x8);
double!(Four, f64x4);

/// Places are counted in [`PLACE_STEP`]s, as integers in the bits of a slot that may run over: the difference
/// of two near places is exact however far they lie from the origin.
impl Scalar for f32 {
    type Vector = Singles;
    const LEAST: f64 = f32::MIN_POSITIVE as f64;
    const TINY: f64 = 1e-24;

    #[inline(always)]
    fn nearest(value: f64) -> f32 {
        value as f32
    }

    #[inline(always)]
    fn displacement(a: Singles, b: Singles) -> Singles {
        let steps: Steps = cast::<Singles, Steps>(b) - cast::<Singles, Steps>(a);
        widest::of_steps(steps) * Singles::splat(PLACE_STEP as f32)
    }

    #[inline(always)]
    fn coordinate(place: Singles, near: Singles, near_coordinate: Singles) -> Singles {
        near_coordinate + Self::displacement(near, place)
    }
}

/// The step between places in single precision, in units of length: displacements reach 64 units.
pub const PLACE_STEP: f64 = 1.0 / (1 << 25) as f64;

/// The slot of a place (in units of length) in single precision.
#[inline(always)]
pub fn place(value: f64) -> f32 {
    const TURN: f64 = (1_u64 << 32) as f64;
    // Added to 1.5 * 2^52 a number is rounded to an integer, which then stands in the lowest bits.
    const ROUNDED: f64 = (3_u64 << 51) as f64;
    let steps = value * (1.0 / PLACE_STEP);
    let within_a_turn = steps - TURN * (steps * (1.0 / TURN)).round_ties_even();
    f32::from_bits((within_a_turn + ROUNDED).to_bits() as u32)
}

/// The arithmetic of numbers side by side.
pub trait Vector:
    Copy
    + Debug
    + Default
    + PartialEq
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// One of them.
    type Number;
    /// Zeros.
    const ZERO: Self;
    /// Ones.
    const ONE: Self;
    /// Halves.
    const HALF: Self;
    /// The same number everywhere.
    fn splat(number: Self::Number) -> Self;
    /// self * factor + addend.
    fn mul_add(self, factor: Self, addend: Self) -> Self;
    /// addend - self * factor.
    fn neg_mul_add(self, factor: Self, addend: Self) -> Self;
    /// Square roots.
    fn sqrt(self) -> Self;
    /// Absolute values.
    fn abs(self) -> Self;
    /// The larger ones; either for a NaN.
    fn max(self, other: Self) -> Self;
    /// The smaller ones; either for a NaN.
    fn min(self, other: Self) -> Self;
    /// `yes` where `self > threshold`, else `no`.
    fn select_greater(self, threshold: Self, yes: Self, no: Self) -> Self;
}

macro_rules! vector {
    ($vector:ident, $number:ident) => {
        impl Vector for $vector {
            type Number = $number;
            const ZERO: Self = $vector::ZERO;
            const ONE: Self = $vector::ONE;
            const HALF: Self = $vector::HALF;
            #[inline(always)]
            fn splat(number: $number) -> Self {
                $vector::splat(number)
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, addend: Self) -> Self {
                self.mul_add(factor, addend)
            }
            #[inline(always)]
            fn neg_mul_add(self, factor: Self, addend: Self) -> Self {
                self.mul_neg_add(factor, addend)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                self.sqrt()
            }
            #[inline(always)]
            fn abs(self) -> Self {
                self.abs()
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                self.fast_max(other)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                self.fast_min(other)
            }
            #[inline(always)]
            fn select_greater(self, threshold: Self, yes: Self, no: Self) -> Self {
                self.simd_gt(threshold).select(yes, no)
            }
        }
    };
}
vector!(f64x8, f64);
vector!(f64x4, f64);
vector!(Singles, f32);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::{Lanes, Places};

    fn displacement(a: f64, b: f64) -> f32 {
        let places = |value| Places::of_slot(Lanes::<f32>(Singles::splat(place(value))));
        places(a).to(places(b)).to_array()[0]
    }

    #[test]
    fn displacements_are_as_good_far_from_the_origin() {
        for origin in [0.0, 1.0, -63.0, 64.0, 1e5, -1e7] {
            for step in [0.0, 1e-3, -0.5, 1.0, 3.7, -20.0] {
                let (a, b) = (origin + 0.3, origin + 0.3 + step);
                let error = f64::from(displacement(a, b)) - (b - a);
                assert!(
                    error.abs() <= PLACE_STEP + f64::from(f32::EPSILON) * step.abs(),
                    "{a} {b}: {error:e}"
                );
            }
        }
    }
}
