//! Simulated time and the choice of the time step.

use std::borrow::Cow;

/// An upper bound on the time step and who stated it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// Why the step may not be longer, for example "acoustic".
    pub reason: &'static str,
    /// Longest stable step in seconds.
    pub step_size: f64,
}

/// Simulated time. Stages state their bounds during a step; the smallest one is taken.
#[derive(Clone, Debug)]
pub struct Clock {
    /// Steps taken.
    pub step: u64,
    /// Time at the start of the present step, in seconds.
    pub time: f64,
    /// The last step taken, in seconds; zero before the first.
    pub previous_step_size: f64,
    bound: Option<Bound>,
    stated: Vec<Bound>,
    counts: Vec<(Cow<'static, str>, u64)>,
    numbers: Vec<(Cow<'static, str>, f64)>,
}

impl Default for Clock {
    fn default() -> Self {
        Clock::at(0, 0.0, 0.0)
    }
}

impl Clock {
    /// A clock that continues from a checkpoint.
    pub fn at(step: u64, time: f64, previous_step_size: f64) -> Self {
        Clock {
            step,
            time,
            previous_step_size,
            bound: None,
            stated: Vec::with_capacity(8),
            counts: Vec::with_capacity(8),
            numbers: Vec::with_capacity(16),
        }
    }

    /// States that the present step may not be longer than `step_size` seconds.
    pub fn limit(&mut self, reason: &'static str, step_size: f64) {
        let bound = Bound { reason, step_size };
        match self.stated.iter_mut().find(|stated| stated.reason == reason) {
            Some(stated) => *stated = bound,
            None => self.stated.push(bound),
        }
        let smaller = self.bound.is_none_or(|b| step_size < b.step_size || step_size.is_nan());
        if smaller {
            self.bound = Some(bound);
        }
    }

    /// The tightest bound stated in this step so far.
    pub fn bound(&self) -> Option<Bound> {
        self.bound
    }

    /// What each reason for a bound stated last.
    pub fn stated(&self) -> &[Bound] {
        &self.stated
    }

    /// Ends the step: time moves on by the tightest bound.
    ///
    /// # Panics
    /// If no stage of the pipeline stated a bound, which is a mistake in the pipeline.
    pub fn advance(&mut self) {
        let bound = self.bound.take().expect("a stage of the pipeline bounds the time step");
        match self.counts.iter_mut().find(|(reason, _)| *reason == bound.reason) {
            Some((_, count)) => *count += 1,
            None => self.counts.push((Cow::Borrowed(bound.reason), 1)),
        }
        self.time += bound.step_size;
        self.previous_step_size = bound.step_size;
        self.step += 1;
    }

    /// How many steps as long as the last one take no longer than `longest` seconds: the fewest times a power of two, and no
    /// more than the most, whatever the fewest take.
    pub fn steps_within(&self, longest: f64, [fewest, most]: [u64; 2]) -> u64 {
        let mut steps = fewest;
        while steps < most && 2.0 * steps as f64 * self.previous_step_size < longest {
            steps *= 2;
        }
        steps
    }

    /// Sets a number of the whole scene. It is part of the state: a checkpoint carries it.
    pub fn set_number(&mut self, name: &'static str, value: f64) {
        self.restore_number(Cow::Borrowed(name), value);
    }

    /// Sets a number of any name, from a checkpoint.
    pub fn restore_number(&mut self, name: Cow<'static, str>, value: f64) {
        match self.numbers.iter_mut().find(|(known, _)| *known == name) {
            Some((_, number)) => *number = value,
            None => self.numbers.push((name, value)),
        }
    }

    /// A number of the whole scene, if one of that name was set.
    pub fn known(&self, name: &str) -> Option<f64> {
        self.numbers.iter().find(|(known, _)| known == name).map(|(_, number)| *number)
    }

    /// A number of the whole scene; zero if none of that name was set.
    pub fn number(&self, name: &str) -> f64 {
        self.known(name).unwrap_or(0.0)
    }

    /// All numbers of the whole scene.
    pub fn numbers(&self) -> &[(Cow<'static, str>, f64)] {
        &self.numbers
    }

    /// Notes the present time under a name, for example when something was last computed.
    pub fn set_mark(&mut self, name: &'static str) {
        self.set_number(name, self.time);
    }

    /// The time in seconds that was noted under a name; the present time if none was.
    pub fn mark(&self, name: &str) -> f64 {
        self.known(name).unwrap_or(self.time)
    }

    /// How many steps each bound has set since the run began.
    pub fn bounds_met(&self) -> &[(Cow<'static, str>, u64)] {
        &self.counts
    }

    /// Sets how many steps a bound has set so far, from a checkpoint.
    pub fn restore_bound(&mut self, reason: &str, steps: u64) {
        self.counts.push((Cow::Owned(reason.to_owned()), steps));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_many_steps_as_a_time_takes() {
        let clock = Clock::at(0, 0.0, 1.0);
        let steps = [1.0, 39.0, 41.0, 100.0, 161.0, 1e9, f64::INFINITY, f64::NAN]
            .map(|longest| clock.steps_within(longest, [20, 160]));
        assert_eq!(steps, [20, 20, 40, 80, 160, 160, 160, 20]);
    }
}
