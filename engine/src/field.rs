//! The declaration of a field: the one place from which storage, sorting, checkpoints and export follow.

use std::fmt;

/// Whether a field is part of the state or computed anew in every step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Kept from step to step, moved by sorting, written to checkpoints.
    State,
    /// Written in every step before it is read; where it is zero away from the surface that zero may stay from the step before.
    Derived,
    /// Computed and read by stages that follow each other, and only held for the chunk of particles that they have
    /// at hand: no column in memory.
    Transient,
}

/// A part of a column.
#[derive(Debug)]
pub enum Part<'a> {
    /// Real numbers in SI units.
    F64(&'a mut [f64]),
    /// Indices, flags and identities.
    U32(&'a mut [u32]),
}

impl<'a> Part<'a> {
    /// Itself in pieces of `most` values; the last one may have fewer.
    pub(crate) fn pieces(self, most: usize) -> impl Iterator<Item = Part<'a>> {
        let (reals, indices) = match self {
            Part::F64(values) => (values, Default::default()),
            Part::U32(values) => (Default::default(), values),
        };
        reals.chunks_mut(most).map(Part::F64).chain(indices.chunks_mut(most).map(Part::U32))
    }
}

/// A type that a column can hold.
pub trait Element: Copy + Default + Send + Sync + fmt::Debug + 'static {
    /// A column's values of this type.
    fn into_values(values: Vec<Self>) -> Values
    where
        Self: Sized;
    /// The vector inside, if the column holds this type.
    fn of(values: &Values) -> Option<&Vec<Self>>
    where
        Self: Sized;
    /// The vector inside, if the column holds this type.
    fn of_mut(values: &mut Values) -> Option<&mut Vec<Self>>
    where
        Self: Sized;
    /// The values of a part, if it holds this type.
    fn of_part<'a>(part: &'a Part<'_>) -> Option<&'a [Self]>
    where
        Self: Sized;
    /// The values of a part, if it holds this type.
    fn of_part_mut<'a>(part: &'a mut Part<'_>) -> Option<&'a mut [Self]>
    where
        Self: Sized;
    /// What an unwritten Derived value is set to, so that reading it shows.
    fn poison() -> Self;
    /// Whether it is what memory holds that was never written.
    fn is_untouched(&self) -> bool;
}

/// Values that are written together or not at all.
const BLOCK: usize = 64;

/// Sets values to zero, and writes only where they are not: columns of what is zero but at the surface take
/// hardly any memory as long as the rest of them is never written. (To write them one by one under a mask would
/// take long: a processor stumbles at masked stores into memory that was never written.)
pub fn clear<T: Element>(values: &mut [T]) {
    values.chunks_mut(BLOCK).filter(|block| is_touched(block)).for_each(|block| block.fill(T::default()));
}

/// Sets values to those `of` as many others, but for blocks that are zero on both sides.
pub(crate) fn copy<T: Element, F: Element>(to: &mut [T], from: &[F], of: impl Fn(F) -> T) {
    let blocks = to.chunks_mut(BLOCK).zip(from.chunks(BLOCK));
    blocks.filter(|(to, from)| is_touched(to) || is_touched(from)).for_each(|(to, from)| {
        to.iter_mut().zip(from).for_each(|(to, &from)| *to = of(from));
    });
}

fn is_touched<T: Element>(block: &[T]) -> bool {
    block.iter().fold(false, |touched, value| touched | !value.is_untouched())
}

/// The values of one column.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Real numbers in SI units.
    F64(Vec<f64>),
    /// Indices, flags and identities.
    U32(Vec<u32>),
}

impl Values {
    /// All of them.
    pub fn whole(&mut self) -> Part<'_> {
        match self {
            Values::F64(values) => Part::F64(values),
            Values::U32(values) => Part::U32(values),
        }
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        match self {
            Values::F64(values) => values.len(),
            Values::U32(values) => values.len(),
        }
    }

    /// Whether there are no particles.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

macro_rules! element {
    ($type:ty, $variant:ident, $poison:expr, $untouched:expr) => {
        impl Element for $type {
            fn into_values(values: Vec<Self>) -> Values {
                Values::$variant(values)
            }
            fn of(values: &Values) -> Option<&Vec<Self>> {
                match values {
                    Values::$variant(values) => Some(values),
                    _ => None,
                }
            }
            fn of_mut(values: &mut Values) -> Option<&mut Vec<Self>> {
                match values {
                    Values::$variant(values) => Some(values),
                    _ => None,
                }
            }
            fn of_part<'a>(part: &'a Part<'_>) -> Option<&'a [Self]> {
                match part {
                    Part::$variant(values) => Some(values),
                    _ => None,
                }
            }
            fn of_part_mut<'a>(part: &'a mut Part<'_>) -> Option<&'a mut [Self]> {
                match part {
                    Part::$variant(values) => Some(values),
                    _ => None,
                }
            }
            fn poison() -> Self {
                $poison
            }
            fn is_untouched(&self) -> bool {
                $untouched(self)
            }
        }
    };
}
element!(f64, F64, f64::NAN, |value: &f64| value.to_bits() == 0);
element!(u32, U32, u32::MAX, |value: &u32| *value == 0);

/// What is known of a field whatever type it holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Description {
    /// Unique name, as in checkpoints and scenes.
    pub name: &'static str,
    /// Symbol in the formulas.
    pub symbol: &'static str,
    /// SI unit, "1" if dimensionless.
    pub unit: &'static str,
    /// Kept or recomputed.
    pub role: Role,
    /// One sentence.
    pub about: &'static str,
}

/// A field of values of type `T`: declared once as a `static`, and nowhere else.
#[derive(Debug)]
pub struct Field<T: Element> {
    /// Name, symbol, unit, role and sentence.
    pub description: Description,
    element: std::marker::PhantomData<T>,
}

impl<T: Element> Field<T> {
    /// A field that is part of the state.
    pub const fn state(
        name: &'static str,
        symbol: &'static str,
        unit: &'static str,
        about: &'static str,
    ) -> Self {
        Self::new(name, symbol, unit, Role::State, about)
    }

    /// A field that every step computes anew.
    pub const fn derived(
        name: &'static str,
        symbol: &'static str,
        unit: &'static str,
        about: &'static str,
    ) -> Self {
        Self::new(name, symbol, unit, Role::Derived, about)
    }

    /// A field that only stages hand to each other which follow one another.
    pub const fn transient(
        name: &'static str,
        symbol: &'static str,
        unit: &'static str,
        about: &'static str,
    ) -> Self {
        Self::new(name, symbol, unit, Role::Transient, about)
    }

    const fn new(
        name: &'static str,
        symbol: &'static str,
        unit: &'static str,
        role: Role,
        about: &'static str,
    ) -> Self {
        let description = Description { name, symbol, unit, role, about };
        Field { description, element: std::marker::PhantomData }
    }
}
