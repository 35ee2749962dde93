//! The liquid (or gas) of a scene.

use super::diagnosis::Fault;
use super::entry::Entry;
use super::quantity::{DENSITY, Kind, NUMBER, SURFACE_TENSION, VELOCITY, VISCOSITY};
use super::section::Section;
use super::values::Choice;

/// A liquid.
#[derive(Debug, Clone, PartialEq)]
pub struct Liquid {
    /// Density at rest in kg/m³.
    pub density: f64,
    /// Surface tension in N/m; 0 for none.
    pub surface_tension: f64,
    /// Viscosity in Pa s; 0 for none.
    pub viscosity: f64,
    /// Speed of sound in m/s; `None` to derive it from the scene.
    pub sound_speed: Option<f64>,
    /// Pressure as a function of density and internal energy.
    pub equation_of_state: EquationOfState,
}

/// Pressure as a function of density and internal energy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum EquationOfState {
    /// Sound speed squared times the excess of density.
    Linear,
    /// Mie-Grueneisen about a shock adiabat whose speed at rest is the liquid's sound speed.
    MieGrueneisen {
        /// Slope of the adiabat: rise of the shock speed over that of the particle speed.
        adiabat_slope: f64,
        /// Grueneisen's coefficient.
        grueneisen: f64,
    },
    /// Ideal gas.
    IdealGas {
        /// Ratio of the specific heats, above 1.
        heat_ratio: f64,
    },
}

/// The names of the equations of state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Name {
    Linear,
    MieGrueneisen,
    IdealGas,
}

impl Choice for Name {
    const NAMES: &'static [(&'static str, Self)] =
        &[("linear", Self::Linear), ("mie-grueneisen", Self::MieGrueneisen), ("ideal-gas", Self::IdealGas)];
}

/// Keys that belong to one equation of state alone.
const OWN_KEYS: [(&str, Name); 3] = [
    ("adiabat_slope", Name::MieGrueneisen),
    ("grueneisen", Name::MieGrueneisen),
    ("heat_ratio", Name::IdealGas),
];

/// Reads a liquid. Also hands back the entries of its sound speed and viscosity, or of the table that lacks
/// them, for later mistakes.
pub(super) fn read(entry: Entry<'_>) -> Result<(Liquid, [Entry<'_>; 2]), Fault> {
    let whole = entry.clone();
    let keys = [
        "density",
        "surface_tension",
        "viscosity",
        "sound_speed",
        "equation_of_state",
        "adiabat_slope",
        "grueneisen",
        "heat_ratio",
    ];
    let table = Section::new(entry, &keys)?;
    let name = table.read_or("equation_of_state", Name::Linear, |entry| entry.choice())?;
    for (key, owner) in OWN_KEYS {
        if let Some(entry) = table.optional(key).filter(|_| owner != name) {
            let owner = Name::NAMES.iter().find(|(_, other)| *other == owner).map_or("", |(name, _)| name);
            let message = format!("`{key}` belongs to another equation of state");
            return Err(entry.fault(message, format!("leave it out, or set equation_of_state = \"{owner}\"")));
        }
    }
    let sound_speed = table.optional("sound_speed");
    let given = match &sound_speed {
        Some(entry) if !entry.is_auto() => Some(entry.positive(VELOCITY)?),
        _ if name == Name::MieGrueneisen => {
            let help = "give the speed of its shock adiabat at rest: sound_speed = \"1483 m/s\"";
            return Err(whole.fault("this equation of state needs a sound speed", help));
        }
        _ => None,
    };
    let equation_of_state = match name {
        Name::Linear => EquationOfState::Linear,
        Name::MieGrueneisen => EquationOfState::MieGrueneisen {
            adiabat_slope: table.required("adiabat_slope", "adiabat_slope = 2")?.not_negative(NUMBER)?,
            grueneisen: table.required("grueneisen", "grueneisen = 2")?.not_negative(NUMBER)?,
        },
        Name::IdealGas => {
            let place = table.required("heat_ratio", "heat_ratio = \"5/3\"")?;
            let number = Kind { example: "\"5/3\"", ..NUMBER };
            let heat_ratio = place.checked(number, "must be above 1", |value| value > 1.0)?;
            EquationOfState::IdealGas { heat_ratio }
        }
    };
    let liquid = Liquid {
        density: table.required("density", "density = \"1000 kg/m3\"")?.positive(DENSITY)?,
        surface_tension: table
            .read_or("surface_tension", 0.0, |entry| entry.not_negative(SURFACE_TENSION))?,
        viscosity: table.read_or("viscosity", 0.0, |entry| entry.not_negative(VISCOSITY))?,
        sound_speed: given,
        equation_of_state,
    };
    if let (Some(place), Name::IdealGas) = (table.optional("surface_tension"), name)
        && liquid.surface_tension > 0.0
    {
        let help = "leave it out, or choose another equation_of_state";
        return Err(place.fault("an ideal gas fills what room there is: it has no surface", help));
    }
    let viscosity = table.optional("viscosity");
    Ok((liquid, [sound_speed, viscosity].map(|place| place.unwrap_or_else(|| whole.clone()))))
}
