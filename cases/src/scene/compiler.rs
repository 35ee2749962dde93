//! Checks expressions for names and dimensions and folds everything known into constants.

use super::expression::{Mistake, Node, Operator, Part};
use super::formula::{Code, Formula, common_dimension};
use super::functions::Function;
use super::quantity::{Dimension, Quantity};
use super::suggest;
use super::units;
use std::ops::Range;

/// What a name stands for.
pub(super) enum Meaning {
    Value(Quantity),
    /// A field of a particle, by its number.
    Field(usize, Dimension),
    /// A parameter that is "auto": it has no value yet.
    Auto,
    Unknown,
}

/// Turns expressions into formulas.
pub(super) struct Compiler<'a> {
    /// Looks up a parameter.
    pub(super) meaning: &'a dyn Fn(&str) -> Meaning,
    /// Names of all parameters, for suggestions.
    pub(super) known: &'a [&'a str],
    /// Whether r and z have a meaning.
    pub(super) spatial: bool,
}

impl Compiler<'_> {
    /// Checks an expression and folds its constants.
    ///
    /// # Errors
    /// Unknown names and functions, and dimensions that do not fit together.
    pub(super) fn formula(&self, node: &Node) -> Result<Formula, Mistake> {
        match &node.part {
            Part::Number(quantity) => Ok(Formula::constant_of(*quantity)),
            Part::Name(name) => self.name(name, node.span.clone()),
            Part::Negate(inner) => {
                let Formula { code, dimension } = self.formula(inner)?;
                let known = matches!(code, Code::Constant(_));
                Ok(Formula { code: Code::Negate(Box::new(code)).folded(known), dimension })
            }
            Part::Binary(operator, sides) => {
                let [left, right] = [self.formula(&sides[0])?, self.formula(&sides[1])?];
                binary(*operator, left, right, &node.span)
            }
            Part::Call(name, arguments) => self.call(name, arguments, &node.span),
        }
    }

    fn name(&self, name: &str, span: Range<usize>) -> Result<Formula, Mistake> {
        let length = Dimension::new(1, 0, 0);
        match (name, (self.meaning)(name)) {
            ("pi", _) => {
                Ok(Formula::constant_of(Quantity { value: std::f64::consts::PI, dimension: Dimension::NONE }))
            }
            ("r", _) if self.spatial => Ok(Formula { code: Code::Radius, dimension: length }),
            ("z", _) if self.spatial => Ok(Formula { code: Code::Height, dimension: length }),
            ("r" | "z", _) => Err(Mistake::new(
                span,
                format!("`{name}` has no value here"),
                "r and z are coordinates: they have a meaning in `velocity`, `internal_energy` and the shape `expression`",
            )),
            (_, Meaning::Value(quantity)) => Ok(Formula::constant_of(quantity)),
            (_, Meaning::Field(number, dimension)) => Ok(Formula { code: Code::Field(number), dimension }),
            (_, Meaning::Auto) => Err(Mistake::new(
                span,
                format!("`{name}` is \"auto\", so it has no value here"),
                format!("give `{name}` a value, or use it for `sound_speed` of [liquid] only"),
            )),
            (_, Meaning::Unknown) if units::find(name).is_some() => Err(Mistake::new(
                span,
                format!("`{name}` is a unit without a number"),
                format!("a unit follows a number: `2 {name}`, and `1 {name}^-1` for one over it"),
            )),
            (_, Meaning::Unknown) => {
                let mut known: Vec<&str> = self.known.to_vec();
                known.extend(["pi"].iter().chain(if self.spatial { &["r", "z"][..] } else { &[] }));
                Err(Mistake::new(
                    span,
                    format!("unknown name `{name}`"),
                    suggest::help("names", name, &known),
                ))
            }
        }
    }

    fn call(&self, name: &str, arguments: &[Node], span: &Range<usize>) -> Result<Formula, Mistake> {
        let Some(function) = Function::find(name) else {
            let help = suggest::help("functions", name, &Function::names());
            return Err(Mistake::new(span.clone(), format!("unknown function `{name}`"), help));
        };
        if arguments.len() != function.arity() {
            let message =
                format!("`{name}` takes {} argument(s), here are {}", function.arity(), arguments.len());
            return Err(Mistake::new(span.clone(), message, format!("write {}", function.usage())));
        }
        let formulas =
            arguments.iter().map(|argument| self.formula(argument)).collect::<Result<Vec<_>, _>>()?;
        let dimension = function.dimension(&formulas).map_err(|problem| {
            Mistake::new(span.clone(), format!("`{name}` {problem}"), format!("write {}", function.usage()))
        })?;
        let known = formulas.iter().all(|formula| formula.constant().is_some());
        let code = match (function, &formulas[0].code) {
            (Function::Legendre | Function::LegendreDerivative, Code::Constant(degree)) => Code::Legendre {
                degree: *degree as usize,
                derivative: function == Function::LegendreDerivative,
                argument: Box::new(formulas[1].code.clone()),
            },
            _ => Code::Call(function, formulas.into_iter().map(|formula| formula.code).collect()),
        };
        Ok(Formula { code: code.folded(known), dimension })
    }
}

fn binary(
    operator: Operator,
    left: Formula,
    right: Formula,
    span: &Range<usize>,
) -> Result<Formula, Mistake> {
    let fail = |message: String, help: &str| Mistake::new(span.clone(), message, help);
    let too_high = || fail("the exponents of the units grow out of range".to_owned(), "check the powers");
    let dimension = match operator {
        Operator::Add | Operator::Subtract => common_dimension(&left, &right).ok_or_else(|| {
            let (first, second) = (left.dimension.described(), right.dimension.described());
            let word = if operator == Operator::Add { "add" } else { "subtract" };
            fail(format!("cannot {word} {first} and {second}"), "both sides need the same dimension")
        })?,
        Operator::Multiply => left.dimension.times(right.dimension, 1).ok_or_else(too_high)?,
        Operator::Divide => left.dimension.times(right.dimension, -1).ok_or_else(too_high)?,
        Operator::Power => power_dimension(&left, &right).map_err(|message| {
            fail(message, "an exponent is a number without unit; with units in the base it is constant, a multiple of one half in the end")
        })?,
    };
    let known = left.constant().is_some() && right.constant().is_some();
    let code = match (operator, &right.code) {
        (Operator::Power, Code::Constant(exponent)) if exponent.fract() == 0.0 && exponent.abs() < 1e4 => {
            Code::WholePower(Box::new(left.code), *exponent as i32)
        }
        _ => Code::Binary(operator, Box::new([left.code, right.code])),
    };
    Ok(Formula { code: code.folded(known), dimension })
}

fn power_dimension(base: &Formula, exponent: &Formula) -> Result<Dimension, String> {
    if exponent.dimension != Dimension::NONE {
        return Err(format!("the exponent is {}", exponent.dimension.described()));
    }
    if base.dimension == Dimension::NONE {
        return Ok(Dimension::NONE);
    }
    let described = base.dimension.described();
    let constant = exponent.constant().ok_or(format!("{described} to a power that varies in space"))?;
    base.dimension
        .power(constant.value)
        .ok_or(format!("{described} to the power {} has no unit", constant.value))
}
