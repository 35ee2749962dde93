//! Lanes that hold nothing and count what is done with them.

use std::cell::Cell;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

pub use engine::lanes::{HalfRow, Row, WIDTH};

thread_local! {
    static OPERATIONS: Cell<u64> = const { Cell::new(0) };
}

fn count(operations: u64) -> Lanes {
    OPERATIONS.set(OPERATIONS.get() + operations);
    Lanes
}

/// The floating-point operations of some work on this thread.
pub fn counted<T>(work: impl FnOnce() -> T) -> (u64, T) {
    let before = OPERATIONS.get();
    let done = work();
    (OPERATIONS.get() - before, done)
}

/// Eight values that nobody asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lanes;

impl Lanes {
    pub const ZERO: Lanes = Lanes;
    pub const ONE: Lanes = Lanes;
    pub const HALF: Lanes = Lanes;

    pub fn splat(_: f64) -> Self {
        Lanes
    }

    pub fn to_array(self) -> [f64; WIDTH] {
        [0.0; WIDTH]
    }

    pub fn transpose(_: [&Row; WIDTH]) -> [Lanes; WIDTH] {
        [Lanes; WIDTH]
    }

    pub fn mul_add(self, _: Lanes, _: Lanes) -> Self {
        count(2)
    }

    pub fn neg_mul_add(self, _: Lanes, _: Lanes) -> Self {
        count(2)
    }

    pub fn sqrt(self) -> Self {
        count(1)
    }

    pub fn abs(self) -> Self {
        Lanes
    }

    pub fn max(self, _: Lanes) -> Self {
        Lanes
    }

    pub fn min(self, _: Lanes) -> Self {
        Lanes
    }

    pub fn select_greater(self, _: Lanes, _: Lanes, _: Lanes) -> Self {
        Lanes
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident) => {
        impl $trait for Lanes {
            type Output = Lanes;
            fn $method(self, _: Lanes) -> Lanes {
                count(1)
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
    fn neg(self) -> Lanes {
        Lanes
    }
}

impl AddAssign for Lanes {
    fn add_assign(&mut self, other: Lanes) {
        *self = *self + other;
    }
}

impl SubAssign for Lanes {
    fn sub_assign(&mut self, other: Lanes) {
        *self = *self - other;
    }
}
