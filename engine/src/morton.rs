//! Morton order: particles that are close in the plane lie close in memory.

use crate::parallel;

/// Spreads the lower 32 bits of a number over the even bits.
fn spread(value: u64) -> u64 {
    let mut v = value & 0xffff_ffff;
    v = (v | (v << 16)) & 0x0000_ffff_0000_ffff;
    v = (v | (v << 8)) & 0x00ff_00ff_00ff_00ff;
    v = (v | (v << 4)) & 0x0f0f_0f0f_0f0f_0f0f;
    v = (v | (v << 2)) & 0x3333_3333_3333_3333;
    (v | (v << 1)) & 0x5555_5555_5555_5555
}

/// Morton key of a point: its cell's column and row, bit by bit in turn.
pub fn key(column: u32, row: u32) -> u64 {
    spread(u64::from(column)) | (spread(u64::from(row)) << 1)
}

/// One of so many particles may precede its place before it pays to sort them anew.
const TOLERATED: usize = 8;

/// The order of particles along the Morton curve over cells of the given size (metres); particles of
/// one cell keep their order. None where the particles are so nearly in order that it doesn't pay: the order of
/// particles nearer to each other than `window` doesn't matter.
pub fn order(r: &[f64], z: &[f64], cell: f64, window: usize) -> Option<Vec<u32>> {
    if r.is_empty() {
        return None;
    }
    let least = |values: &[f64]| -parallel::maximum(values.len(), |i| -values[i]);
    let (r_least, z_least) = (least(r), least(z));
    let index = |value: f64, least: f64| ((value - least) / cell) as u32;
    let key_of = |i: usize| key(index(r[i], r_least), index(z[i], z_least));
    let precedes = |start: usize, (), len: usize| {
        (start..start + len).filter(|&i| key_of(i) < key_of(i.saturating_sub(window))).count()
    };
    let misplaced = parallel::fold_chunks(r.len(), (), &precedes, &|a, b| a + b);
    if misplaced * TOLERATED <= r.len() {
        return None;
    }
    let mut keys: Vec<(u64, u32)> = (0..r.len()).map(|i| (key_of(i), i as u32)).collect();
    keys.sort_unstable();
    // By reference: collected from the keys themselves the order would keep their memory.
    Some(keys.iter().map(|key| key.1).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_interleave_bits() {
        assert_eq!(key(0b11, 0b00), 0b0101);
        assert_eq!(key(0b00, 0b11), 0b1010);
        assert_eq!(key(u32::MAX, u32::MAX), u64::MAX);
    }

    #[test]
    fn order_is_a_permutation_that_follows_the_curve() {
        let r = [1.5, 0.5, 0.5, 1.5];
        let z = [1.5, 1.5, 0.5, 0.5];
        assert_eq!(order(&r, &z, 1.0, 1), Some(vec![2, 3, 1, 0]));
        assert_eq!(order(&[0.5, 1.5, 0.5, 1.5], &[0.5, 0.5, 1.5, 1.5], 1.0, 1), None);
    }
}
