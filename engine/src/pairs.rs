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

mod terms;

use crate::lanes::{HalfRow, Lanes, Row, WIDTH};
use crate::neighbours::NeighbourList;
use crate::parallel;
use crate::pipeline::{Fault, PairWork, Stage, World};
use arrayvec::ArrayVec;
use atomic_refcell::AtomicRefMut;
use std::marker::PhantomData;

pub use terms::{Columns, Interaction, MOST_OUTPUTS, PairTerm, Record};

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
    /// An index takes 4 bytes, the rows of a particle 64, or 96 where the record has a second one. Operations
    /// are those of the pairs alone; what is done once a particle adds a few per cent.
    fn pair_work(&self, world: &World) -> PairWork {
        let mut columns = Columns::new();
        self.terms.outputs(&mut columns);
        let rows = size_of::<Row>() + if R::SECOND { size_of::<HalfRow>() } else { 0 };
        let written = size_of::<f64>() * columns.iter().flatten().count();
        let (pairs, particles) = (world.neighbours.slots(), world.neighbours.len());
        let bytes = pairs * (size_of::<u32>() + rows) + particles * (rows + written);
        let operations = pairs as u64 * (self.interaction.operations() + self.terms.operations());
        PairWork { pairs: pairs as u64, bytes: bytes as u64, operations }
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
