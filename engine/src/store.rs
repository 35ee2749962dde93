//! Particles as columns: one contiguous array per field.

use crate::field::{Description, Element, Role, Values};
use atomic_refcell::{AtomicRef, AtomicRefCell, AtomicRefMut};
use std::marker::PhantomData;

/// The columns of all particles. A stage reaches them only through the handles its wiring gave it.
#[derive(Debug)]
pub struct Store {
    len: usize,
    columns: Vec<(Description, AtomicRefCell<Values>)>,
    scratch: Vec<(Vec<f64>, Vec<u32>)>,
}

/// The right to read a field.
#[derive(Debug)]
pub struct Read<T>(pub(crate) usize, pub(crate) PhantomData<T>);
/// The right to set a field, whatever it held before.
#[derive(Debug)]
pub struct Write<T>(pub(crate) usize, pub(crate) PhantomData<T>);
/// The right to read a field and change it.
#[derive(Debug)]
pub struct Update<T>(pub(crate) usize, pub(crate) PhantomData<T>);
/// The right to add to what earlier stages of the step wrote.
#[derive(Debug)]
pub struct Add<T>(pub(crate) usize, pub(crate) PhantomData<T>);

/// A handle that lets values change.
pub trait Mutable<T> {
    /// Position of the column in the store.
    fn column(&self) -> usize;
}
macro_rules! handle {
    ($handle:ident) => {
        impl<T> Clone for $handle<T> {
            fn clone(&self) -> Self {
                *self
            }
        }
        impl<T> Copy for $handle<T> {}
    };
}
handle!(Read);
handle!(Write);
handle!(Update);
handle!(Add);
macro_rules! mutable {
    ($handle:ident) => {
        impl<T> Mutable<T> for $handle<T> {
            fn column(&self) -> usize {
                self.0
            }
        }
    };
}
mutable!(Write);
mutable!(Update);
mutable!(Add);

impl Store {
    pub(crate) fn new(len: usize, columns: Vec<(Description, Values)>) -> Self {
        let columns = columns.into_iter().map(|(d, v)| (d, AtomicRefCell::new(v))).collect();
        Store { len, columns, scratch: Vec::new() }
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are no particles.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The values behind a read handle.
    ///
    /// # Panics
    /// If the same stage holds the column mutably: a mistake in the stage, never in its input.
    pub fn read<T: Element>(&self, handle: Read<T>) -> AtomicRef<'_, [T]> {
        self.borrow(handle.0)
    }

    /// The values behind a write, update or add handle, to change them.
    ///
    /// # Panics
    /// If the same stage holds the column already: a mistake in the stage, never in its input.
    pub fn write<T: Element>(&self, handle: impl Mutable<T>) -> AtomicRefMut<'_, [T]> {
        let column = self.columns[handle.column()].1.borrow_mut();
        AtomicRefMut::map(column, |values| {
            T::of_mut(values).expect("handles carry the column's type").as_mut_slice()
        })
    }

    fn borrow<T: Element>(&self, column: usize) -> AtomicRef<'_, [T]> {
        let column = self.columns[column].1.borrow();
        AtomicRef::map(column, |values| T::of(values).expect("handles carry the column's type").as_slice())
    }

    /// A column by name, if this store has it and it holds type `T`: for diagnostics and export.
    pub fn by_name<T: Element>(&self, name: &str) -> Option<AtomicRef<'_, [T]>> {
        let column = self.columns.iter().find(|(d, _)| d.name == name)?;
        AtomicRef::filter_map(column.1.borrow(), |v| T::of(v).map(Vec::as_slice))
    }

    /// A column by name, to change; `None` as for [`Store::by_name`].
    pub fn by_name_mut<T: Element>(&mut self, name: &str) -> Option<&mut [T]> {
        let (_, column) = self.columns.iter_mut().find(|(d, _)| d.name == name)?;
        T::of_mut(column.get_mut()).map(Vec::as_mut_slice)
    }

    /// Sets a column by name before a run; false if there is none of that name, type and length.
    pub fn set<T: Element>(&mut self, name: &str, values: &[T]) -> bool {
        let Some((_, column)) = self.columns.iter_mut().find(|(d, _)| d.name == name) else {
            return false;
        };
        match T::of_mut(column.get_mut()) {
            Some(column) if column.len() == values.len() => {
                column.copy_from_slice(values);
                true
            }
            _ => false,
        }
    }

    /// Every column with its description, in the order of first use.
    pub fn columns(&self) -> impl Iterator<Item = (Description, AtomicRef<'_, Values>)> {
        self.columns.iter().map(|(description, values)| (*description, values.borrow()))
    }

    /// Bytes that the columns take, with the spare one of each type that sorting needs.
    pub fn bytes(&self) -> usize {
        let column = |values: &Values| match values {
            Values::F64(values) => bytes_of(values),
            Values::U32(values) => bytes_of(values),
        };
        let columns: usize = self.columns.iter().map(|(_, values)| column(&values.borrow())).sum();
        columns
            + self.scratch.iter().map(|(reals, indices)| bytes_of(reals) + bytes_of(indices)).sum::<usize>()
    }

    /// Moves every State value to its new place: particle `order[k]` becomes particle k.
    pub fn permute(&mut self, order: &[u32]) {
        if self.scratch.is_empty() {
            self.scratch.push((vec![0.0; self.len], vec![0; self.len]));
        }
        let (reals, indices) = &mut self.scratch[0];
        for (description, column) in &mut self.columns {
            if description.role == Role::Derived {
                continue;
            }
            match column.get_mut() {
                Values::F64(values) => gather(values, reals, order),
                Values::U32(values) => gather(values, indices, order),
            }
        }
    }

    /// Fills every Derived column with a value that shows when it is read before it is written.
    pub fn poison_derived(&mut self) {
        for (description, column) in &mut self.columns {
            if description.role == Role::Derived {
                match column.get_mut() {
                    Values::F64(values) => values.fill(f64::poison()),
                    Values::U32(values) => values.fill(u32::poison()),
                }
            }
        }
    }
}

/// Bytes that the memory of some values takes.
pub fn bytes_of<T>(values: &Vec<T>) -> usize {
    values.capacity() * size_of::<T>()
}

fn gather<T: Element>(values: &mut Vec<T>, scratch: &mut Vec<T>, order: &[u32]) {
    let source = &values[..];
    crate::parallel::for_chunks(order.len(), (&mut scratch[..], order), |_, (target, order)| {
        for (target, &from) in target.iter_mut().zip(order) {
            *target = source[from as usize];
        }
    });
    std::mem::swap(values, scratch);
}
