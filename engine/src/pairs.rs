//! The pair pass: one traversal of the neighbour list in which any number of pair terms sum what they
//! need.
//!
//! ```text
//! for each block of 8 particles a (one per lane; half a block where registers are narrow, twice as many in single precision):
//!     load a's rows, set all sums to zero
//!     for each interleaved entry: load a neighbour b in each lane, evaluate the pair once,
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
        let width = R::Scalar::LANES;
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
    fn begin(&self, a: &R, b: R) -> Begun<R, I::Approach> {
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
        // A block of eight particles whose lists lie side by side, half of it, or two.
        let (block, half) = (first / WIDTH, first % WIDTH / (WIDTH / 2));
        let numbers =
            [block, block + 1].map(|block| std::array::from_fn(|lane| (WIDTH * block + lane) as u32));
        let a = load::<R>(rows, numbers.each_ref(), half);
        let own = self.interaction.prepare(&a);
        let mut sum = terms.zero();
        let blocks = R::Scalar::LANES.div_ceil(WIDTH);
        let lists: [&[[u32; WIDTH]]; 2] =
            std::array::from_fn(|k| if k < blocks { list.block(block + k) } else { &[] });
        if half == 0 && rows.bytes() > CACHED {
            for k in 0..blocks {
                let later = list.block(block + blocks + k);
                later.iter().for_each(|entry| R::Scalar::prefetch(rows, entry));
            }
        }
        let longest = lists[0].len().max(lists[1].len());
        let neighbours = |k: usize| load::<R>(rows, R::Scalar::entry(&lists, k, &numbers), half);
        if longest > 0 {
            // The next neighbours are loaded and their pairs begun before the present ones are summed: loads,
            // transposes, root and divisions then overlap with the long rest of the pair.
            let mut present = self.begin(&a, neighbours(0));
            for k in 1..longest {
                let next = self.begin(&a, neighbours(k));
                self.add(terms, (&a, &own), present, &mut sum);
                present = next;
            }
            self.add(terms, (&a, &own), present, &mut sum);
        }
        terms.finish(&a, sum, &mut results[..U::OUTPUTS]);
    }
}

/// Loads the rows of both blocks of particles, or of the one, or of its half of that number.
#[inline(always)]
fn load<R: Record<Scalar: Packed>>(rows: &RowTable, particles: [&[u32; WIDTH]; 2], half: usize) -> R {
    R::from_slots(R::Scalar::load(rows, particles, half))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::Domain;
    use crate::lanes::{Four, Places, Row, Scalar, Slots};

    /// A place, and a number that neighbours weigh by.
    #[derive(Clone, Copy)]
    struct Weighed<T: Scalar> {
        r: Places<T>,
        z: Places<T>,
        weight: Lanes<T>,
    }

    impl<T: Scalar> Record for Weighed<T> {
        type Scalar = T;

        fn from_slots(slots: Slots<T>) -> Self {
            let [r, z, weight, ..] = slots.whole;
            Weighed { r: Places::of_slot(r), z: Places::of_slot(z), weight }
        }
    }

    /// The square of the distance.
    struct Square;

    impl<T: Scalar> Interaction<Weighed<T>> for Square {
        type Pair = Lanes<T>;
        type Own = ();
        type Approach = ();

        fn prepare(&self, _: &Weighed<T>) {}

        fn approach(&self, _: &Weighed<T>, _: &Weighed<T>) {}

        fn operations(&self) -> u64 {
            5
        }

        fn evaluate(&self, a: &Weighed<T>, (): &(), b: &Weighed<T>, (): &()) -> Lanes<T> {
            let (dr, dz) = (a.r.to(b.r), a.z.to(b.z));
            dr.mul_add(dr, dz * dz)
        }
    }

    /// The mean of the neighbours' weights, each times a square.
    struct Sum;

    impl<T: Scalar> PairTerm<Weighed<T>, Lanes<T>> for Sum {
        type Sum = Lanes<T>;
        const OUTPUTS: usize = 1;

        fn zero(&self) -> Lanes<T> {
            Lanes::ZERO
        }

        fn add(&self, _: &Weighed<T>, b: &Weighed<T>, square: &Lanes<T>, sum: &mut Lanes<T>) {
            *sum = b.weight.mul_add(*square, *sum);
        }

        fn finish(&self, a: &Weighed<T>, sum: Lanes<T>, results: &mut [Lanes<T>]) {
            results[0] = sum / a.weight;
        }

        fn operations(&self) -> u64 {
            2
        }

        fn outputs(&self, columns: &mut Columns) {
            columns.push(None);
        }
    }

    fn sums<T: Packed>(list: &NeighbourList, rows: &RowTable) -> Vec<f64> {
        let pass = PairPass::<Weighed<T>, _, _, _>::new("sums", Square, Sum, ((), 1), 1.0);
        let mut results = vec![0.0; list.len()];
        pass.traverse(&pass.terms.0, (list, rows), 0, [Some(&mut results[..])].into_iter().collect());
        results
    }

    /// However many lie side by side, each particle has the sum of the plain loop over its neighbours, to the last bit.
    #[test]
    fn four_side_by_side_and_eight_give_the_same_bits() {
        for count in [1, 4, 5, 37, 45] {
            let of = |i: usize, by: f64| (by * (i as f64 + 1.0)).sin();
            let [r, z, weight] =
                [1.7, 2.9, 4.3].map(|by| (0..count).map(|i| 3.0 + of(i, by)).collect::<Vec<_>>());
            let mut list = NeighbourList::default();
            list.build([&r, &z, &vec![0.4; count]], &Domain::default());
            let mut rows = RowTable::default();
            rows.resize(count, list.images().len());
            for i in 0..count {
                rows.double[i] = Row([r[i], z[i], weight[i], 0.0, 0.0, 0.0, 0.0, 0.0]);
            }
            let expected = (0..count).map(|a| {
                let add = |sum: f64, b: usize| {
                    let (dr, dz) = (r[b] - r[a], z[b] - z[a]);
                    let square = Lanes::splat(dr).mul_add(Lanes::splat(dr), Lanes::splat(dz * dz));
                    Lanes::<f64>::splat(weight[b]).mul_add(square, Lanes::splat(sum)).to_array()[0]
                };
                list.of(a).fold(0.0, add) / weight[a]
            });
            let expected: Vec<f64> = expected.collect();
            assert!(count < 37 || expected.iter().filter(|sum| **sum > 0.0).count() > count / 2);
            assert_eq!(sums::<f64>(&list, &rows), expected);
            assert_eq!(sums::<Four>(&list, &rows), expected);
        }
    }
}
