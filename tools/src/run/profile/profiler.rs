//! What each thread does in each stage, from the spans of the engine.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use rayon::ThreadPool;

use crate::command::Extent;
use crate::failure::Failure;

/// Of so many steps one is watched, and all that go into the trace: watching every step would cost 4 % of the
/// run. A prime, so that what happens every few steps is met as often as it happens.
const SAMPLE: u64 = 7;
/// Steps from the first one on that go into the trace, one by one.
const OPENING: u64 = 200;
/// From then on, each of so many.
const INTERVAL: u64 = 1000;
/// Most pieces of work in a trace, of all threads together: about 22 MB of text. A step that would begin
/// beyond half of them in the opening, or beyond all later, is left out.
const MOST: usize = 3 << 16;

/// Identities of what has a length: a chunk, a step, then the stages in the order of their first run.
pub(super) const CHUNK: u64 = 1;
pub(super) const STEP: u64 = 2;
pub(super) const STAGES: u64 = 3;

/// Follows the spans of a run: how long each thread is busy in each stage, and some steps piece by piece.
/// It observes; what is computed stays the same, bit for bit.
pub(in crate::run) struct Profiler {
    origin: Instant,
    /// Off while particles are packed.
    recording: AtomicBool,
    /// The first step since the run began, or went on.
    first: AtomicU64,
    /// Whether the present step is watched.
    watching: AtomicBool,
    /// Whether it goes into the trace.
    traced: AtomicBool,
    /// Identity of the present stage.
    present: AtomicU64,
    stages: Mutex<Vec<Busy>>,
    threads: Vec<Mutex<Thread>>,
}

/// How long the threads worked on the chunks of a stage, in the steps that were watched.
#[derive(Clone, Debug)]
pub(super) struct Busy {
    pub(super) stage: String,
    /// Elapsed nanoseconds.
    pub(super) elapsed: u64,
    /// Nanoseconds of each thread.
    pub(super) threads: Vec<u64>,
    /// Sum over the calls of the longest time of a thread, in nanoseconds.
    pub(super) longest: u64,
}

/// A piece of work that a trace shows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub(super) kind: Kind,
    /// Nanoseconds since the profiler began.
    pub(super) start: u64,
    /// Its length in nanoseconds.
    pub(super) length: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// A step of a number.
    Step(u64),
    /// A stage, or a group of them, by its place among the profiler's.
    Stage(usize),
    /// A chunk of a stage.
    Chunk(usize),
}

#[derive(Default)]
struct Thread {
    /// Starts of the spans and chunks that are open.
    open: Vec<u64>,
    /// Nanoseconds in chunks since the present stage or group of stages began, by stage.
    busy: Vec<u64>,
    /// The stage of the chunk at hand, by its place.
    chunk: usize,
    step: u64,
    pieces: Vec<Piece>,
}

/// A panic elsewhere must not hide behind one here.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Profiler {
    /// A profiler of all spans on the threads of a pool from now on, where one is asked for.
    ///
    /// # Errors
    /// If the process has one already.
    pub(in crate::run) fn asked(extent: &Extent, pool: &ThreadPool) -> Result<Option<Arc<Self>>, Failure> {
        extent.profile.then(|| Self::listen(pool.current_num_threads())).transpose()
    }

    fn listen(threads: usize) -> Result<Arc<Self>, Failure> {
        let room = |_| Thread {
            open: Vec::with_capacity(8),
            pieces: Vec::with_capacity(MOST / threads),
            ..Thread::default()
        };
        let profiler = Arc::new(Profiler {
            origin: Instant::now(),
            recording: AtomicBool::new(false),
            first: AtomicU64::new(0),
            watching: AtomicBool::new(false),
            traced: AtomicBool::new(false),
            present: AtomicU64::new(STAGES),
            stages: Mutex::default(),
            threads: (0..threads).map(room).map(Mutex::new).collect(),
        });
        tracing::subscriber::set_global_default(Arc::clone(&profiler))
            .map_err(|error| Failure::on_the_way(format!("cannot follow the stages: {error}")))?;
        Ok(profiler)
    }

    /// Records what happens from now on; the next step is the first.
    pub(in crate::run) fn start(&self, step: u64) {
        self.first.store(step, Ordering::Relaxed);
        self.recording.store(true, Ordering::Relaxed);
    }

    /// Records no longer.
    pub(super) fn stop(&self) {
        self.recording.store(false, Ordering::Relaxed);
        self.watching.store(false, Ordering::Relaxed);
    }

    /// How busy the threads were in each stage.
    pub(super) fn busy(&self) -> Vec<Busy> {
        lock(&self.stages).clone()
    }

    /// Hands out the pieces of work of every thread for a trace.
    pub(super) fn pieces(&self) -> impl Iterator<Item = Vec<Piece>> + '_ {
        self.threads.iter().map(|thread| lock(thread).pieces.clone())
    }

    /// Whether a step goes into the trace.
    fn is_traced(&self, step: u64, pieces: usize) -> bool {
        let most = MOST / self.threads.len();
        let taken = step - self.first.load(Ordering::Relaxed);
        (taken < OPENING && pieces < most / 2) || (step.is_multiple_of(INTERVAL) && pieces < most)
    }

    /// The thread that asks, while it is watched.
    fn watched(&self) -> Option<MutexGuard<'_, Thread>> {
        let watching = self.watching.load(Ordering::Relaxed);
        let number = watching.then(rayon::current_thread_index).flatten()?;
        self.threads.get(number).map(lock)
    }

    /// Decides whether a step is watched.
    pub(super) fn begin_step(&self, number: u64) {
        let thread = rayon::current_thread_index().and_then(|thread| self.threads.get(thread));
        let Some(thread) = thread.filter(|_| self.recording.load(Ordering::Relaxed)) else { return };
        let mut thread = lock(thread);
        let traced = self.is_traced(number, thread.pieces.len());
        thread.step = number;
        self.traced.store(traced, Ordering::Relaxed);
        self.watching.store(traced || number.is_multiple_of(SAMPLE), Ordering::Relaxed);
    }

    /// The identity of a stage.
    pub(super) fn stage(&self, name: &str) -> u64 {
        let mut stages = lock(&self.stages);
        let known = stages.iter().position(|stage| stage.stage == name);
        let place = known.unwrap_or_else(|| {
            let threads = vec![0; self.threads.len()];
            stages.push(Busy { stage: name.to_owned(), elapsed: 0, threads, longest: 0 });
            stages.len() - 1
        });
        STAGES + place as u64
    }

    /// Takes down how busy each thread was, when all of them have finished a stage, or stages that take chunks in
    /// turn: of those each has the part of the elapsed time that its chunks are of all.
    fn end_stage(&self, elapsed: u64) {
        let mut stages = lock(&self.stages);
        let mut busy: Vec<Vec<u64>> = vec![vec![0; self.threads.len()]; stages.len()];
        for (k, thread) in self.threads.iter().enumerate() {
            for (place, time) in lock(thread).busy.iter_mut().enumerate() {
                busy[place][k] = std::mem::take(time);
            }
        }
        let all: u64 = busy.iter().flatten().sum();
        for (stage, busy) in stages.iter_mut().zip(busy) {
            let own: u64 = busy.iter().sum();
            if own > 0 {
                stage.elapsed += (elapsed as f64 * (own as f64 / all as f64)) as u64;
                stage.longest += busy.iter().copied().max().unwrap_or(0);
                stage.threads.iter_mut().zip(busy).for_each(|(total, busy)| *total += busy);
            }
        }
    }

    fn now(&self) -> u64 {
        self.origin.elapsed().as_nanos() as u64
    }

    /// Says which stage the chunks from now on are of.
    pub(super) fn enter_stage(&self, identity: u64) {
        self.present.store(identity, Ordering::Relaxed);
    }

    /// Notes the begin of a span or chunk.
    pub(super) fn begin(&self) {
        if let Some(mut thread) = self.watched() {
            let now = self.now();
            thread.open.push(now);
        }
    }

    /// Notes the begin of a chunk of the named stage; of the present one without a name.
    pub(super) fn begin_chunk(&self, stage: &str) {
        let identity =
            if stage.is_empty() { self.present.load(Ordering::Relaxed) } else { self.stage(stage) };
        if let Some(mut thread) = self.watched() {
            let place = (identity - STAGES) as usize;
            if thread.busy.len() <= place {
                thread.busy.resize(place + 1, 0);
            }
            thread.chunk = place;
            let now = self.now();
            thread.open.push(now);
        }
    }

    /// Takes down what has come to its end.
    pub(super) fn end(&self, identity: u64) {
        let Some(mut thread) = self.watched() else { return };
        let Some(start) = thread.open.pop() else { return };
        let length = self.now() - start;
        let place = |identity: u64| (identity - STAGES) as usize;
        let kind = match identity {
            CHUNK => {
                let chunk = thread.chunk;
                thread.busy[chunk] += length;
                Kind::Chunk(chunk)
            }
            STEP => Kind::Step(thread.step),
            identity => Kind::Stage(place(identity)),
        };
        if self.traced.load(Ordering::Relaxed) && thread.pieces.len() < thread.pieces.capacity() {
            thread.pieces.push(Piece { kind, start, length });
        }
        drop(thread);
        if let Kind::Stage(_) = kind {
            self.end_stage(length);
        }
    }
}
