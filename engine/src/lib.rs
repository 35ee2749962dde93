//! The engine of Meniscus: particles as columns, Morton order, neighbour lists, pair passes, the
//! pipeline with its clock, and checkpoints. It names no physics; the stages bring that.

pub mod bins;
pub mod checkpoint;
pub mod clock;
pub mod domain;
pub mod field;
pub mod group;
pub mod lanes;
#[cfg(unix)]
pub mod memory;
pub mod morton;
pub mod neighbours;
pub mod pairs;
pub mod parallel;
pub mod pipeline;
pub mod store;
pub mod wiring;
