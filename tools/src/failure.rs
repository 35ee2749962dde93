//! Why a command could not do what it was asked for, and the exit code that tells.

use std::process::ExitCode;

use meniscus_cases::scene::Diagnosis;
use meniscus_cases::simulation::StartError;
use meniscus_engine::checkpoint::CheckpointError;

use crate::output::OutputError;

/// A command's end that is no success.
#[derive(Debug)]
pub(crate) struct Failure {
    report: miette::Report,
    code: u8,
}

/// What ran, but failed.
const FAILED: u8 = 1;
/// What other input would mend.
const BAD_INPUT: u8 = 2;
/// What somebody stopped.
pub(crate) const INTERRUPTED: u8 = 130;

impl Failure {
    /// Something that the user has to change.
    pub(crate) fn input(sentence: impl Into<String>) -> Self {
        Self::of(sentence.into(), BAD_INPUT)
    }

    /// Something that went wrong on the way.
    pub(crate) fn on_the_way(sentence: impl Into<String>) -> Self {
        Self::of(sentence.into(), FAILED)
    }

    /// A stop that somebody asked for.
    pub(crate) fn interrupted(sentence: impl Into<String>) -> Self {
        Self::of(sentence.into(), INTERRUPTED)
    }

    /// Whether somebody asked for it.
    pub(crate) fn is_interruption(&self) -> bool {
        self.code == INTERRUPTED
    }

    fn of(sentence: String, code: u8) -> Self {
        Failure { report: miette::Report::msg(sentence), code }
    }

    /// Says on standard error what is wrong.
    pub(crate) fn tell(&self) -> ExitCode {
        eprintln!("{:?}", self.report);
        ExitCode::from(self.code)
    }
}

impl From<Diagnosis> for Failure {
    fn from(diagnosis: Diagnosis) -> Self {
        Failure { report: miette::Report::new(diagnosis), code: BAD_INPUT }
    }
}

impl From<StartError> for Failure {
    fn from(error: StartError) -> Self {
        let code = match error {
            StartError::Packing(diagnosis) => return diagnosis.into(),
            StartError::Stopped => INTERRUPTED,
            StartError::Checkpoint(_) => BAD_INPUT,
            StartError::Wiring(_) | StartError::FirstState(_) => FAILED,
        };
        Self::of(error.to_string(), code)
    }
}

impl From<OutputError> for Failure {
    fn from(error: OutputError) -> Self {
        Failure { report: miette::Report::new(error), code: FAILED }
    }
}

impl From<CheckpointError> for Failure {
    fn from(error: CheckpointError) -> Self {
        Self::of(error.to_string(), FAILED)
    }
}
