//! Reading one table of a scene, key by key, with a place for every mistake.

use super::diagnosis::Fault;
use super::entry::{Entry, Node};
use super::parameters::Context;
use super::suggest;
use std::ops::Range;
use toml_edit::TableLike;

/// A table whose keys are all known.
pub(super) struct Section<'a> {
    context: &'a Context<'a>,
    path: String,
    table: &'a dyn TableLike,
    span: Range<usize>,
}

impl<'a> Section<'a> {
    /// A table, after a look at its keys.
    ///
    /// # Errors
    /// A key that is not among the `known` ones.
    pub(super) fn new(entry: Entry<'a>, known: &[&str]) -> Result<Self, Fault> {
        let Node::Table(table) = entry.node else {
            let help = suggest::help("keys", "", known);
            return Err(Fault::new(entry.span.clone(), format!("`{}` must be a table", entry.path), help));
        };
        let section = Self { context: entry.context, path: entry.path, table, span: entry.span };
        for (key, item) in table.iter() {
            if !known.contains(&key) {
                let span = table.key(key).and_then(toml_edit::Key::span).or(item.span()).unwrap_or_default();
                let message = format!("unknown key `{key}` in {}", section.place());
                return Err(Fault::new(span, message, suggest::help("keys", key, known)));
            }
        }
        Ok(section)
    }

    /// The entry under a key.
    ///
    /// # Errors
    /// If the key is missing.
    pub(super) fn required(&self, key: &str, example: &str) -> Result<Entry<'a>, Fault> {
        self.optional(key).ok_or_else(|| {
            Fault::new(
                self.span.clone(),
                format!("missing key `{key}` in {}", self.place()),
                format!("add: {example}"),
            )
            .labelled(format!("`{key}` is missing here"))
        })
    }

    /// The entry under a key, if it is there.
    pub(super) fn optional(&self, key: &str) -> Option<Entry<'a>> {
        let item = self.table.get(key)?;
        let node = Node::of(item)?;
        let path = if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) };
        let key_span = self.table.key(key).and_then(toml_edit::Key::span);
        let span = item.span().or(key_span).unwrap_or_default();
        Some(Entry { context: self.context, path, span, node })
    }

    /// The entry under a key of a table in this one, if it is there.
    pub(super) fn inner(&self, table: &str, key: &str) -> Option<Entry<'a>> {
        let Entry { context, path, span, node } = self.optional(table)?;
        let Node::Table(table) = node else { return None };
        Section { context, path, table, span }.optional(key)
    }

    /// What `read` makes of the entry under a key, or `default` without one.
    ///
    /// # Errors
    /// Those of `read`.
    pub(super) fn read_or<T>(
        &self,
        key: &str,
        default: T,
        read: impl FnOnce(Entry<'a>) -> Result<T, Fault>,
    ) -> Result<T, Fault> {
        self.optional(key).map_or(Ok(default), read)
    }

    fn place(&self) -> String {
        match self.path.as_str() {
            "" => "the scene".to_owned(),
            path => format!("`{path}`"),
        }
    }
}
