//! Loops over chunks of particles on all cores, with results that don't depend on how many there are.
//!
//! A range is halved at fixed places until a chunk holds at most [`CHUNK`] particles, and partial
//! results are combined along the same tree: the order of every sum is fixed by the number of
//! particles alone. Nothing is allocated.

use crate::lanes::{Lanes, WIDTH};
use tracing::level_filters::LevelFilter;

/// Largest number of particles in one chunk; a multiple of the SIMD width. To hand out a chunk takes as long as a few
/// particles.
pub const CHUNK: usize = 256 * WIDTH;
/// The same where a particle takes long: the threads are then done at about the same time.
pub const DEAR_CHUNK: usize = 64 * WIDTH;

/// Something that can be divided at a particle: a slice, or a tuple of such.
pub trait Split: Send + Sized {
    /// The part before particle `at` and the part from it on.
    fn split(self, at: usize) -> (Self, Self);
}

impl<T: Sync> Split for &[T] {
    fn split(self, at: usize) -> (Self, Self) {
        self.split_at(at)
    }
}

impl<T: Send> Split for &mut [T] {
    fn split(self, at: usize) -> (Self, Self) {
        self.split_at_mut(at)
    }
}

impl Split for () {
    fn split(self, _: usize) -> (Self, Self) {
        ((), ())
    }
}

impl<S: Split> Split for Option<S> {
    fn split(self, at: usize) -> (Self, Self) {
        self.map(|columns| columns.split(at)).unzip()
    }
}

macro_rules! split_tuple {
    ($($name:ident),+) => {
        impl<$($name: Split),+> Split for ($($name,)+) {
            #[allow(non_snake_case)]
            fn split(self, at: usize) -> (Self, Self) {
                let ($($name,)+) = self;
                $(let $name = $name.split(at);)+
                (($($name.0,)+), ($($name.1,)+))
            }
        }
    };
}
split_tuple!(A);
split_tuple!(A, B);
split_tuple!(A, B, C);
split_tuple!(A, B, C, D);

/// Calls `body(start, columns)` for every chunk of `0..len`, `columns` cut to that chunk.
pub fn for_chunks<S, F>(len: usize, columns: S, body: F)
where
    S: Split,
    F: Fn(usize, S) + Sync,
{
    fold_chunks(len, columns, &|start, columns, _| body(start, columns), &|(), ()| ());
}

/// Like [`for_chunks`] with chunks of at most `most` entries, as many as lanes or more, for few but expensive entries.
pub fn for_chunks_of<S, F>(most: usize, len: usize, columns: S, body: F)
where
    S: Split,
    F: Fn(usize, S) + Sync,
{
    fold_range(most, 0, len, columns, &|start, columns, _| body(start, columns), &|(), ()| ());
}

/// Calls `body(start, columns, length)` for every chunk and combines the results in a fixed order.
pub fn fold_chunks<S, R, F, C>(len: usize, columns: S, body: &F, combine: &C) -> R
where
    S: Split,
    R: Send,
    F: Fn(usize, S, usize) -> R + Sync,
    C: Fn(R, R) -> R + Sync,
{
    fold_range(CHUNK, 0, len, columns, body, combine)
}

/// Calls `body(number, item)` for every item, of which there must be one, and combines the results along a tree
/// that halves their number. Nobody is told of them.
pub(crate) fn fold_each<T, R, F, C>(first: usize, items: &mut [T], body: &F, combine: &C) -> R
where
    T: Send,
    R: Send,
    F: Fn(usize, &mut T) -> R + Sync,
    C: Fn(R, R) -> R + Sync,
{
    if let [item] = items {
        return body(first, item);
    }
    let middle = items.len() / 2;
    let (left, right) = items.split_at_mut(middle);
    let (left, right) = rayon::join(
        || fold_each(first, left, body, combine),
        || fold_each(first + middle, right, body, combine),
    );
    combine(left, right)
}

/// Does the work of one chunk, and tells a subscriber when it begins and ends: from that a profile knows how
/// long each thread was busy. It is a chunk of the named stage, or of the present one without a name. A span would
/// say the same, but what it does when it is dropped costs the hot
/// loops 2 % even where nobody listens.
#[inline(always)]
pub(crate) fn told<R>(stage: &str, work: impl FnOnce() -> R) -> R {
    let listening = LevelFilter::current() == LevelFilter::TRACE;
    if listening {
        tell_begin(stage);
    }
    let done = work();
    if listening {
        tell_end();
    }
    done
}

#[cold]
#[inline(never)]
fn tell_begin(stage: &str) {
    tracing::trace!(name: "chunk begins", stage, "a chunk begins");
}

#[cold]
#[inline(never)]
fn tell_end() {
    tracing::trace!(name: "chunk ends", "a chunk ends");
}

fn fold_range<S, R, F, C>(most: usize, start: usize, len: usize, columns: S, body: &F, combine: &C) -> R
where
    S: Split,
    R: Send,
    F: Fn(usize, S, usize) -> R + Sync,
    C: Fn(R, R) -> R + Sync,
{
    if len <= most {
        return told("", || body(start, columns, len));
    }
    let middle = (len / 2).next_multiple_of(WIDTH);
    let (left, right) = columns.split(middle);
    let (a, b) = rayon::join(
        || fold_range(most, start, middle, left, body, combine),
        || fold_range(most, start + middle, len - middle, right, body, combine),
    );
    combine(a, b)
}

/// Sum of a column in a fixed order.
pub fn sum_of(column: &[f64]) -> f64 {
    let body = |_: usize, column: &[f64], _: usize| {
        let eight = column.chunks(WIDTH).map(|eight| Lanes::load_or(eight, 0.0));
        eight.fold(Lanes::ZERO, |sum, eight| sum + eight).sum()
    };
    fold_chunks(column.len(), column, &body, &|a, b| a + b)
}

/// The larger one; NaN wins over everything.
#[inline(always)]
pub fn larger(a: f64, b: f64) -> f64 {
    if a > b || a.is_nan() { a } else { b }
}

/// Largest `value(particle)`, minus infinity without particles; NaN wins over everything. Eight running results
/// side by side in a chunk let the loop run in SIMD registers.
pub fn maximum<F: Fn(usize) -> f64 + Sync>(len: usize, value: F) -> f64 {
    let body = |start: usize, (), len: usize| {
        let mut running = [f64::NEG_INFINITY; WIDTH];
        let whole = len - len % WIDTH;
        for first in (start..start + whole).step_by(WIDTH) {
            for (lane, running) in running.iter_mut().enumerate() {
                *running = larger(*running, value(first + lane));
            }
        }
        let rest = (start + whole..start + len).map(&value).fold(f64::NEG_INFINITY, larger);
        running.into_iter().fold(rest, larger)
    };
    fold_chunks(len, (), &body, &larger)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_have_the_same_bits_for_any_number_of_threads() {
        let value = |i: usize| ((i * 7919) % 1013) as f64 * 1e-3 + 1.0 / (1.0 + i as f64);
        let column: Vec<f64> = (0..100_003).map(value).collect();
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| sum_of(&column)).to_bits()
        };
        assert_eq!(with(1), with(2));
        assert_eq!(with(1), with(8));
    }

    #[test]
    fn a_column_is_summed_to_its_end() {
        let column: Vec<f64> = (0..10_003).map(f64::from).collect();
        assert_eq!(sum_of(&column), 10_003.0 * 10_002.0 / 2.0);
    }

    #[test]
    fn chunks_cover_every_particle_once() {
        let mut seen = vec![0u32; 10_007];
        let index: Vec<usize> = (0..seen.len()).collect();
        for_chunks(seen.len(), (&mut seen[..], &index[..]), |start, (seen, index)| {
            for (k, seen) in seen.iter_mut().enumerate() {
                assert_eq!(index[k], start + k);
                *seen += 1;
            }
        });
        assert!(seen.iter().all(|&n| n == 1));
    }

    #[test]
    fn not_a_number_is_never_hidden_by_a_maximum() {
        assert!(maximum(5000, |i| if i == 17 { f64::NAN } else { i as f64 }).is_nan());
    }
}
