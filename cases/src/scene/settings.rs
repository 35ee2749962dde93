//! Values set from outside the file (`--set key=value`), written into the scene's text.

use super::suggest;
use std::ops::Range;
use toml_edit::{Document, Item, Table, TableLike, Value};

/// The names outside any table, which a bare key means before it means a parameter.
const TOP_LEVEL: [&str; 3] = ["format", "title", "paper"];

/// One `key=value`.
#[derive(Debug)]
pub(super) struct Setting {
    /// As it was given.
    pub(super) raw: String,
    /// Where the value starts in it.
    pub(super) value_start: usize,
    path: Vec<String>,
    /// How many parts of the path were there before.
    existing: usize,
}

/// What is wrong with a setting itself.
pub(super) struct BadSetting {
    pub(super) span: Range<usize>,
    pub(super) message: String,
    pub(super) help: String,
}

impl Setting {
    /// Writes a setting into the document; its comments stay.
    ///
    /// # Errors
    /// No `=`, a bare name that is no parameter, or a path through something that is no table.
    pub(super) fn apply(raw: &str, root: &mut Table) -> Result<Self, BadSetting> {
        let bad = |span: Range<usize>, message: String, help: String| BadSetting { span, message, help };
        let Some((key, value)) = raw.split_once('=') else {
            let help = "write --set key=value, for instance --set radius=\"15 um\"";
            return Err(bad(0..raw.len(), format!("`{raw}` sets nothing"), help.to_owned()));
        };
        let key_span = 0..key.len();
        let value_start = key.len() + 1 + (value.len() - value.trim_start().len());
        let mut path: Vec<String> = key.split('.').map(|part| part.trim().to_owned()).collect();
        if path.iter().any(String::is_empty) {
            let help = "write --set radius=\"15 um\" or --set method.theta=0.6";
            return Err(bad(key_span, format!("`{key}` is no key"), help.to_owned()));
        }
        if path.len() == 1 && !TOP_LEVEL.contains(&path[0].as_str()) {
            let known = parameter_names(root);
            if !known.iter().any(|name| *name == path[0]) {
                let known: Vec<&str> = known.iter().map(String::as_str).collect();
                let help = format!(
                    "{}; any other value has a dotted key, such as method.theta",
                    suggest::help("parameters", &path[0], &known)
                );
                return Err(bad(key_span, format!("the scene has no parameter `{}`", path[0]), help));
            }
            path.insert(0, "parameters".to_owned());
        }
        let existing = set_in_table(root, &path, parsed(value)).map_err(|depth| {
            let (message, help) = match path.get(depth) {
                None => {
                    (format!("`{key}` is a table"), format!("name one of its keys: --set {key}.KEY=VALUE"))
                }
                Some(part) => (
                    format!("`{}` holds no key `{part}`", path[..depth].join(".")),
                    "the key must lead through tables, and lists by their index from 0".to_owned(),
                ),
            };
            bad(key_span, message, help)
        })?;
        Ok(Self { raw: raw.to_owned(), value_start, path, existing })
    }

    /// Where its value now stands, followed by the places of the keys that it brought along.
    pub(super) fn places(&self, document: &Document<&str>) -> Vec<Range<usize>> {
        let mut keys = Vec::new();
        let mut place = Some(Place::Table(document.as_table()));
        for (depth, part) in self.path.iter().enumerate() {
            if let Some(table) = place.and_then(Place::table)
                && depth >= self.existing
            {
                keys.extend(table.key(part).and_then(toml_edit::Key::span));
            }
            place = place.and_then(|place| place.inner(part));
        }
        let value = place.and_then(|place| place.span());
        value.into_iter().chain(keys).collect()
    }
}

#[derive(Clone, Copy)]
enum Place<'a> {
    Table(&'a dyn TableLike),
    Tables(&'a toml_edit::ArrayOfTables),
    Value(&'a Value),
}

impl<'a> Place<'a> {
    fn table(self) -> Option<&'a dyn TableLike> {
        match self {
            Place::Table(table) => Some(table),
            Place::Value(Value::InlineTable(table)) => Some(table),
            _ => None,
        }
    }

    fn inner(self, part: &str) -> Option<Self> {
        match (self.table(), self) {
            (Some(table), _) => match table.get(part)? {
                Item::None => None,
                Item::Table(table) => Some(Place::Table(table)),
                Item::ArrayOfTables(tables) => Some(Place::Tables(tables)),
                Item::Value(value) => Some(Place::Value(value)),
            },
            (_, Place::Tables(tables)) => Some(Place::Table(tables.get(part.parse().ok()?)?)),
            (_, Place::Value(value)) => Some(Place::Value(value.as_array()?.get(part.parse().ok()?)?)),
            _ => None,
        }
    }

    fn span(self) -> Option<Range<usize>> {
        match self {
            Place::Value(value) => value.span(),
            _ => None,
        }
    }
}

fn parameter_names(root: &Table) -> Vec<String> {
    let table = root.get("parameters").and_then(Item::as_table_like);
    table.iter().flat_map(|table| table.iter()).map(|(name, _)| name.to_owned()).collect()
}

/// A TOML value where the text is one, else the text itself: the shell has eaten its quotes.
fn parsed(text: &str) -> Value {
    let text = text.trim();
    match text.parse::<Value>() {
        Ok(Value::Datetime(_)) | Err(_) => Value::from(text),
        Ok(value) => value,
    }
}

/// How many parts of the path were there before, or the depth at which the path leads nowhere: its own length where it
/// leads to a table.
fn set_in_table(table: &mut dyn TableLike, path: &[String], value: Value) -> Result<usize, usize> {
    let inner = match table.get_mut(&path[0]) {
        Some(item) => item,
        None => {
            let mut item = Item::Value(value);
            for (depth, part) in path.iter().enumerate().skip(1).rev() {
                let mut created = Table::new();
                // Only the table that holds the value needs a header of its own.
                created.set_implicit(depth + 1 < path.len());
                created.insert(part, item);
                item = Item::Table(created);
            }
            table.insert(&path[0], item);
            return Ok(0);
        }
    };
    set_in_item(inner, &path[1..], value).map(|depth| depth + 1).map_err(|depth| depth + 1)
}

fn set_in_item(item: &mut Item, path: &[String], value: Value) -> Result<usize, usize> {
    match item {
        Item::Value(slot) => set_in_value(slot, path, value),
        Item::Table(_) | Item::ArrayOfTables(_) if path.is_empty() => Err(0),
        Item::Table(table) => set_in_table(table, path, value),
        Item::ArrayOfTables(tables) => {
            let table = path[0].parse().ok().and_then(|index| tables.get_mut(index)).ok_or(0_usize)?;
            let rest = &path[1..];
            if rest.is_empty() {
                return Err(1);
            }
            set_in_table(table, rest, value).map(|depth| depth + 1).map_err(|depth| depth + 1)
        }
        Item::None => Err(0),
    }
}

fn set_in_value(slot: &mut Value, path: &[String], mut value: Value) -> Result<usize, usize> {
    if path.is_empty() {
        *value.decor_mut() = slot.decor().clone();
        *slot = value;
        return Ok(0);
    }
    match slot {
        Value::InlineTable(table) => set_in_table(table, path, value),
        Value::Array(array) => {
            let inner = path[0].parse().ok().and_then(|index| array.get_mut(index)).ok_or(0_usize)?;
            set_in_value(inner, &path[1..], value).map(|depth| depth + 1).map_err(|depth| depth + 1)
        }
        _ => Err(0),
    }
}
