//! The trace of a run, in the format of Chrome's trace events, which <https://ui.perfetto.dev> opens.

use std::io::Write;
use std::path::Path;

use serde::Serialize;

use super::profiler::{Kind, Piece, Profiler};
use crate::output::OutputResult;
use crate::output::atomic::write_atomic;

/// The whole file. (The names are the format's.)
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Trace<'a> {
    trace_events: Vec<TraceEvent<'a>>,
    display_time_unit: &'static str,
}

/// A piece of work (`ph` is `X`) or the name of a thread (`M`).
#[derive(Serialize)]
struct TraceEvent<'a> {
    name: &'a str,
    cat: &'static str,
    ph: &'static str,
    pid: u32,
    tid: usize,
    /// Start in microseconds.
    ts: f64,
    /// Length in microseconds.
    dur: f64,
    args: Details,
}

#[derive(Default, Serialize)]
struct Details {
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    step: Option<u64>,
}

/// Writes the pieces of work that a profiler has kept, all of them or nothing.
///
/// # Errors
/// When the file cannot be written.
pub(super) fn write(profiler: &Profiler, path: &Path) -> OutputResult<()> {
    let stages = profiler.busy();
    let mut events = Vec::new();
    for (thread, pieces) in profiler.pieces().enumerate() {
        let details = Details { name: Some(format!("thread {thread}")), step: None };
        let name = TraceEvent::new("thread_name", ("", "M"), thread, details);
        events.push(name);
        events.extend(pieces.iter().map(|piece| {
            let event = match piece.kind {
                Kind::Step(number) => {
                    let details = Details { name: None, step: Some(number) };
                    TraceEvent::new("step", ("step", "X"), thread, details)
                }
                Kind::Stage(place) => TraceEvent::of(&stages[place].stage, "stage", thread),
                Kind::Chunk(place) => TraceEvent::of(&stages[place].stage, "chunk", thread),
            };
            event.at(piece)
        }));
    }
    let trace = Trace { trace_events: events, display_time_unit: "ns" };
    write_atomic(path, |file| {
        serde_json::to_writer(&mut *file, &trace)?;
        file.write_all(b"\n")
    })
}

impl<'a> TraceEvent<'a> {
    fn new(name: &'a str, (cat, ph): (&'static str, &'static str), tid: usize, args: Details) -> Self {
        TraceEvent { name, cat, ph, pid: 1, tid, ts: 0.0, dur: 0.0, args }
    }

    fn of(stage: &'a str, category: &'static str, thread: usize) -> Self {
        Self::new(stage, (category, "X"), thread, Details::default())
    }

    fn at(self, piece: &Piece) -> Self {
        TraceEvent { ts: piece.start as f64 * 1e-3, dur: piece.length as f64 * 1e-3, ..self }
    }
}
