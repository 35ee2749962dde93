//! The words, numbers and units that expressions are made of.

use super::expression::Mistake;
use super::quantity::Quantity;
use super::units::{self, Measure};

/// Words of conditions that may follow a number without a unit.
const KEYWORDS: [&str; 2] = ["and", "or"];

/// A text and how far it has been read.
pub(super) struct Scanner<'a> {
    pub(super) text: &'a str,
    pub(super) position: usize,
}

impl<'a> Scanner<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Self { text, position: 0 }
    }

    /// A number with the unit that may follow it.
    ///
    /// # Errors
    /// Digits that make no number, letters that make no unit.
    pub(super) fn quantity(&mut self) -> Result<Quantity, Mistake> {
        let start = self.position;
        self.skip(|character| character.is_ascii_digit() || character == '.');
        let exponent = &self.text[self.position..];
        let digits =
            exponent.strip_prefix(['e', 'E']).map(|rest| rest.strip_prefix(['+', '-']).unwrap_or(rest));
        if let Some(digits) = digits.filter(|rest| rest.starts_with(|first: char| first.is_ascii_digit())) {
            self.position += exponent.len() - digits.len();
            self.skip(|character| character.is_ascii_digit());
        }
        let written = &self.text[start..self.position];
        let value: f64 = written.parse().map_err(|_| {
            Mistake::new(
                start..self.position,
                format!("`{written}` is no number"),
                "write it like 2.5 or 1.5e-6",
            )
        })?;
        self.unit(value)
    }

    /// The unit after a number, if one follows.
    fn unit(&mut self, number: f64) -> Result<Quantity, Mistake> {
        let mut measure = Measure::new(number);
        let mut sign = 1;
        let mut first = true;
        loop {
            let before = self.position;
            self.skip_spaces();
            if !first {
                sign = if self.eat('/') { -1 } else { 1 };
                if sign == 1 && !self.eat('*') {
                    self.eat('\u{b7}');
                }
                self.skip_spaces();
            }
            let start = self.position;
            let symbol = self.take(|character| character.is_alphabetic());
            let power = self.unit_power();
            // What goes on after a unit's letters and exponent is a name.
            let ends = !self.peek().is_some_and(|next| next.is_alphanumeric() || next == '_' || next == '(');
            match units::find(symbol).filter(|_| ends && power != 0) {
                Some(unit) => {
                    measure.times(unit, sign * power).ok_or_else(|| {
                        Mistake::new(start..self.position, "this power of a unit is too high", units::HELP)
                    })?;
                }
                None if first && !symbol.is_empty() && !KEYWORDS.contains(&symbol) => {
                    self.position = start;
                    let word = self.word();
                    let help = format!("{}; a product needs its `*`", units::HELP);
                    return Err(Mistake::new(
                        start..start + word.len(),
                        format!("`{word}` is no unit"),
                        help,
                    ));
                }
                None => {
                    self.position = before;
                    return Ok(measure.quantity());
                }
            }
            first = false;
        }
    }

    /// The exponent right after a unit's symbol: `m3`, `m^3` or `m^-3`.
    fn unit_power(&mut self) -> i16 {
        let before = self.position;
        let caret = self.text[before..].starts_with('^');
        self.position += usize::from(caret);
        let negative = caret && self.text[self.position..].starts_with('-');
        self.position += usize::from(negative);
        match self.take(|character| character.is_ascii_digit()).parse::<i16>() {
            Ok(power) => {
                if negative {
                    -power
                } else {
                    power
                }
            }
            Err(_) => {
                self.position = before;
                1
            }
        }
    }

    /// Goes past a character that must come next, spaces aside.
    pub(super) fn expect(&mut self, wanted: char) -> Result<(), Mistake> {
        if self.eat(wanted) { Ok(()) } else { Err(self.unexpected(&format!("`{wanted}`"))) }
    }

    /// Goes past a character if it comes next, spaces aside.
    pub(super) fn eat(&mut self, wanted: char) -> bool {
        self.skip_spaces();
        let found = self.peek() == Some(wanted);
        self.position += if found { wanted.len_utf8() } else { 0 };
        found
    }

    /// Goes past a name.
    pub(super) fn word(&mut self) -> &'a str {
        self.take(|character| character.is_alphanumeric() || character == '_')
    }

    fn take(&mut self, belongs: impl Fn(char) -> bool) -> &'a str {
        let start = self.position;
        self.skip(belongs);
        &self.text[start..self.position]
    }

    fn skip(&mut self, belongs: impl Fn(char) -> bool) {
        let rest = &self.text[self.position..];
        self.position += rest.find(|character| !belongs(character)).unwrap_or(rest.len());
    }

    /// Goes past spaces.
    pub(super) fn skip_spaces(&mut self) {
        self.skip(char::is_whitespace);
    }

    /// The next character.
    pub(super) fn peek(&self) -> Option<char> {
        self.text[self.position..].chars().next()
    }

    /// The mistake that something else was expected here.
    pub(super) fn unexpected(&self, wanted: &str) -> Mistake {
        let (found, length) = match self.peek() {
            Some(character) => (format!("found `{character}`"), character.len_utf8()),
            None => ("it ends".to_owned(), 0),
        };
        let message = format!("the expression does not parse: expected {wanted}, but {found}");
        Mistake::new(
            self.position..self.position + length,
            message,
            "expressions know + - * / ^, parentheses and functions such as sqrt(x)",
        )
    }
}
