//! Columns of a checkpoint by name, and quantities that follow from them.

use std::f64::consts::PI;

use meniscus_cases::assemble::Physics;
use meniscus_cases::scene::Scene;
use meniscus_engine::checkpoint::{CheckpointError, ColumnView, Mapped, Role};

use super::failure::{Failure, known};
use super::open;

/// What such a quantity is, in words.
fn about(name: &str) -> &'static str {
    match name {
        "speed" => "magnitude of the velocity",
        "size" => "root of the particle's area",
        _ => "whole pressure, with the reference pressure",
    }
}

/// A column that was asked for, or what follows from others.
pub enum Chosen<'a> {
    Column(ColumnView<'a>),
    Following(Quantity),
}

impl Chosen<'_> {
    pub fn name(&self) -> &str {
        match self {
            Chosen::Column(column) => column.name(),
            Chosen::Following(quantity) => &quantity.name,
        }
    }

    pub fn symbol(&self) -> &str {
        match self {
            Chosen::Column(column) => column.symbol(),
            Chosen::Following(_) => "",
        }
    }

    pub fn unit(&self) -> &str {
        match self {
            Chosen::Column(column) => column.unit(),
            Chosen::Following(quantity) => &quantity.unit,
        }
    }

    pub fn about(&self) -> &str {
        match self {
            Chosen::Column(column) => column.about(),
            Chosen::Following(quantity) => about(&quantity.name),
        }
    }

    /// Its role as people read it.
    pub fn role(&self) -> &'static str {
        match self {
            Chosen::Column(column) if column.role() == Role::State => "state",
            _ => "derived",
        }
    }

    /// Shows all values piece by piece.
    pub fn stream(&self, mapped: &Mapped, mut look: impl FnMut(&[f64])) -> Result<(), CheckpointError> {
        match self {
            Chosen::Column(column) => mapped.stream(column, look),
            Chosen::Following(quantity) => {
                look(&quantity.values);
                Ok(())
            }
        }
    }
}

/// The quantities of these names, or all columns where no name is given.
pub fn choose<'a>(
    mapped: &Mapped,
    columns: &[ColumnView<'a>],
    names: &[String],
) -> Result<Vec<Chosen<'a>>, Failure> {
    if names.is_empty() {
        return Ok(columns.iter().copied().map(Chosen::Column).collect());
    }
    let chosen = names.iter().map(|name| match column(columns, name) {
        Some(column) if name != "pressure" => Ok(Chosen::Column(column)),
        _ => quantity(mapped, columns, name).map(Chosen::Following),
    });
    chosen.collect()
}

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
