//! What a run is measured by: observations on the way, fits at the end, exact solutions to compare with.

mod evaluate;
pub mod exact;
pub mod fit;
mod history;
mod observe;
mod surface;
#[cfg(test)]
mod tests;

pub use evaluate::{Outcome, conservation, evaluate, oscillation_fit};
pub use history::History;
pub use observe::{Observer, Quantity, numbered};
