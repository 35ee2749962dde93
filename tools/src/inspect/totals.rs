//! Sums over all particles of a checkpoint.

use meniscus_engine::checkpoint::ColumnView;
use serde::Serialize;

use super::columns::column;

/// A number about the whole liquid.
#[derive(Debug, Serialize)]
pub struct Total {
    pub name: String,
    pub unit: String,
    pub value: f64,
}

/// Sums over the columns, as far as they are there.
pub fn totals(columns: &[ColumnView<'_>]) -> Vec<Total> {
    let column = |name| column(columns, name);
    let mut totals = Vec::new();
    let mut add = |name: &str, unit: &str, value| {
        totals.push(Total { name: name.to_owned(), unit: unit.to_owned(), value });
    };
    let Some(mass) = column("mass") else {
        return totals;
    };
    add("mass", "kg", mass.values().sum());
    if let (Some(radial), Some(axial)) = (column("velocity_r"), column("velocity_z")) {
        let momenta = mass.values().zip(axial.values());
        add("momentum z", "kg m/s", momenta.map(|(m, z)| m * z).sum());
        let motions = mass.values().zip(radial.values().zip(axial.values()));
        let energies = motions.map(|(m, (r, z))| 0.5 * m * (r * r + z * z));
        add("kinetic energy", "J", energies.sum());
    }
    totals
}
