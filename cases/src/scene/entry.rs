//! One value of a scene, with all that a mistake about it needs.

use super::diagnosis::Fault;
use super::parameters::Context;
use super::section::Section;
use super::suggest;
use super::written::Written;
use std::ops::Range;
use toml_edit::{ArrayOfTables, Item, TableLike, Value};

/// One value (or table) of a scene under its key.
#[derive(Clone)]
pub(super) struct Entry<'a> {
    pub(super) context: &'a Context<'a>,
    /// From the top of the scene, as `--set` writes it.
    pub(super) path: String,
    pub(super) span: Range<usize>,
    pub(super) node: Node<'a>,
}

/// What can stand under a key.
#[derive(Clone, Copy)]
pub(super) enum Node<'a> {
    Value(&'a Value),
    Table(&'a dyn TableLike),
    Tables(&'a ArrayOfTables),
}

impl<'a> Node<'a> {
    pub(super) fn of(item: &'a Item) -> Option<Self> {
        match item {
            Item::None => None,
            Item::Value(value) => Some(Self::of_value(value)),
            Item::Table(table) => Some(Self::Table(table)),
            Item::ArrayOfTables(tables) => Some(Self::Tables(tables)),
        }
    }

    fn of_value(value: &'a Value) -> Self {
        match value {
            Value::InlineTable(table) => Self::Table(table),
            value => Self::Value(value),
        }
    }
}

impl<'a> Entry<'a> {
    /// The whole scene.
    pub(super) fn root(context: &'a Context<'a>, table: &'a dyn TableLike) -> Self {
        Self { context, path: String::new(), span: 0..0, node: Node::Table(table) }
    }

    /// The last part of the path.
    pub(super) fn key(&self) -> &str {
        self.path.rsplit('.').next().unwrap_or_default()
    }

    /// The elements of an array.
    ///
    /// # Errors
    /// If it is no array.
    pub(super) fn elements(&self, example: &str) -> Result<Vec<Entry<'a>>, Fault> {
        let entry = |index: usize, node: Node<'a>, span: Option<Range<usize>>| Entry {
            context: self.context,
            path: format!("{}.{index}", self.path),
            span: span.unwrap_or(self.span.clone()),
            node,
        };
        match self.node {
            Node::Tables(tables) => Ok(tables
                .iter()
                .enumerate()
                .map(|(index, table)| entry(index, Node::Table(table), table.span()))
                .collect()),
            Node::Value(Value::Array(array)) => Ok(array
                .iter()
                .enumerate()
                .map(|(index, value)| entry(index, Node::of_value(value), value.span()))
                .collect()),
            _ => Err(self.wrong_type("a list", example)),
        }
    }

    /// The single key of a table that says which of several kinds it is, and what stands under it.
    ///
    /// # Errors
    /// If it is no table, or has not exactly one key, or one that is not known.
    pub(super) fn variant(self, known: &[&str], example: &str) -> Result<Entry<'a>, Fault> {
        if !matches!(self.node, Node::Table(_)) {
            return Err(self.wrong_type("a table with one key", example));
        }
        let whole = self.clone();
        let section = Section::new(self, known)?;
        let mut found = known.iter().filter_map(|key| section.optional(key));
        match (found.next(), found.next()) {
            (Some(entry), None) => Ok(entry),
            (first, _) => {
                let problem = if first.is_none() { "no kind" } else { "more than one kind" };
                let message = format!("`{}` has {problem}: it needs exactly one key", whole.path);
                let help = format!("write it like {example}; {}", suggest::help("kinds", "", known));
                Err(Fault::new(whole.span, message, help))
            }
        }
    }

    pub(super) fn value(&self) -> Option<&'a Value> {
        match self.node {
            Node::Value(value) => Some(value),
            _ => None,
        }
    }

    /// The number or text here as it is written, if it is one.
    pub(super) fn written(&self) -> Option<Written<'a>> {
        self.value().and_then(Written::of)
    }

    /// Whether this is "auto", or a parameter that is.
    pub(super) fn is_auto(&self) -> bool {
        self.written().is_some_and(|written| self.context.is_auto(&written))
    }

    /// A mistake of this value. Where it only names a parameter, the parameter is to blame.
    pub(super) fn fault(&self, message: impl Into<String>, help: impl Into<String>) -> Fault {
        let Some(written) = self.written() else {
            return Fault::new(self.span.clone(), message, help);
        };
        let blamed = self.context.blame(&written);
        let fault = Fault::new(blamed.span.clone(), message, help);
        if blamed.span == written.span { fault } else { fault.labelled(format!("used as `{}`", self.path)) }
    }

    /// The value as it stands in the text (that of the parameter it names).
    pub(super) fn shown(&self) -> &'a str {
        let span = self.written().map_or(self.span.clone(), |written| self.context.blame(&written).span);
        self.context.text_at(span).trim_matches(['"', '\''])
    }

    /// A mistake about the type of this value.
    pub(super) fn wrong_type(&self, expected: &str, example: &str) -> Fault {
        let found = match self.node {
            Node::Table(_) => "a table",
            Node::Tables(_) => "a list of tables",
            Node::Value(value) => match value {
                Value::String(_) => "a text",
                Value::Integer(_) | Value::Float(_) => "a number",
                Value::Boolean(_) => "true or false",
                Value::Datetime(_) => "a date",
                Value::Array(_) => "a list",
                Value::InlineTable(_) => "a table",
            },
        };
        let message = format!("`{}` expects {expected}, not {found}", self.key());
        Fault::new(self.span.clone(), message, format!("write it like {example}"))
    }
}
