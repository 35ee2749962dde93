//! What a run is measured by: observations on the way, fits at the end, exact solutions to compare with.

pub mod boundary_integral;
pub mod bridge;
mod columns;
mod curve;
mod energy;
mod evaluate;
pub mod exact;
mod film;
pub mod fit;
mod flow;
mod free_surface;
pub mod growth;
mod history;
mod jet;
pub mod large;
mod motion;
mod observe;
pub mod potential;
pub mod spheroid;
mod spread;
mod surface;
#[cfg(test)]
mod tests;
pub mod thread;
pub mod viscous;

pub use columns::{columns_of, numbered, with_index};
pub use evaluate::{Outcome, conservation, evaluate, oscillation_fit};
pub use history::History;
pub use jet::{compressible_growth_ratio, growth_of_wave};
pub use observe::{Observer, Quantity};
