//! Lanes that hold nothing and count what is done with them.

use std::cell::Cell;
use std::marker::PhantomData;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

pub use engine::lanes::{Double, Scalar, WHOLE};

thread_local! {
    static OPERATIONS: Cell<u64> = const { Cell::new(0) };
}

fn count<T: Scalar>(operations: u64) -> Lanes<T> {
    OPERATIONS.set(OPERATIONS.get() + operations);
    Lanes(PhantomData)
}

/// The floating-point operations of some work on this thread.
pub fn counted<T>(work: impl FnOnce() -> T) -> (u64, T) {
    let before = OPERATIONS.get();
    let done = work();
    (OPERATIONS.get() - before, done)
}

/// Values that nobody asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lanes<T: Scalar = f64>(PhantomData<T>);

/// The slots of particles that are not there.
#[derive(Clone, Copy, Debug, Default)]
pub struct Slots<T: Scalar = f64> {
    pub whole: [Lanes<T>; WHOLE],
    pub halves: [Lanes<T>; 2],
    pub thirds: [Lanes<T>; 3],
    pub last: Lanes<T>,
    pub coordinate: Lanes<T>,
}

/// Places that nobody asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Places<T: Scalar = f64>(PhantomData<T>);

impl<T: Scalar> Places<T> {
    pub fn of_slot(_: Lanes<T>) -> Self {
        Places(PhantomData)
    }

    pub fn to(self, _: Self) -> Lanes<T> {
        count(1)
    }

    pub fn coordinates(self, _: Self, _: Lanes<T>) -> Lanes<T> {
        Lanes::ZERO
    }
}

impl<T: Scalar> Lanes<T> {
    pub const ZERO: Self = Lanes(PhantomData);
    pub const ONE: Self = Lanes(PhantomData);
    pub const HALF: Self = Lanes(PhantomData);

    pub fn splat(_: f64) -> Self {
        Self::ZERO
    }

    pub fn mul_add(self, _: Self, _: Self) -> Self {
        count(2)
    }

    pub fn neg_mul_add(self, _: Self, _: Self) -> Self {
        count(2)
    }

    pub fn sqrt(self) -> Self {
        count(1)
    }

    pub fn abs(self) -> Self {
        self
    }

    pub fn max(self, _: Self) -> Self {
        self
    }

    pub fn min(self, _: Self) -> Self {
        self
    }

    pub fn select_greater(self, _: Self, _: Self, _: Self) -> Self {
        self
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident) => {
        impl<T: Scalar> $trait for Lanes<T> {
            type Output = Self;
            fn $method(self, _: Self) -> Self {
                count(1)
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
    fn neg(self) -> Self {
        self
    }
}

impl<T: Scalar> AddAssign for Lanes<T> {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Scalar> SubAssign for Lanes<T> {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}
