//! Values and names as they stand in the text.

use super::diagnosis::Fault;
use super::functions::Function;
use super::units;
use std::ops::Range;
use toml_edit::Value;

/// A value as it stands in the text.
#[derive(Debug, Clone)]
pub(super) struct Written<'a> {
    pub(super) content: Content<'a>,
    pub(super) span: Range<usize>,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Content<'a> {
    Number(f64),
    Text(&'a str),
}

impl<'a> Written<'a> {
    /// A number or a text; `None` for any other value.
    pub(super) fn of(value: &'a Value) -> Option<Self> {
        let content = match value {
            Value::Integer(number) => Content::Number(*number.value() as f64),
            Value::Float(number) => Content::Number(*number.value()),
            Value::String(text) => Content::Text(text.value()),
            _ => return None,
        };
        Some(Self { content, span: value.span().unwrap_or_default() })
    }
}

/// Checks that a parameter may have this name.
///
/// # Errors
/// A name that expressions cannot hold, or that means something else to them.
pub(super) fn check_name(name: &str, span: Range<usize>) -> Result<(), Fault> {
    let mut characters = name.chars();
    let starts = characters.next().is_some_and(|first| first.is_alphabetic() || first == '_');
    if !starts || !characters.all(|character| character.is_alphanumeric() || character == '_') {
        let help = "letters, digits and `_` make a name, so that expressions can use it";
        return Err(Fault::new(span, format!("`{name}` cannot name a parameter"), help));
    }
    let symbol = name.trim_end_matches(|last: char| last.is_ascii_digit());
    let power = &name[symbol.len()..];
    let reason = if matches!(name, "r" | "z") {
        "a coordinate"
    } else if matches!(name, "pi" | "auto") || Function::find(name).is_some() {
        "known to every expression"
    } else if units::find(symbol).is_some()
        && (power.is_empty() || power.parse::<i16>().is_ok_and(|power| power != 0))
    {
        "a unit"
    } else {
        return Ok(());
    };
    let help = "choose another name";
    Err(Fault::new(span, format!("`{name}` is {reason}: it cannot name a parameter"), help))
}
