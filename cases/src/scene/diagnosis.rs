//! What is reported about a scene: one mistake or doubt, with the place it is about.

use miette::{
    Diagnostic, LabeledSpan, MietteError, MietteSpanContents, NamedSource, Severity, SourceCode, SourceSpan,
    SpanContents,
};
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// One mistake (an error) or doubt (a warning) about a scene, with the file, the place that is to
/// blame, and help. Displayed in full by `miette`.
#[derive(Debug, Clone)]
pub struct Diagnosis {
    severity: Severity,
    report: Arc<Report>,
}

#[derive(Debug)]
struct Report {
    message: String,
    help: String,
    place: Option<Place>,
}

/// A stretch of a source and what to write under it.
#[derive(Debug, Clone)]
pub(super) struct Place {
    pub(super) source: NamedSource<String>,
    pub(super) span: Range<usize>,
    pub(super) label: String,
}

/// Longest line of a source that is shown whole, in bytes.
const LONGEST_LINE: usize = 400;

impl Place {
    /// What is underlined: of a long stretch its beginning.
    fn shown(&self) -> Range<usize> {
        let Range { start, end } = self.span;
        start..self.source.inner().floor_char_boundary(end.min(start + LONGEST_LINE / 2))
    }
}

/// The source, of a long line only what lies around the place.
impl SourceCode for Place {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        before: usize,
        after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        let contents = self.source.read_span(span, before, after)?;
        if contents.data().split(|byte| *byte == b'\n').all(|line| line.len() <= LONGEST_LINE) {
            return Ok(contents);
        }
        let (text, place) = (self.source.inner(), span.offset());
        let line = text[..place].rfind('\n').map_or(0, |position| position + 1);
        let reach = LONGEST_LINE / 2 * before.min(1);
        let start = text.floor_char_boundary(line.max(place.saturating_sub(reach)));
        let end = text[place..].find('\n').map_or(text.len(), |length| place + length);
        let end = text.floor_char_boundary(end.min(place + LONGEST_LINE / 2));
        Ok(Box::new(MietteSpanContents::new_named(
            self.source.name().to_owned(),
            &text.as_bytes()[start..end],
            (start, end - start).into(),
            text[..line].matches('\n').count(),
            start - line,
            1,
        )))
    }
}

impl Diagnosis {
    pub(super) fn new(severity: Severity, message: String, help: String, place: Option<Place>) -> Self {
        Self { severity, report: Arc::new(Report { message, help, place }) }
    }

    /// The same with a reason that was found only later.
    pub(crate) fn because(&self, reason: impl fmt::Display) -> Self {
        let Report { message, help, place } = &*self.report;
        Self::new(self.severity, format!("{message}: {reason}"), help.clone(), place.clone())
    }

    /// The same where it is about a setting that another option than `--set` has given, which shows it from a byte on.
    #[must_use]
    pub fn given_by(self, option: &str, setting: &str, start: usize) -> Self {
        let Some(place) = &self.report.place else { return self };
        if place.source.name() != "--set" || place.source.inner() != setting {
            return self;
        }
        let Range { start: first, end } = place.span;
        let place = Place {
            source: NamedSource::new(option, setting[start..].to_owned()),
            span: first.saturating_sub(start)..end.saturating_sub(start),
            label: place.label.clone(),
        };
        let Report { message, help, .. } = &*self.report;
        Self::new(self.severity, message.clone(), help.clone(), Some(place))
    }

    /// Whether this is an error, not a warning.
    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }

    /// Name of the source that is to blame: the scene's path, or `--set`.
    pub fn source_name(&self) -> Option<&str> {
        self.report.place.as_ref().map(|place| place.source.name())
    }

    /// Line of that source, counted from 1.
    pub fn line(&self) -> Option<usize> {
        let place = self.report.place.as_ref()?;
        Some(place.source.inner()[..place.span.start].matches('\n').count() + 1)
    }

    /// The text that is underlined.
    pub fn blamed(&self) -> Option<&str> {
        let place = self.report.place.as_ref()?;
        Some(&place.source.inner()[place.span.clone()])
    }
}

impl fmt::Display for Diagnosis {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.report.message)
    }
}

impl std::error::Error for Diagnosis {}

impl Diagnostic for Diagnosis {
    fn severity(&self) -> Option<Severity> {
        Some(self.severity)
    }

    fn help(&self) -> Option<Box<dyn fmt::Display + '_>> {
        (!self.report.help.is_empty()).then(|| Box::new(&self.report.help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.report.place.as_ref().map(|place| place as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let place = self.report.place.as_ref()?;
        let label = (!place.label.is_empty()).then(|| place.label.clone());
        let span = SourceSpan::from(place.shown());
        Some(Box::new(std::iter::once(LabeledSpan::new_with_span(label, span))))
    }
}

/// A mistake at a place of the effective text, before it is known which source that came from.
#[derive(Debug)]
pub(super) struct Fault {
    pub(super) span: Range<usize>,
    pub(super) message: String,
    pub(super) label: String,
    pub(super) help: String,
}

impl Fault {
    pub(super) fn new(span: Range<usize>, message: impl Into<String>, help: impl Into<String>) -> Self {
        Self { span, message: message.into(), label: String::new(), help: help.into() }
    }

    pub(super) fn labelled(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }
}
