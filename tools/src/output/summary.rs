//! `summary.json`: the machine-readable result of a run, and its table for
//! people.

use std::io::Write;
use std::path::Path;

use serde::{Deserialize, Deserializer, Serialize};

use super::atomic::{read_text, write_atomic};
use super::{OutputError, OutputResult};
pub use profile::{PairSpeed, Profile, StageProfile};
pub use table::print_table;

mod profile;
mod table;

/// What a run did, what it measured and what it cost. SI units throughout; a
/// number that is not finite is `null` in the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Name of the scene.
    pub scene: String,
    /// How the run ended; absent in summaries of verifications.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub status: Option<Status>,
    /// Why it failed, in a sentence.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
    /// Number of particles at the end: some may have been split, and others merged.
    pub particles: u64,
    /// Number of particles at the start of the run; zero where it is not known.
    #[serde(default)]
    pub first_particles: u64,
    /// Number of steps done.
    pub steps: u64,
    /// Simulated time in seconds.
    #[serde(deserialize_with = "number")]
    pub time: f64,
    /// Elapsed time in seconds.
    #[serde(deserialize_with = "number")]
    pub wall_seconds: f64,
    /// Processor time of all threads in seconds.
    #[serde(deserialize_with = "number")]
    pub cpu_seconds: f64,
    /// Number of threads.
    pub threads: usize,
    /// Elapsed nanoseconds per particle and step; no number where no step was taken.
    #[serde(deserialize_with = "number")]
    pub ns_per_particle_step: f64,
    /// Processor nanoseconds of all threads per particle and step.
    #[serde(deserialize_with = "number")]
    pub core_ns_per_particle_step: f64,
    /// Whether pairs were summed in single precision.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub mixed_precision: bool,
    /// How many steps each bound of the time step has set.
    #[serde(default)]
    pub step_bounds: Vec<(String, u64)>,
    /// What each stage cost.
    pub stages: Vec<StageCost>,
    /// How fast each stage was, where the run was asked for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub profile: Option<Profile>,
    /// What was measured, against what is exact.
    pub measures: Vec<Measure>,
    /// How well the conserved quantities were kept.
    pub conservation: Conservation,
    /// Version of the program, and the instruction set that it was built for.
    pub version: String,
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// It reached its end.
    Done,
    /// It broke down or missed its verification.
    Failed,
    /// It was stopped after a clean checkpoint.
    Interrupted,
}

impl Status {
    /// The word for it in files.
    pub fn word(self) -> &'static str {
        match self {
            Status::Done => "done",
            Status::Failed => "failed",
            Status::Interrupted => "interrupted",
        }
    }
}

/// The cost of one stage of the step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StageCost {
    /// Name of the stage.
    pub name: String,
    /// How often it ran.
    pub calls: u64,
    /// Elapsed time in seconds, all calls together.
    #[serde(deserialize_with = "number")]
    pub seconds: f64,
    /// The same in nanoseconds per particle and step.
    #[serde(deserialize_with = "number")]
    pub ns_per_particle_step: f64,
    /// Its part of the whole run, from 0 to 1.
    #[serde(deserialize_with = "number")]
    pub share: f64,
}

/// One measured quantity, against its exact value where there is one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measure {
    /// What was measured.
    pub name: String,
    /// The measured value in `unit`.
    #[serde(deserialize_with = "number")]
    pub value: f64,
    /// SI unit; empty for a plain number.
    pub unit: String,
    /// The exact value, if known.
    pub reference: Option<f64>,
    /// (value - reference) / reference, if known.
    pub relative_error: Option<f64>,
}

/// Relative changes of conserved quantities from start to end.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Conservation {
    /// Axial momentum, relative to the sum of its magnitudes.
    #[serde(deserialize_with = "number")]
    pub momentum_z: f64,
    /// Total energy.
    #[serde(deserialize_with = "number")]
    pub energy: f64,
    /// Mass.
    #[serde(deserialize_with = "number")]
    pub mass: f64,
}

/// JSON has no word for a number that is not finite; it is written as `null`.
fn number<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::deserialize(deserializer)?.unwrap_or(f64::NAN))
}

impl Summary {
    /// Writes the summary as JSON, all of it or nothing.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&self, path: &Path) -> OutputResult<()> {
        write_atomic(path, |file| {
            serde_json::to_writer_pretty(&mut *file, self)?;
            file.write_all(b"\n")
        })
    }

    /// Reads a summary back.
    ///
    /// # Errors
    /// When the file is missing or no summary; the sentence names the place.
    pub fn read(path: &Path) -> OutputResult<Self> {
        let text = read_text(path)?;
        serde_json::from_str(&text)
            .map_err(|error| OutputError::content(path, format!("no summary of a run: {error}")))
    }
}

#[cfg(test)]
pub(in crate::output) mod tests {
    use super::*;
    use std::fs;

    pub(in crate::output) fn example() -> Summary {
        let stage = |name: &str, seconds: f64| StageCost {
            name: name.to_owned(),
            calls: 12_000,
            seconds,
            ns_per_particle_step: seconds * 1e9 / (36_000.0 * 12_000.0),
            share: seconds / 20.0,
        };
        Summary {
            scene: "droplet_oscillation".to_owned(),
            status: Some(Status::Done),
            failure: None,
            particles: 36_000,
            first_particles: 36_000,
            steps: 12_000,
            time: 1.25e-4,
            wall_seconds: 20.0,
            cpu_seconds: 160.0,
            threads: 8,
            ns_per_particle_step: 46.3,
            core_ns_per_particle_step: 370.4,
            mixed_precision: true,
            step_bounds: vec![("acoustic".to_owned(), 1000)],
            stages: vec![
                stage("integrate", 2.0),
                stage("pair pass: density rate, riemann pressure, energy rate", 14.0),
                stage("neighbours", 4.0),
            ],
            profile: None,
            measures: vec![
                Measure {
                    name: "period".to_owned(),
                    value: 3.142e-5,
                    unit: "s".to_owned(),
                    reference: Some(3.125e-5),
                    relative_error: Some(0.00544),
                },
                Measure {
                    name: "largest overshoot of the pressure anywhere".to_owned(),
                    value: 1234.0,
                    unit: "Pa".to_owned(),
                    reference: None,
                    relative_error: None,
                },
            ],
            conservation: Conservation { momentum_z: 3e-17, energy: -1.2e-3, mass: 0.0 },
            version: "0.1.0 (AVX2)".to_owned(),
        }
    }

    #[test]
    fn the_file_comes_back_and_keeps_its_contract() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("summary.json");
        let mut summary = example();
        summary.write(&path).unwrap();
        assert_eq!(Summary::read(&path).unwrap(), summary);
        let text = fs::read_to_string(&path).unwrap();
        let json: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(json["status"], "done");
        assert!(json["measures"][1]["reference"].is_null());
        assert_eq!(json["conservation"]["momentum_z"], 3e-17);
        assert!(json.get("failure").is_none());
        summary.conservation.energy = f64::NAN;
        summary.write(&path).unwrap();
        assert!(Summary::read(&path).unwrap().conservation.energy.is_nan());
        fs::write(&path, "{}").unwrap();
        let error = Summary::read(&path).unwrap_err().to_string();
        assert!(error.contains("missing field `scene`"), "{error}");
    }
}
