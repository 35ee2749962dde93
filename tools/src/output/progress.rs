//! How far a run is: a bar on a terminal, plain lines anywhere else.

use std::io::{self, IsTerminal, Write};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::units::{duration, grouped, quantity};

/// Length of the bar in its own units: a tenth of a percent each.
const BAR_LENGTH: u64 = 1000;
/// Shortest time between two changes of the bar.
const REDRAW: Duration = Duration::from_millis(100);

/// What takes no longer needs no progress.
const SHORT: Duration = Duration::from_millis(500);

/// Progress of a run, shown on standard error.
pub struct Progress {
    /// Simulated seconds, or one.
    total: f64,
    /// Steps after which it ends in any case.
    steps: Option<u64>,
    started: Instant,
    first: Option<f64>,
    shown: Instant,
    shown_fraction: f64,
    what: String,
    later: f64,
    display: Display,
}

enum Display {
    Quiet,
    Bar(ProgressBar),
    Lines(Box<dyn Write + Send>),
}

impl Progress {
    /// Progress of `what` towards `total_time` (simulated seconds): a bar if
    /// standard error is a terminal, else a line now and then.
    pub fn new(total_time: f64, what: &str) -> Self {
        if !io::stderr().is_terminal() {
            return Self::to_writer(total_time, what, Box::new(io::stderr()));
        }
        let bar = ProgressBar::new(BAR_LENGTH);
        if let Ok(style) = ProgressStyle::with_template("{prefix} {bar:30.cyan/white.dim} {msg}") {
            bar.set_style(style.progress_chars("━╸━"));
        }
        bar.set_prefix(what.to_owned());
        Self::with(total_time, what, Display::Bar(bar))
    }

    /// Progress of something that has no simulated time.
    pub fn of_part(what: &str) -> Self {
        Self::new(1.0, what)
    }

    /// Progress as plain lines to any writer.
    pub fn to_writer(total_time: f64, what: &str, writer: Box<dyn Write + Send>) -> Self {
        Self::with(total_time, what, Display::Lines(writer))
    }

    /// The same, where it ends after some steps, counted from the start of the run, if that comes first.
    pub fn within(mut self, steps: Option<u64>) -> Self {
        self.steps = steps;
        self
    }

    /// The same, where more follows: `later` times this work. The time left is then that of all.
    pub fn followed_by(mut self, later: f64) -> Self {
        self.later = later;
        self
    }

    /// Progress that shows nothing, not even messages.
    pub fn quiet() -> Self {
        Self::with(1.0, "", Display::Quiet)
    }

    fn with(total: f64, what: &str, display: Display) -> Self {
        let now = Instant::now();
        Self {
            total,
            steps: None,
            started: now,
            first: None,
            shown: now,
            shown_fraction: 0.0,
            what: what.to_owned(),
            later: 0.0,
            display,
        }
    }

    /// Tells that `step` steps are done, up to the simulated `time`, the last
    /// of size `step_size` (both in seconds). Cheap enough for every step.
    pub fn update(&mut self, step: u64, time: f64, step_size: f64) {
        let (mut done, mut last) = (time / self.total, step_size / self.total);
        if let Some(steps) = self.steps.filter(|steps| step as f64 / *steps as f64 > done) {
            (done, last) = (step as f64 / steps as f64, 1.0 / steps as f64);
        }
        self.show(done, last, || {
            let (time, step_size) = (quantity(time, "s", 4), quantity(step_size, "s", 3));
            format!("t = {time}  dt = {step_size}  step {}  ", grouped(step))
        });
    }

    /// Tells which part is done, from 0 to 1, where [`Self::of_part`] began. What is over at once shows nothing.
    pub fn update_part(&mut self, part: f64) {
        if self.started.elapsed() >= SHORT {
            self.show(part, part, String::new);
        }
    }

    /// Shows that the part `done` is done, `last` of it since the call before, and what more is to be said.
    fn show(&mut self, done: f64, last: f64, what: impl FnOnce() -> String) {
        // A resumed run starts late: only what it has done itself tells its pace.
        let first = *self.first.get_or_insert(done - last);
        let fraction = done.clamp(0.0, 1.0);
        let since_shown = self.shown.elapsed();
        let due = match self.display {
            Display::Quiet => false,
            Display::Bar(_) => since_shown >= REDRAW,
            Display::Lines(_) => is_due(since_shown, self.shown_fraction, fraction),
        };
        if !due {
            return;
        }
        self.shown = Instant::now();
        self.shown_fraction = fraction;
        let elapsed = self.started.elapsed().as_secs_f64();
        let to_do = (1.0 - done).max(0.0) + self.later;
        let left = elapsed * to_do / (done - first);
        let state = format!(
            "{:3.0} %  {}{} left{}",
            (fraction * 100.0).floor(),
            what(),
            remaining(left),
            if self.later > 0.0 { " in all" } else { "" },
        );
        match &mut self.display {
            Display::Quiet => {}
            Display::Bar(bar) => {
                bar.set_position((fraction * BAR_LENGTH as f64) as u64);
                bar.set_message(state);
            }
            Display::Lines(writer) => write_line(writer, &format!("{}: {state}", self.what)),
        }
    }

    /// Says something beside the progress, on a line of its own.
    pub fn message(&mut self, text: &str) {
        match &mut self.display {
            Display::Quiet => {}
            Display::Bar(bar) => bar.suspend(|| eprintln!("{text}")),
            Display::Lines(writer) => write_line(writer, text),
        }
    }

    /// Takes the progress off the screen. Dropping it does the same.
    pub fn finish(self) {}
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Display::Bar(bar) = &self.display {
            bar.finish_and_clear();
        }
    }
}

/// An estimate, so whole seconds do.
fn remaining(seconds: f64) -> String {
    match seconds {
        0.0..100.0 => format!("{seconds:.0} s"),
        _ if seconds.is_finite() => duration(seconds),
        _ => "?".to_owned(),
    }
}

/// Whether a line is due, so long after the last, when the fraction done has
/// grown from one value to another: at every tenth, and between tenths at a
/// pace that a reader can follow.
fn is_due(since_shown: Duration, from: f64, to: f64) -> bool {
    (to * 10.0).floor() > (from * 10.0).floor()
        || (since_shown >= Duration::from_secs(2) && to - from >= 0.01)
        || since_shown >= Duration::from_secs(60)
}

/// A reader that went away is no reason to stop a run.
fn write_line(writer: &mut impl Write, line: &str) {
    let _ = writeln!(writer, "{line}").and_then(|()| writer.flush());
}

#[cfg(test)]
mod tests {
    use std::sync::{Arc, Mutex};

    use super::*;

    #[derive(Clone, Default)]
    struct Shared(Arc<Mutex<Vec<u8>>>);

    impl Write for Shared {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.lock().unwrap().write(bytes)
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_fast_run_prints_a_line_each_tenth() {
        let shared = Shared::default();
        let mut progress = Progress::to_writer(1e-4, "droplet", Box::new(shared.clone()));
        for step in 1..=1000 {
            progress.update(step, step as f64 / 1000.0 * 1e-4, 1e-7);
        }
        progress.message("checkpoint written");
        progress.finish();
        let text = String::from_utf8(shared.0.lock().unwrap().clone()).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 11, "{text}");
        let expected = "droplet:  50 %  t = 50.00 µs  dt = 100 ns  step 500  0 s left";
        assert_eq!(lines[4], expected, "{text}");
        assert_eq!(lines.last(), Some(&"checkpoint written"));
    }

    #[test]
    fn the_nearer_end_counts() {
        let shared = Shared::default();
        let mut progress = Progress::to_writer(1.0, "droplet", Box::new(shared.clone())).within(Some(10));
        progress.update(5, 1e-6, 1e-7);
        progress.update(6, 0.9, 0.1);
        let text = String::from_utf8(shared.0.lock().unwrap().clone()).unwrap();
        let parts: Vec<&str> = text.lines().map(|line| &line[9..15]).collect();
        assert_eq!(parts, [" 50 % ", " 90 % "], "{text}");
    }

    #[test]
    fn lines_are_neither_too_many_nor_too_few() {
        let seconds = Duration::from_secs_f64;
        assert!(!is_due(seconds(0.1), 0.11, 0.19));
        assert!(is_due(seconds(0.0), 0.19, 0.2));
        assert!(!is_due(seconds(5.0), 0.11, 0.111));
        assert!(is_due(seconds(2.5), 0.11, 0.13));
        assert!(is_due(seconds(61.0), 0.11, 0.11));
    }

    #[test]
    fn quiet_is_quiet_and_odd_numbers_do_no_harm() {
        let mut progress = Progress::quiet();
        progress.update(1, 0.5, 0.1);
        progress.message("nothing");
        let mut progress = Progress::to_writer(0.0, "odd", Box::new(io::sink()));
        progress.update(1, f64::NAN, f64::NAN);
        progress.update(2, 1.0, 0.0);
    }
}
