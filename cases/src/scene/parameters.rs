//! The scene's `[parameters]`: names for quantities, which may be expressions of one another.

use super::Parameter;
use super::compiler::{Compiler, Meaning};
use super::diagnosis::Fault;
use super::expression::{Mistake, Node, Part};
use super::formula::Formula;
use super::quantity::{Dimension, Quantity};
use super::written::{Content, Written, check_name};
use std::collections::HashMap;
use std::ops::Range;
use toml_edit::TableLike;

/// What all of a scene's values are read against: its text and its parameters.
pub(super) struct Context<'a> {
    text: &'a str,
    definitions: Vec<Definition<'a>>,
    resolved: HashMap<&'a str, Option<Quantity>>,
}

/// Parameters that may build on one another, so that no scene exhausts the stack.
const LONGEST_CHAIN: usize = 100;

struct Definition<'a> {
    name: &'a str,
    written: Written<'a>,
}

impl<'a> Context<'a> {
    /// Reads the table of parameters, if there is one, and works out their values.
    ///
    /// # Errors
    /// Names that mean something else already, values that are neither numbers nor texts, mistakes
    /// in their expressions, circles among them.
    pub(super) fn new(text: &'a str, table: Option<&'a dyn TableLike>) -> Result<Self, Fault> {
        let mut context = Self { text, definitions: Vec::new(), resolved: HashMap::new() };
        for (name, item) in table.iter().flat_map(|table| table.iter()) {
            let key =
                table.and_then(|table| table.key(name)).and_then(toml_edit::Key::span).unwrap_or_default();
            check_name(name, key.clone())?;
            let written = item.as_value().and_then(Written::of).ok_or_else(|| {
                let help = format!("write it like {name} = \"2.5 um\", {name} = 2 or {name} = \"2*radius\"");
                Fault::new(
                    item.span().unwrap_or(key),
                    format!("the parameter `{name}` is neither a number nor a text"),
                    help,
                )
            })?;
            context.definitions.push(Definition { name, written });
        }
        for index in 0..context.definitions.len() {
            context.resolve(index, &mut Vec::new())?;
        }
        Ok(context)
    }

    /// The parameters in the order of the text.
    pub(super) fn parameters(&self) -> Vec<Parameter> {
        let value = |name: &str| self.resolved.get(name).copied().flatten();
        self.definitions
            .iter()
            .map(|definition| Parameter { name: definition.name.to_owned(), value: value(definition.name) })
            .collect()
    }

    /// Finds a parameter that is no finite number. Asked only once the parameters that stand on
    /// their own have been checked where they are used: one of those is the likely cause.
    ///
    /// # Errors
    /// At that parameter.
    pub(super) fn check_finite(&self) -> Result<(), Fault> {
        for Definition { name, written } in &self.definitions {
            if let Some(Quantity { value, .. }) = self.resolved.get(name).copied().flatten()
                && !value.is_finite()
            {
                let message = format!("the parameter `{name}` is {value}: not a finite number");
                let help = "check for divisions by zero, and for roots and logarithms of negative numbers";
                return Err(Fault::new(written.span.clone(), message, help));
            }
        }
        Ok(())
    }

    /// Reads a value as a formula; r and z mean something only where it is `spatial`.
    pub(super) fn formula(&self, written: &Written<'_>, spatial: bool) -> Result<Formula, Fault> {
        let text = match written.content {
            Content::Number(value) => {
                return Ok(Formula::constant_of(Quantity { value, dimension: Dimension::NONE }));
            }
            Content::Text(text) => text,
        };
        let known: Vec<&str> = self.definitions.iter().map(|definition| definition.name).collect();
        let meaning = |name: &str| match self.resolved.get(name) {
            Some(Some(quantity)) => Meaning::Value(*quantity),
            Some(None) => Meaning::Auto,
            None => Meaning::Unknown,
        };
        let compiler = Compiler { meaning: &meaning, known: &known, spatial };
        Node::parse(text)
            .and_then(|node| compiler.formula(&node))
            .map_err(|mistake| self.place(mistake, written))
    }

    /// Whether a value is "auto" or names a parameter that is.
    pub(super) fn is_auto(&self, written: &Written<'_>) -> bool {
        match written.content {
            Content::Text(text) => text == "auto" || matches!(self.resolved.get(text.trim()), Some(None)),
            Content::Number(_) => false,
        }
    }

    /// Where a value comes from: a value that only names a parameter is that parameter's.
    pub(super) fn blame(&self, written: &Written<'a>) -> Written<'a> {
        let mut blamed = written.clone();
        while let Some(definition) = self.named(&blamed) {
            blamed = definition.written.clone();
        }
        blamed
    }

    /// The scene's text at a place.
    pub(super) fn text_at(&self, span: Range<usize>) -> &'a str {
        self.text.get(span).unwrap_or_default()
    }

    fn named(&self, written: &Written<'_>) -> Option<&Definition<'a>> {
        match written.content {
            Content::Text(text) => self.definition(text.trim()).map(|index| &self.definitions[index]),
            Content::Number(_) => None,
        }
    }

    fn definition(&self, name: &str) -> Option<usize> {
        self.definitions.iter().position(|definition| definition.name == name)
    }

    /// Works out one parameter, after those it is made of. `open` holds the ones on the way here.
    fn resolve(&mut self, index: usize, open: &mut Vec<usize>) -> Result<(), Fault> {
        let Definition { name, written } = &self.definitions[index];
        let (name, written) = (*name, written.clone());
        if self.resolved.contains_key(name) {
            return Ok(());
        }
        if open.len() > LONGEST_CHAIN {
            let message = format!("more than {LONGEST_CHAIN} parameters build on one another");
            return Err(Fault::new(written.span, message, "give some of them values of their own"));
        }
        if open.contains(&index) {
            let circle: Vec<&str> = open.iter().map(|&index| self.definitions[index].name).collect();
            let message =
                format!("the parameters define one another in a circle: {} -> {name}", circle.join(" -> "));
            return Err(Fault::new(written.span, message, "give one of them a value of its own"));
        }
        if let Content::Text(text) = written.content {
            if text == "auto" {
                self.resolved.insert(name, None);
                return Ok(());
            }
            let node = Node::parse(text).map_err(|mistake| self.place(mistake, &written))?;
            let mut names = Vec::new();
            node.names(&mut names);
            open.push(index);
            for name in names {
                if let Some(other) = self.definition(name) {
                    self.resolve(other, open)?;
                }
            }
            open.pop();
            if let Part::Name(other) = &node.part
                && self.resolved.get(other.as_str()) == Some(&None)
            {
                self.resolved.insert(name, None);
                return Ok(());
            }
        }
        let quantity = self.formula(&written, false)?.constant();
        self.resolved.insert(name, quantity);
        Ok(())
    }

    /// Puts a mistake of an expression into the scene's text. Where escapes hide its place, the
    /// whole value is to blame.
    fn place(&self, mistake: Mistake, written: &Written<'_>) -> Fault {
        let inside = match written.content {
            Content::Text(text) => self.text_at(written.span.clone()).find(text),
            Content::Number(_) => None,
        };
        let span = match inside {
            Some(offset) if !mistake.span.is_empty() => {
                let start = written.span.start + offset;
                start + mistake.span.start..start + mistake.span.end
            }
            _ => written.span.clone(),
        };
        Fault::new(span, mistake.message, mistake.help)
    }
}
