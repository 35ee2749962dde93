//! What a checkpoint holds: the types of format version 1.

use rkyv::{Archive, Deserialize, Serialize};

/// Everything a run needs to continue, and to be understood later.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Checkpoint {
    /// Where the run stands.
    pub clock: Clock,
    /// Text of the effective scene: with every change from the command line applied.
    pub scene: String,
    /// Revision of the source that wrote the file.
    pub revision: String,
    /// The fields, each with one value a particle, in the order of the particle store.
    pub columns: Vec<Column>,
}

impl Checkpoint {
    /// The column of this name, if there is one.
    pub fn column(&self, name: &str) -> Option<&Column> {
        self.columns.iter().find(|column| column.name == name)
    }

    /// Number of particles: the length shared by all columns.
    pub fn particles(&self) -> usize {
        self.columns.first().map_or(0, |column| column.data.len())
    }
}

/// Where a run stands in time.
#[derive(Archive, Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct Clock {
    /// Number of steps taken.
    pub step: u64,
    /// Physical time reached, s.
    pub time: f64,
    /// The last step taken, s.
    pub step_size: f64,
    /// Other numbers the run needs to continue, each with its name.
    pub scalars: Vec<(String, f64)>,
}

impl Clock {
    /// The scalar of this name, if there is one.
    pub fn scalar(&self, name: &str) -> Option<f64> {
        let mut scalars = self.scalars.iter();
        scalars.find(|(other, _)| other == name).map(|&(_, value)| value)
    }
}

/// One field of all particles, described well enough to be read without the program.
#[derive(Archive, Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Column {
    /// Name of the field, unique in its checkpoint.
    pub name: String,
    /// Symbol used in formulas.
    pub symbol: String,
    /// Unit of the values; empty or "1" for a plain number.
    pub unit: String,
    /// One sentence about the field.
    pub about: String,
    /// Whether the next step depends on it.
    pub role: Role,
    /// One value a particle.
    pub data: Data,
}

/// Whether a field carries the state or follows from it.
#[derive(Archive, Clone, Copy, Debug, Deserialize, Eq, PartialEq, Serialize)]
pub enum Role {
    /// The run depends on it: a checkpoint without it cannot continue.
    State,
    /// Recomputed from the state, stored for the reader's sake.
    Derived,
}

/// The values of one column.
#[derive(Archive, Clone, Debug, Deserialize, PartialEq, Serialize)]
pub enum Data {
    /// Floating-point numbers.
    F64(Vec<f64>),
    /// Whole numbers, such as identities and marks.
    U32(Vec<u32>),
}

impl Data {
    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::F64(values) => values.len(),
            Self::U32(values) => values.len(),
        }
    }

    /// Whether there is no value.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// First section of a file: small, so that it can be read and checked without the columns.
#[derive(Archive, Clone, Debug, Deserialize, Serialize)]
pub struct Preface {
    /// Where the run stands.
    pub clock: Clock,
    /// Text of the effective scene.
    pub scene: String,
    /// Revision of the source.
    pub revision: String,
}
