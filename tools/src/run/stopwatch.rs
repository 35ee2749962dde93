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
        let start = Moment::now();
        let done = work();
        let cost = start.elapsed();
        self.wall += cost.wall;
        self.cpu += cost.cpu;
        done
    }
}

/// A point in time, by the clock and by the processor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moment {
    wall: Instant,
    cpu: Duration,
}

impl Moment {
    /// The present one.
    pub(super) fn now() -> Self {
        Moment { wall: Instant::now(), cpu: processor_time() }
    }

    /// What has been spent since.
    pub(super) fn elapsed(&self) -> Stopwatch {
        Stopwatch {
            wall: self.wall.elapsed().as_secs_f64(),
            cpu: processor_time().saturating_sub(self.cpu).as_secs_f64(),
        }
    }
}

/// Processor time of all threads of this process since its start; zero where the system tells none.
fn processor_time() -> Duration {
    #[cfg(unix)]
    {
        use rustix::time::{ClockId, clock_gettime};
        let time = clock_gettime(ClockId::ProcessCPUTime);
        Duration::new(u64::try_from(time.tv_sec).unwrap_or(0), u32::try_from(time.tv_nsec).unwrap_or(0))
    }
    #[cfg(not(unix))]
    Duration::ZERO
}
