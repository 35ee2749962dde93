//! Columns of a checkpoint by name, and quantities that follow from them.

use std::f64::consts::PI;

use meniscus_cases::assemble::Physics;
use meniscus_cases::scene::Scene;
use meniscus_engine::checkpoint::{ColumnView, Mapped};

use super::failure::{Failure, known};
use super::open;

/// Quantities that no checkpoint needs to hold, with their units.
pub const FOLLOWING: [(&str, &str); 3] = [("speed", "m/s"), ("size", "m"), ("pressure", "Pa")];

/// Values of a field or of what follows from others, one a particle.
pub struct Quantity {
    pub name: String,
    pub unit: String,
    pub values: Vec<f64>,
}

/// The column of a name.
pub fn column<'a>(columns: &[ColumnView<'a>], name: &str) -> Option<ColumnView<'a>> {
    columns.iter().copied().find(|column| column.name() == name)
}

/// The values of a column that others build on.
pub fn values(columns: &[ColumnView<'_>], name: &str) -> Result<Vec<f64>, Failure> {
    let column = column(columns, name).ok_or_else(|| unknown(columns, name))?;
    Ok(column.values().collect())
}

/// A quantity by its name. A column of that name comes first, but for the pressure: a column holds it
/// less the reference pressure.
pub fn quantity(mapped: &Mapped, columns: &[ColumnView<'_>], name: &str) -> Result<Quantity, Failure> {
    let named = |unit: &str, values| Quantity { name: name.to_owned(), unit: unit.to_owned(), values };
    if let Some(column) = column(columns, name).filter(|_| name != "pressure") {
        return Ok(named(column.unit(), column.values().collect()));
    }
    let of = |name: &str| values(columns, name);
    match name {
        "speed" => {
            let components = of("velocity_r")?.into_iter().zip(of("velocity_z")?);
            Ok(named("m/s", components.map(|(r, z)| r.hypot(z)).collect()))
        }
        "size" => Ok(named("m", sizes(columns, open::scene(mapped).as_ref())?)),
        "pressure" => {
            let scene = open::scene(mapped).ok_or(Failure::NoScene)?;
            Ok(named("Pa", pressures(columns, &Physics::of(&scene))?))
        }
        _ => Err(unknown(columns, name)),
    }
}

/// The root of area of every particle, in m; at most twice that of the scene, as near the axis it
/// would grow without bound.
pub fn sizes(columns: &[ColumnView<'_>], scene: Option<&Scene>) -> Result<Vec<f64>, Failure> {
    let [radius, mass, density] = ["radius", "mass", "density"].map(|name| values(columns, name));
    let (radius, mass, density) = (radius?, mass?, density?);
    let origin = scene.map_or(0.0, |scene| scene.domain.origin);
    let largest = scene.map_or(f64::INFINITY, |scene| 2.0 * scene.particle_size);
    let size = |i: usize| (mass[i] / (2.0 * PI * (radius[i] + origin) * density[i])).sqrt().min(largest);
    Ok((0..radius.len()).map(size).collect())
}

fn pressures(columns: &[ColumnView<'_>], physics: &Physics) -> Result<Vec<f64>, Failure> {
    let density = values(columns, "density")?;
    if !physics.equation.with_energy() {
        return Ok(density.iter().map(|density| physics.equation.pressure(*density, 0.0)).collect());
    }
    let (energy, radial) = (values(columns, "total_energy")?, values(columns, "velocity_r")?);
    let axial = values(columns, "velocity_z")?;
    let internal = |i: usize| energy[i] - 0.5 * (radial[i] * radial[i] + axial[i] * axial[i]);
    Ok((0..density.len()).map(|i| physics.equation.pressure(density[i], internal(i))).collect())
}

fn unknown(columns: &[ColumnView<'_>], name: &str) -> Failure {
    Failure::UnknownField { name: name.to_owned(), known: known(columns) }
}
