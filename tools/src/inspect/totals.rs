//! Sums over all particles that physics watches, where the fields for them are there.

use meniscus_engine::checkpoint::ColumnView;
use serde::Serialize;

use super::statistics::Statistics;

/// A number about the whole liquid.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Total {
    pub name: &'static str,
    pub unit: String,
    pub value: f64,
}

/// Mass, axial momentum, kinetic energy and extents, as far as the fields allow.
pub fn totals(columns: &[ColumnView<'_>]) -> Vec<Total> {
    let column = |name| column(columns, name);
    let mut totals = Vec::new();
    let mut add = |name, unit: &str, value| {
        totals.push(Total { name, unit: unit.to_owned(), value });
    };
    if let Some(mass) = column("mass") {
        add("mass", mass.unit(), mass.values().sum());
        if let (Some(radial), Some(axial)) = (column("velocity_r"), column("velocity_z")) {
            let momenta = mass.values().zip(axial.values());
            add("momentum z", "kg m/s", momenta.map(|(m, z)| m * z).sum());
            let motions = mass.values().zip(radial.values().zip(axial.values()));
            let energies = motions.map(|(m, (r, z))| 0.5 * m * (r * r + z * z));
            add("kinetic energy", "J", energies.sum());
        }
    }
    for (coordinate, lowest, highest) in
        [("radius", "smallest r", "largest r"), ("axial", "smallest z", "largest z")]
    {
        let Some(column) = column(coordinate) else {
            continue;
        };
        let statistics = Statistics::of(column.values());
        for (name, value) in [(lowest, statistics.minimum), (highest, statistics.maximum)] {
            if let Some(value) = value {
                add(name, column.unit(), value);
            }
        }
    }
    totals
}

/// The column of a name.
pub fn column<'a>(columns: &[ColumnView<'a>], name: &str) -> Option<ColumnView<'a>> {
    columns.iter().copied().find(|column| column.name() == name)
}
