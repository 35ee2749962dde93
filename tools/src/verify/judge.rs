//! Runs against targets: one row for each measure of each run.

use serde::Serialize;

use super::catalogue::Case;
use crate::output::summary::{Status, Summary};
use crate::study::error::{Measured, measured};

/// One measure of one run.
#[derive(Clone, Debug, Serialize)]
pub(super) struct Row {
    pub(super) case: String,
    pub(super) resolution: f64,
    pub(super) measured: Measured,
    pub(super) target: Option<f64>,
    /// Whether the target was met; `None` where there is none.
    pub(super) met: Option<bool>,
    pub(super) paper_error: Option<f64>,
    /// Smallest error of another program.
    pub(super) code_error: Option<f64>,
    /// What that cost in core-seconds.
    pub(super) code_seconds: Option<f64>,
    pub(super) core_seconds: f64,
    pub(super) core_ns_per_particle_step: f64,
    pub(super) failure: Option<String>,
}

/// The rows of a run. A run that broke down, or lacks a measure, misses that measure's target.
pub(super) fn judge(case: &Case, resolution: f64, summary: &Summary) -> Vec<Row> {
    let done = summary.status == Some(Status::Done);
    let rows = case.measure.iter().map(|expectation| {
        let missing = Measured {
            name: expectation.name.clone(),
            value: f64::NAN,
            unit: String::new(),
            exact: None,
            error: None,
        };
        let measured = measured(summary, &expectation.name).unwrap_or(missing);
        let target = expectation.target_at(resolution);
        let error = measured.error.filter(|_| done);
        let met = target.map(|target| error.is_some_and(|error| error.abs() <= target));
        let best = expectation.best_code();
        Row {
            case: case.name.clone(),
            resolution,
            measured,
            target,
            // Whoever breaks down misses, target or not.
            met: if done { met } else { Some(false) },
            paper_error: expectation.paper_at(resolution),
            code_error: best.map(|(error, _)| error),
            code_seconds: best.map(|(_, seconds)| seconds),
            core_seconds: summary.cpu_seconds,
            core_ns_per_particle_step: summary.core_ns_per_particle_step,
            failure: summary.failure.clone(),
        }
    });
    rows.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::error::tests::fake;
    use crate::verify::catalogue::tests::example;

    #[test]
    fn targets_are_met_missed_or_absent() {
        let case = example();
        let met = |resolution, value| judge(&case, resolution, &fake("frequency", value, 10.0))[0].met;
        assert_eq!(met(12.0, 10.9), Some(true));
        assert_eq!(met(12.0, 8.9), Some(false));
        assert_eq!(met(25.0, 10.9), Some(false));
        assert_eq!(met(8.0, 20.0), None);
        assert_eq!(met(12.0, f64::NAN), Some(false));
        assert_eq!(judge(&case, 12.0, &fake("other", 1.0, 1.0))[0].met, Some(false));
    }

    #[test]
    fn a_run_that_broke_down_misses_all() {
        let mut summary = fake("frequency", 10.0, 10.0);
        summary.status = Some(Status::Failed);
        assert_eq!(judge(&example(), 8.0, &summary)[0].met, Some(false));
    }
}
