//! Which spans and events of the engine the profiler follows.

use std::num::NonZeroU64;

use tracing::field::{Field, Visit};
use tracing::span::{Attributes, Id, Record};
use tracing::{Event, Metadata, Subscriber};

use super::profiler::{CHUNK, Profiler, STAGES, STEP};

impl Subscriber for Profiler {
    fn enabled(&self, metadata: &Metadata) -> bool {
        let known = ["step", "stage", "chunk begins", "chunk ends"];
        metadata.target().starts_with("meniscus") && known.contains(&metadata.name())
    }

    fn new_span(&self, span: &Attributes) -> Id {
        let mut seen = Seen { profiler: self, identity: STEP };
        span.record(&mut seen);
        Id::from_non_zero_u64(NonZeroU64::new(seen.identity).unwrap_or(NonZeroU64::MIN))
    }

    fn enter(&self, id: &Id) {
        if id.into_u64() >= STAGES {
            self.enter_stage(id.into_u64());
        }
        self.begin();
    }

    fn exit(&self, id: &Id) {
        self.end(id.into_u64());
    }

    fn event(&self, event: &Event) {
        if event.metadata().name() == "chunk begins" {
            event.record(&mut Begin(self));
        } else {
            self.end(CHUNK);
        }
    }

    fn record(&self, _: &Id, _: &Record) {}

    fn record_follows_from(&self, _: &Id, _: &Id) {}
}

/// Which step or stage a span is of.
struct Seen<'a> {
    profiler: &'a Profiler,
    identity: u64,
}

impl Visit for Seen<'_> {
    fn record_u64(&mut self, _: &Field, number: u64) {
        self.profiler.begin_step(number);
    }

    fn record_str(&mut self, _: &Field, name: &str) {
        self.identity = self.profiler.stage(name);
    }

    fn record_debug(&mut self, _: &Field, _: &dyn std::fmt::Debug) {}
}

/// The chunk whose begin is told.
struct Begin<'a>(&'a Profiler);

impl Visit for Begin<'_> {
    fn record_str(&mut self, field: &Field, stage: &str) {
        if field.name() == "stage" {
            self.0.begin_chunk(stage);
        }
    }

    fn record_debug(&mut self, _: &Field, _: &dyn std::fmt::Debug) {}
}
