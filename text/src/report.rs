//! Complaints about a file, with their place.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};

/// A range of bytes of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Span {
    pub(crate) start: usize,
    pub(crate) end: usize,
}

impl From<Range<usize>> for Span {
    fn from(range: Range<usize>) -> Self {
        Self { start: range.start, end: range.end }
    }
}

impl Span {
    /// From the start of this span to the end of `last`.
    pub(crate) fn to(self, last: Self) -> Self {
        Self { start: self.start.min(last.start), end: self.end.max(last.end) }
    }
}

/// What is wrong, before it is known in which file.
#[derive(Clone, Debug)]
pub(crate) struct Complaint(Box<Told>);

/// What a complaint tells.
#[derive(Clone, Debug)]
struct Told {
    message: String,
    span: Span,
    label: String,
    others: Vec<(Span, String)>,
    help: Option<String>,
}

/// A result, or what is wrong.
pub(crate) type Checked<T> = Result<T, Complaint>;

impl Complaint {
    /// A complaint about the text at `span`.
    pub(crate) fn new(span: Span, message: impl Into<String>) -> Self {
        let (label, others) = (String::new(), Vec::new());
        Self(Box::new(Told { message: message.into(), span, label, others, help: None }))
    }

    /// The place, for sorting.
    pub(crate) fn place(&self) -> (usize, usize) {
        (self.0.span.start, self.0.span.end)
    }

    /// The same with a few words beneath the carets.
    pub(crate) fn label(mut self, label: impl Into<String>) -> Self {
        self.0.label = label.into();
        self
    }

    /// The same with the way out.
    pub(crate) fn help(mut self, help: impl Into<String>) -> Self {
        self.0.help = Some(help.into());
        self
    }

    /// The same with a way out, unless it has one.
    pub(crate) fn or_help(self, help: &str) -> Self {
        if self.0.help.is_some() { self } else { self.help(help) }
    }

    /// The same with another place that has to do with it.
    pub(crate) fn and(mut self, span: Span, label: impl Into<String>) -> Self {
        self.0.others.push((span, label.into()));
        self
    }

    /// The same with the nearest of the known names, or with some of them where none is near.
    pub(crate) fn nearest<'a>(self, name: &str, known: impl IntoIterator<Item = &'a str>) -> Self {
        let mut known: Vec<&str> = known.into_iter().collect();
        known.sort_unstable();
        known.truncate(MOST_NAMES);
        let similar = |other: &&str| match other.eq_ignore_ascii_case(name) {
            true => 1.0,
            false => strsim::normalized_damerau_levenshtein(name, other),
        };
        let best = known.iter().max_by(|a, b| similar(a).total_cmp(&similar(b)));
        match best {
            Some(best) if similar(best) >= NEAR => self.help(format!("did you mean `{best}`?")),
            Some(_) => {
                let n_more = known.len().saturating_sub(FEW_NAMES);
                let few = known[..known.len() - n_more].join(", ");
                let more = if n_more > 0 { format!(", and {n_more} more") } else { String::new() };
                self.help(format!("known here: {few}{more}"))
            }
            None => self.or_help("none is declared here"),
        }
    }
}

/// Names that are compared with one that is not known, at most.
const MOST_NAMES: usize = 1000;
/// Names that are told where none is near, at most.
const FEW_NAMES: usize = 24;
/// Similarity from which on a name is taken for a slip of another.
const NEAR: f64 = 0.5;

/// The text of a file and its name.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    pub(crate) name: Arc<str>,
    pub(crate) text: Arc<str>,
}

impl Source {
    /// The complaint as an error about this file.
    pub(crate) fn error(&self, complaint: Complaint) -> Report {
        Report { source: self.clone(), complaint, level: Level::ERROR }
    }

    /// The complaint as a warning about this file.
    pub(crate) fn warning(&self, complaint: Complaint) -> Report {
        Report { source: self.clone(), complaint, level: Level::WARNING }
    }

    /// The complaint as words about a place of this file.
    pub(crate) fn note(&self, complaint: Complaint) -> Report {
        Report { source: self.clone(), complaint, level: Level::NOTE }
    }
}

/// A complaint about a file with its place. Its `Display` shows the line, carets under the place, and the way out.
#[derive(Clone, Debug)]
pub struct Report {
    source: Source,
    complaint: Complaint,
    level: Level<'static>,
}

impl Report {
    /// What is wrong, in one sentence.
    pub fn message(&self) -> &str {
        &self.complaint.0.message
    }

    /// The way out, where one is known.
    pub fn help(&self) -> Option<&str> {
        self.complaint.0.help.as_deref()
    }

    /// The bytes of the file that it is about.
    pub fn span(&self) -> Range<usize> {
        let span = self.shown(self.complaint.0.span);
        span.start..span.end
    }

    /// Line and column of its place, both from 1; the column counts characters.
    pub fn line_and_column(&self) -> (usize, usize) {
        let before = &self.source.text[..self.span().start];
        let line = before.bytes().filter(|byte| *byte == b'\n').count() + 1;
        let start = before.rfind('\n').map_or(0, |at| at + 1);
        (line, before[start..].chars().count() + 1)
    }

    /// The span within the text and on boundaries of characters.
    fn shown(&self, span: Span) -> Span {
        let text = &self.source.text;
        let on_boundary = |mut at: usize| {
            at = at.min(text.len());
            while !text.is_char_boundary(at) {
                at -= 1;
            }
            at
        };
        let start = on_boundary(span.start);
        Span { start, end: on_boundary(span.end).max(start) }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Told { message, span, label, others, help } = &*self.complaint.0;
        let place = |kind: AnnotationKind, span: Span, label: &str| {
            let span = self.shown(span);
            let at = kind.span(span.start..span.end);
            if label.is_empty() { at } else { at.label(label.to_owned()) }
        };
        let mut snippet = Snippet::source(&*self.source.text)
            .path(&*self.source.name)
            .annotation(place(AnnotationKind::Primary, *span, label));
        for (span, label) in others {
            snippet = snippet.annotation(place(AnnotationKind::Context, *span, label));
        }
        let mut group = self.level.clone().primary_title(message.clone()).element(snippet);
        if let Some(help) = help {
            group = group.element(Level::HELP.message(help.clone()));
        }
        f.write_str(&Renderer::plain().render(&[group]))
    }
}

impl std::error::Error for Report {}
