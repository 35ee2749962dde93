//! What the command line offers, as a library: runs and their outputs, plans, inspection of checkpoints.

pub mod command;
mod failure;
pub mod inspect;
pub mod output;
mod plan;
mod run;
