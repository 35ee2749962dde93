//! The checkpoints of a run: handed to the system at once, brought to the disk while the run goes on.

use std::fs::File;
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use meniscus_cases::scene::Scene;
use meniscus_cases::simulation::Simulation;
use meniscus_engine::checkpoint;

use crate::failure::Failure;
use crate::output::OutputError;
use crate::output::folder::RunFolder;

/// Checkpoints that are kept.
const KEPT: usize = 3;
/// However few steps the scene asks for, no more time than this is lost when a machine dies.
const LONGEST_PAUSE: Duration = Duration::from_secs(600);

type Written = Result<(), Failure>;

/// Writes checkpoints, one at a time, on a thread of their own.
pub(super) struct Checkpoints {
    folder: RunFolder,
    pending: Option<JoinHandle<Written>>,
    last: Instant,
}

impl Checkpoints {
    /// The checkpoints of the run in a folder; the first one is due later.
    pub(super) fn of(folder: &RunFolder) -> Self {
        Checkpoints { folder: folder.clone(), pending: None, last: Instant::now() }
    }

    /// Whether the last one is so long ago that time would be lost.
    pub(super) fn are_overdue(&self) -> bool {
        self.last.elapsed() > LONGEST_PAUSE
    }

    /// Writes a checkpoint of a run and removes the oldest ones. The rows of the series that belong to
    /// it are on the disk first: a resumed run goes on with them.
    ///
    /// # Errors
    /// What went wrong with this checkpoint or the one before.
    pub(super) fn write(
        &mut self,
        (simulation, scene): (&Simulation, &Scene),
        series: Option<File>,
    ) -> Written {
        self.finish()?;
        let (folder, path) = (self.folder.checkpoints(), self.folder.series());
        let name = folder.join(checkpoint::file_name(simulation.world.clock.step));
        let unfinished = simulation.with_checkpoint(scene, |state| checkpoint::begin(&name, state))?;
        self.start(move || {
            series.map_or(Ok(()), |file| file.sync_data()).map_err(OutputError::file("write", &path))?;
            unfinished.finish()?;
            Ok(checkpoint::keep_last(&folder, KEPT)?)
        })
    }

    /// Waits until all that was to be written lies on the disk.
    ///
    /// # Errors
    /// What went wrong with it.
    pub(super) fn finish(&mut self) -> Written {
        match self.pending.take().map(JoinHandle::join) {
            None => Ok(()),
            Some(Ok(written)) => written,
            Some(Err(panic)) => std::panic::resume_unwind(panic),
        }
    }

    fn start(&mut self, work: impl FnOnce() -> Written + Send + 'static) -> Written {
        self.last = Instant::now();
        self.pending = Some(std::thread::spawn(work));
        Ok(())
    }
}

impl Drop for Checkpoints {
    fn drop(&mut self) {
        // A run that fails for another reason still leaves its last checkpoint whole.
        if let Some(pending) = self.pending.take() {
            let _ = pending.join();
        }
    }
}
