//! The scene's text with its settings, and the way from a place in it back to who wrote it.

use super::diagnosis::{Diagnosis, Fault, Place};
use super::settings::Setting;
use miette::{NamedSource, Severity};
use std::ops::Range;
use toml_edit::{Document, DocumentMut};

/// The effective text of a scene.
pub(super) struct Source<'a> {
    name: &'a str,
    original: &'a str,
    /// The original with all settings written into it.
    pub(super) text: String,
    settings: Vec<(Setting, Vec<Range<usize>>)>,
}

impl<'a> Source<'a> {
    /// Applies settings (`key=value`) to a scene's text.
    ///
    /// # Errors
    /// Text that is no TOML, and settings that set nothing.
    pub(super) fn new(name: &'a str, original: &'a str, settings: &[String]) -> Result<Self, Diagnosis> {
        let mut source = Self { name, original, text: original.to_owned(), settings: Vec::new() };
        let document =
            Document::parse(original).map_err(|error| source.diagnose(Severity::Error, syntax(&error)))?;
        if settings.is_empty() {
            return Ok(source);
        }
        let mut edited: DocumentMut = document.into_mut();
        let mut applied = Vec::new();
        for raw in settings {
            applied.push(Setting::apply(raw, edited.as_table_mut()).map_err(|bad| {
                let place = Place {
                    source: NamedSource::new("--set", raw.clone()),
                    span: bad.span,
                    label: String::new(),
                };
                Diagnosis::new(Severity::Error, bad.message, bad.help, Some(place))
            })?);
        }
        source.text = edited.to_string();
        let text = source.text.clone();
        let document = Document::parse(text.as_str())
            .map_err(|error| source.diagnose(Severity::Error, syntax(&error)))?;
        source.settings = applied
            .into_iter()
            .map(|setting| {
                let places = setting.places(&document);
                (setting, places)
            })
            .collect();
        Ok(source)
    }

    /// Turns a mistake in the effective text into a diagnosis of what the user wrote: the setting,
    /// where one is to blame, else the file.
    pub(super) fn diagnose(&self, severity: Severity, fault: Fault) -> Diagnosis {
        let (source, span) =
            self.setting_at(&fault.span).or_else(|| self.original_at(&fault.span)).unwrap_or_else(|| {
                (NamedSource::new(self.name, self.text.clone()), first_line(&self.text, fault.span.clone()))
            });
        let place = Place { source, span, label: fault.label };
        Diagnosis::new(severity, fault.message, fault.help, Some(place))
    }

    fn setting_at(&self, span: &Range<usize>) -> Option<(NamedSource<String>, Range<usize>)> {
        let holds =
            |place: &Range<usize>| place.start <= span.start && span.end <= place.end && !span.is_empty();
        // The last setting of a key is the one that counts.
        let (setting, index) = self.settings.iter().rev().find_map(|(setting, places)| {
            places.iter().position(holds).map(|index| (setting, (index, places)))
        })?;
        let (index, places) = index;
        let raw = &setting.raw;
        let key = 0..setting.raw.find('=').unwrap_or(raw.len());
        let whole = setting.value_start..raw.trim_end().len().max(setting.value_start);
        let place =
            if index > 0 { key } else { self.within_value(raw, &whole, span, &places[0]).unwrap_or(whole) };
        Some((NamedSource::new("--set", raw.clone()), place))
    }

    /// The same stretch of the value as it was given: there its quotes may be missing.
    fn within_value(
        &self,
        raw: &str,
        whole: &Range<usize>,
        span: &Range<usize>,
        value: &Range<usize>,
    ) -> Option<Range<usize>> {
        if span == value {
            return None;
        }
        let wanted = &self.text[span.clone()];
        let offset = whole.start + span.start - value.start;
        [Some(offset), offset.checked_sub(1)]
            .into_iter()
            .flatten()
            .map(|start| start..start + span.len())
            .find(|place| raw.get(place.clone()) == Some(wanted))
    }

    /// The same place of the file before the settings: the nearest line of the same text.
    fn original_at(&self, span: &Range<usize>) -> Option<(NamedSource<String>, Range<usize>)> {
        let start = self.text[..span.start].rfind('\n').map_or(0, |position| position + 1);
        let line = self.text[start..].lines().next().unwrap_or_default();
        let number = self.text[..start].matches('\n').count();
        let mut position = 0;
        let mut best: Option<(usize, usize)> = None;
        for (index, candidate) in self.original.split_inclusive('\n').enumerate() {
            if candidate.trim_end_matches(['\n', '\r']) == line {
                let found = (index.abs_diff(number), position);
                best = Some(best.map_or(found, |best| best.min(found)));
            }
            position += candidate.len();
        }
        let (_, found) = best?;
        let offset = span.start - start;
        let length = span.len().min(line.len() - offset.min(line.len()));
        Some((NamedSource::new(self.name, self.original.to_owned()), found + offset..found + offset + length))
    }
}

/// A stretch cut off at the end of its first line.
fn first_line(text: &str, span: Range<usize>) -> Range<usize> {
    let length = text.get(span.clone()).and_then(|text| text.lines().next()).map_or(0, str::len);
    span.start..span.start + length
}

/// The fault that a broken text makes.
pub(super) fn syntax(error: &toml_edit::TomlError) -> Fault {
    let message = format!("this is no TOML: {}", error.message().trim().replace('\n', ", "));
    Fault::new(
        error.span().unwrap_or_default(),
        message,
        "a line of a scene is `key = value` or a [table]; texts need quotes",
    )
}
