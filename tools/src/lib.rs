//! What the command line offers, as a library: outputs of a run and inspection of checkpoints.

pub mod inspect;
pub mod output;
