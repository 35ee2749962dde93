//! What a run writes into its folder and shows to its user.
//!
//! Nothing here knows the engine: plain slices and structs go in, files come
//! out. Every file that a reader may open while the run goes on (or after it
//! was killed) is written next to its place and renamed, so that it is either
//! the old one or the new one, never half of either.

pub(crate) mod atomic;
mod axis;
mod canvas;
mod error;

pub mod chart;
pub mod colour;
pub mod folder;
pub mod picture;
pub mod plot;
pub mod progress;
pub mod report;
pub mod series;
pub mod summary;
pub mod units;
pub mod vtk;

pub(crate) use error::is_full;
pub use error::{OutputError, OutputResult};
