//! The columns that a scene's measures are made from.

use super::{bridge, film, flow, jet, large, observe::Quantity, spread, thread};
use crate::scene::Measure;

/// The name of the `index`-th of several equal ones: the first one stays plain.
pub fn numbered(name: &str, index: usize) -> String {
    match index {
        0 => name.to_owned(),
        _ => format!("{name}-{}", index + 1),
    }
}

/// Every measure with the number of those of its kind before it.
pub fn with_index(measures: &[Measure]) -> impl Iterator<Item = (&Measure, usize)> {
    measures.iter().enumerate().map(|(k, measure)| {
        let kind = std::mem::discriminant(measure);
        let before = measures[..k].iter();
        let same = before.filter(|other| std::mem::discriminant(*other) == kind);
        (measure, same.count())
    })
}

/// Plain names and SI units of the columns that a measure is made from.
fn names(measure: &Measure) -> &'static [(&'static str, &'static str)] {
    match measure {
        Measure::LaplacePressure { .. } => &[("core pressure", "Pa")],
        Measure::Oscillation { .. } => &[("mode amplitude", "1")],
        Measure::SpuriousVelocity { .. } => &[("spurious velocity", "1")],
        Measure::GrowthRate { .. } => &jet::COLUMNS,
        Measure::FilmRetraction { .. } => &film::COLUMNS,
        Measure::MomentumDrift | Measure::EnergyDrift | Measure::EnergyGain => &[],
        Measure::LargeOscillation { .. } => &large::COLUMNS,
        Measure::Spread { .. } => &spread::COLUMNS,
        Measure::Coalescence { .. } => &bridge::COLUMNS,
        Measure::PinchOff { .. } => &thread::COLUMNS,
        Measure::SemiAxis { .. } => &flow::SEMI_AXES,
        Measure::PlateauDensity { .. } => &flow::PLATEAU,
        Measure::ShockSpeed { .. } => &flow::SHOCK,
    }
}

/// The columns that the `index`-th measure of its kind is made from.
pub fn columns_of(measure: &Measure, index: usize) -> Vec<Quantity> {
    let quantity = |&(name, unit)| Quantity { name: numbered(name, index), unit };
    names(measure).iter().map(quantity).collect()
}
