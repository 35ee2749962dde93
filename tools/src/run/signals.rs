//! Signals: a clean stop, and a checkpoint on the way.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use crate::failure::INTERRUPTED;

/// What the user has asked for since the run began.
#[derive(Clone)]
pub(crate) struct Signals {
    stop: Arc<AtomicBool>,
    checkpoint: Arc<AtomicBool>,
}

impl Signals {
    /// From now on signals are noted. A second SIGINT or SIGTERM ends the process at once.
    pub(super) fn listen() -> io::Result<Self> {
        let signals = Signals { stop: Arc::default(), checkpoint: Arc::default() };
        for signal in [SIGINT, SIGTERM] {
            // First in line, so that it sees the flag as the signal before left it.
            let status = i32::from(INTERRUPTED);
            flag::register_conditional_shutdown(signal, status, Arc::clone(&signals.stop))?;
            flag::register(signal, Arc::clone(&signals.stop))?;
        }
        #[cfg(unix)]
        flag::register(signal_hook::consts::SIGUSR1, Arc::clone(&signals.checkpoint))?;
        Ok(signals)
    }

    /// Whether the run is to stop.
    pub(crate) fn stop(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Whether a checkpoint was asked for since the last call.
    pub(super) fn take_checkpoint(&self) -> bool {
        self.checkpoint.swap(false, Ordering::Relaxed)
    }
}
