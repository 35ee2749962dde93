//! The pair pass: one traversal of the neighbour list in which any number of pair terms sum what they
//! need.
//!
//! ```text
//! for each block of 8 particles a (one per lane):
//!     load a's rows, set all sums to zero
//!     for each interleaved entry: load 8 neighbours b, evaluate the pair once,
//!         let every term add to its sums
//!     let every term finish; store
//! ```
//! The pass owns loop, loads and stores; terms own the physics. Terms are fused at compile time.

use crate::lanes::{HalfRow, Lanes, Row, WIDTH};
use crate::neighbours::NeighbourList;
use crate::parallel;
use crate::pipeline::{Fault, PairWork, Stage, World};
use crate::store::Write;
use arrayvec::ArrayVec;
use atomic_refcell::AtomicRefMut;
use std::marker::PhantomData;

/// Most columns that one pass can write.
pub const MOST_OUTPUTS: usize = 24;

/// The packed rows of all particles, then of their images, then some to fill the last block.
#[derive(Clone, Debug, Default)]
pub struct RowTable {
    /// One row a particle.
    pub first: Vec<Row>,
    /// Half a row more where the record needs it, else empty.
    pub second: Vec<HalfRow>,
}

impl RowTable {
    /// Makes room for `particles` and `images`; new rows are zero.
    pub fn resize(&mut self, particles: usize, images: usize, with_second: bool) {
        let count = particles + images + WIDTH;
        self.first.resize(count, Row::default());
        self.second.resize(if with_second { count } else { 0 }, HalfRow::default());
    }
}

/// What a pass knows of a particle: named values that stand in fixed slots of its rows.
pub trait Record: Copy {
    /// Whether it needs the second, half row.
    const SECOND: bool;

    /// Names the slots. `second` is zero where it isn't needed.
    fn from_slots(first: [Lanes; WIDTH], second: [Lanes; WIDTH / 2]) -> Self;
}

/// What is evaluated once per pair for all terms: distance, kernel, weight, Riemann state.
pub trait Interaction<R: Record>: Send + Sync {
    /// The evaluated pair.
    type Pair;

    /// What is computed once per particle, before its neighbours.
    type Own;

    /// Prepares eight particles.
    fn prepare(&self, a: &R) -> Self::Own;

    /// Evaluates eight pairs. Must be finite for a particle with itself.
    fn evaluate(&self, a: &R, own: &Self::Own, b: &R) -> Self::Pair;
}

/// One sum over the neighbours of a particle.
pub trait PairTerm<R: Record, P>: Send + Sync {
    /// The running sums.
    type Sum;

    /// Number of columns that the term writes.
    const OUTPUTS: usize;

    /// The sums before the first neighbour.
    fn zero(&self) -> Self::Sum;

    /// Adds one neighbour per lane. Must add nothing for a particle with itself.
    fn add(&self, a: &R, b: &R, pair: &P, sum: &mut Self::Sum);

    /// Turns the sums into the `OUTPUTS` results.
    fn finish(&self, a: &R, sum: Self::Sum, results: &mut [Lanes]);

    /// The columns to which the results go, as many as `OUTPUTS`; a result without a column is dropped.
    fn outputs(&self, columns: &mut Columns);
}

/// Where the results of a pass go.
pub type Columns = ArrayVec<Option<Write<f64>>, MOST_OUTPUTS>;

/// A term that only some scenes have. The test for it in the loop costs next to nothing, where another
/// fused pass for every combination would cost minutes of building.
impl<R: Record, P, T: PairTerm<R, P>> PairTerm<R, P> for Option<T> {
    type Sum = Option<T::Sum>;
    const OUTPUTS: usize = T::OUTPUTS;

    #[inline(always)]
    fn zero(&self) -> Self::Sum {
        self.as_ref().map(T::zero)
    }

    #[inline(always)]
    fn add(&self, a: &R, b: &R, pair: &P, sum: &mut Self::Sum) {
        if let (Some(term), Some(sum)) = (self, sum) {
            term.add(a, b, pair, sum);
        }
    }

    #[inline(always)]
    fn finish(&self, a: &R, sum: Self::Sum, results: &mut [Lanes]) {
        if let (Some(term), Some(sum)) = (self, sum) {
            term.finish(a, sum, results);
        }
    }

    fn outputs(&self, columns: &mut Columns) {
        match self {
            Some(term) => term.outputs(columns),
            None => columns.extend(std::iter::repeat_n(None, T::OUTPUTS)),
        }
    }
}

macro_rules! fused_terms {
    ($($term:ident $sum:ident),+) => {
        #[allow(non_snake_case, unused_assignments)]
        impl<R: Record, P, $($term: PairTerm<R, P>),+> PairTerm<R, P> for ($($term,)+) {
            type Sum = ($($term::Sum,)+);
            const OUTPUTS: usize = 0 $(+ $term::OUTPUTS)+;

            #[inline(always)]
            fn zero(&self) -> Self::Sum {
                let ($($term,)+) = self;
                ($($term.zero(),)+)
            }

            #[inline(always)]
            fn add(&self, a: &R, b: &R, pair: &P, sum: &mut Self::Sum) {
                let ($($term,)+) = self;
                let ($($sum,)+) = sum;
                $($term.add(a, b, pair, $sum);)+
            }

            #[inline(always)]
            fn finish(&self, a: &R, sum: Self::Sum, mut results: &mut [Lanes]) {
                let ($($term,)+) = self;
                let ($($sum,)+) = sum;
                $(
                    let (mine, others) = results.split_at_mut($term::OUTPUTS);
                    $term.finish(a, $sum, mine);
                    results = others;
                )+
            }

            fn outputs(&self, columns: &mut Columns) {
                let ($($term,)+) = self;
                $($term.outputs(columns);)+
            }
        }
    };
}
fused_terms!(A sum_a);
fused_terms!(A sum_a, B sum_b);
fused_terms!(A sum_a, B sum_b, C sum_c);
fused_terms!(A sum_a, B sum_b, C sum_c, D sum_d);
fused_terms!(A sum_a, B sum_b, C sum_c, D sum_d, E sum_e);
fused_terms!(A sum_a, B sum_b, C sum_c, D sum_d, E sum_e, F sum_f);

/// A traversal of all pairs with its terms, as a stage of the pipeline.
pub struct PairPass<R, I, T> {
    name: &'static str,
    interaction: I,
    terms: T,
    record: PhantomData<fn() -> R>,
}

impl<R: Record, I: Interaction<R>, T: PairTerm<R, I::Pair>> PairPass<R, I, T> {
    /// A pass under the given name.
    pub fn new(name: &'static str, interaction: I, terms: T) -> Self {
        PairPass { name, interaction, terms, record: PhantomData }
    }

    /// Walks all pairs; `outputs` are the columns of the terms in their order.
    pub fn traverse(
        &self,
        list: &NeighbourList,
        rows: &RowTable,
        outputs: ArrayVec<Option<&mut [f64]>, MOST_OUTPUTS>,
    ) {
        parallel::for_chunks(list.len(), outputs, |start, mut outputs| {
            let len = outputs.iter().flatten().map(|column| column.len()).next().unwrap_or(0);
            let mut results = [Lanes::ZERO; MOST_OUTPUTS];
            for offset in (0..len).step_by(WIDTH) {
                self.block(list, rows, start + offset, &mut results);
                for (column, result) in outputs.iter_mut().zip(&results) {
                    let Some(column) = column else { continue };
                    result.store(&mut column[offset..len.min(offset + WIDTH)]);
                }
            }
        });
    }

    #[inline(always)]
    fn add(&self, a: &R, own: &I::Own, b: &R, sum: &mut T::Sum) {
        let pair = self.interaction.evaluate(a, own, b);
        self.terms.add(a, b, &pair, sum);
    }

    #[inline(always)]
    fn block(&self, list: &NeighbourList, rows: &RowTable, first: usize, results: &mut [Lanes]) {
        let a = load::<R>(rows, std::array::from_fn(|lane| (first + lane) as u32));
        let own = self.interaction.prepare(&a);
        let mut sum = self.terms.zero();
        if let Some((entry, others)) = list.block(first / WIDTH).split_first() {
            // The next neighbours are loaded before the present ones are summed: loads and transposes
            // then overlap with the long chain of root and divisions.
            let mut b = load::<R>(rows, *entry);
            for entry in others {
                let next = load::<R>(rows, *entry);
                self.add(&a, &own, &b, &mut sum);
                b = next;
            }
            self.add(&a, &own, &b, &mut sum);
        }
        self.terms.finish(&a, sum, &mut results[..T::OUTPUTS]);
    }
}

/// Loads the rows of eight particles.
#[inline(always)]
pub fn load<R: Record>(rows: &RowTable, particles: [u32; WIDTH]) -> R {
    let row = |lane: usize| &rows.first[particles[lane] as usize];
    let first = Lanes::transpose(std::array::from_fn(row));
    let second = if R::SECOND {
        Lanes::transpose_half(std::array::from_fn(|lane| &rows.second[particles[lane] as usize]))
    } else {
        [Lanes::ZERO; WIDTH / 2]
    };
    R::from_slots(first, second)
}

impl<R, I, T> Stage for PairPass<R, I, T>
where
    R: Record,
    I: Interaction<R>,
    T: PairTerm<R, I::Pair>,
{
    fn name(&self) -> &'static str {
        self.name
    }

    /// ```text
    /// bytes = pairs * (index + rows of b) + particles * (rows of a + 8 * columns)
    /// ```
    /// An index takes 4 bytes, the rows of a particle 64, or 96 where the record has a second one.
    fn pair_work(&self, world: &World) -> PairWork {
        let mut columns = Columns::new();
        self.terms.outputs(&mut columns);
        let rows = size_of::<Row>() + if R::SECOND { size_of::<HalfRow>() } else { 0 };
        let written = size_of::<f64>() * columns.iter().flatten().count();
        let (pairs, particles) = (world.neighbours.slots(), world.neighbours.len());
        let bytes = pairs * (size_of::<u32>() + rows) + particles * (rows + written);
        PairWork { pairs: pairs as u64, bytes: bytes as u64 }
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        let mut handles = Columns::new();
        self.terms.outputs(&mut handles);
        let mut columns: ArrayVec<Option<AtomicRefMut<[f64]>>, MOST_OUTPUTS> =
            handles.into_iter().map(|handle| handle.map(|handle| world.store.write(handle))).collect();
        let outputs = columns.iter_mut().map(|column| column.as_deref_mut()).collect();
        self.traverse(&world.neighbours, &world.rows, outputs);
        Ok(())
    }
}
