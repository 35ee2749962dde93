//! How far a measure is from what is exact, and how fast it gets nearer.

use crate::output::summary::Summary;
use crate::output::units::quantity;

/// A measured number with its error.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub(crate) struct Measured {
    /// What was measured.
    pub(crate) name: String,
    /// The value in `unit`.
    pub(crate) value: f64,
    /// SI unit; empty for a plain number.
    pub(crate) unit: String,
    /// The exact value, if there is one.
    pub(crate) exact: Option<f64>,
    /// Relative to the exact value; the value itself where zero is exact.
    pub(crate) error: Option<f64>,
}

impl Measured {
    /// The value with its unit.
    pub(crate) fn shown(&self) -> String {
        match self.value.is_nan() {
            true => "not reached".to_owned(),
            false => quantity(self.value, &self.unit, 4),
        }
    }
}

/// Changes of conserved quantities, which count as measures whose exact value is zero.
const DRIFTS: [&str; 3] = ["momentum-drift", "energy-drift", "mass-drift"];

/// A measure of a run by its name, if the run has it.
pub(crate) fn measured(summary: &Summary, name: &str) -> Option<Measured> {
    let found = summary.measures.iter().find(|measure| measure.name == name);
    if let Some(measure) = found {
        let value = measure.value;
        let absolute = (measure.reference == Some(0.0) && value.is_finite()).then_some(value);
        return Some(Measured {
            name: name.to_owned(),
            value,
            unit: measure.unit.clone(),
            exact: measure.reference,
            error: measure.relative_error.or(absolute),
        });
    }
    let kept = &summary.conservation;
    let drifts = [kept.momentum_z, kept.energy, kept.mass];
    let (_, value) = DRIFTS.iter().zip(drifts).find(|(drift, _)| **drift == name)?;
    let error = value.is_finite().then_some(value);
    Some(Measured { name: name.to_owned(), value, unit: String::new(), exact: Some(0.0), error })
}

/// Order p of errors that fall as size^p: the slope of their logarithms by least squares, from
/// pairs of size and error. `None` with fewer than two sizes.
pub(crate) fn order(points: &[(f64, f64)]) -> Option<f64> {
    let logarithms: Vec<(f64, f64)> = (points.iter())
        .map(|(size, error)| (size.ln(), error.abs().ln()))
        .filter(|(size, error)| size.is_finite() && error.is_finite())
        .collect();
    let count = logarithms.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| logarithms.iter().map(of).sum::<f64>() / count;
    let (x, y) = (mean(|point| point.0), mean(|point| point.1));
    let squares: f64 = logarithms.iter().map(|point| (point.0 - x).powi(2)).sum();
    let products: f64 = logarithms.iter().map(|point| (point.0 - x) * (point.1 - y)).sum();
    (squares > 1e-12).then(|| products / squares)
}

/// What an order of convergence means, in words.
pub(crate) fn order_in_words(name: &str, order: f64) -> String {
    if order > 0.1 {
        format!("{name}: the error falls with order {order:.1}.")
    } else {
        format!("{name}: the error does not fall with the resolution.")
    }
}

/// An error in percent, or as a power of ten where it is an absolute one far from percents.
pub(crate) fn percent(error: f64) -> String {
    let percent = 100.0 * error;
    if percent == 0.0 {
        return "0 %".to_owned();
    }
    match percent.abs() {
        10.0.. => format!("{percent:+.0} %"),
        1.0.. => format!("{percent:+.1} %"),
        0.1.. => format!("{percent:+.2} %"),
        0.01.. => format!("{percent:+.3} %"),
        size if size.is_finite() => format!("{error:+.1e}"),
        _ => "?".to_owned(),
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    #[test]
    fn what_was_not_reached_is_told_in_words() {
        let mut summary = fake("frequency", f64::NAN, 1.0);
        assert_eq!(measured(&summary, "frequency").unwrap().shown(), "not reached");
        summary.measures[0].value = 1.5;
        assert_eq!(measured(&summary, "frequency").unwrap().shown(), "1.500 Hz");
    }
    use crate::output::summary::{Conservation, Measure, Status};

    /// A summary with one measure against an exact value.
    pub(crate) fn fake(name: &str, value: f64, reference: f64) -> Summary {
        let relative_error = (reference != 0.0).then(|| (value - reference) / reference);
        let measure = Measure {
            name: name.to_owned(),
            value,
            unit: "Hz".to_owned(),
            reference: Some(reference),
            relative_error,
        };
        Summary {
            scene: "fake".to_owned(),
            status: Some(Status::Done),
            failure: None,
            particles: 100,
            first_particles: 100,
            steps: 10,
            time: 1.0,
            wall_seconds: 1.0,
            cpu_seconds: 2.0,
            threads: 2,
            ns_per_particle_step: 500.0,
            core_ns_per_particle_step: 1000.0,
            mixed_precision: false,
            step_bounds: Vec::new(),
            stages: Vec::new(),
            profile: None,
            measures: vec![measure],
            conservation: Conservation { momentum_z: 1e-14, energy: f64::NAN, mass: 0.0 },
            version: String::new(),
        }
    }

    #[test]
    fn errors_are_relative_unless_zero_is_exact() {
        assert_eq!(measured(&fake("a", 11.0, 10.0), "a").unwrap().error, Some(0.1));
        assert_eq!(measured(&fake("a", 0.02, 0.0), "a").unwrap().error, Some(0.02));
        assert_eq!(measured(&fake("a", f64::NAN, 0.0), "a").unwrap().error, None);
        assert_eq!(measured(&fake("a", 1.0, 1.0), "b"), None);
    }

    #[test]
    fn drifts_are_measures() {
        let summary = fake("a", 1.0, 1.0);
        assert_eq!(measured(&summary, "momentum-drift").unwrap().error, Some(1e-14));
        assert_eq!(measured(&summary, "energy-drift").unwrap().error, None);
    }

    #[test]
    fn the_order_is_the_slope() {
        let points = [(1.0, -4.0), (0.5, 1.0), (0.25, 0.25)];
        assert!((order(&points).unwrap() - 2.0).abs() < 1e-12);
        assert_eq!(order(&points[..1]), None);
        assert_eq!(order(&[(1.0, 0.0), (2.0, f64::NAN)]), None);
    }

    #[test]
    fn percents_have_the_digits_they_need() {
        assert_eq!(percent(0.123), "+12 %");
        assert_eq!(percent(-0.0012), "-0.12 %");
        assert_eq!(percent(3e-14), "+3.0e-14");
    }
}
