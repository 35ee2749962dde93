//! Neighbour lists that are valid for many steps: every pair within the sum of two particles' reaches,
//! in blocks of eight particles whose entries are interleaved (sliced ELL).
//!
//! ```text
//! for each block of 8 particles: for each entry k: [neighbour k of particle 0, ..., of particle 7]
//! ```
//! A short list is filled up with the particle itself, which at distance zero contributes nothing.
//! Images (mirrored at the axis, shifted by the period) are numbered after the particles.

use crate::bins::Bins;
use crate::domain::{Domain, Image};
use crate::lanes::{Lanes, WIDTH, pack};
use crate::parallel;
use crate::store::bytes_of;
use std::ops::Range;

/// So many particles may change their places among each other to even out the lengths of lists; they lie in a few
/// cells, and it doesn't matter to the caches which comes first.
pub const WINDOW: usize = 8 * WIDTH;

/// It pays where it leaves at most this part of a list.
const EVEN: f64 = 0.96;

/// The neighbours of every particle.
#[derive(Clone, Debug, Default)]
pub struct NeighbourList {
    len: usize,
    images: Vec<Image>,
    block_start: Vec<u32>,
    /// Interleaved: eight of them belong to one block. While a list is built, what the old one's hold is of no use any
    /// more: then an order of the particles lies there, if one is looked for, and behind it how many neighbours each has.
    entries: Vec<u32>,
    bins: Bins,
    /// The largest distance of a listed pair, m.
    largest: f64,
    /// Memory for the next build, for places and reaches in the order of the cells. It holds nothing in between:
    /// who has other use for it can take it.
    pub scratch: [Vec<f64>; 3],
    /// Whether the list holds for the particles where they lie now, if somebody has looked.
    pub still_holds: Option<bool>,
    /// As long as this is above zero the list holds in any case: how far, m, a particle may still move or its reach
    /// grow, by what moved farthest in each step so far. Where nobody knows it is zero.
    pub margin: f64,
    builds: u64,
}

impl NeighbourList {
    /// Builds the list for particles at (r, z) (metres): a pair is listed if its distance is below
    /// reach_a + reach_b (metres) and above zero: what lies at the same place has no pair axis.
    pub fn build(&mut self, points: [&[f64]; 3], domain: &Domain) {
        self.count(points, domain);
        self.fill(points);
    }

    /// The first half of [`NeighbourList::build`]: how many neighbours particles at (r, z) with their reaches (metres)
    /// have. [`NeighbourList::fill`] must follow, but particles may change their order in between.
    pub fn count(&mut self, points: [&[f64]; 3], domain: &Domain) {
        self.place(points, domain);
        let len = points[0].len();
        self.len = len;
        self.entries.resize(self.entries.len().max(2 * len), 0);
        let search = Search { bins: &self.bins, points, sorted: &self.scratch, largest: self.largest };
        let counts = &mut self.entries[len..2 * len];
        parallel::for_chunks_of(parallel::DEAR_CHUNK, len, counts, |start, counts| {
            for (k, count) in counts.iter_mut().enumerate() {
                *count = 0;
                search.near(start + k, |_, inside| *count += inside.count_ones());
            }
        });
    }

    /// Looks for an order of the particles in which each block of eight has lists of about the same length, for a block's
    /// are filled up to its longest one: [`NeighbourList::order`] tells it. Everyone stays within his [`WINDOW`]. False
    /// where it doesn't pay.
    pub fn find_even_order(&mut self) -> bool {
        let (order, counts) = self.entries[..2 * self.len].split_at_mut(self.len);
        let (mut before, mut after) = (0, 0);
        for window in counts.chunks(WINDOW) {
            before += window.chunks(WIDTH).flat_map(|block| block.iter().max()).sum::<u32>();
            let mut sorted = [0; WINDOW];
            let sorted = &mut sorted[..window.len()];
            sorted.copy_from_slice(window);
            sorted.sort_unstable();
            after += sorted.chunks(WIDTH).flat_map(|block| block.last()).sum::<u32>();
        }
        if f64::from(after) > EVEN * f64::from(before) {
            return false;
        }
        order.iter_mut().zip(0..).for_each(|(place, particle)| *place = particle);
        for window in order.chunks_mut(WINDOW) {
            window.sort_unstable_by_key(|&particle| (counts[particle as usize], particle));
        }
        true
    }

    /// Between [`NeighbourList::find_even_order`] and [`NeighbourList::fill`]: particle `order[k]` becomes particle k.
    pub fn order(&self) -> &[u32] {
        &self.entries[..self.len]
    }

    /// The particles have taken up that order, and so have `points`.
    pub fn reorder(&mut self, points: [&[f64]; 3], domain: &Domain) {
        let (order, counts) = self.entries[..2 * self.len].split_at_mut(self.len);
        let windows = counts.chunks_mut(WINDOW).zip(order.chunks(WINDOW)).enumerate();
        for (window, (counts, order)) in windows {
            let mut before = [0; WINDOW];
            before[..counts.len()].copy_from_slice(counts);
            for (count, &from) in counts.iter_mut().zip(order) {
                *count = before[from as usize - window * WINDOW];
            }
        }
        self.place(points, domain);
    }

    /// Lends the memory of the entries while a new list is made: what the old one's hold is of no use then.
    pub fn take_entries(&mut self) -> Vec<u32> {
        std::mem::take(&mut self.entries)
    }

    /// Takes back what [`NeighbourList::take_entries`] lent.
    pub fn return_entries(&mut self, memory: Vec<u32>) {
        self.entries = memory;
    }

    /// Images, cells, and places and reaches in the cells' order.
    fn place(&mut self, [r, z, reach]: [&[f64]; 3], domain: &Domain) {
        self.largest = 2.0 * parallel::maximum(reach.len(), |i| reach[i]);
        domain.images(r, z, self.largest, &mut self.images);
        let images = &self.images;
        let place = |point: usize| match point.checked_sub(r.len()) {
            None => (r[point], z[point]),
            Some(image) => {
                let source = images[image].source as usize;
                domain.place(&images[image], r[source], z[source])
            }
        };
        // Cells of half the largest distance: five rows of them hold fewer points than three of twice the size.
        let count = r.len() + images.len();
        self.bins.build_of(count, place, 0.5 * self.largest);
        for column in &mut self.scratch {
            column.clear();
            if count + WIDTH > column.capacity() {
                // As in fill: the old memory goes before there is more. Images alone become more.
                *column = Vec::new();
                column.reserve_exact(count + images.len() / 4 + WIDTH);
            }
        }
        let [sorted_r, sorted_z, sorted_reach] = &mut self.scratch;
        for &member in self.bins.members() {
            let point = member as usize;
            let (r, z) = place(point);
            let source = point.checked_sub(reach.len()).map_or(point, |image| images[image].source as usize);
            sorted_r.push(r);
            sorted_z.push(z);
            sorted_reach.push(reach[source]);
        }
        self.scratch.iter_mut().for_each(|column| column.resize(count + WIDTH, 0.0));
    }

    /// The second half of [`NeighbourList::build`], for the particles that were counted.
    pub fn fill(&mut self, points: [&[f64]; 3]) {
        let len = points[0].len();
        let search = Search { bins: &self.bins, points, sorted: &self.scratch, largest: self.largest };
        self.block_start.clear();
        self.block_start.push(0);
        let mut total = 0;
        for block in self.entries[len..2 * len].chunks(WIDTH) {
            total += block.iter().max().copied().unwrap_or(0);
            self.block_start.push(total);
        }
        let total = total as usize * WIDTH;
        if total > self.entries.capacity() {
            // The old ones need not be kept while room is made; fresh memory is touched where it is filled.
            self.entries = Vec::new();
            self.entries = vec![0; total + total / 32];
        }
        self.entries.resize(total, 0);
        fill_blocks(&search, &self.block_start, 0, len, self.entries.as_chunks_mut().0);
        self.builds += 1;
    }

    /// Notes that no particle has moved farther, or its reach grown more, than by so many metres.
    pub fn note_motion(&mut self, most: f64) {
        self.margin -= most;
    }

    /// Number of particles in the list.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether the list has not been built, or for no particle.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The images, numbered from [`NeighbourList::len`] on.
    pub fn images(&self) -> &[Image] {
        &self.images
    }

    /// How often the list was built.
    pub fn builds(&self) -> u64 {
        self.builds
    }

    /// Listed pairs, counted from both sides.
    #[cfg(test)]
    fn pairs(&self) -> u64 {
        (0..self.len).map(|particle| self.of(particle).count() as u64).sum()
    }

    /// Entries of all blocks, with those that fill up short lists: what a pair pass evaluates.
    pub fn slots(&self) -> usize {
        self.entries.len()
    }

    /// Bytes that the list takes, and what building it needs.
    pub fn bytes(&self) -> usize {
        let numbers = [&self.block_start, &self.entries].map(bytes_of);
        let points = self.scratch.iter().map(bytes_of);
        bytes_of(&self.images) + self.bins.bytes() + numbers.into_iter().chain(points).sum::<usize>()
    }

    /// The interleaved entries of the eight particles from `8 * block` on; none behind the last particle.
    #[inline]
    pub fn block(&self, block: usize) -> &[[u32; WIDTH]] {
        if block + 1 >= self.block_start.len() {
            return &[];
        }
        let (entries, _) = self.entries.as_chunks();
        &entries[self.block_start[block] as usize..self.block_start[block + 1] as usize]
    }

    /// The listed neighbours of one particle; numbers from [`NeighbourList::len`] on are images.
    #[inline]
    pub fn of(&self, particle: usize) -> impl Iterator<Item = usize> + '_ {
        let entries = self.block(particle / WIDTH).iter().map(move |entry| entry[particle % WIDTH] as usize);
        // It fills up its own list.
        entries.take_while(move |&number| number != particle)
    }

    /// Particles and listed images in the order of their cells.
    pub fn in_cells(&self) -> &[u32] {
        self.bins.members()
    }

    /// Calls `visit` with ranges of [`NeighbourList::in_cells`] that together hold all that lay within `reach` metres of
    /// (r, z) when the list was built, and some more.
    #[inline]
    pub fn near(&self, r: f64, z: f64, reach: f64, visit: impl FnMut(Range<usize>)) {
        self.bins.near(r, z, reach, visit);
    }

    /// The image of that number, if it is one's.
    #[inline]
    fn image(&self, number: usize) -> Option<&Image> {
        number.checked_sub(self.len).map(|image| &self.images[image])
    }

    /// The particle behind a number that may be an image's.
    #[inline]
    pub fn source(&self, number: usize) -> usize {
        self.image(number).map_or(number, |image| image.source as usize)
    }

    /// Whether it is an image across the axis.
    #[inline]
    pub fn is_mirrored(&self, number: usize) -> bool {
        self.image(number).is_some_and(|image| image.mirrored)
    }

    /// Where that particle or image lies, m, with the particles at (r, z), m.
    #[inline]
    pub fn place_of(&self, number: usize, domain: &Domain, [r, z]: [&[f64]; 2]) -> (f64, f64) {
        match self.image(number) {
            Some(image) => {
                let source = image.source as usize;
                domain.place(image, r[source], z[source])
            }
            None => (r[number], z[number]),
        }
    }
}

struct Search<'a> {
    bins: &'a Bins,
    /// The particles.
    points: [&'a [f64]; 3],
    /// Particles and images in the order of their cells.
    sorted: &'a [Vec<f64>; 3],
    largest: f64,
}

impl Search<'_> {
    /// Calls `found(members, inside)` for eight members at a time with a bit for each that is listed for
    /// particle a. They are tested side by side: a branch on each would be guessed wrong as often as not.
    #[inline(always)]
    fn near(&self, a: usize, mut found: impl FnMut(&[u32; WIDTH], u32)) {
        let [r, z, reach] = self.points;
        let (r_a, z_a, reach_a) = (Lanes::splat(r[a]), Lanes::splat(z[a]), Lanes::splat(reach[a]));
        self.bins.near(r[a], z[a], reach[a] + 0.5 * self.largest, |range| {
            for start in range.clone().step_by(WIDTH) {
                let [r, z, reach] = self.sorted;
                let (dr, dz) = (Lanes::load(&r[start..]) - r_a, Lanes::load(&z[start..]) - z_a);
                let limit = Lanes::load(&reach[start..]) + reach_a;
                let square = dr * dr + dz * dz;
                // At distance zero lies the particle itself: it is no pair.
                let inside = square.less_bits(limit * limit) & Lanes::ZERO.less_bits(square);
                let members = &self.bins.padded_members()[start..start + WIDTH];
                let members = members.try_into().expect("eight members");
                found(members, inside & (0xff >> (WIDTH - (range.end - start).min(WIDTH))));
            }
        });
    }
}

/// Fills the entries of particles `first..last`, halving the range for rayon.
fn fill_blocks(
    search: &Search,
    block_start: &[u32],
    first: usize,
    last: usize,
    entries: &mut [[u32; WIDTH]],
) {
    let offset = block_start[first / WIDTH] as usize;
    if last - first > parallel::DEAR_CHUNK {
        let middle = first + ((last - first) / 2).next_multiple_of(WIDTH);
        let (left, right) = entries.split_at_mut(block_start[middle / WIDTH] as usize - offset);
        rayon::join(
            || fill_blocks(search, block_start, first, middle, left),
            || fill_blocks(search, block_start, middle, last, right),
        );
        return;
    }
    parallel::told("", || fill_chunk(search, (block_start, offset), first..last, entries));
}

/// Fills the entries of a range of particles, which begin at place `offset` of all entries.
fn fill_chunk(
    search: &Search,
    (block_start, offset): (&[u32], usize),
    range: Range<usize>,
    entries: &mut [[u32; WIDTH]],
) {
    let last = range.end;
    for start in range.step_by(WIDTH) {
        let block = start / WIDTH;
        let [begin, end] = [block, block + 1].map(|block| block_start[block] as usize - offset);
        let block_entries = &mut entries[begin..end];
        for lane in 0..WIDTH {
            let particle = start + lane;
            let mut count = 0;
            let mut store = |found: &[u32]| {
                for &b in found {
                    block_entries[count][lane] = b;
                    count += 1;
                }
            };
            if particle < last {
                let mut found = [0; 16 * WIDTH];
                let mut length = 0;
                search.near(particle, |members, inside| {
                    if length + WIDTH > found.len() {
                        store(&found[..length]);
                        length = 0;
                    }
                    found[length..length + WIDTH].copy_from_slice(&pack(members, inside));
                    length += inside.count_ones() as usize;
                });
                store(&found[..length]);
            }
            for entry in &mut block_entries[count..] {
                entry[lane] = particle.min(last - 1) as u32;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(count: usize) -> (Vec<f64>, Vec<f64>) {
        let r = (0..count).map(|i| (i as f64 * 0.754_877_666).fract()).collect();
        let z = (0..count).map(|i| (i as f64 * 0.569_840_291).fract()).collect();
        (r, z)
    }

    #[test]
    fn the_list_holds_exactly_the_pairs_within_reach() {
        let (r, z) = points(700);
        let reach: Vec<f64> = (0..700).map(|i| 0.02 + 0.02 * ((i % 5) as f64)).collect();
        let domain = Domain { origin: 0.0, period: Some((0.0, 1.0)) };
        let mut list = NeighbourList::default();
        list.build([&r, &z, &reach], &domain);
        for a in 0..700 {
            let mut listed: Vec<usize> = list.of(a).collect();
            listed.sort_unstable();
            let mut expected = Vec::new();
            for b in 0..700 + list.images().len() {
                let s = list.source(b);
                let (br, bz) =
                    if b < 700 { (r[b], z[b]) } else { domain.place(&list.images()[b - 700], r[s], z[s]) };
                assert_eq!(list.place_of(b, &domain, [&r, &z]), (br, bz));
                let distance = (br - r[a]).hypot(bz - z[a]);
                if distance > 0.0 && distance < reach[a] + reach[s] {
                    expected.push(b);
                }
            }
            assert_eq!(listed, expected, "particle {a}");
        }
    }

    #[test]
    fn an_even_order_makes_lists_shorter_and_keeps_the_pairs() {
        let (mut r, mut z) = points(3000);
        let mut reach: Vec<f64> = (0..3000).map(|i| 0.006 + 0.001 * ((i % 7) as f64)).collect();
        let domain = Domain { origin: 0.0, period: Some((0.0, 1.0)) };
        let mut list = NeighbourList::default();
        list.build([&r, &z, &reach], &domain);
        let (slots, pairs) = (list.slots(), list.pairs());
        list.count([&r, &z, &reach], &domain);
        assert!(list.find_even_order(), "lists of chance lengths");
        let order = list.order().to_vec();
        for column in [&mut r, &mut z, &mut reach] {
            *column = order.iter().map(|&from| column[from as usize]).collect();
        }
        list.reorder([&r, &z, &reach], &domain);
        list.fill([&r, &z, &reach]);
        assert!((list.slots() as f64) < 0.9 * slots as f64, "{} of {slots}", list.slots());
        assert_eq!(list.pairs(), pairs);
        list.count([&r, &z, &reach], &domain);
        assert!(!list.find_even_order());
        list.fill([&r, &z, &reach]);
        let mut anew = NeighbourList::default();
        anew.build([&r, &z, &reach], &domain);
        assert_eq!(list.entries, anew.entries);
    }

    #[test]
    fn the_list_does_not_depend_on_the_number_of_threads() {
        let (r, z) = points(5000);
        let reach = vec![0.015; 5000];
        let build = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mut list = NeighbourList::default();
                list.build([&r, &z, &reach], &Domain::default());
                list.entries
            })
        };
        assert_eq!(build(1), build(3));
    }
}
