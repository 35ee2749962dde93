//! Physical quantities: a value in SI units with its dimension.

use std::fmt;

/// Exponents of metre, kilogram and second, counted in halves so that square roots stay exact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dimension {
    halves: [i16; 3],
}

impl Dimension {
    /// The dimension of a plain number.
    pub const NONE: Self = Self::new(0, 0, 0);

    /// From whole exponents of metre, kilogram and second.
    pub const fn new(metre: i16, kilogram: i16, second: i16) -> Self {
        Self { halves: [2 * metre, 2 * kilogram, 2 * second] }
    }

    /// Exponents of metre, kilogram and second.
    pub fn exponents(self) -> [f64; 3] {
        self.halves.map(|halves| 0.5 * f64::from(halves))
    }

    pub(super) fn times(self, other: Self, sign: i16) -> Option<Self> {
        let mut halves = self.halves;
        for (total, added) in halves.iter_mut().zip(other.halves) {
            *total = total.checked_add(added.checked_mul(sign)?)?;
        }
        Some(Self { halves })
    }

    /// Raised to a power; `None` if an exponent is then no multiple of one half, or out of range.
    pub(super) fn power(self, exponent: f64) -> Option<Self> {
        let mut halves = [0; 3];
        for (raised, own) in halves.iter_mut().zip(self.halves) {
            let exact = f64::from(own) * exponent;
            let whole = exact.round();
            if (exact - whole).abs() > 1e-9 || whole.abs() > 1000.0 {
                return None;
            }
            *raised = whole as i16;
        }
        Some(Self { halves })
    }

    /// What a quantity of this dimension is, with its article: "a length".
    pub(super) fn described(self) -> String {
        const NAMES: [(Dimension, &str); 14] = [
            (Dimension::NONE, "a number without unit"),
            (Dimension::new(1, 0, 0), "a length"),
            (Dimension::new(2, 0, 0), "an area"),
            (Dimension::new(3, 0, 0), "a volume"),
            (Dimension::new(0, 1, 0), "a mass"),
            (Dimension::new(0, 0, 1), "a time"),
            (Dimension::new(0, 0, -1), "a rate"),
            (Dimension::new(1, 0, -1), "a velocity"),
            (Dimension::new(1, 0, -2), "an acceleration"),
            (Dimension::new(2, 0, -2), "an energy per mass"),
            (Dimension::new(-3, 1, 0), "a density"),
            (Dimension::new(0, 1, -2), "a surface tension"),
            (Dimension::new(-1, 1, -2), "a pressure"),
            (Dimension::new(-1, 1, -1), "a viscosity"),
        ];
        let known = NAMES.iter().find(|(dimension, _)| *dimension == self);
        known.map_or_else(|| format!("a quantity in {self}"), |(_, name)| (*name).to_owned())
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let parts: Vec<String> = ["kg", "m", "s"]
            .iter()
            .zip([self.halves[1], self.halves[0], self.halves[2]])
            .filter(|(_, halves)| *halves != 0)
            .map(|(unit, halves)| match halves {
                2 => (*unit).to_owned(),
                halves if halves % 2 == 0 => format!("{unit}^{}", halves / 2),
                halves => format!("{unit}^({halves}/2)"),
            })
            .collect();
        formatter.write_str(&parts.join(" "))
    }
}

/// A value in SI units with its dimension.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// The value in the SI unit of the dimension.
    pub value: f64,
    /// The dimension.
    pub dimension: Dimension,
}

impl fmt::Display for Quantity {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{}", Short(self.value))?;
        match self.dimension {
            Dimension::NONE => Ok(()),
            dimension => write!(formatter, " {dimension}"),
        }
    }
}

/// Shows a number with five digits, in powers of ten where it is large or small.
pub(super) struct Short(pub(super) f64);

impl fmt::Display for Short {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rounded: f64 = format!("{:.4e}", self.0).parse().unwrap_or(self.0);
        if rounded == 0.0 || (1e-3..1e5).contains(&rounded.abs()) || !rounded.is_finite() {
            write!(formatter, "{rounded}")
        } else {
            write!(formatter, "{rounded:e}")
        }
    }
}

/// What a key of the scene expects.
#[derive(Debug, Clone, Copy)]
pub(super) struct Kind {
    pub(super) name: &'static str,
    pub(super) dimension: Dimension,
    /// The SI unit.
    pub(super) unit: &'static str,
    pub(super) example: &'static str,
}

pub(super) const LENGTH: Kind =
    Kind { name: "a length", dimension: Dimension::new(1, 0, 0), unit: "m", example: "2.5 um" };
pub(super) const TIME: Kind =
    Kind { name: "a time", dimension: Dimension::new(0, 0, 1), unit: "s", example: "3 us" };
pub(super) const VELOCITY: Kind =
    Kind { name: "a velocity", dimension: Dimension::new(1, 0, -1), unit: "m/s", example: "150 m/s" };
pub(super) const DENSITY: Kind =
    Kind { name: "a density", dimension: Dimension::new(-3, 1, 0), unit: "kg/m3", example: "1000 kg/m3" };
pub(super) const SURFACE_TENSION: Kind = Kind {
    name: "a surface tension",
    dimension: Dimension::new(0, 1, -2),
    unit: "N/m",
    example: "0.074 N/m",
};
pub(super) const VISCOSITY: Kind =
    Kind { name: "a viscosity", dimension: Dimension::new(-1, 1, -1), unit: "Pa s", example: "1 mPa s" };
pub(super) const SPECIFIC_ENERGY: Kind = Kind {
    name: "an energy per mass",
    dimension: Dimension::new(2, 0, -2),
    unit: "J/kg",
    example: "100 J/kg",
};
pub(super) const RATE: Kind =
    Kind { name: "a rate", dimension: Dimension::new(0, 0, -1), unit: "Hz", example: "1 Hz" };
pub(super) const SQUARED_RATE: Kind =
    Kind { name: "a squared rate", dimension: Dimension::new(0, 0, -2), unit: "Hz^2", example: "1 Hz^2" };
pub(super) const NUMBER: Kind =
    Kind { name: "a number without unit", dimension: Dimension::NONE, unit: "", example: "0.5" };
