//! The pair pass: one traversal of the neighbour list in which any number of pair terms sum what they
//! need.
//!
//! ```text
//! for each block of 8 particles a (one per lane; two blocks side by side in single precision):
//!     load a's rows, set all sums to zero
//!     for each interleaved entry: load 8 neighbours b, evaluate the pair once,
//!         let every term add to its sums
//!     let every term finish; store
//! ```
//! Sums that change slowly need not be found in every step: the seldom ones join every few steps.
//!
//! The pass owns loop, loads and stores; terms own the physics. Terms are fused at compile time.

mod terms;

use crate::clock::Clock;
use crate::group::{Around, Chunk, ChunkStage, Partial};
use crate::lanes::{Lanes, Packed, RowTable, WIDTH};
use crate::neighbours::NeighbourList;
use crate::pipeline::{PairWork, World};
use arrayvec::ArrayVec;
use std::cell::RefMut;
use std::marker::PhantomData;

pub use terms::{Columns, Interaction, MOST_OUTPUTS, PairTerm, Powers, Record};

/// Whether the roots and divisions of the next pairs are begun before the present ones are summed. With the
/// sixteen registers of AVX2 what must be kept meanwhile takes more than that saves.
const BEGINS_AHEAD: bool = cfg!(target_feature = "avx512f");

/// Bytes of rows that the caches of a core hold. Where there are more, those of the next block are asked for ahead.
/// (Measured: 2.3 MB take 1.3 ns a particle less without asking, 2.7 the same, 3 and 3.7 MB 4 ns more.)
const CACHED: usize = 5 << 19;

/// Neighbours, and how far their pairs are known.
struct Begun<R, A> {
    b: R,
    approach: Option<A>,
}

/// A traversal of all pairs with its terms, as a stage of the pipeline.
pub struct PairPass<R, I, T, S> {
    name: &'static str,
    interaction: I,
    /// Those of every step, and all in those steps in which the seldom ones join.
    terms: (T, S),
    /// Steps between two of the latter.
    interval: u64,
    /// Factors of the results.
    scales: ArrayVec<f64, MOST_OUTPUTS>,
    record: PhantomData<fn() -> R>,
}

impl<R, I, T, S> PairPass<R, I, T, S>
where
    R: Record<Scalar: Packed>,
    I: Interaction<R>,
    T: PairTerm<R, I::Pair>,
    S: PairTerm<R, I::Pair>,
{
    /// A pass under the given name over rows whose lengths are in units of `unit` metres. The seldom terms are
    /// summed in every `interval`th step, and their columns written in these alone.
    pub fn new(
        name: &'static str,
        interaction: I,
        terms: T,
        (seldom, interval): (S, u64),
        unit: f64,
    ) -> Self {
        let terms = (terms, seldom);
        let mut powers = Powers::new();
        terms.powers(&mut powers);
        let scales = powers.into_iter().map(|power| unit.powi(power)).collect();
        PairPass { name, interaction, terms, interval, scales, record: PhantomData }
    }

    /// Whether all terms are summed in this step; at compile time where none is seldom.
    fn sums_all(&self, clock: &Clock) -> bool {
        S::OUTPUTS == 0 || clock.step.is_multiple_of(self.interval)
    }

    /// Columns of the terms, in their order.
    fn columns(&self, all: bool) -> Columns {
        let mut columns = Columns::new();
        if all {
            self.terms.outputs(&mut columns)
        } else {
            self.terms.0.outputs(&mut columns)
        }
        columns
    }

    /// Walks the pairs of the particles from `start` on, a multiple of the SIMD width; `outputs` are the columns of
    /// these terms in their order, for these particles.
    fn traverse<U: PairTerm<R, I::Pair>>(
        &self,
        terms: &U,
        (list, rows): (&NeighbourList, &RowTable),
        start: usize,
        mut outputs: ArrayVec<Option<&mut [f64]>, MOST_OUTPUTS>,
    ) {
        let len = outputs.iter().flatten().map(|column| column.len()).next().unwrap_or(0);
        let mut results = [Lanes::<R::Scalar>::ZERO; MOST_OUTPUTS];
        let width = R::Scalar::BLOCKS * WIDTH;
        for offset in (0..len).step_by(width) {
            self.block(terms, (list, rows), start + offset, &mut results);
            let here = offset..len.min(offset + width);
            let whole = here.len() == width;
            for ((column, result), scale) in outputs.iter_mut().zip(&results).zip(&self.scales) {
                let Some(column) = column else { continue };
                if whole {
                    R::Scalar::store(*result, *scale, &mut column[here.clone()]);
                } else {
                    R::Scalar::store_part(*result, *scale, &mut column[here.clone()]);
                }
            }
        }
    }

    #[inline(always)]
    fn begin(&self, rows: &RowTable, a: &R, neighbours: [&[u32; WIDTH]; 2]) -> Begun<R, I::Approach> {
        let b = load::<R>(rows, neighbours);
        let approach = if BEGINS_AHEAD { Some(self.interaction.approach(a, &b)) } else { None };
        Begun { b, approach }
    }

    #[inline(always)]
    fn add<U: PairTerm<R, I::Pair>>(
        &self,
        terms: &U,
        (a, own): (&R, &I::Own),
        begun: Begun<R, I::Approach>,
        sum: &mut U::Sum,
    ) {
        let Begun { b, approach } = begun;
        let approach = match approach {
            Some(approach) => approach,
            None => self.interaction.approach(a, &b),
        };
        let pair = self.interaction.evaluate(a, own, &b, &approach);
        terms.add(a, &b, &pair, sum);
    }

    #[inline(always)]
    fn block<U: PairTerm<R, I::Pair>>(
        &self,
        terms: &U,
        (list, rows): (&NeighbourList, &RowTable),
        first: usize,
        results: &mut [Lanes<R::Scalar>],
    ) {
        let numbers = [first, first + WIDTH].map(|first| std::array::from_fn(|lane| (first + lane) as u32));
        let a = load::<R>(rows, numbers.each_ref());
        let own = self.interaction.prepare(&a);
        let mut sum = terms.zero();
        let lists: [&[[u32; WIDTH]]; 2] =
            std::array::from_fn(|k| if k < R::Scalar::BLOCKS { list.block(first / WIDTH + k) } else { &[] });
        if rows.bytes() > CACHED {
            for k in 0..R::Scalar::BLOCKS {
                let later = list.block(first / WIDTH + R::Scalar::BLOCKS + k);
                later.iter().for_each(|entry| R::Scalar::prefetch(rows, entry));
            }
        }
        let longest = lists[0].len().max(lists[1].len());
        if longest > 0 {
            // The next neighbours are loaded and their pairs begun before the present ones are summed: loads,
            // transposes, root and divisions then overlap with the long rest of the pair.
            let mut present = self.begin(rows, &a, R::Scalar::entry(&lists, 0, &numbers));
            for k in 1..longest {
                let next = self.begin(rows, &a, R::Scalar::entry(&lists, k, &numbers));
                self.add(terms, (&a, &own), present, &mut sum);
                present = next;
            }
            self.add(terms, (&a, &own), present, &mut sum);
        }
        terms.finish(&a, sum, &mut results[..U::OUTPUTS]);
    }
}

/// Loads the rows of eight particles, or twice as many in single precision.
#[inline(always)]
pub fn load<R: Record<Scalar: Packed>>(rows: &RowTable, particles: [&[u32; WIDTH]; 2]) -> R {
    R::from_slots(R::Scalar::load(rows, particles))
}

impl<R, I, T, S> ChunkStage for PairPass<R, I, T, S>
where
    R: Record<Scalar: Packed>,
    I: Interaction<R>,
    T: PairTerm<R, I::Pair>,
    S: PairTerm<R, I::Pair>,
{
    fn name(&self) -> &'static str {
        self.name
    }

    fn is_dear(&self) -> bool {
        true
    }

    /// ```text
    /// bytes = pairs * (index + row of b) + particles * (row of a + 8 * columns)
    /// ```
    /// An index takes 4 bytes, a row 64. Operations are those of the pairs alone; what is done once a particle adds a
    /// few per cent.
    fn pair_work(&self, world: &World) -> PairWork {
        let all = self.sums_all(&world.clock);
        let row = R::Scalar::BYTES;
        let written = size_of::<f64>() * self.columns(all).iter().flatten().count();
        let (pairs, particles) = (world.neighbours.slots(), world.neighbours.len());
        let bytes = pairs * (size_of::<u32>() + row) + particles * (row + written);
        let sums = if all { self.terms.operations() } else { self.terms.0.operations() };
        let operations = pairs as u64 * (self.interaction.operations() + sums);
        PairWork { pairs: pairs as u64, bytes: bytes as u64, operations }
    }

    fn chunk(&self, around: &Around, chunk: &Chunk) -> Partial {
        let all = self.sums_all(around.clock);
        let handles = self.columns(all);
        let mut columns: ArrayVec<Option<RefMut<[f64]>>, MOST_OUTPUTS> =
            handles.into_iter().map(|handle| handle.map(|handle| chunk.write(handle))).collect();
        let outputs = columns.iter_mut().map(|column| column.as_deref_mut()).collect();
        let pairs = (around.neighbours, around.rows);
        if all {
            self.traverse(&self.terms, pairs, chunk.start, outputs);
        } else {
            self.traverse(&self.terms.0, pairs, chunk.start, outputs);
        }
        [0.0; 2]
    }
}
