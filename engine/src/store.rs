//! Particles as columns: one contiguous array per field.

use crate::field::{Description, Element, Role, Values, copy};
use arrayvec::ArrayVec;
use atomic_refcell::{AtomicRef, AtomicRefCell, AtomicRefMut};
use std::marker::PhantomData;

/// The columns of all particles. A stage reaches them only through the handles its wiring gave it.
#[derive(Debug)]
pub struct Store {
    len: usize,
    /// Whether somebody has set columns who is no stage, or a stage has added particles or taken some out.
    is_changed: bool,
    keeps_transients: bool,
    columns: Vec<(Description, AtomicRefCell<Values>)>,
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

/// A handle that lets values be read.
pub trait Readable<T> {
    /// Position of the column in the store.
    fn column(&self) -> usize;
}

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
macro_rules! reaches {
    ($reach:ident: $($handle:ident),+) => {
        $(impl<T> $reach<T> for $handle<T> {
            fn column(&self) -> usize {
                self.0
            }
        })+
    };
}
reaches!(Readable: Read, Update);
reaches!(Mutable: Write, Update, Add);

impl Store {
    pub(crate) fn new(len: usize, columns: Vec<(Description, Values)>) -> Self {
        let columns = columns.into_iter().map(|(d, v)| (d, AtomicRefCell::new(v))).collect();
        Store { len, is_changed: true, keeps_transients: false, columns }
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are no particles.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The values behind a read or update handle.
    ///
    /// # Panics
    /// If the same stage holds the column mutably: a mistake in the stage, never in its input.
    pub fn read<T: Element>(&self, handle: impl Readable<T>) -> AtomicRef<'_, [T]> {
        let column = self.columns[handle.column()].1.borrow();
        AtomicRef::map(column, |values| T::of(values).expect("handles carry the column's type").as_slice())
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

    /// Some columns by their places, to be cut into chunks.
    ///
    /// # Panics
    /// If one of them is asked for twice.
    pub(crate) fn lock<const N: usize>(
        &self,
        places: impl Iterator<Item = usize>,
    ) -> ArrayVec<AtomicRefMut<'_, Values>, N> {
        places.map(|place| self.columns[place].1.borrow_mut()).collect()
    }

    /// Gives Transient fields columns, too, from now on, to look at what stages hand to each other.
    pub fn keep_transients(&mut self) {
        let transient =
            self.columns.iter_mut().filter(|(description, _)| description.role == Role::Transient);
        for (_, column) in transient {
            match column.get_mut() {
                Values::F64(values) => values.resize(self.len, 0.0),
                Values::U32(values) => values.resize(self.len, 0),
            }
        }
        self.keeps_transients = true;
    }

    /// Whether Transient fields have columns.
    pub(crate) fn keeps_transients(&self) -> bool {
        self.keeps_transients
    }

    /// A column by name, if this store has it and it holds type `T`: for diagnostics and export.
    pub fn by_name<T: Element>(&self, name: &str) -> Option<AtomicRef<'_, [T]>> {
        let has_values = |d: &Description| d.role != Role::Transient || self.keeps_transients;
        let column = self.columns.iter().find(|(d, _)| d.name == name && has_values(d))?;
        AtomicRef::filter_map(column.1.borrow(), |v| T::of(v).map(Vec::as_slice))
    }

    /// Whether a stage has added particles or taken some out, or columns were set by somebody who is no stage, since [`Store::forget_changes`]: what stages keep about
    /// them outside of the store doesn't hold then.
    pub fn is_changed(&self) -> bool {
        self.is_changed
    }

    /// Whatever stages keep about the columns has been made anew.
    pub fn forget_changes(&mut self) {
        self.is_changed = false;
    }

    /// A column by name, to change; `None` as for [`Store::by_name`].
    pub fn by_name_mut<T: Element>(&mut self, name: &str) -> Option<&mut [T]> {
        self.is_changed = true;
        let (_, column) = self.columns.iter_mut().find(|(d, _)| d.name == name)?;
        T::of_mut(column.get_mut()).map(Vec::as_mut_slice)
    }

    /// Sets a column by name before a run; false if there is none of that name, type and length.
    pub fn set<T: Element>(&mut self, name: &str, values: &[T]) -> bool {
        self.is_changed = true;
        let Some((_, column)) = self.columns.iter_mut().find(|(d, _)| d.name == name) else {
            return false;
        };
        match T::of_mut(column.get_mut()) {
            Some(column) if column.len() == values.len() => {
                copy(column, values, |value| value);
                true
            }
            _ => false,
        }
    }

    /// Every field that some stage uses, with a column or without.
    pub fn fields(&self) -> impl Iterator<Item = Description> {
        self.columns.iter().map(|(description, _)| *description)
    }

    /// Every column with its description, in the order of first use.
    pub fn columns(&self) -> impl Iterator<Item = (Description, AtomicRef<'_, Values>)> {
        let kept = self.columns.iter().filter(|(description, _)| description.role != Role::Transient);
        kept.map(|(description, values)| (*description, values.borrow()))
    }

    /// Bytes that the columns take.
    pub fn bytes(&self) -> usize {
        let column = |values: &Values| match values {
            // A long column asks for more memory than it ever touches.
            Values::F64(values) => size_of_val(&values[..]),
            Values::U32(values) => size_of_val(&values[..]),
        };
        self.columns.iter().map(|(_, values)| column(&values.borrow())).sum()
    }

    /// Lends the memory of as many Derived columns, or takes it back: swaps both. What comes back must be as long at
    /// least. Only between steps and in their first stage, when nobody expects anything there.
    pub fn swap_derived(&mut self, scratch: &mut [Vec<f64>]) {
        let derived = self.columns.iter_mut().filter(|(description, _)| description.role == Role::Derived);
        let derived = derived.filter_map(|(_, column)| f64::of_mut(column.get_mut()));
        for (column, scratch) in derived.zip(scratch) {
            scratch.truncate(self.len);
            std::mem::swap(column, scratch);
        }
    }

    /// The State columns, then all others if asked for, taken out of the store while `look` looks at them; it
    /// gives them back.
    pub fn lend<R>(
        &self,
        with_derived: bool,
        look: impl FnOnce(Vec<(Description, Values)>) -> (R, Vec<Values>),
    ) -> R {
        let wanted = |(d, _): &&(Description, AtomicRefCell<Values>)| match d.role {
            Role::State => true,
            Role::Derived => with_derived,
            Role::Transient => false,
        };
        let mut wanted: Vec<_> = self.columns.iter().filter(wanted).collect();
        wanted.sort_by_key(|(description, _)| description.role == Role::Derived);
        let take = |column: &AtomicRefCell<Values>| {
            std::mem::replace(&mut *column.borrow_mut(), Values::U32(Vec::new()))
        };
        let (result, returned) = look(wanted.iter().map(|(d, column)| (*d, take(column))).collect());
        for ((_, column), values) in wanted.into_iter().zip(returned) {
            *column.borrow_mut() = values;
        }
        result
    }

    /// Moves every State value to its new place: particle `order[k]` becomes particle k. The memory of a Derived
    /// column serves as scratch.
    pub fn permute(&mut self, order: &[u32]) {
        self.is_changed = true;
        let mut scratch = [Vec::new()];
        self.swap_derived(&mut scratch);
        let [moved] = &mut scratch;
        moved.resize(self.len, 0.0);
        let is_state = |column: &&mut (Description, _)| column.0.role == Role::State;
        let columns = self.columns.iter_mut().filter(is_state).map(|(_, column)| column.get_mut());
        let mut first_swapped = None;
        for column in columns {
            match column {
                Values::F64(values) => {
                    gather(moved, order, |from| values[from]);
                    if is_sparse(moved) {
                        copy(values, moved, |value| value);
                    } else {
                        std::mem::swap(values, moved);
                        first_swapped = first_swapped.or(Some(values));
                    }
                }
                Values::U32(values) => {
                    // A real number holds every index exactly.
                    gather(moved, order, |from| f64::from(values[from]));
                    copy(values, moved, |value| value as u32);
                }
            }
        }
        // What was lent may have room for images as well: it goes back, or the next list would make that room anew.
        if let Some(values) = first_swapped {
            moved.copy_from_slice(values);
            std::mem::swap(values, moved);
        }
        self.swap_derived(&mut scratch);
    }

    /// Adds as many particles, each a copy of the one named.
    pub fn add_copies(&mut self, of: &[u32]) {
        self.is_changed = true;
        for (description, column) in &mut self.columns {
            if description.role == Role::Transient && !self.keeps_transients {
                continue;
            }
            match column.get_mut() {
                Values::F64(values) => extend(values, of),
                Values::U32(values) => extend(values, of),
            }
        }
        self.len += of.len();
    }

    /// Takes particles out, named in ascending order; the others keep theirs.
    pub fn remove(&mut self, particles: &[u32]) {
        self.is_changed = true;
        for (_, column) in &mut self.columns {
            match column.get_mut() {
                Values::F64(values) => take_out(values, particles),
                Values::U32(values) => take_out(values, particles),
            }
        }
        self.len -= particles.len();
    }

    /// Fills every Derived column with a value that shows when it is read before it is written, for tests.
    pub fn poison_derived(&mut self) {
        self.is_changed = true;
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

fn extend<T: Copy>(values: &mut Vec<T>, of: &[u32]) {
    if values.capacity() < values.len() + of.len() {
        values.reserve_exact(of.len() + values.len() / ROOM);
    }
    for &from in of {
        values.push(values[from as usize]);
    }
}

fn take_out<T>(values: &mut Vec<T>, places: &[u32]) {
    let (mut place, mut gone) = (0, places.iter().peekable());
    values.retain(|_| {
        let is_gone = gone.next_if_eq(&&place).is_some();
        place += 1;
        !is_gone
    });
}

/// One particle in so many more have room at once when columns become longer.
const ROOM: usize = 16;

/// Bytes that the memory of some values takes.
pub fn bytes_of<T>(values: &Vec<T>) -> usize {
    values.capacity() * size_of::<T>()
}

/// One value in so many may be other than zero for a column to be written where it is not zero alone.
const SPARSE: usize = 16;

fn is_sparse(values: &[f64]) -> bool {
    values.iter().filter(|value| !value.is_untouched()).count() <= values.len() / SPARSE
}

fn gather(moved: &mut [f64], order: &[u32], value: impl Fn(usize) -> f64 + Sync) {
    crate::parallel::for_chunks(order.len(), (moved, order), |_, (moved, order)| {
        for (moved, &from) in moved.iter_mut().zip(order) {
            *moved = value(from as usize);
        }
    });
}

#[cfg(test)]
mod tests {
    use crate::field::Field;
    use crate::wiring::Wiring;

    static PLACE: Field<f64> = Field::state("place", "x", "m", "Where it is.");
    static NUMBER: Field<u32> = Field::state("number", "i", "1", "Which it is.");
    static FORCE: Field<f64> = Field::derived("force", "f", "N", "What pulls.");

    #[test]
    fn particles_are_added_and_taken_out_of_all_columns() {
        let mut wiring = Wiring::new();
        wiring.stage("move");
        wiring.update(&PLACE);
        wiring.update(&NUMBER);
        wiring.write(&FORCE);
        let mut store = wiring.allocate(4);
        assert!(store.set("place", &[0.0, 1.0, 2.0, 3.0]) && store.set("number", &[10, 11, 12, 13]));
        store.forget_changes();
        store.add_copies(&[3, 1]);
        assert!(store.is_changed());
        store.remove(&[0, 2, 5]);
        assert_eq!(store.len(), 3);
        assert_eq!(*store.by_name::<f64>("place").unwrap(), [1.0, 3.0, 3.0]);
        assert_eq!(*store.by_name::<u32>("number").unwrap(), [11, 13, 13]);
        assert!(store.columns().all(|(_, values)| values.len() == 3));
    }
}
