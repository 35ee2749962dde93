//! Packed rows: what a pair pass loads of each particle, and how eight of them become lanes.

use super::scalar::Singles;
use super::{Four, Lanes, Scalar, WIDTH};
use crate::store::bytes_of;
use wide::bytemuck::cast;
use wide::{f32x4, f32x8, f64x2, f64x4, f64x8, u64x4, u64x8};

/// Slots of full precision in a row.
pub const WHOLE: usize = 6;

/// Number of particles that one [`Lanes`] of single precision holds.
pub const SINGLES: usize = size_of::<Singles>() / size_of::<f32>();

/// Slots of a row of single precision.
pub const SLOTS: usize = 2 * WIDTH;

/// In single precision, where every number has a slot: that of the first third, or of the last number.
pub const THIRDS: usize = WIDTH;

/// In single precision: the slot of the first coordinate as a number.
pub const COORDINATE: usize = WIDTH + WIDTH / 2;

/// The packed rows of all particles, then of their images, then some to fill the last block.
#[derive(Clone, Debug, Default)]
pub struct RowTable {
    /// One row a particle in double precision, else empty.
    pub double: Vec<Row>,
    /// The same in single precision.
    pub single: Vec<SingleRow>,
    /// The unit of length of rows of single precision, m.
    pub unit: f64,
    /// Whether they are those of the particles as they lie in memory now, with their images.
    pub are_current: bool,
}

impl RowTable {
    /// Makes room for `particles` and `images`, whose rows must be written anew.
    pub fn resize(&mut self, particles: usize, images: usize) {
        make_room(&mut self.double, particles + images + WIDTH, images);
    }

    /// Makes room for `particles` and `images` in single precision.
    pub fn resize_single(&mut self, particles: usize, images: usize) {
        make_room(&mut self.single, particles + images + 2 * WIDTH, images);
    }

    /// The rows of the first `particles`, to write them.
    ///
    /// # Panics
    /// If there are fewer.
    pub fn part(&mut self, particles: usize) -> RowPart<'_> {
        let of = |rows: usize| if rows == 0 { 0 } else { particles };
        let (double, single) = (of(self.double.len()), of(self.single.len()));
        RowPart { double: &mut self.double[..double], single: &mut self.single[..single] }
    }

    /// Bytes that the rows take.
    pub fn bytes(&self) -> usize {
        bytes_of(&self.double) + bytes_of(&self.single)
    }
}

/// Makes a table of which so many rows are images' as long as it must be, and gives old rows back before there are
/// longer ones. Images alone become more: there is room for a quarter more of them.
fn make_room<T: Clone + Default>(rows: &mut Vec<T>, count: usize, images: usize) {
    if count > rows.capacity() {
        *rows = Vec::new();
        rows.reserve_exact(count + images / 4);
    }
    rows.resize(count, T::default());
}

/// The rows of some particles in a row, as [`RowTable`] holds them.
#[derive(Debug, Default)]
pub struct RowPart<'a> {
    /// One row a particle in double precision, else empty.
    pub double: &'a mut [Row],
    /// The same in single precision.
    pub single: &'a mut [SingleRow],
}

impl<'a> RowPart<'a> {
    /// Takes the rows of the first `particles` off, or all that are left.
    pub(crate) fn take(&mut self, particles: usize) -> RowPart<'a> {
        fn first<'a, T>(rows: &mut &'a mut [T], count: usize) -> &'a mut [T] {
            let count = count.min(rows.len());
            rows.split_off_mut(..count).unwrap_or_default()
        }
        RowPart { double: first(&mut self.double, particles), single: first(&mut self.single, particles) }
    }
}

/// What a record names: the slots of as many particles as there are lanes. In double precision a row is one cache
/// line, as in single precision, because numbers that need not be exact share a slot.
#[derive(Clone, Copy, Debug)]
pub struct Slots<T: Scalar = f64> {
    /// Those of full precision.
    pub whole: [Lanes<T>; WHOLE],
    /// Two that share the next slot, rounded to 21 bits in double precision.
    pub halves: [Lanes<T>; 2],
    /// Three that share the last slot, rounded to 10 bits in double precision.
    pub thirds: [Lanes<T>; 3],
    /// The last slot where only one number lies in it.
    pub last: Lanes<T>,
    /// The first coordinate as a number, whatever a place is.
    pub coordinate: Lanes<T>,
}

/// A scalar of which rows are packed.
pub trait Packed: Scalar {
    /// Particles side by side in lanes.
    const LANES: usize;

    /// Bytes of a particle's row.
    const BYTES: usize;

    /// Entry `k` of the lists of one block of eight particles or two; a list's own particles stand in for what it lacks.
    fn entry<'a>(
        lists: &[&'a [[u32; WIDTH]]; 2],
        k: usize,
        own: &'a [[u32; WIDTH]; 2],
    ) -> [&'a [u32; WIDTH]; 2];

    /// Loads rows of both blocks, or of the one, or of its half of that number, and turns them into slots.
    fn load(rows: &RowTable, particles: [&[u32; WIDTH]; 2], half: usize) -> Slots<Self>;

    /// Asks for the rows of eight particles, so that they lie in the caches when they are loaded.
    fn prefetch(rows: &RowTable, particles: &[u32; WIDTH]);

    /// Writes as many results as there are lanes in SI units: `scale` times those of single precision, whose
    /// lengths have a unit of their own.
    ///
    /// # Panics
    /// If `values` takes fewer.
    fn store(lanes: Lanes<Self>, scale: f64, values: &mut [f64]);

    /// The same for as many as `values` takes.
    fn store_part(lanes: Lanes<Self>, scale: f64, values: &mut [f64]);
}

macro_rules! packed_double {
    ($scalar:ident, $load:ident) => {
        impl Packed for $scalar {
            const LANES: usize = size_of::<Lanes<$scalar>>() / size_of::<f64>();
            const BYTES: usize = size_of::<Row>();

            #[inline(always)]
            fn entry<'a>(
                lists: &[&'a [[u32; WIDTH]]; 2],
                k: usize,
                own: &'a [[u32; WIDTH]; 2],
            ) -> [&'a [u32; WIDTH]; 2] {
                [&lists[0][k], &own[1]]
            }

            #[inline(always)]
            fn load(rows: &RowTable, [particles, _]: [&[u32; WIDTH]; 2], half: usize) -> Slots<$scalar> {
                let [whole @ .., shared, last] = $load(&rows.double, particles, half);
                Slots { whole, halves: shared.halves(), thirds: last.thirds(), last, coordinate: whole[0] }
            }

            #[inline(always)]
            fn prefetch(rows: &RowTable, particles: &[u32; WIDTH]) {
                particles.iter().for_each(|&particle| prefetch(&rows.double, particle as usize));
            }

            #[inline(always)]
            fn store(lanes: Lanes<$scalar>, _: f64, values: &mut [f64]) {
                values[..Self::LANES].copy_from_slice(&lanes.to_array());
            }

            #[cold]
            fn store_part(lanes: Lanes<$scalar>, _: f64, values: &mut [f64]) {
                values.copy_from_slice(&lanes.to_array()[..values.len()]);
            }
        }
    };
}
packed_double!(f64, load_eight);
packed_double!(Four, load_four);

#[inline(always)]
fn load_eight(rows: &[Row], particles: &[u32; WIDTH], _: usize) -> [Lanes; WIDTH] {
    transpose(std::array::from_fn(|lane| &rows[particles[lane] as usize]))
}

#[inline(always)]
fn load_four(rows: &[Row], particles: &[u32; WIDTH], half: usize) -> [Lanes<Four>; WIDTH] {
    let four = &particles.as_chunks::<{ WIDTH / 2 }>().0[half];
    transpose_four(std::array::from_fn(|lane| &rows[four[lane] as usize]))
}

impl Packed for f32 {
    const LANES: usize = SINGLES;
    const BYTES: usize = size_of::<SingleRow>();

    #[inline(always)]
    fn entry<'a>(
        lists: &[&'a [[u32; WIDTH]]; 2],
        k: usize,
        own: &'a [[u32; WIDTH]; 2],
    ) -> [&'a [u32; WIDTH]; 2] {
        [lists[0].get(k).unwrap_or(&own[0]), lists[1].get(k).unwrap_or(&own[1])]
    }

    #[inline(always)]
    fn load(rows: &RowTable, particles: [&[u32; WIDTH]; 2], _: usize) -> Slots<f32> {
        let row = |block: usize, lane: usize| &rows.single[particles[block][lane] as usize];
        let low: [&SingleRow; WIDTH] = std::array::from_fn(|lane| row(0, lane));
        #[cfg(target_feature = "avx512f")]
        let high: [&SingleRow; WIDTH] = std::array::from_fn(|lane| row(1, lane));
        let quarter = |quarter: usize| -> [Lanes<f32>; WIDTH / 2] {
            let low = transpose_quarter(low, quarter);
            #[cfg(target_feature = "avx512f")]
            let high = transpose_quarter(high, quarter);
            std::array::from_fn(|k| {
                Lanes(cast([
                    low[k],
                    #[cfg(target_feature = "avx512f")]
                    high[k],
                ]))
            })
        };
        let ([a, b, c, d], [e, f, halves @ ..]) = (quarter(0), quarter(1));
        let ([thirds @ .., _], [coordinate, ..]) = (quarter(2), quarter(3));
        Slots { whole: [a, b, c, d, e, f], halves, thirds, last: thirds[0], coordinate }
    }

    #[inline(always)]
    fn prefetch(rows: &RowTable, particles: &[u32; WIDTH]) {
        particles.iter().for_each(|&particle| prefetch(&rows.single, particle as usize));
    }

    #[inline(always)]
    fn store(lanes: Lanes<f32>, scale: f64, values: &mut [f64]) {
        let all = lanes.to_array().map(|value| f64::from(value) * scale);
        values[..SINGLES].copy_from_slice(&all);
    }

    #[cold]
    fn store_part(lanes: Lanes<f32>, scale: f64, values: &mut [f64]) {
        for (value, lane) in values.iter_mut().zip(lanes.to_array()) {
            *value = f64::from(lane) * scale;
        }
    }
}

/// Eight slots of one particle, one cache line: what a pair pass loads of a neighbour.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Row(pub [f64; WIDTH]);

/// The sixteen slots of one particle in single precision, one cache line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(64))]
pub struct SingleRow(pub [f32; SLOTS]);

impl Default for Row {
    fn default() -> Self {
        Row([0.0; WIDTH])
    }
}

impl Lanes {
    /// Loads one row per lane and turns rows into slots: result\[s\] holds slot s of all eight rows.
    #[inline(always)]
    pub fn transpose(rows: [&Row; WIDTH]) -> [Lanes; WIDTH] {
        transpose(rows)
    }

    /// Slots for two numbers, each rounded to 21 bits.
    #[inline(always)]
    pub fn of_halves([high, low]: [Lanes; 2]) -> Lanes {
        Lanes(cast(rounded(high, HALF) << HALF | rounded(low, HALF)))
    }

    /// Slots for three numbers, each rounded to 10 bits.
    #[inline(always)]
    pub fn of_thirds([high, middle, low]: [Lanes; 3]) -> Lanes {
        let place = |number: Lanes, place: u32| rounded(number, THIRD) << (THIRD - place * (64 - THIRD));
        Lanes(cast(place(high, 0) | place(middle, 1) | place(low, 2)))
    }
}

macro_rules! shared_slots {
    ($scalar:ident, $vector:ident, $bits:ident) => {
        impl Lanes<$scalar> {
            /// The halves that share a slot.
            #[inline(always)]
            fn halves(self) -> [Self; 2] {
                let bits: $bits = cast(self.0);
                [Self::cut(bits, HALF), Lanes(cast(bits << HALF))]
            }

            /// The thirds that share a slot.
            #[inline(always)]
            fn thirds(self) -> [Self; 3] {
                let bits: $bits = cast(self.0);
                let third = |place: u32| Self::cut(bits << (place * (64 - THIRD)), THIRD);
                [third(0), third(1), third(2)]
            }

            /// Numbers without their last bits.
            #[inline(always)]
            fn cut(numbers: $bits, bits: u32) -> Self {
                Lanes(cast::<$bits, $vector>(numbers) & $vector::splat(f64::from_bits(u64::MAX << bits)))
            }
        }
    };
}
shared_slots!(f64, f64x8, u64x8);
shared_slots!(Four, f64x4, u64x4);

/// Bits of a number of double precision that half a slot and a third lack. What is left begins with sign and exponent,
/// and is made a number again by moving it to its place.
const HALF: u32 = 32;
const THIRD: u32 = 43;

/// The bits of numbers that are rounded to as many fewer, the last one kept in the lowest place.
#[inline(always)]
fn rounded(numbers: Lanes, bits: u32) -> u64x8 {
    (cast::<f64x8, u64x8>(numbers.0) + u64x8::splat(1 << (bits - 1))) >> bits
}

/// The same slot with the sign of its second number turned.
#[inline(always)]
pub fn with_second_third_turned(slot: f64) -> f64 {
    f64::from_bits(slot.to_bits() ^ (1 << (THIRD - 1)))
}

impl SingleRow {
    /// Sets the first eight slots of eight rows or fewer: slots\[s\] holds slot s of all of them.
    #[inline(always)]
    pub fn set_first(rows: &mut [SingleRow], slots: [[f32; WIDTH]; WIDTH]) {
        let first = f32x8::transpose(slots.map(f32x8::new));
        for (SingleRow(slots), first) in rows.iter_mut().zip(first) {
            slots[..WIDTH].copy_from_slice(&first.to_array());
        }
    }
}

/// Asks for a value, so that it lies in the caches when it is needed; nothing happens if there is none of that number.
#[inline(always)]
fn prefetch<T>(values: &[T], number: usize) {
    #[cfg(target_arch = "x86_64")]
    {
        use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
        let address = values.as_ptr().wrapping_add(number);
        // SAFETY: a prefetch is a hint: it never faults, wherever the address lies; SSE is part of x86-64.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(address.cast()) };
    }
}

/// Four slots of eight rows, from slot 4 * `quarter` on.
#[inline(always)]
fn transpose_quarter(rows: [&SingleRow; WIDTH], quarter: usize) -> [f32x8; WIDTH / 2] {
    let part = |row: usize| f32x4::new(rows[row].0.as_chunks().0[quarter]);
    // Rows k and k + 4 side by side: the transpose's last step, which exchanges halves, then falls away.
    let both = |k: usize| cast::<[f32x4; 2], f32x8>([part(k), part(k + 4)]);
    let zero = f32x8::ZERO;
    let slots = f32x8::transpose([both(0), both(1), both(2), both(3), zero, zero, zero, zero]);
    let low = |lanes: f32x8| cast::<f32x8, [f32x4; 2]>(lanes)[0];
    std::array::from_fn(|k| cast([low(slots[k]), low(slots[k + 4])]))
}

#[cfg(target_feature = "avx512f")]
#[inline(always)]
fn transpose(rows: [&Row; WIDTH]) -> [Lanes; WIDTH] {
    use std::arch::x86_64::*;
    // SAFETY: every row is 64 bytes, 64-byte aligned (repr(align(64))) and borrowed for the loads;
    // __m512d and f64x8 are both 64-byte vectors of eight f64; avx512f is enabled at build time.
    unsafe {
        let load = |k: usize| _mm512_load_pd(rows[k].0.as_ptr());
        let (r0, r1, r2, r3) = (load(0), load(1), load(2), load(3));
        let (r4, r5, r6, r7) = (load(4), load(5), load(6), load(7));
        let (a0, a1) = (_mm512_unpacklo_pd(r0, r1), _mm512_unpackhi_pd(r0, r1));
        let (a2, a3) = (_mm512_unpacklo_pd(r2, r3), _mm512_unpackhi_pd(r2, r3));
        let (a4, a5) = (_mm512_unpacklo_pd(r4, r5), _mm512_unpackhi_pd(r4, r5));
        let (a6, a7) = (_mm512_unpacklo_pd(r6, r7), _mm512_unpackhi_pd(r6, r7));
        const EVEN: i32 = 0x88;
        const ODD: i32 = 0xdd;
        let b0 = _mm512_shuffle_f64x2::<EVEN>(a0, a2);
        let b1 = _mm512_shuffle_f64x2::<EVEN>(a1, a3);
        let b2 = _mm512_shuffle_f64x2::<ODD>(a0, a2);
        let b3 = _mm512_shuffle_f64x2::<ODD>(a1, a3);
        let b4 = _mm512_shuffle_f64x2::<EVEN>(a4, a6);
        let b5 = _mm512_shuffle_f64x2::<EVEN>(a5, a7);
        let b6 = _mm512_shuffle_f64x2::<ODD>(a4, a6);
        let b7 = _mm512_shuffle_f64x2::<ODD>(a5, a7);
        let columns: [__m512d; WIDTH] = [
            _mm512_shuffle_f64x2::<EVEN>(b0, b4),
            _mm512_shuffle_f64x2::<EVEN>(b1, b5),
            _mm512_shuffle_f64x2::<EVEN>(b2, b6),
            _mm512_shuffle_f64x2::<EVEN>(b3, b7),
            _mm512_shuffle_f64x2::<ODD>(b0, b4),
            _mm512_shuffle_f64x2::<ODD>(b1, b5),
            _mm512_shuffle_f64x2::<ODD>(b2, b6),
            _mm512_shuffle_f64x2::<ODD>(b3, b7),
        ];
        std::mem::transmute::<[__m512d; WIDTH], [Lanes; WIDTH]>(columns)
    }
}

#[cfg(not(target_feature = "avx512f"))]
#[inline(always)]
fn transpose(rows: [&Row; WIDTH]) -> [Lanes; WIDTH] {
    let half = |half: usize| transpose_four(std::array::from_fn(|k| rows[half * WIDTH / 2 + k]));
    let (low, high) = (half(0), half(1));
    std::array::from_fn(|slot| Lanes(cast([low[slot].0, high[slot].0])))
}

/// The same of four rows.
#[inline(always)]
fn transpose_four(rows: [&Row; WIDTH / 2]) -> [Lanes<Four>; WIDTH] {
    let pair = |pair: usize| -> [Lanes<Four>; 2] {
        let part = |row: usize| f64x2::new(rows[row].0.as_chunks().0[pair]);
        // Rows k and k + 2 side by side, as they are loaded: the transpose's last step, which exchanges halves, falls away.
        let both = |k: usize| cast::<[f64x2; 2], f64x4>([part(k), part(k + 2)]);
        let slots = f64x4::transpose([both(0), both(1), f64x4::ZERO, f64x4::ZERO]);
        let low = |lanes: f64x4| cast::<f64x4, [f64x2; 2]>(lanes)[0];
        [Lanes(cast([low(slots[0]), low(slots[2])])), Lanes(cast([low(slots[1]), low(slots[3])]))]
    };
    let [[a, b], [c, d], [e, f], [g, h]] = [pair(0), pair(1), pair(2), pair(3)];
    [a, b, c, d, e, f, g, h]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_single_precision_become_slots() {
        let row = |row: usize| SingleRow(std::array::from_fn(|slot| (100 * row + slot) as f32));
        let rows = RowTable { single: (0..20).map(row).collect(), ..RowTable::default() };
        let particles: [[u32; WIDTH]; 2] = [[3, 1, 4, 19, 5, 9, 2, 6], [0, 0, 7, 8, 10, 11, 12, 18]];
        let slots = f32::load(&rows, particles.each_ref(), 0);
        let all = slots.whole.iter().chain(&slots.halves).chain(&slots.thirds);
        for (slot, lanes) in all.enumerate().chain([(THIRDS, &slots.last), (COORDINATE, &slots.coordinate)]) {
            let expected =
                particles.as_flattened()[..SINGLES].iter().map(|row| 100.0 * *row as f32 + slot as f32);
            assert!(lanes.to_array().into_iter().eq(expected), "slot {slot}");
        }
    }

    #[test]
    fn results_are_stored_in_double_precision() {
        let lanes = Lanes::<f32>(Singles::new(std::array::from_fn(|lane| lane as f32)));
        let mut values = [0.0; SINGLES];
        f32::store(lanes, 0.5, &mut values);
        assert_eq!(values[SINGLES - 1], 0.5 * (SINGLES - 1) as f64);
        f32::store_part(lanes, 2.0, &mut values[..3]);
        assert_eq!(values[..4], [0.0, 2.0, 4.0, 1.5]);
    }

    #[test]
    fn half_a_block_has_the_slots_of_its_particles() {
        let row = |row: usize| Row(std::array::from_fn(|slot| (100 * row + slot) as f64));
        let rows: Vec<Row> = (0..20).map(row).collect();
        let particles = [3, 1, 4, 19, 5, 9, 2, 6];
        let eight = load_eight(&rows, &particles, 0);
        for half in [0, 1] {
            for (four, eight) in load_four(&rows, &particles, half).into_iter().zip(eight) {
                assert_eq!(four.to_array(), eight.to_array()[4 * half..4 * half + 4]);
            }
        }
    }

    #[test]
    fn transpose_turns_rows_into_slots() {
        let rows: [Row; WIDTH] =
            std::array::from_fn(|row| Row(std::array::from_fn(|slot| (10 * row + slot) as f64)));
        let slots = Lanes::transpose(std::array::from_fn(|k| &rows[k]));
        for (slot, lanes) in slots.iter().enumerate() {
            let expected: [f64; WIDTH] = std::array::from_fn(|row| (10 * row + slot) as f64);
            assert_eq!(lanes.to_array(), expected);
        }
    }

    #[test]
    fn numbers_that_share_a_slot_are_rounded() {
        let numbers = [-1.0 / 3.0, 2e-300, 7e299];
        let lane = |lanes: Lanes| lanes.to_array()[5];
        let close = |found: Lanes, number: f64, bits: i32| {
            assert!((lane(found) / number - 1.0).abs() < 0.5_f64.powi(bits), "{found:?}, not {number}");
        };
        let [high, low] = Lanes::of_halves([numbers[0], numbers[2]].map(Lanes::splat)).halves();
        close(high, numbers[0], 21);
        close(low, numbers[2], 21);
        let slot = Lanes::of_thirds(numbers.map(Lanes::splat));
        slot.thirds().into_iter().zip(numbers).for_each(|(found, number)| close(found, number, 10));
        let turned = Lanes::<f64>::splat(with_second_third_turned(lane(slot))).thirds().map(lane);
        let [high, middle, low] = slot.thirds().map(lane);
        assert_eq!(turned, [high, -middle, low]);
        // Exact where the bits suffice, and what is not a number stays so.
        let few = [1.0, -0.75, 96.0];
        assert_eq!(Lanes::of_thirds(few.map(Lanes::splat)).thirds().map(lane), few);
        let [_, middle, _] = Lanes::of_thirds([0.0, f64::NAN, 0.0].map(Lanes::splat)).thirds();
        assert!(lane(middle).is_nan());
    }
}
