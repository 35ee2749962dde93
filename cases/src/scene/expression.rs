//! Expressions as a scene writes them, with the place of every part.

use super::parser;
use super::quantity::{Dimension, Quantity};
use std::ops::Range;

/// What is wrong with an expression, and where in its text.
#[derive(Debug)]
pub(super) struct Mistake {
    pub(super) span: Range<usize>,
    pub(super) message: String,
    pub(super) help: String,
}

impl Mistake {
    pub(super) fn new(span: Range<usize>, message: impl Into<String>, help: impl Into<String>) -> Self {
        Self { span, message: message.into(), help: help.into() }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
}

/// A part of an expression with its place in the text.
#[derive(Debug)]
pub(super) struct Node {
    pub(super) part: Part,
    pub(super) span: Range<usize>,
}

#[derive(Debug)]
pub(super) enum Part {
    Number(Quantity),
    Name(String),
    Negate(Box<Node>),
    Binary(Operator, Box<[Node; 2]>),
    Call(String, Vec<Node>),
}

/// How two values may stand to one another.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Relation {
    Less,
    AtMost,
    Greater,
    AtLeast,
    Equal,
    Unequal,
}

impl Relation {
    /// All relations with their signs; one that begins another comes after it.
    pub(super) const SIGNS: [(&str, Self); 6] = [
        ("<=", Self::AtMost),
        (">=", Self::AtLeast),
        ("==", Self::Equal),
        ("!=", Self::Unequal),
        ("<", Self::Less),
        (">", Self::Greater),
    ];

    pub(super) fn holds(self, left: f64, right: f64) -> bool {
        match self {
            Self::Less => left < right,
            Self::AtMost => left <= right,
            Self::Greater => left > right,
            Self::AtLeast => left >= right,
            Self::Equal => left == right,
            Self::Unequal => left != right,
        }
    }
}

/// What is true or false, as it is written.
#[derive(Debug)]
pub(super) enum Test {
    Any(Vec<Test>),
    All(Vec<Test>),
    Not(Box<Test>),
    /// Each value stands to the next one in a relation.
    Compare(Vec<Node>, Vec<Relation>),
}

impl Node {
    /// Reads a whole text.
    ///
    /// # Errors
    /// At the first place that breaks the grammar.
    pub(super) fn parse(text: &str) -> Result<Self, Mistake> {
        parser::parse(text)
    }

    /// Every name that stands in the expression, functions aside.
    pub(super) fn names<'a>(&'a self, found: &mut Vec<&'a str>) {
        match &self.part {
            Part::Number(_) => {}
            Part::Name(name) => found.push(name),
            Part::Negate(inner) => inner.names(found),
            Part::Binary(_, sides) => sides.iter().for_each(|side| side.names(found)),
            Part::Call(_, arguments) => arguments.iter().for_each(|argument| argument.names(found)),
        }
    }
}

/// Zero needs no unit: it stands for nothing of any dimension.
pub(super) fn is_bare_zero(quantity: Quantity) -> bool {
    quantity.value == 0.0 && quantity.dimension == Dimension::NONE
}
