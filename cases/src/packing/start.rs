//! Where the particles stand before the relaxation: a jittered lattice, clipped by the region; in large
//! regions a tile that is settled already.

use super::domain::{Domain, Point};
use super::relax::{relax, surroundings};
use std::ops::ControlFlow;

/// Half width of the jitter in lattice spacings. A uniform jitter of a whole (or half) spacing has
/// no Bragg peak left: nothing of the lattice survives as a preferred direction. At half a spacing
/// neighbours are still arranged like the lattice and it grows back.
const JITTER: f64 = 1.0;

/// Particles along a side of the tile.
const TILE: usize = 96;

/// `count` points of a jittered square lattice that `wanted` accepts: those that lie deepest inside, so that what
/// the lattice has too much or too little is spread evenly along the whole boundary.
pub(super) fn points(
    domain: &Domain,
    seed: u64,
    count: usize,
    wanted: impl Fn(&Point) -> bool,
) -> Vec<Point> {
    let [r_min, r_max, z_min, z_max] = domain.bounds;
    let repeats = domain.period_r.is_some();
    // Beyond the bounds by one row, except where the axis or a period ends the lattice.
    let first_r = if domain.has_axis || repeats { 0.0 } else { r_min - 1.0 };
    let last_r = if repeats { r_max } else { r_max + 1.0 };
    let columns = (last_r - first_r).ceil() as usize;
    let (first_z, rows, spacing) = match domain.period {
        Some(period) => (0.0, period.round() as usize, period / period.round()),
        None => (z_min - 1.0, (z_max - z_min + 2.0).ceil() as usize, 1.0),
    };
    let mut random = SplitMix(seed);
    let mut candidates: Vec<(f64, usize, Point)> = Vec::new();
    for index in 0..columns * rows {
        let (row, column) = (index / columns, index % columns);
        let jitter = [random.centred() * JITTER, random.centred() * JITTER];
        let point =
            [first_r + column as f64 + 0.5 + jitter[0], first_z + (row as f64 + 0.5 + jitter[1]) * spacing];
        let distance = domain.signed_distance(point);
        if distance < 1.5 && wanted(&point) {
            candidates.push((distance, index, point));
        }
    }
    candidates.sort_by(|one, other| one.0.total_cmp(&other.0));
    candidates.truncate(count);
    // Back in lattice order: neighbours in space stay neighbours in memory.
    candidates.sort_by_key(|candidate| candidate.1);
    candidates.into_iter().map(|(_, _, point)| point).collect()
}

/// The points that `wanted` accepts of a settled tile, repeated over the region's bounds.
pub(super) fn settled_points(
    domain: &Domain,
    seed: u64,
    iterations: usize,
    wanted: impl Fn(&Point) -> bool,
) -> Vec<Point> {
    let plane = Domain::tile(TILE);
    let mut tile = points(&plane, seed, plane.count, |_| true);
    let go_on = &mut || ControlFlow::Continue(());
    // Nobody stops it.
    let _ = relax(&plane, (&mut tile, &surroundings(&plane, &[])), iterations, go_on);
    let [r_min, r_max, z_min, z_max] = domain.bounds;
    let copies = |width: f64| (width / TILE as f64).ceil() as usize;
    let (columns, rows) = (copies(r_max - r_min), copies(z_max - z_min));
    let copy = |index: usize| {
        let corner = [index % columns, index / columns].map(|place| (place * TILE) as f64);
        let corner = [r_min + corner[0], z_min + corner[1]];
        tile.iter().map(move |point| [corner[0] + point[0], corner[1] + point[1]])
    };
    (0..columns * rows).flat_map(copy).filter(wanted).collect()
}

/// Vigna's generator: one seed, one sequence, on every machine.
struct SplitMix(u64);

impl SplitMix {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^ (bits >> 31)
    }

    /// Uniform between -1 and 1.
    fn centred(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}
