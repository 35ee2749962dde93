//! Who touches which field: the wiring gives stages their handles, checks order and access, and is the
//! one list from which storage follows.

use crate::field::{Description, Element, Field, Role, Values};
use crate::store::{Add, Read, Store, Update, Write};
use std::marker::PhantomData;

/// What a stage does with a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// Reads it.
    Read,
    /// Sets it, whatever it held.
    Write,
    /// Reads and changes it.
    Update,
    /// Adds to what is there.
    Add,
}

/// One stage's access to one field.
#[derive(Clone, Debug)]
pub struct Use {
    /// Name of the stage.
    pub stage: &'static str,
    /// The field.
    pub field: Description,
    /// What the stage does with it.
    pub access: Access,
}

struct Entry {
    description: Description,
    allocate: fn(usize) -> Values,
}

/// Collects the fields and their uses while the stages of a pipeline are constructed, in their order.
#[derive(Default)]
pub struct Wiring {
    entries: Vec<Entry>,
    uses: Vec<Use>,
    /// Stages that do again what others did.
    repeats: Vec<[&'static str; 2]>,
    stage: &'static str,
}

/// Mistakes in the order or access of stages, one sentence each.
#[derive(Debug, thiserror::Error)]
#[error("{}", sentences.join("\n"))]
pub struct WiringError {
    /// One sentence per mistake.
    pub sentences: Vec<String>,
}

impl Wiring {
    /// An empty wiring.
    pub fn new() -> Self {
        Self::default()
    }

    /// From now on, handles are given to the stage of this name.
    pub fn stage(&mut self, name: &'static str) {
        self.stage = name;
    }

    /// Says that a later stage does again what an earlier one did, with the same handles.
    pub fn repeat(&mut self, earlier: &'static str, later: &'static str) {
        self.repeats.push([earlier, later]);
    }

    /// The right to read a field. A Derived field must have been written by an earlier stage.
    pub fn read<T: Element>(&mut self, field: &'static Field<T>) -> Read<T> {
        Read(self.log(field, Access::Read), PhantomData)
    }

    /// The right to set a field.
    pub fn write<T: Element>(&mut self, field: &'static Field<T>) -> Write<T> {
        Write(self.log(field, Access::Write), PhantomData)
    }

    /// The right to read a field and change it.
    pub fn update<T: Element>(&mut self, field: &'static Field<T>) -> Update<T> {
        Update(self.log(field, Access::Update), PhantomData)
    }

    /// The right to add to a field that an earlier stage wrote.
    pub fn add<T: Element>(&mut self, field: &'static Field<T>) -> Add<T> {
        Add(self.log(field, Access::Add), PhantomData)
    }

    fn log<T: Element>(&mut self, field: &'static Field<T>, access: Access) -> usize {
        let description = field.description;
        self.uses.push(Use { stage: self.stage, field: description, access });
        let known = self.entries.iter().position(|e| e.description.name == description.name);
        known.unwrap_or_else(|| {
            let allocate = |len| T::into_values(vec![T::default(); len]);
            self.entries.push(Entry { description, allocate });
            self.entries.len() - 1
        })
    }

    /// Every use, in the order of the pipeline.
    pub fn uses(&self) -> &[Use] {
        &self.uses
    }

    /// Checks that every Derived and Transient field is written before it is read, that nothing written is
    /// overwritten unread, and that nothing is computed that nobody reads.
    ///
    /// # Errors
    /// One sentence per mistake.
    pub fn check(&self) -> Result<(), WiringError> {
        let mut sentences = Vec::new();
        for entry in self.entries.iter().filter(|e| e.description.role != Role::State) {
            self.check_derived(entry.description.name, &mut sentences);
        }
        if sentences.is_empty() { Ok(()) } else { Err(WiringError { sentences }) }
    }

    /// Checks that what is Transient is written and read by stages that take the same chunks in turn; `works` are the
    /// names of those, as they follow each other.
    ///
    /// # Errors
    /// One sentence per mistake.
    pub(crate) fn check_transients(&self, works: &[Vec<&'static str>]) -> Result<(), WiringError> {
        let place = |used: &Use| works.iter().position(|stages| stages.contains(&used.stage));
        let transient: Vec<&Use> =
            self.uses.iter().filter(|used| used.field.role == Role::Transient).collect();
        let mut sentences: Vec<String> = Vec::new();
        for read in transient.iter().filter(|used| used.access != Access::Write) {
            let of_field = |used: &&&Use| used.access == Access::Write && used.field.name == read.field.name;
            let far = transient.iter().filter(of_field).find(|written| {
                let places = (place(written), place(read));
                places.0.is_some() && places.1.is_some() && places.0 != places.1
            });
            if let Some(written) = far {
                let (reader, name, writer) = (read.stage, read.field.name, written.stage);
                sentences.push(format!(
                    "stage `{reader}` reads `{name}`, which is only held while `{writer}` and the stages after it take \
                     a chunk in turn; move it there"
                ));
            }
        }
        if sentences.is_empty() { Ok(()) } else { Err(WiringError { sentences }) }
    }

    fn check_derived(&self, name: &str, sentences: &mut Vec<String>) {
        let mut written: Option<&Use> = None;
        let mut unread: Option<&Use> = None;
        for used in self.uses.iter().filter(|u| u.field.name == name) {
            let reader = used.stage;
            match (used.access, written) {
                (Access::Write, _) => {
                    if let Some(lost) = unread {
                        sentences.push(format!(
                            "stage `{reader}` overwrites `{name}`, which stage `{}` wrote and nobody read in between",
                            lost.stage
                        ));
                    }
                    (written, unread) = (Some(used), Some(used));
                }
                (_, None) => sentences.push(self.unwritten(used)),
                (Access::Add, Some(_)) => {}
                (Access::Read | Access::Update, Some(_)) => unread = None,
            }
        }
        if let Some(lost) = unread {
            sentences.push(format!(
                "stage `{}` writes `{name}`, which no later stage of this scene reads: leave the stage or the field out",
                lost.stage
            ));
        }
    }

    fn unwritten(&self, used: &Use) -> String {
        let verb = if used.access == Access::Add { "adds to" } else { "reads" };
        let name = used.field.name;
        let later = self.uses.iter().find(|u| u.field.name == name && u.access == Access::Write);
        let remedy = match later {
            Some(writer) => {
                format!("stage `{}` writes it only later in the step: move it forward", writer.stage)
            }
            None => "add the stage that writes it".to_string(),
        };
        format!(
            "stage `{}` {verb} `{name}`, which no earlier stage of this scene produces; {remedy}",
            used.stage
        )
    }

    /// Places and fields of the columns that any of the named stages uses.
    pub(crate) fn columns_of(&self, stages: &[&'static str]) -> Vec<(usize, Description)> {
        let repeated = self.repeats.iter().filter(|[_, later]| stages.contains(later));
        let stages: Vec<&str> = stages.iter().copied().chain(repeated.map(|[earlier, _]| *earlier)).collect();
        let used = |entry: &Entry| {
            let name = entry.description.name;
            self.uses.iter().any(|used| used.field.name == name && stages.contains(&used.stage))
        };
        let entries = self.entries.iter().enumerate().filter(|(_, entry)| used(entry));
        entries.map(|(place, entry)| (place, entry.description)).collect()
    }

    /// Number of columns.
    pub(crate) fn count(&self) -> usize {
        self.entries.len()
    }

    /// A store with exactly the columns that the stages asked for, all zero; Transient ones are empty.
    pub fn allocate(&self, len: usize) -> Store {
        let allocate = |entry: &Entry| match entry.description.role {
            Role::Transient => (entry.description, (entry.allocate)(0)),
            _ => (entry.description, (entry.allocate)(len)),
        };
        Store::new(len, self.entries.iter().map(allocate).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    static POSITION: Field<f64> = Field::state("position", "x", "m", "Where it is.");
    static FORCE: Field<f64> = Field::derived("force", "f", "N", "What pulls.");

    #[test]
    fn a_read_before_the_write_is_explained() {
        let mut wiring = Wiring::new();
        wiring.stage("move");
        wiring.read(&FORCE);
        wiring.update(&POSITION);
        wiring.stage("pull");
        wiring.write(&FORCE);
        let text = wiring.check().unwrap_err().to_string();
        assert!(
            text.contains(
                "stage `move` reads `force`, which no earlier stage of this scene produces; \
                 stage `pull` writes it only later in the step: move it forward"
            ),
            "{text}"
        );
        assert!(
            text.contains("stage `pull` writes `force`, which no later stage of this scene reads"),
            "{text}"
        );
    }

    #[test]
    fn an_overwritten_field_is_explained() {
        let mut wiring = Wiring::new();
        wiring.stage("pull");
        wiring.write(&FORCE);
        wiring.stage("push");
        wiring.write(&FORCE);
        wiring.stage("move");
        wiring.read(&FORCE);
        let text = wiring.check().unwrap_err().to_string();
        assert_eq!(
            text,
            "stage `push` overwrites `force`, which stage `pull` wrote and nobody read in between"
        );
    }

    #[test]
    fn the_store_holds_what_was_asked_for() {
        let mut wiring = Wiring::new();
        wiring.stage("pull");
        let write = wiring.write(&FORCE);
        wiring.stage("move");
        let read = wiring.read(&FORCE);
        wiring.check().unwrap();
        let store = wiring.allocate(3);
        store.write(write).copy_from_slice(&[1.0, 2.0, 3.0]);
        assert_eq!(&*store.read(read), &[1.0, 2.0, 3.0]);
        assert_eq!(store.columns().count(), 1);
    }
}
