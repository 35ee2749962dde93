//! The units a scene may use.

use super::quantity::{Dimension, Quantity};

/// Symbol, value in SI, dimension, and whether SI prefixes go with it.
const UNITS: [(&str, f64, Dimension, bool); 14] = [
    ("m", 1.0, Dimension::new(1, 0, 0), true),
    ("g", 1e-3, Dimension::new(0, 1, 0), true),
    ("s", 1.0, Dimension::new(0, 0, 1), true),
    ("N", 1.0, Dimension::new(1, 1, -2), true),
    ("Pa", 1.0, Dimension::new(-1, 1, -2), true),
    ("J", 1.0, Dimension::new(2, 1, -2), true),
    ("W", 1.0, Dimension::new(2, 1, -3), true),
    ("Hz", 1.0, Dimension::new(0, 0, -1), true),
    ("L", 1e-3, Dimension::new(3, 0, 0), true),
    ("bar", 1e5, Dimension::new(-1, 1, -2), true),
    ("atm", 101_325.0, Dimension::new(-1, 1, -2), false),
    ("dyn", 1e-5, Dimension::new(1, 1, -2), false),
    ("rad", 1.0, Dimension::NONE, false),
    ("deg", std::f64::consts::PI / 180.0, Dimension::NONE, false),
];

/// Powers of ten as exact quotients: 1e-6 times a decimal number would cost a rounding.
const PREFIXES: [(&str, f64, f64); 13] = [
    ("f", 1.0, 1e15),
    ("p", 1.0, 1e12),
    ("n", 1.0, 1e9),
    ("u", 1.0, 1e6),
    ("\u{b5}", 1.0, 1e6),
    ("\u{3bc}", 1.0, 1e6),
    ("m", 1.0, 1e3),
    ("c", 1.0, 1e2),
    ("d", 1.0, 10.0),
    ("h", 1e2, 1.0),
    ("k", 1e3, 1.0),
    ("M", 1e6, 1.0),
    ("G", 1e9, 1.0),
];

/// What a help text says about units.
pub(super) const HELP: &str = "known units are m, g, s, N, Pa, J, W, Hz, L, bar (with prefixes f p n u m c d h k M G), \
     atm, dyn, rad and deg, combined as in \"1000 kg/m3\" or \"50 mN/m\"";

/// The unit of this symbol, with or without a prefix, as numerator and denominator of its value.
pub(super) fn find(symbol: &str) -> Option<(f64, f64, Dimension)> {
    let plain = |name: &str| UNITS.iter().find(|unit| unit.0 == name);
    if symbol == "kg" {
        return Some((1.0, 1.0, Dimension::new(0, 1, 0)));
    }
    if let Some((_, value, dimension, _)) = plain(symbol) {
        return Some((*value, 1.0, *dimension));
    }
    PREFIXES.iter().find_map(|(prefix, above, below)| {
        let (_, value, dimension, _) = plain(symbol.strip_prefix(prefix)?).filter(|unit| unit.3)?;
        Some((value * above, *below, *dimension))
    })
}

/// A number with a unit under construction: `number * above / below`.
pub(super) struct Measure {
    number: f64,
    above: f64,
    below: f64,
    dimension: Dimension,
}

impl Measure {
    pub(super) fn new(number: f64) -> Self {
        Self { number, above: 1.0, below: 1.0, dimension: Dimension::NONE }
    }

    /// Multiplies by a unit to a power; `None` if the exponents grow out of range.
    pub(super) fn times(&mut self, unit: (f64, f64, Dimension), power: i16) -> Option<()> {
        let (above, below) = if power < 0 { (unit.1, unit.0) } else { (unit.0, unit.1) };
        self.above *= above.powi(i32::from(power.abs()));
        self.below *= below.powi(i32::from(power.abs()));
        self.dimension = self.dimension.times(unit.2, power)?;
        Some(())
    }

    pub(super) fn quantity(&self) -> Quantity {
        Quantity { value: self.number * self.above / self.below, dimension: self.dimension }
    }
}
