//! What comes before the clock starts: the particles settle.

use meniscus_cases::simulation::{Settling, Simulation};

use super::checkpoints::Checkpoints;
use super::{INTERRUPTED, Run};
use crate::failure::Failure;

impl Run {
    /// Lets the particles settle. A signal to stop ends the process, after a checkpoint.
    pub(super) fn settle(&self, mut settling: Settling) -> Result<Simulation, Failure> {
        let unit = Simulation::capillary_time(&self.scene);
        let mut progress = self.progress(self.settling_time(), self.scene.until, "settling");
        let mut checkpoints = Checkpoints::of(&self.folder);
        let every = self.scene.output.checkpoint_every;
        while !settling.is_over() {
            let (stop, asked) = (self.signals.stop(), self.signals.take_checkpoint());
            let due = every > 0 && settling.steps() > 0 && settling.steps().is_multiple_of(every);
            if stop || asked || due || checkpoints.are_overdue() {
                checkpoints.write_settling(&settling, &self.scene)?;
            }
            if stop {
                checkpoints.finish()?;
                let folder = self.folder.path().display();
                eprintln!(
                    "interrupted while the particles settled; `meniscus resume {folder}` lets them go on"
                );
                std::process::exit(i32::from(INTERRUPTED));
            }
            if asked {
                checkpoints.finish()?;
                progress.message("checkpoint written while the particles settle");
            }
            let before = settling.time();
            settling.step()?;
            let done = settling.time();
            progress.update(settling.steps(), done * unit, (done - before) * unit);
        }
        checkpoints.finish()?;
        Ok(settling.finish(&self.scene)?)
    }
}
