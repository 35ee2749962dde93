//! Bodies of liquid: their shapes and initial states.

use super::diagnosis::Fault;
use super::entry::Entry;
use super::formula::Formula;
use super::liquid::{EquationOfState, Liquid};
use super::quantity::{DENSITY, Kind, SPECIFIC_ENERGY, Short, VELOCITY};
use super::section::Section;
use super::shapes;
use crate::region::Region;
use crate::shape::Shape;

/// A body of liquid.
#[derive(Debug, Clone)]
pub struct Body {
    /// Where the liquid is.
    pub shape: Shape,
    /// How it moves at first.
    pub velocity: VelocityField,
    /// Density at the start in kg/m3; `None` for the liquid's at rest.
    pub density: Option<f64>,
    /// Specific internal energy at the start in J/kg.
    pub internal_energy: Formula,
}

/// An initial velocity.
#[derive(Debug, Clone)]
pub struct VelocityField {
    radial: Formula,
    axial: Formula,
}

impl VelocityField {
    /// No motion.
    pub fn rest() -> Self {
        Self { radial: Formula::zero(), axial: Formula::zero() }
    }

    /// Velocity `[U_r, U_z]` in m/s at the point r, z in metres.
    pub fn at(&self, r: f64, z: f64) -> [f64; 2] {
        [self.radial.at(r, z), self.axial.at(r, z)]
    }
}

/// Speed of light in m/s: what is to be faster is a mistake, and its squares may be no numbers.
pub(super) const LIGHT: f64 = 299_792_458.0;

/// Points along each side of the grid on which fields are sampled.
pub(super) const SAMPLES: usize = 64;

/// Reads a body; `origin` is the radius of the scene's r = 0. Also hands back the entry of its
/// shape, for later mistakes.
pub(super) fn read<'a>(entry: Entry<'a>, origin: f64, liquid: &Liquid) -> Result<(Body, Entry<'a>), Fault> {
    let table = Section::new(entry, &["shape", "velocity", "density", "internal_energy"])?;
    let place = table.required("shape", "shape = { sphere = { radius = \"2.5 um\" } }")?;
    let shape = shapes::read(place.clone(), origin)?;
    if shape.bounds()[0] < -origin {
        let message = "the body reaches across the axis";
        return Err(place.fault(message, "keep its r above minus the `origin` of [domain]"));
    }
    let velocity = table.read_or("velocity", VelocityField::rest(), |entry| read_velocity(entry, &shape))?;
    let density = table.read_or("density", None, |entry| {
        let density = entry.positive(DENSITY)?;
        if liquid.surface_tension > 0.0 && density != liquid.density {
            let message = format!(
                "a body under surface tension cannot start with a `density` of {} kg/m3: it has \
                 the liquid's, at the pressure of its surface",
                Short(density)
            );
            return Err(entry.fault(message, "leave it out"));
        }
        Ok(Some(density))
    })?;
    let equation = liquid.equation_of_state;
    if let Some(entry) = table.optional("internal_energy").filter(|_| equation == EquationOfState::Linear) {
        let message = "`internal_energy` belongs to another equation of state: a linear one knows no energy";
        let help = "leave it out, or set equation_of_state = \"mie-grueneisen\" or \"ideal-gas\" in [liquid]";
        return Err(entry.fault(message, help));
    }
    let internal_energy = table.read_or("internal_energy", Formula::zero(), |entry| {
        entry.context.check_finite()?;
        let formula = finite_field(&entry, SPECIFIC_ENERGY, &shape)?;
        let least = shape.interior_points(SAMPLES).map(|[r, z]| formula.at(r, z)).fold(0.0, f64::min);
        if least < 0.0 && matches!(equation, EquationOfState::IdealGas { .. }) {
            let message =
                format!("`internal_energy` is {} J/kg somewhere: a gas has no less than 0", Short(least));
            return Err(entry.fault(message, "give the body a positive one, or none"));
        }
        Ok(formula)
    })?;
    Ok((Body { shape, velocity, density, internal_energy }, place))
}

fn read_velocity(entry: Entry<'_>, shape: &Shape) -> Result<VelocityField, Fault> {
    entry.context.check_finite()?;
    let table = Section::new(entry, &["r", "z"])?;
    let component = |key: &str| {
        table.read_or(key, Formula::zero(), |entry| {
            let formula = finite_field(&entry, VELOCITY, shape)?;
            let fastest = shape.interior_points(SAMPLES).map(|[r, z]| formula.at(r, z).abs());
            let fastest = fastest.fold(0.0, f64::max);
            if fastest > LIGHT {
                let message = format!("`{}` is up to {} m/s: faster than light", entry.path, Short(fastest));
                return Err(entry.fault(message, "check its numbers and units"));
            }
            Ok(formula)
        })
    };
    Ok(VelocityField { radial: component("r")?, axial: component("z")? })
}

/// A field that has a value everywhere in a shape.
fn finite_field(entry: &Entry<'_>, kind: Kind, shape: &Shape) -> Result<Formula, Fault> {
    let formula = entry.field(Some(kind))?;
    match shape.interior_points(SAMPLES).find(|[r, z]| !formula.at(*r, *z).is_finite()) {
        None => Ok(formula),
        Some(point) => Err(not_finite(entry, &formula, point)),
    }
}

/// The mistake that a field has no value at a point.
pub(super) fn not_finite(entry: &Entry<'_>, formula: &Formula, [r, z]: [f64; 2]) -> Fault {
    let message = format!("`{}` is {} at r = {r:.3e} m, z = {z:.3e} m", entry.path, formula.at(r, z));
    entry.fault(message, "check for divisions by zero, and for roots and logarithms of negative numbers")
}
