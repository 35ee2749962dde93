//! The numerical choices of a scene.

use super::choices::{
    AxisTreatment, Curvature, Flux, Precision, Recoil, ReferencePressure, Scheme, TimeIntegration,
};
use super::diagnosis::Fault;
use super::entry::Entry;
use super::quantity::{Kind, NUMBER};
use super::section::Section;

/// Every numerical choice.
#[derive(Debug, Clone, PartialEq)]
pub struct Method {
    /// Weights of the pair sums.
    pub scheme: Scheme,
    /// Treatment of the axis.
    pub axis: AxisTreatment,
    /// Width K of the zone next to the axis, in smoothing lengths; at least 1.
    pub axis_factor: f64,
    /// Smoothing length over the sum of two particles' sizes, between 0.4 and 1.5.
    pub theta: f64,
    /// States of the Riemann problems.
    pub flux: Flux,
    /// Whether the contacts of the first-order flux are those of shocks where the energy equation is solved and
    /// the liquid has no viscosity.
    pub shock_contacts: bool,
    /// Time integration.
    pub time_integration: TimeIntegration,
    /// Curvature estimate.
    pub curvature: Curvature,
    /// Most steps from one curvature estimate to the next; at least 1.
    pub curvature_interval: u64,
    /// Support of the colour field, in particle sizes; positive.
    pub colour_support: f64,
    /// Smoothing length of the paper's normals over the sum of two particles' sizes, between 0.4 and 3.
    pub normal_theta: f64,
    /// Pressure that forces are measured from.
    pub reference_pressure: ReferencePressure,
    /// Whether gradients are corrected to be exact for linear fields.
    pub kernel_correction: bool,
    /// Whether the pressure of tangential surface gradients is kept.
    pub tangential_pressure: bool,
    /// Whether the strain is corrected.
    pub strain_correction: bool,
    /// Threshold of the guard of the colour field, from 0 (off) to 1.
    pub colour_guard: f64,
    /// Over which particles the momentum is spread that surface forces would bring in.
    pub momentum_correction: Recoil,
    /// Coefficient of particle shifting, 0 for none; without a choice it is [`SHIFTING`] where there is
    /// surface tension, [`FREE_SHIFTING`] where there is none (less at large smoothing lengths), and none where the
    /// energy equation is solved.
    pub shifting: Option<f64>,
    /// Steps from one shift of the particles to the next, at least 1; without a choice it is [`SHIFTING_INTERVAL`] where
    /// there is surface tension, else 1.
    pub shifting_interval: Option<u64>,
    /// Courant number, above 0 and at most 0.6.
    pub cfl: f64,
    /// Precision of the pair sums; mixed only with the default weights.
    pub precision: Precision,
}

/// Largest Courant number: with it every case survives its hard variants. With .7 drops with 12 particles to the radius
/// throw off single ones at a hundred times the flow's speed; an impact at 200 + 200 m/s survives .8.
pub const LARGEST_COURANT: f64 = 0.6;

/// Least support of the colour field, in particle sizes: with less it sees single particles. The frequency of a drop with 35 to the
/// radius (`cases/oscillating-drop/scene.toml`) is off by 63, 9 and 5 % with 3, 4 and 5, and the fit leaves a third of the motion
/// or more; with 6 it is off by .005 %.
pub const LEAST_COLOUR_SUPPORT: f64 = 6.0;

/// Coefficient of particle shifting under surface tension: of 1, 2, 3 and 5 the one with which most fast
/// collisions of drops end well.
pub const SHIFTING: f64 = 3.0;

/// Steps from one shift to the next under surface tension, where few particles shift. An odd number: with two and four
/// they always shift in steps in which the surface is looked for as well, whose forces are then balanced for one moment of every
/// shift, and the momentum rate of films (five sizes of particles) is off by -.2 and -.5 % in the mean instead of -.03 with
/// one and -.06 with three. Of 16 long drops that swing the mean gains .12, .18 and .24 % of its energy with one, three and
/// five, 29 fast collisions gain .49, .37 and .55. A free spheroid, whose particles all shift, loses .081 of its energy with four
/// and .007 with one.
pub const SHIFTING_INTERVAL: u64 = 3;

/// Coefficient of particle shifting without surface tension: 3, 4 and 8 leave a free spheroid with 50 particles per
/// radius an error of .31, .34 and .53 % and take 1.4, .6 and .3 % of its energy in 7 s; none leaves 1.9 %.
pub const FREE_SHIFTING: f64 = 4.0;

/// Thetas up to which [`FREE_SHIFTING`] is whole, and from which on there is none: neighbours that are drawn out
/// into rows still see each other then, and a long spheroid wins up to 1 % of its energy by shifting with .6, 9 and 27 %
/// with .75 and 1 if it is whole there.
pub const FREE_SHIFTING_THETA: [f64; 2] = [0.5, 0.7];

impl Method {
    /// The measured defaults.
    pub fn defaults() -> Self {
        Self {
            scheme: Scheme::HarmonicMean,
            axis: AxisTreatment::Conservative,
            axis_factor: 2.0,
            theta: 0.5,
            flux: Flux::Reconstructed,
            shock_contacts: true,
            time_integration: TimeIntegration::AdamsBashforth,
            curvature: Curvature::ColourField,
            curvature_interval: 8,
            colour_support: 11.0,
            normal_theta: 1.5,
            reference_pressure: ReferencePressure::Drop,
            kernel_correction: true,
            tangential_pressure: true,
            strain_correction: true,
            colour_guard: 0.85,
            momentum_correction: Recoil::Drop,
            shifting: None,
            shifting_interval: None,
            cfl: 0.5,
            precision: Precision::Double,
        }
    }

    /// The widest support radius of a sum, in particle sizes: that of pairs, and `with_tension` those that find the
    /// surface and its curvature.
    pub fn widest_support(&self, with_tension: bool) -> f64 {
        let pairs = 4.0 * self.theta;
        if !with_tension {
            return pairs;
        }
        let by_normals = self.curvature == Curvature::NormalDivergence;
        let normals = if by_normals { 4.0 * self.normal_theta } else { 0.0 };
        let colour = if by_normals && self.colour_guard == 0.0 { 0.0 } else { self.colour_support };
        pairs.max(normals).max(colour)
    }

    /// The paper's own choices.
    pub fn paper() -> Self {
        Self {
            axis: AxisTreatment::Parshikov,
            flux: Flux::FirstOrder,
            shock_contacts: false,
            time_integration: TimeIntegration::Euler,
            curvature: Curvature::NormalDivergence,
            reference_pressure: ReferencePressure::None,
            kernel_correction: false,
            tangential_pressure: false,
            strain_correction: false,
            colour_guard: 0.0,
            momentum_correction: Recoil::Whole,
            shifting: Some(0.0),
            cfl: 0.3,
            ..Self::defaults()
        }
    }

    /// Reads the table of choices; what it leaves unset stays as in `base`.
    pub(super) fn read(entry: Entry<'_>, base: Self) -> Result<Self, Fault> {
        let table = Section::new(entry, &KEYS)?;
        let mut method = Self {
            scheme: table.read_or("scheme", base.scheme, |entry| entry.choice())?,
            axis: table.read_or("axis", base.axis, |entry| entry.choice())?,
            axis_factor: table.read_or("axis_factor", base.axis_factor, |entry| {
                let number = Kind { example: "2", ..NUMBER };
                entry.checked(number, "must be at least 1", |value| value >= 1.0)
            })?,
            theta: table.read_or("theta", base.theta, |entry| {
                entry.checked(NUMBER, "must lie between 0.4 and 1.5", |value| (0.4..=1.5).contains(&value))
            })?,
            flux: table.read_or("flux", base.flux, |entry| entry.choice())?,
            shock_contacts: table.read_or("shock_contacts", base.shock_contacts, |entry| entry.flag())?,
            time_integration: table
                .read_or("time_integration", base.time_integration, |entry| entry.choice())?,
            curvature: table.read_or("curvature", base.curvature, |entry| entry.choice())?,
            curvature_interval: table
                .read_or("curvature_interval", base.curvature_interval, |entry| entry.count(1))?,
            colour_support: table.read_or("colour_support", base.colour_support, |entry| {
                let number = Kind { example: "11", ..NUMBER };
                entry.checked(number, "must be at least 6", |value| value >= LEAST_COLOUR_SUPPORT)
            })?,
            normal_theta: table.read_or("normal_theta", base.normal_theta, |entry| {
                entry.checked(NUMBER, "must lie between 0.4 and 3", |value| (0.4..=3.0).contains(&value))
            })?,
            reference_pressure: table
                .read_or("reference_pressure", base.reference_pressure, |entry| entry.choice())?,
            kernel_correction: table
                .read_or("kernel_correction", base.kernel_correction, |entry| entry.flag())?,
            tangential_pressure: table
                .read_or("tangential_pressure", base.tangential_pressure, |entry| entry.flag())?,
            strain_correction: table
                .read_or("strain_correction", base.strain_correction, |entry| entry.flag())?,
            colour_guard: table.read_or("colour_guard", base.colour_guard, |entry| {
                entry.checked(NUMBER, "must lie between 0 (off) and 1", |value| (0.0..=1.0).contains(&value))
            })?,
            momentum_correction: table
                .read_or("momentum_correction", base.momentum_correction, |entry| entry.choice())?,
            shifting: table
                .read_or("shifting", base.shifting, |entry| entry.not_negative(NUMBER).map(Some))?,
            shifting_interval: table
                .read_or("shifting_interval", base.shifting_interval, |entry| entry.count(1).map(Some))?,
            cfl: table.read_or("cfl", base.cfl, |entry| {
                entry.checked(NUMBER, "must be above 0 and at most 0.6", |value| {
                    value > 0.0 && value <= LARGEST_COURANT
                })
            })?,
            precision: base.precision,
        };
        method.precision =
            table.read_or("precision", method.precision, |entry| method.checked_precision(entry))?;
        Ok(method)
    }

    /// Pairs of single precision are built for the default weights alone: each more takes long to build.
    fn checked_precision(&self, entry: Entry<'_>) -> Result<Precision, Fault> {
        let precision = entry.choice()?;
        let default = (self.scheme, self.axis) == (Scheme::HarmonicMean, AxisTreatment::Conservative);
        if precision == Precision::Mixed && !default {
            let message = "mixed precision knows neither Parshikov's scheme nor his treatment of the axis";
            let help = "leave method.precision at \"double\", or set method.scheme = \"harmonic-mean\" and \
                        method.axis = \"conservative\"";
            return Err(entry.fault(message, help));
        }
        Ok(precision)
    }
}

const KEYS: [&str; 21] = [
    "scheme",
    "axis",
    "axis_factor",
    "theta",
    "flux",
    "shock_contacts",
    "time_integration",
    "curvature",
    "curvature_interval",
    "colour_support",
    "normal_theta",
    "reference_pressure",
    "kernel_correction",
    "tangential_pressure",
    "strain_correction",
    "colour_guard",
    "momentum_correction",
    "shifting",
    "shifting_interval",
    "cfl",
    "precision",
];
