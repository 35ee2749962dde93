//! The kinds of value a scene's keys take.

use super::diagnosis::Fault;
use super::entry::Entry;
use super::formula::Formula;
use super::quantity::{Dimension, Kind, NUMBER, Quantity, Short};
use super::suggest;

/// A choice among names.
pub trait Choice: Copy + PartialEq + 'static {
    /// Every choice with the name that scenes call it by.
    const NAMES: &'static [(&'static str, Self)];

    /// The name of this choice in a scene.
    fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, choice)| *choice == self).map_or("", |(name, _)| name)
    }
}

impl<'a> Entry<'a> {
    /// A text as it stands.
    pub(super) fn text(&self) -> Result<&'a str, Fault> {
        self.value()
            .and_then(|value| value.as_str())
            .ok_or_else(|| self.wrong_type("a text", "\"a text in quotes\""))
    }

    /// True or false.
    pub(super) fn flag(&self) -> Result<bool, Fault> {
        self.value().and_then(|value| value.as_bool()).ok_or_else(|| self.wrong_type("true or false", "true"))
    }

    /// One of several names.
    pub(super) fn choice<T: Choice>(&self) -> Result<T, Fault> {
        let given = self.text()?;
        let names: Vec<&str> = T::NAMES.iter().map(|(name, _)| *name).collect();
        T::NAMES.iter().find(|(name, _)| *name == given).map(|(_, choice)| *choice).ok_or_else(|| {
            let message = format!("`{}` knows no `{given}`", self.key());
            self.fault(message, suggest::help("values", given, &names))
        })
    }

    /// A finite quantity in SI units.
    pub(super) fn quantity(&self, kind: Kind) -> Result<f64, Fault> {
        let formula = self.formula_of(Some(kind), false)?;
        let value = formula.constant().map_or(f64::NAN, |quantity| quantity.value);
        if value.is_finite() {
            return Ok(value);
        }
        let message = format!("`{}` is {value}: not a finite number", self.key());
        Err(self.fault(message, format!("{} such as \"{}\" is expected", kind.name, kind.example)))
    }

    /// A quantity above zero.
    pub(super) fn positive(&self, kind: Kind) -> Result<f64, Fault> {
        self.checked(kind, "must be positive", |value| value > 0.0)
    }

    /// A quantity of zero or more.
    pub(super) fn not_negative(&self, kind: Kind) -> Result<f64, Fault> {
        self.checked(kind, "must not be negative", |value| value >= 0.0)
    }

    /// A quantity that a rule, told in words, accepts.
    pub(super) fn checked(&self, kind: Kind, rule: &str, accept: impl Fn(f64) -> bool) -> Result<f64, Fault> {
        let value = self.quantity(kind)?;
        if accept(value) {
            return Ok(value);
        }
        let unit =
            if kind.dimension == Dimension::NONE { String::new() } else { format!(" {}", kind.dimension) };
        let message = format!("`{}` is {}{unit}: it {rule}", self.key(), Short(value));
        let help = format!("{} such as {} is expected", kind.name, example(kind));
        Err(self.fault(message, help))
    }

    /// A whole number of at least `least`, and of at most 2^53: beyond that not every one has its own f64.
    pub(super) fn count(&self, least: u64) -> Result<u64, Fault> {
        let rule = format!("must be a whole number from {least} to 2^53");
        let accept =
            |value: f64| value.fract() == 0.0 && (least as f64..=9_007_199_254_740_992.0).contains(&value);
        Ok(self.checked(Kind { example: "10", ..NUMBER }, &rule, accept)? as u64)
    }

    /// An expression in r and z; of any dimension without a `kind`.
    pub(super) fn field(&self, kind: Option<Kind>) -> Result<Formula, Fault> {
        self.formula_of(kind, true)
    }

    fn formula_of(&self, kind: Option<Kind>, spatial: bool) -> Result<Formula, Fault> {
        let expected = kind.map_or("an expression", |kind| kind.name);
        let shown = kind.map_or("\"r^2 + z^2 - radius^2\"".to_owned(), example);
        let written = self.written().ok_or_else(|| self.wrong_type(expected, &shown))?;
        let formula = self.context.formula(&written, spatial)?;
        match kind {
            Some(kind) if formula.dimension() != kind.dimension && !formula.is_bare_zero() => {
                Err(self.wrong_unit(&formula, kind))
            }
            _ => Ok(formula),
        }
    }

    fn wrong_unit(&self, formula: &Formula, kind: Kind) -> Fault {
        let (given, key) = (self.shown(), self.key());
        let described = formula.dimension().described();
        let message =
            format!("`{given}` is {described}; `{key}` expects {} such as {}", kind.name, example(kind));
        let help = match formula.constant() {
            // What has no unit is in SI units as likely as not.
            Some(Quantity { value, dimension: Dimension::NONE }) if value.is_finite() => {
                format!("add a unit: \"{} {}\" in SI units", Short(value), kind.unit)
            }
            Some(Quantity { value, .. }) if !value.is_finite() => {
                format!("{} such as {} is expected", kind.name, example(kind))
            }
            _ => format!(
                "give `{key}` a value in {}",
                if kind.dimension == Dimension::NONE {
                    "no unit".to_owned()
                } else {
                    kind.dimension.to_string()
                }
            ),
        };
        self.fault(message, help)
    }
}

fn example(kind: Kind) -> String {
    if kind.dimension == Dimension::NONE { kind.example.to_owned() } else { format!("\"{}\"", kind.example) }
}
