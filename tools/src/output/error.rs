//! What can go wrong when results are written or read back, in sentences.

use std::io;
use std::path::{Path, PathBuf};

use miette::Diagnostic;
use thiserror::Error;

/// A result whose error is an [`OutputError`].
pub type OutputResult<T> = Result<T, OutputError>;

/// A file or folder of a run that could not be made, written or read.
#[derive(Debug, Error, Diagnostic)]
pub enum OutputError {
    /// The operating system refused; the source says why.
    #[error("cannot {action} `{}`: {source}", path.display())]
    File {
        /// What was tried: "write", "read", "create the folder".
        action: &'static str,
        /// The file or folder concerned.
        path: PathBuf,
        /// The reason that the operating system gave.
        source: io::Error,
    },
    /// The file is there, but its content is not what it should be.
    #[error("`{}`: {problem}", path.display())]
    Content {
        /// The file concerned.
        path: PathBuf,
        /// What is wrong with it, and where.
        problem: String,
    },
    /// The caller's data cannot be written as asked.
    #[error("cannot write `{}`: {problem}", path.display())]
    Data {
        /// The file that was to be written.
        path: PathBuf,
        /// What is wrong with the data.
        problem: String,
    },
    /// The output folder holds something already.
    #[error(
        "the output folder `{}` is not empty; choose another with `--out DIR`, \
         or replace the run in it with `--overwrite`",
        .0.display()
    )]
    Occupied(PathBuf),
    /// The folder to be overwritten shows no sign of an earlier run.
    #[error(
        "the folder `{}` holds files, but no earlier run to overwrite; choose another with `--out DIR`",
        .0.display()
    )]
    NotARun(PathBuf),
    /// The output folder's place is taken by something that is no folder.
    #[error("`{}` is not a folder; choose another place with `--out DIR`", .0.display())]
    NotAFolder(PathBuf),
    /// Another process writes into the folder.
    #[error("another run is writing into `{}`; wait for its end or stop it, or choose another folder", .0.display())]
    InUse(PathBuf),
    /// There is no run to continue at this place.
    #[error("there is no run in `{}` (no `checkpoints` folder)", .0.display())]
    NoRun(PathBuf),
}

impl OutputError {
    /// Wraps an error of the operating system with what was tried and where.
    pub(crate) fn file(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_path_buf();
        move |source| Self::File { action, path, source }
    }

    /// A file whose content is wrong.
    pub(crate) fn content(path: &Path, problem: impl Into<String>) -> Self {
        Self::Content { path: path.to_path_buf(), problem: problem.into() }
    }

    /// Data that cannot become the file asked for.
    pub(crate) fn data(path: &Path, problem: impl Into<String>) -> Self {
        Self::Data { path: path.to_path_buf(), problem: problem.into() }
    }
}
