//! What can go wrong when results are written or read back, in sentences.

use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

use miette::Diagnostic;
use thiserror::Error;

/// A result whose error is an [`OutputError`].
pub type OutputResult<T> = Result<T, OutputError>;

/// A file or folder of a run that could not be made, written or read.
#[derive(Debug, Error, Diagnostic)]
pub enum OutputError {
    /// The operating system refused.
    #[error("cannot {action} `{}`: {reason}{}", path.display(), way_out(reason))]
    File {
        /// What was tried: "write", "read", "create the folder".
        action: &'static str,
        /// The file or folder concerned.
        path: PathBuf,
        /// The reason that the operating system gave.
        reason: io::Error,
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
    #[error("there is no run in `{}` (no `checkpoints` folder); name the folder of a run", .0.display())]
    NoRun(PathBuf),
}

/// Whether a disk is full, or the user's part of it.
pub(crate) fn is_full(reason: &io::Error) -> bool {
    matches!(reason.kind(), ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge)
}

fn way_out(reason: &io::Error) -> &'static str {
    match is_full(reason) {
        true => "; free space there and repeat the command, or go on with a run by `meniscus resume DIR`",
        false => "; check the place and its permissions, or choose another one",
    }
}

impl OutputError {
    /// Wraps an error of the operating system with what was tried and where.
    pub(crate) fn file(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_path_buf();
        move |reason| Self::File { action, path, reason }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_disk_is_told_once_with_a_way_out() {
        let path = Path::new("series.csv");
        let error = |kind| OutputError::file("write", path)(io::Error::from(kind));
        let told = format!("{:?}", miette::Report::new(error(ErrorKind::StorageFull)));
        assert_eq!(told.matches("no storage space").count(), 1, "{told}");
        assert!(told.contains("free space") && told.contains("resume DIR"), "{told}");
        assert!(!error(ErrorKind::PermissionDenied).to_string().contains("free space"));
    }
}
