//! How an inspection can end.

use std::io;
use std::path::PathBuf;
use std::process::ExitCode;

use meniscus_cases::scene::Diagnosis;
use meniscus_engine::checkpoint::{CheckpointError, ColumnView};

use crate::output::{OutputError, is_full};
use meniscus_cases::scene::FOLLOWING;

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
    #[error(
        "the checkpoint's scene is none that this release reads, and this quantity needs it; leave it out, or use the release that wrote the file"
    )]
    NoScene,
    #[error("this checkpoint has no particle with a finite position")]
    NoParticle,
    #[error("{}: the name ends in none of {expected}; give the file one of these endings", path.display())]
    UnknownEnding { path: PathBuf, expected: &'static str },
    #[error("{}: there is no folder `{}`; make it, or choose another name", path.display(), folder.display())]
    NoFolder { path: PathBuf, folder: PathBuf },
    #[error("the colours go from --low {low} to --high {high}: choose a --high above --low")]
    Range { low: f64, high: f64 },
    #[error("{}: there is a file already; choose another name, or replace it with --overwrite", path.display())]
    Exists { path: PathBuf },
    #[error("{}: there is a folder of that name; choose another name", path.display())]
    IsFolder { path: PathBuf },
    #[error("{0}")]
    Condition(Diagnosis),
    #[error(transparent)]
    File(#[from] OutputError),
    #[error(transparent)]
    Unread(OutputError),
    #[error("cannot write the output: {0}; check what the output is connected to")]
    Output(#[from] io::Error),
}

impl Failure {
    /// 1 for a file that is damaged or a disk that is full, 2 for anything that other arguments would mend.
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Self::Checkpoint(error) if error.is_damage() => ExitCode::from(1),
            Self::File(OutputError::File { reason, .. }) if !is_full(reason) => ExitCode::from(2),
            Self::Output(_) | Self::File(_) => ExitCode::from(1),
            _ => ExitCode::from(2),
        }
    }

    /// Whether the reader of the output has gone, as `head` does when it has enough.
    pub fn is_closed_pipe(&self) -> bool {
        matches!(self, Self::Output(error) if error.kind() == io::ErrorKind::BrokenPipe)
    }

    /// The whole message for people; a condition is shown with the place of its mistake.
    pub fn told(&self) -> String {
        match self {
            Self::Condition(diagnosis) => format!("{:?}", miette::Report::new(diagnosis.clone())),
            _ => format!("error: {self}"),
        }
    }
}

/// The names of the columns and of what follows from them, for a message.
pub fn known(columns: &[ColumnView<'_>]) -> String {
    let names = columns.iter().map(ColumnView::name);
    let names = names.chain(FOLLOWING.map(|(name, _)| name));
    let names: Vec<String> = names.map(|name| format!("`{name}`")).collect();
    names.join(", ")
}
