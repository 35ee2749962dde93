//! The named choices of the method.

use super::values::Choice;
pub use meniscus_stages::correction::Recoil;
pub use meniscus_stages::record::Precision;

/// Weights of the pair sums in r.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scheme {
    /// Harmonic means of the two radii.
    HarmonicMean,
    /// Parshikov's form.
    Parshikov,
}

/// What happens next to the axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AxisTreatment {
    /// Momentum and energy stay conserved.
    Conservative,
    /// The paper's switch to Parshikov's scheme.
    Parshikov,
}

/// States that the Riemann problem of a pair starts from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flux {
    /// Reconstructed at the midpoint.
    Reconstructed,
    /// The particles' own.
    FirstOrder,
}

/// How the clock advances.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeIntegration {
    /// Two-step Adams-Bashforth.
    AdamsBashforth,
    /// The paper's one-step method.
    Euler,
}

/// How the curvature of the surface is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Curvature {
    /// From a smoothed colour field.
    ColourField,
    /// The paper's divergence of the normals.
    NormalDivergence,
}

/// Pressure that forces are measured from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ReferencePressure {
    /// One for each drop, a connected body of liquid.
    Drop,
    /// None.
    None,
}

impl Choice for Scheme {
    const NAMES: &'static [(&'static str, Self)] =
        &[("harmonic-mean", Self::HarmonicMean), ("parshikov", Self::Parshikov)];
}

impl Choice for AxisTreatment {
    const NAMES: &'static [(&'static str, Self)] =
        &[("conservative", Self::Conservative), ("parshikov", Self::Parshikov)];
}

impl Choice for Flux {
    const NAMES: &'static [(&'static str, Self)] =
        &[("reconstructed", Self::Reconstructed), ("first-order", Self::FirstOrder)];
}

impl Choice for TimeIntegration {
    const NAMES: &'static [(&'static str, Self)] =
        &[("adams-bashforth", Self::AdamsBashforth), ("euler", Self::Euler)];
}

impl Choice for Curvature {
    const NAMES: &'static [(&'static str, Self)] =
        &[("colour-field", Self::ColourField), ("normal-divergence", Self::NormalDivergence)];
}

impl Choice for Recoil {
    const NAMES: &'static [(&'static str, Self)] =
        &[("drop", Self::Drop), ("whole", Self::Whole), ("none", Self::None)];
}

impl Choice for ReferencePressure {
    const NAMES: &'static [(&'static str, Self)] = &[("drop", Self::Drop), ("none", Self::None)];
}

impl Choice for Precision {
    const NAMES: &'static [(&'static str, Self)] = &[("double", Self::Double), ("mixed", Self::Mixed)];
}
