//! How an inspection can end.

use std::io;
use std::path::PathBuf;
use std::process::ExitCode;

use meniscus_engine::checkpoint::{CheckpointError, ColumnView};

/// What an inspection found.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Verdict {
    /// Nothing wrong.
    Good,
    /// A damaged file, or two files that differ.
    Bad,
}

impl Verdict {
    pub fn exit_code(self) -> ExitCode {
        match self {
            Self::Good => ExitCode::SUCCESS,
            Self::Bad => ExitCode::from(1),
        }
    }
}

/// Why an inspection could not be done.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    #[error("no checkpoint named; name a file or the folder of a run")]
    NothingNamed,
    #[error("{}: found no checkpoint in this folder; name a file, or the folder of a run that has written one", folder.display())]
    NoCheckpoint { folder: PathBuf },
    #[error("found no field `{name}`; this checkpoint has {known}")]
    UnknownField { name: String, known: String },
    #[error("a place needs the fields `radius` and `axial`; this checkpoint has {known}")]
    NoCoordinates { known: String },
    #[error("this checkpoint has no particle with a finite position; leave out --at")]
    NoParticle,
    #[error("cannot write the output: {0}; check what the output is connected to")]
    Output(#[from] io::Error),
}

impl Failure {
    /// 1 for a file that is damaged, 2 for anything that other arguments would mend.
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Checkpoint(error) if error.is_damage() => ExitCode::from(1),
            Self::Output(_) => ExitCode::from(1),
            _ => ExitCode::from(2),
        }
    }

    /// Whether the reader of the output has gone, as `head` does when it has enough.
    pub fn is_closed_pipe(&self) -> bool {
        matches!(self, Self::Output(error) if error.kind() == io::ErrorKind::BrokenPipe)
    }
}

/// The names of the columns, for a message.
pub fn known(columns: &[ColumnView<'_>]) -> String {
    let names: Vec<String> = columns.iter().map(|column| format!("`{}`", column.name())).collect();
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}
