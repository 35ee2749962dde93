//! Elapsed and processor time of parts of a run.

use std::time::{Duration, Instant};

/// What something has cost so far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stopwatch {
    /// Elapsed seconds.
    pub(super) wall: f64,
    /// Processor seconds of all threads.
    pub(super) cpu: f64,
}

impl Stopwatch {
    /// Does something and adds what it costs.
    pub(super) fn time<T>(&mut self, work: impl FnOnce() -> T) -> T {
        let (wall, cpu) = (Instant::now(), processor_time());
        let done = work();
        self.wall += wall.elapsed().as_secs_f64();
        self.cpu += processor_time().saturating_sub(cpu).as_secs_f64();
        done
    }
}

/// Processor time of all threads of this process since its start; zero where the system tells none.
pub(super) fn processor_time() -> Duration {
    #[cfg(unix)]
    {
        use rustix::time::{ClockId, clock_gettime};
        let time = clock_gettime(ClockId::ProcessCPUTime);
        Duration::new(u64::try_from(time.tv_sec).unwrap_or(0), u32::try_from(time.tv_nsec).unwrap_or(0))
    }
    #[cfg(not(unix))]
    Duration::ZERO
}
