//! Stages that follow each other and look at no other particle's columns: they take one chunk of particles after the
//! other in turn, while it lies in the cache.
//!
//! ```text
//! every stage of the group prepares
//! for each chunk of particles, on whichever thread: for each stage of the group: work on the chunk
//! every stage finishes, with what it found in all chunks
//! ```
//! What only they hand to each other is Transient: it exists for the chunks at hand alone. Chunks are cut at the
//! same places for any number of threads, and what is found in them is combined along the same tree.

use crate::clock::Clock;
use crate::field::{Description, Element, Part, Role};
use crate::lanes::{RowPart, RowTable, WIDTH};
use crate::neighbours::NeighbourList;
use crate::parallel::{self, DEAR_CHUNK};
use crate::pipeline::{Cost, Fault, PairWork, World};
use crate::store::{Mutable, Readable};
use crate::wiring::Wiring;
use arrayvec::ArrayVec;
use std::cell::{Ref, RefCell, RefMut};
use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Largest chunk where no stage of a group takes long; some forty columns of it fit into a second-level cache.
const LIGHT_CHUNK: usize = 128 * WIDTH;
/// Most columns in memory that the stages of a group use.
const MOST_COLUMNS: usize = 40;
/// Most Transient fields of a group.
const MOST_TRANSIENTS: usize = 16;
/// Both together.
const MOST_LOCKED: usize = MOST_COLUMNS + MOST_TRANSIENTS;
/// Most stages of a group.
const MOST_STAGES: usize = 8;
/// Columns of a chunk begin so much apart beyond their length: at equal places of their pages they would
/// displace each other from the first-level cache.
const APART: usize = 3 * WIDTH;

/// What a stage finds in a chunk, and then in all of them.
pub type Partial = [f64; 2];

/// A stage that works on chunks of particles: it reads and writes their own columns alone, and what lies around.
pub trait ChunkStage: Send + Sync {
    /// The name under which its cost is reported.
    fn name(&self) -> &'static str;

    /// Whether there is anything to do in this step; one stage alone makes its group wait.
    fn is_due(&self, _world: &World) -> bool {
        true
    }

    /// What is done once, before the first stage of the group sees a chunk.
    ///
    /// # Errors
    /// A [`Fault`] that says which particle and quantity went bad.
    fn prepare(&mut self, _world: &mut World) -> Result<(), Fault> {
        Ok(())
    }

    /// Does the stage's work on one chunk. It must not start work on other threads.
    fn chunk(&self, around: &Around, chunk: &Chunk) -> Partial;

    /// Combines what two chunks gave; their sum if not said otherwise.
    fn combine(&self, left: Partial, right: Partial) -> Partial {
        [left[0] + right[0], left[1] + right[1]]
    }

    /// What is done once, when the last stage of the group has seen all chunks.
    ///
    /// # Errors
    /// As for [`ChunkStage::prepare`].
    fn finish(&mut self, _world: &mut World, _found: Partial) -> Result<(), Fault> {
        Ok(())
    }

    /// Whether a particle takes so long that chunks must be small for all threads to be done at about the same time.
    fn is_dear(&self) -> bool {
        false
    }

    /// Whether it writes rows. Then it must end its group: rows can be read only when all are written.
    fn packs_rows(&self) -> bool {
        false
    }

    /// Whether what follows needs what it does when it finishes.
    fn ends_group(&self) -> bool {
        self.packs_rows()
    }

    /// Bytes that the stage keeps for itself, where it keeps something of every particle.
    fn bytes(&self) -> usize {
        0
    }

    /// What one run evaluates and moves, where the stage is a pair pass; must cost nothing to tell.
    fn pair_work(&self, _world: &World) -> PairWork {
        PairWork::default()
    }
}

/// What lies around a chunk, to be read.
#[derive(Debug)]
pub struct Around<'a> {
    /// Time and step size.
    pub clock: &'a Clock,
    /// Who is near whom.
    pub neighbours: &'a NeighbourList,
    /// The rows of all particles; empty where a stage of the group writes them.
    pub rows: &'a RowTable,
}

/// The columns of a chunk of particles. A stage reaches them through the handles its wiring gave it.
#[derive(Debug)]
pub struct Chunk<'c, 'a> {
    /// Number of its first particle.
    pub start: usize,
    len: usize,
    slots: &'c [u8],
    /// Its part of the columns in memory.
    kept: &'c [RefCell<Part<'a>>],
    transient: ArrayVec<RefCell<Part<'c>>, MOST_TRANSIENTS>,
    rows: RefCell<RowPart<'a>>,
}

impl<'a> Chunk<'_, 'a> {
    /// Number of its particles.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether it has no particles.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The values behind a read or update handle.
    ///
    /// # Panics
    /// If the same stage holds them mutably: a mistake in the stage, never in its input.
    pub fn read<T: Element>(&self, handle: impl Readable<T>) -> Ref<'_, [T]> {
        let slot = usize::from(self.slots[handle.column()]);
        match self.kept.get(slot) {
            Some(part) => Ref::map(part.borrow(), |part| values(T::of_part(part))),
            None => Ref::map(self.transient(slot).borrow(), |part| values(T::of_part(part))),
        }
    }

    /// The values behind a write, update or add handle, to change them.
    ///
    /// # Panics
    /// If the same stage holds them already: a mistake in the stage, never in its input.
    pub fn write<T: Element>(&self, handle: impl Mutable<T>) -> RefMut<'_, [T]> {
        let slot = usize::from(self.slots[handle.column()]);
        match self.kept.get(slot) {
            Some(part) => RefMut::map(part.borrow_mut(), |part| values(T::of_part_mut(part))),
            None => RefMut::map(self.transient(slot).borrow_mut(), |part| values(T::of_part_mut(part))),
        }
    }

    /// The rows of the chunk's particles, to write them.
    ///
    /// # Panics
    /// If the same stage holds them already: a mistake in the stage, never in its input.
    pub fn rows(&self) -> RefMut<'_, RowPart<'a>> {
        self.rows.borrow_mut()
    }
}

impl<'c> Chunk<'c, '_> {
    fn transient(&self, slot: usize) -> &RefCell<Part<'c>> {
        &self.transient[slot - self.kept.len()]
    }
}

fn values<S>(of_type: Option<S>) -> S {
    of_type.expect("handles carry the column's type")
}

type Found = ArrayVec<Partial, MOST_STAGES>;

/// The stages of a group and the columns they use.
pub(crate) struct Group {
    stages: Vec<Box<dyn ChunkStage>>,
    /// The stages' names, for a trace.
    pub(crate) name: String,
    /// Columns in memory, by their places in the store.
    columns: Vec<usize>,
    /// Transient fields, likewise.
    transients: Vec<usize>,
    /// By place in the store: which of the group's columns it is, those in memory first.
    slots: Vec<u8>,
    /// Memory of each thread for Transient fields.
    scratch: Vec<Mutex<Vec<f64>>>,
    /// Time in chunks, of each stage on all threads.
    nanoseconds: Vec<AtomicU64>,
    most: usize,
    packs_rows: bool,
}

impl Group {
    /// A group of stages that follow each other.
    ///
    /// # Panics
    /// If it uses more columns or stages than a group can have: a mistake in the pipeline.
    pub(crate) fn new(stages: Vec<Box<dyn ChunkStage>>, wiring: &Wiring) -> Self {
        let names: Vec<&'static str> = stages.iter().map(|stage| stage.name()).collect();
        let used = wiring.columns_of(&names);
        let is_transient = |(_, description): &&(usize, Description)| description.role == Role::Transient;
        let transients: Vec<usize> = used.iter().filter(is_transient).map(|(k, _)| *k).collect();
        let columns: Vec<usize> =
            used.iter().filter(|column| !is_transient(column)).map(|(k, _)| *k).collect();
        let mut slots = vec![u8::MAX; wiring.count()];
        for (slot, place) in columns.iter().chain(&transients).enumerate() {
            slots[*place] = slot as u8;
        }
        let fits = columns.len() <= MOST_COLUMNS && transients.len() <= MOST_TRANSIENTS;
        assert!(fits && stages.len() <= MOST_STAGES, "a group is too large: {names:?}");
        let is_dear = stages.iter().any(|stage| stage.is_dear());
        Group {
            name: names.join(" + "),
            transients,
            columns,
            slots,
            scratch: Vec::new(),
            nanoseconds: stages.iter().map(|_| AtomicU64::new(0)).collect(),
            most: if is_dear { DEAR_CHUNK } else { LIGHT_CHUNK },
            packs_rows: stages.iter().any(|stage| stage.packs_rows()),
            stages,
        }
    }

    /// Its stages.
    pub(crate) fn stages(&self) -> impl Iterator<Item = &dyn ChunkStage> {
        self.stages.iter().map(|stage| stage.as_ref())
    }

    /// Bytes that it holds for Transient fields, and those of its stages.
    pub(crate) fn bytes(&self) -> usize {
        let own: usize = self.stages().map(|stage| stage.bytes()).sum();
        own + self.scratch.len() * self.room() * size_of::<f64>()
    }

    fn room(&self) -> usize {
        self.transients.len() * (self.most + APART) + WIDTH
    }

    /// Runs all stages, and adds to the cost of each: what its preparation and its end take, and of the chunks'
    /// elapsed time the part that its work on all threads is of all work.
    pub(crate) fn run(&mut self, world: &mut World, costs: &mut [Cost]) -> Result<(), Fault> {
        if !self.stages.iter().all(|stage| stage.is_due(world)) {
            return Ok(());
        }
        for (stage, cost) in self.stages.iter_mut().zip(&mut *costs) {
            let _span = tracing::info_span!("stage", name = stage.name()).entered();
            let begin = Instant::now();
            stage.prepare(world)?;
            cost.time += begin.elapsed();
            cost.calls += 1;
        }
        self.make_room();
        let (found, elapsed) = {
            let _span = tracing::info_span!("stage", name = self.name.as_str()).entered();
            let begin = Instant::now();
            (self.chunks(world, |_| true), begin.elapsed())
        };
        let all: u64 = self.nanoseconds.iter().map(|time| time.load(Ordering::Relaxed)).sum();
        for (time, cost) in self.nanoseconds.iter().zip(&mut *costs) {
            let part = time.swap(0, Ordering::Relaxed) as f64 / all.max(1) as f64;
            cost.time += Duration::from_secs_f64(part * elapsed.as_secs_f64());
        }
        for ((stage, cost), found) in self.stages.iter_mut().zip(costs).zip(found) {
            let _span = tracing::info_span!("stage", name = stage.name()).entered();
            let begin = Instant::now();
            stage.finish(world, found)?;
            cost.time += begin.elapsed();
            cost.pair_work += stage.pair_work(world);
        }
        Ok(())
    }

    /// Runs one of the stages alone; what the others would have handed to it is not defined.
    pub(crate) fn run_one(&mut self, name: &str, world: &mut World) -> Result<(), Fault> {
        self.make_room();
        if let Some(place) = self.stages.iter().position(|stage| stage.name() == name) {
            self.stages[place].prepare(world)?;
            let found = self.chunks(world, |stage| stage == place);
            self.stages[place].finish(world, found[place])?;
        }
        Ok(())
    }

    /// Room for Transient fields on every thread.
    fn make_room(&mut self) {
        let threads = rayon::current_num_threads();
        if self.scratch.len() < threads {
            let room = self.room();
            self.scratch.resize_with(threads, || Mutex::new(vec![0.0; room]));
        }
    }

    /// All chunks, with those of the stages that are chosen by their places.
    fn chunks(&self, world: &mut World, is_chosen: impl Fn(usize) -> bool + Sync) -> Found {
        let World { store, clock, neighbours, rows, arena } = world;
        let (len, no_rows) = (store.len(), RowTable::default());
        let (rows, mut own_rows) =
            if self.packs_rows { (&no_rows, rows.part(len)) } else { (&*rows, RowPart::default()) };
        let around = Around { clock, neighbours, rows };
        // The parts of all chunks, chunk after chunk.
        let kept = if store.keeps_transients() { &self.transients[..] } else { &[] };
        let (columns, count) = (self.columns.len() + kept.len(), len.div_ceil(self.most));
        let nothing = |_| RefCell::new(Part::U32(&mut []));
        let parts: &mut [RefCell<Part>] = arena.alloc_slice_fill_with(columns * count, nothing);
        let mut locked = store.lock::<MOST_LOCKED>(self.columns.iter().chain(kept).copied());
        for (column, values) in locked.iter_mut().enumerate() {
            let places = parts[column..].iter_mut().step_by(columns);
            places
                .zip(values.whole().pieces(self.most))
                .for_each(|(place, part)| *place = RefCell::new(part));
        }
        let mut parts = parts.chunks_exact_mut(columns);
        let piece = |_| (&mut *parts.next().unwrap_or_default(), own_rows.take(self.most));
        let pieces: &mut [Piece] = arena.alloc_slice_fill_with(count, piece);
        let body = |number: usize, (parts, rows): &mut Piece| {
            let thread = rayon::current_thread_index().unwrap_or(0);
            let mut scratch = self.scratch[thread].lock().unwrap_or_else(PoisonError::into_inner);
            let start = number * self.most;
            let range = start..len.min(start + self.most);
            self.chunk((&around, &is_chosen), range, (parts, std::mem::take(rows)), &mut scratch)
        };
        let combine = |left: Found, right: Found| {
            let both = self.stages.iter().zip(left.into_iter().zip(right));
            both.map(|(stage, (left, right))| stage.combine(left, right)).collect()
        };
        parallel::fold_each(0, pieces, &body, &combine)
    }

    /// All stages on one chunk.
    fn chunk<'a>(
        &self,
        (around, is_chosen): (&Around, &impl Fn(usize) -> bool),
        range: Range<usize>,
        (kept, rows): (&[RefCell<Part<'a>>], RowPart<'a>),
        scratch: &mut [f64],
    ) -> Found {
        if cfg!(debug_assertions) {
            scratch.fill(f64::poison());
        }
        let len = range.len();
        // Lanes are stored fastest where they don't cross the lines of a cache.
        let skipped = scratch.as_ptr().align_offset(WIDTH * size_of::<f64>()).min(WIDTH);
        let columns = scratch[skipped..].chunks_mut(self.most + APART).take(self.transients.len());
        let transient = columns.map(|column| RefCell::new(Part::F64(&mut column[..len]))).collect();
        let rows = RefCell::new(rows);
        let chunk = Chunk { start: range.start, len, slots: &self.slots, kept, transient, rows };
        let mut begin = Instant::now();
        let work = |(place, (stage, time)): (usize, (&dyn ChunkStage, &AtomicU64))| {
            if !is_chosen(place) {
                return Partial::default();
            }
            let found = parallel::told(stage.name(), || stage.chunk(around, &chunk));
            let end = Instant::now();
            time.fetch_add((end - begin).as_nanos() as u64, Ordering::Relaxed);
            begin = end;
            found
        };
        self.stages().zip(&self.nanoseconds).enumerate().map(work).collect()
    }
}

/// The columns and rows of one chunk.
type Piece<'p, 'a> = (&'p mut [RefCell<Part<'a>>], RowPart<'a>);
