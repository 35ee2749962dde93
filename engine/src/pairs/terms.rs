//! What a pair pass is made of: the record of a particle, the pair, and the sums over neighbours.

use crate::lanes::{Lanes, Scalar, Slots};
use crate::store::Write;
use arrayvec::ArrayVec;

/// Most columns that one pass can write.
pub const MOST_OUTPUTS: usize = 24;

/// What a pass knows of a particle: named values that stand in fixed slots of its rows.
pub trait Record: Copy {
    /// The precision of its slots.
    type Scalar: Scalar;

    /// Names the slots.
    fn from_slots(slots: Slots<Self::Scalar>) -> Self;
}

/// What is evaluated once per pair for all terms: distance, kernel, weight, Riemann state.
pub trait Interaction<R: Record>: Send + Sync {
    /// The evaluated pair.
    type Pair;

    /// What is computed once per particle, before its neighbours.
    type Own;

    /// Prepares eight particles.
    fn prepare(&self, a: &R) -> Self::Own;

    /// What takes long to compute and so begins a neighbour ahead: roots and divisions.
    type Approach;

    /// Begins with eight pairs. Must be finite for a particle with itself.
    fn approach(&self, a: &R, b: &R) -> Self::Approach;

    /// Floating-point operations of [`Interaction::approach`] and [`Interaction::evaluate`] in one lane, counted as
    /// a term's.
    fn operations(&self) -> u64;

    /// Evaluates eight pairs. Must be finite for a particle with itself.
    fn evaluate(&self, a: &R, own: &Self::Own, b: &R, approach: &Self::Approach) -> Self::Pair;
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
    fn finish(&self, a: &R, sum: Self::Sum, results: &mut [Lanes<R::Scalar>]);

    /// Floating-point operations of [`PairTerm::add`] in one lane: additions, subtractions, multiplications,
    /// divisions and roots. A fused multiplication and addition counts as two, a choice as none.
    fn operations(&self) -> u64;

    /// The power of length in the unit of each of the `OUTPUTS` results: those of a divergence or gradient are
    /// per metre.
    fn powers(&self, powers: &mut Powers) {
        powers.extend(std::iter::repeat_n(-1, Self::OUTPUTS));
    }

    /// The columns to which the results go, as many as `OUTPUTS`; a result without a column is dropped.
    fn outputs(&self, columns: &mut Columns);
}

/// Where the results of a pass go.
pub type Columns = ArrayVec<Option<Write<f64>>, MOST_OUTPUTS>;

/// Powers of length in the units of the results of a pass.
pub type Powers = ArrayVec<i32, MOST_OUTPUTS>;

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
    fn finish(&self, a: &R, sum: Self::Sum, results: &mut [Lanes<R::Scalar>]) {
        if let (Some(term), Some(sum)) = (self, sum) {
            term.finish(a, sum, results);
        }
    }

    fn operations(&self) -> u64 {
        self.as_ref().map_or(0, T::operations)
    }

    fn powers(&self, powers: &mut Powers) {
        match self {
            Some(term) => term.powers(powers),
            None => powers.extend(std::iter::repeat_n(0, T::OUTPUTS)),
        }
    }

    fn outputs(&self, columns: &mut Columns) {
        match self {
            Some(term) => term.outputs(columns),
            None => columns.extend(std::iter::repeat_n(None, T::OUTPUTS)),
        }
    }
}

/// No term.
impl<R: Record, P> PairTerm<R, P> for () {
    type Sum = ();
    const OUTPUTS: usize = 0;

    #[inline(always)]
    fn zero(&self) {}

    #[inline(always)]
    fn add(&self, _: &R, _: &R, _: &P, (): &mut ()) {}

    #[inline(always)]
    fn finish(&self, _: &R, (): (), _: &mut [Lanes<R::Scalar>]) {}

    fn operations(&self) -> u64 {
        0
    }

    fn outputs(&self, _: &mut Columns) {}
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
            fn finish(&self, a: &R, sum: Self::Sum, mut results: &mut [Lanes<R::Scalar>]) {
                let ($($term,)+) = self;
                let ($($sum,)+) = sum;
                $(
                    let (mine, others) = results.split_at_mut($term::OUTPUTS);
                    $term.finish(a, $sum, mine);
                    results = others;
                )+
            }

            fn operations(&self) -> u64 {
                let ($($term,)+) = self;
                0 $(+ $term.operations())+
            }

            fn powers(&self, powers: &mut Powers) {
                let ($($term,)+) = self;
                $($term.powers(powers);)+
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
