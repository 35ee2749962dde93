//! What `run --profile` adds to a summary.

use serde::{Deserialize, Serialize};

use super::StageCost;

/// How fast the stages of a run were.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Profile {
    /// Every stage of a step, and what came before and between the steps.
    pub stages: Vec<StageProfile>,
}

/// How fast one stage was.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StageProfile {
    /// What every summary tells of it.
    #[serde(flatten)]
    pub cost: StageCost,
    /// The part of the elapsed time in which each thread worked on chunks of particles, in a sample of the
    /// steps; empty where there are no chunks.
    pub busy: Vec<f64>,
    /// Longest busy time of a thread over the mean of all threads, in the mean over the calls; 1 is even.
    pub imbalance: Option<f64>,
    /// What a pair pass evaluates and moves.
    pub pairs: Option<PairSpeed>,
}

/// The speed of a pair pass. A pair counts from both its sides, and so do the entries that fill a list of
/// neighbours up to its block of eight particles.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PairSpeed {
    /// Evaluated pairs of a particle in a step.
    pub per_particle_step: f64,
    /// Evaluated pairs in a nanosecond, all threads together.
    pub per_nanosecond: f64,
    /// Loaded and stored: for each pair a neighbour's number and packed rows, for each particle its rows and
    /// results. Caches serve most of it.
    pub gigabytes_per_second: f64,
    /// Thousands of millions of floating-point operations on pairs in a second. A fused multiplication and
    /// addition counts as two.
    pub gigaflops: f64,
}
