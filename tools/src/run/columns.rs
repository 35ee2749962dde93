//! The particles' columns as people want to see them.

use meniscus_cases::simulation::Simulation;
use meniscus_engine::field::{Description, Role, Values};
use meniscus_stages::fields;

/// Values of a quantity, one a particle, with its SI unit.
pub(super) struct Shown {
    pub(super) unit: &'static str,
    pub(super) values: Vec<f64>,
}

/// A real column by its field; empty if this run has none of it.
pub(super) fn column(simulation: &Simulation, name: &str) -> Vec<f64> {
    let column = simulation.world.store.by_name::<f64>(name);
    column.map_or_else(Vec::new, |column| column.to_vec())
}

/// Whole pressure in Pa: with the reference pressure that forces leave out.
pub(super) fn pressure(simulation: &Simulation) -> Vec<f64> {
    let equation = simulation.physics.equation;
    let density = column(simulation, fields::DENSITY.description.name);
    let energy = column(simulation, fields::TOTAL_ENERGY.description.name);
    let radial = column(simulation, fields::VELOCITY_R.description.name);
    let axial = column(simulation, fields::VELOCITY_Z.description.name);
    let internal = |i: usize| {
        let kinetic = 0.5 * (radial[i] * radial[i] + axial[i] * axial[i]);
        energy.get(i).map_or(0.0, |total| total - kinetic)
    };
    density.iter().enumerate().map(|(i, density)| equation.pressure(*density, internal(i))).collect()
}

/// The root of area of every particle, in m.
pub(super) fn size(simulation: &Simulation) -> Vec<f64> {
    let origin = simulation.physics.domain.origin;
    let of = |description: Description| column(simulation, description.name);
    let (r, mass) = (of(fields::RADIUS.description), of(fields::MASS.description));
    let density = of(fields::DENSITY.description);
    // Near the axis the area grows without bound; what is drawn must not.
    let largest = 2.0 * simulation.physics.particle_size;
    (0..r.len())
        .map(|i| {
            let circumference = 2.0 * std::f64::consts::PI * (r[i] + origin);
            (mass[i] / (circumference * density[i])).sqrt().min(largest)
        })
        .collect()
}

/// A quantity by name: a column, or one of `meniscus_cases::scene::FOLLOWING`. `None` for one that is computed in every step, before the first one.
pub(super) fn shown(simulation: &Simulation, name: &str) -> Option<Shown> {
    match name {
        "pressure" => return Some(Shown { unit: "Pa", values: pressure(simulation) }),
        "size" => return Some(Shown { unit: "m", values: size(simulation) }),
        "speed" => {
            let radial = column(simulation, fields::VELOCITY_R.description.name);
            let axial = column(simulation, fields::VELOCITY_Z.description.name);
            let values = radial.iter().zip(axial).map(|(u, w)| u.hypot(w)).collect();
            return Some(Shown { unit: "m/s", values });
        }
        _ => {}
    }
    let mut columns = simulation.world.store.columns();
    let (description, values) = columns.find(|(d, _)| d.name == name)?;
    if description.role == Role::Derived && simulation.world.clock.previous_step_size == 0.0 {
        return None;
    }
    let values = match &*values {
        Values::F64(values) => values.clone(),
        Values::U32(values) => values.iter().map(|value| f64::from(*value)).collect(),
    };
    let unit = description.unit;
    Some(Shown { unit, values })
}
