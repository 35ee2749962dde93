//! Checked expressions, ready to be evaluated.

use super::expression::{Operator, is_bare_zero};
use super::functions::Function;
use super::quantity::{Dimension, Quantity};

/// A checked expression in r and z, in SI units throughout.
#[derive(Debug, Clone)]
pub struct Formula {
    pub(super) code: Code,
    pub(super) dimension: Dimension,
}

impl Formula {
    /// Zero, of any dimension.
    pub fn zero() -> Self {
        Self { code: Code::Constant(0.0), dimension: Dimension::NONE }
    }

    /// The same quantity everywhere.
    pub(super) fn constant_of(quantity: Quantity) -> Self {
        Self { code: Code::Constant(quantity.value), dimension: quantity.dimension }
    }

    /// Value at the point r, z, both in metres.
    pub fn at(&self, r: f64, z: f64) -> f64 {
        self.code.at(r, z, &[])
    }

    /// Value for a particle at r, z (m) whose fields have the given values, in SI units.
    pub(super) fn of_particle(&self, r: f64, z: f64, fields: &[f64]) -> f64 {
        self.code.at(r, z, fields)
    }

    pub(super) fn dimension(&self) -> Dimension {
        self.dimension
    }

    /// The value, if it depends on neither r nor z.
    pub(super) fn constant(&self) -> Option<Quantity> {
        match self.code {
            Code::Constant(value) => Some(Quantity { value, dimension: self.dimension }),
            _ => None,
        }
    }

    /// Whether it is the constant zero without a unit, which fits any dimension.
    pub(super) fn is_bare_zero(&self) -> bool {
        self.constant().is_some_and(is_bare_zero)
    }
}

/// What is computed: a tree of operations on SI values.
#[derive(Debug, Clone)]
pub(super) enum Code {
    Constant(f64),
    Radius,
    Height,
    /// A particle's field by its number; no scene has any.
    Field(usize),
    Negate(Box<Code>),
    Binary(Operator, Box<[Code; 2]>),
    WholePower(Box<Code>, i32),
    Call(Function, Box<[Code]>),
    Legendre {
        degree: usize,
        derivative: bool,
        argument: Box<Code>,
    },
}

impl Code {
    fn at(&self, r: f64, z: f64, fields: &[f64]) -> f64 {
        match self {
            Code::Constant(value) => *value,
            Code::Radius => r,
            Code::Height => z,
            Code::Field(number) => fields.get(*number).copied().unwrap_or(f64::NAN),
            Code::Negate(inner) => -inner.at(r, z, fields),
            Code::Binary(operator, sides) => {
                apply(*operator, sides[0].at(r, z, fields), sides[1].at(r, z, fields))
            }
            Code::WholePower(base, exponent) => base.at(r, z, fields).powi(*exponent),
            Code::Call(function, arguments) => {
                let second = arguments.get(1).map_or(0.0, |second| second.at(r, z, fields));
                function.value(arguments[0].at(r, z, fields), second)
            }
            Code::Legendre { degree, derivative, argument } => {
                super::functions::legendre(*degree, argument.at(r, z, fields))[usize::from(*derivative)]
            }
        }
    }

    /// Numbers of the particles' fields that go into it.
    pub(super) fn fields(&self, found: &mut Vec<usize>) {
        match self {
            Code::Constant(_) | Code::Radius | Code::Height => {}
            Code::Field(number) => found.push(*number),
            Code::Negate(inner) | Code::WholePower(inner, _) => inner.fields(found),
            Code::Legendre { argument, .. } => argument.fields(found),
            Code::Binary(_, sides) => sides.iter().for_each(|side| side.fields(found)),
            Code::Call(_, arguments) => arguments.iter().for_each(|argument| argument.fields(found)),
        }
    }

    /// The value in place of the code, if all that goes into it is constant.
    pub(super) fn folded(self, inputs_constant: bool) -> Self {
        if inputs_constant { Code::Constant(self.at(0.0, 0.0, &[])) } else { self }
    }
}

fn apply(operator: Operator, left: f64, right: f64) -> f64 {
    match operator {
        Operator::Add => left + right,
        Operator::Subtract => left - right,
        Operator::Multiply => left * right,
        Operator::Divide => left / right,
        Operator::Power => left.powf(right),
    }
}

/// The dimension of two formulas that are added or compared; a bare zero takes the other's.
pub(super) fn common_dimension(left: &Formula, right: &Formula) -> Option<Dimension> {
    if left.dimension == right.dimension || right.is_bare_zero() {
        Some(left.dimension)
    } else {
        left.is_bare_zero().then_some(right.dimension)
    }
}
