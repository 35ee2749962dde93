//! What the command line offers, as a library: runs and their outputs, plans, verification,
//! studies, inspection of checkpoints.

pub mod command;
mod failure;
pub mod inspect;
mod memory;
pub mod output;
mod plan;
mod run;
mod study;
mod verify;
