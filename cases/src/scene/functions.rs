//! The functions that expressions know.

use super::formula::{Formula, common_dimension};
use super::quantity::Dimension;

/// A function of one or two arguments.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Function {
    SquareRoot,
    Exponential,
    Logarithm,
    Sine,
    Cosine,
    Tangent,
    Absolute,
    Minimum,
    Maximum,
    Legendre,
    LegendreDerivative,
}

const FUNCTIONS: [(&str, Function, &str); 11] = [
    ("sqrt", Function::SquareRoot, "sqrt(x)"),
    ("exp", Function::Exponential, "exp(x)"),
    ("log", Function::Logarithm, "log(x), the natural logarithm"),
    ("sin", Function::Sine, "sin(x) with x in radians"),
    ("cos", Function::Cosine, "cos(x) with x in radians"),
    ("tan", Function::Tangent, "tan(x) with x in radians"),
    ("abs", Function::Absolute, "abs(x)"),
    ("min", Function::Minimum, "min(x, y) with x and y of one dimension"),
    ("max", Function::Maximum, "max(x, y) with x and y of one dimension"),
    ("legendre", Function::Legendre, "legendre(n, x) with a constant whole n from 0 to 1000"),
    (
        "legendre_derivative",
        Function::LegendreDerivative,
        "legendre_derivative(n, x) with a constant whole n from 0 to 1000",
    ),
];

impl Function {
    pub(super) fn find(name: &str) -> Option<Self> {
        FUNCTIONS.iter().find(|entry| entry.0 == name).map(|entry| entry.1)
    }

    pub(super) fn names() -> Vec<&'static str> {
        FUNCTIONS.iter().map(|entry| entry.0).collect()
    }

    /// How it is written.
    pub(super) fn usage(self) -> &'static str {
        FUNCTIONS.iter().find(|entry| entry.1 == self).map_or("", |entry| entry.2)
    }

    pub(super) fn arity(self) -> usize {
        match self {
            Self::Minimum | Self::Maximum | Self::Legendre | Self::LegendreDerivative => 2,
            _ => 1,
        }
    }

    /// The dimension of the result, or what is wrong with the arguments.
    pub(super) fn dimension(self, arguments: &[Formula]) -> Result<Dimension, String> {
        let first = arguments[0].dimension();
        let plain = |formula: &Formula| match formula.dimension() {
            Dimension::NONE => Ok(()),
            dimension => Err(format!("expects a number without unit, not {}", dimension.described())),
        };
        match self {
            Self::SquareRoot => first.power(0.5).ok_or(format!("of {} has no unit", first.described())),
            Self::Absolute => Ok(first),
            Self::Minimum | Self::Maximum => {
                common_dimension(&arguments[0], &arguments[1]).ok_or_else(|| {
                    let second = arguments[1].dimension();
                    format!("cannot compare {} and {}", first.described(), second.described())
                })
            }
            Self::Legendre | Self::LegendreDerivative => {
                arguments.iter().try_for_each(plain)?;
                let degree = arguments[0].constant().map(|degree| degree.value);
                let good =
                    degree.is_some_and(|degree| degree.fract() == 0.0 && (0.0..=1000.0).contains(&degree));
                if good { Ok(Dimension::NONE) } else { Err("expects a whole number first".to_owned()) }
            }
            _ => plain(&arguments[0]).map(|()| Dimension::NONE),
        }
    }

    /// The value; functions of one argument leave the second aside.
    pub(super) fn value(self, first: f64, second: f64) -> f64 {
        match self {
            Self::SquareRoot => first.sqrt(),
            Self::Exponential => first.exp(),
            Self::Logarithm => first.ln(),
            Self::Sine => first.sin(),
            Self::Cosine => first.cos(),
            Self::Tangent => first.tan(),
            Self::Absolute => first.abs(),
            // Unlike f64's own, these hand a NaN on, so that it is found and reported.
            Self::Minimum => {
                if second < first || second.is_nan() {
                    second
                } else {
                    first
                }
            }
            Self::Maximum => {
                if second > first || second.is_nan() {
                    second
                } else {
                    first
                }
            }
            Self::Legendre => legendre(first as usize, second)[0],
            Self::LegendreDerivative => legendre(first as usize, second)[1],
        }
    }
}

/// The Legendre polynomial of this degree and its derivative, by the three-term recurrence
/// `(k+1) P_(k+1) = (2k+1) x P_k - k P_(k-1)` and `P'_(k+1) = (k+1) P_k + x P'_k`.
pub(crate) fn legendre(degree: usize, x: f64) -> [f64; 2] {
    let (mut before, mut value, mut derivative) = (0.0, 1.0, 0.0);
    for index in 0..degree {
        let index = index as f64;
        let next = ((2.0 * index + 1.0) * x * value - index * before) / (index + 1.0);
        derivative = (index + 1.0) * value + x * derivative;
        (before, value) = (value, next);
    }
    [value, derivative]
}
