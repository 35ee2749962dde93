//! Morton order: particles that are close in the plane lie close in memory.

use crate::parallel;

/// Spreads the bits of a number over the even bits.
fn spread(value: u16) -> u32 {
    let mut v = u32::from(value);
    v = (v | (v << 8)) & 0x00ff_00ff;
    v = (v | (v << 4)) & 0x0f0f_0f0f;
    v = (v | (v << 2)) & 0x3333_3333;
    (v | (v << 1)) & 0x5555_5555
}

/// Morton key of a point: its cell's column and row, bit by bit in turn.
pub fn key(column: u16, row: u16) -> u32 {
    spread(column) | (spread(row) << 1)
}

/// One of so many particles may precede its place before it pays to sort them anew.
const TOLERATED: usize = 8;

/// The order of particles along the Morton curve over cells of the given size (metres), or of larger ones where there
/// would be more in a row than a key tells apart; particles of one cell keep their order. None where the particles are
/// so nearly in order that it doesn't pay: the order of particles nearer to each other than `window` doesn't matter.
///
/// It is left in `memory`, whatever that held, for there keys and particles are sorted.
pub fn order<'a>(
    r: &[f64],
    z: &[f64],
    cell: f64,
    window: usize,
    memory: &'a mut Vec<u32>,
) -> Option<&'a [u32]> {
    if r.is_empty() {
        return None;
    }
    let most = |values: &[f64]| parallel::maximum(values.len(), |i| values[i]);
    let least = |values: &[f64]| -parallel::maximum(values.len(), |i| -values[i]);
    let (r_least, z_least) = (least(r), least(z));
    let extent = (most(r) - r_least).max(most(z) - z_least);
    let cell = cell.max(extent / f64::from(u16::MAX));
    let index = |value: f64, least: f64| ((value - least) / cell) as u16;
    let key_of = |i: usize| key(index(r[i], r_least), index(z[i], z_least));
    let precedes = |start: usize, (), len: usize| {
        (start..start + len).filter(|&i| key_of(i) < key_of(i.saturating_sub(window))).count()
    };
    let misplaced = parallel::fold_chunks(r.len(), (), &precedes, &|a, b| a + b);
    if misplaced * TOLERATED <= r.len() {
        return None;
    }
    memory.resize(memory.len().max(2 * r.len()), 0);
    let (pairs, _) = memory[..2 * r.len()].as_chunks_mut();
    pairs.iter_mut().enumerate().for_each(|(i, pair)| *pair = [key_of(i), i as u32]);
    pairs.sort_unstable_by_key(|&[key, particle]| u64::from(key) << 32 | u64::from(particle));
    for place in 0..r.len() {
        memory[place] = memory[2 * place + 1];
    }
    Some(&memory[..r.len()])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_interleave_bits() {
        assert_eq!(key(0b11, 0b00), 0b0101);
        assert_eq!(key(0b00, 0b11), 0b1010);
        assert_eq!(key(u16::MAX, u16::MAX), u32::MAX);
    }

    #[test]
    fn order_is_a_permutation_that_follows_the_curve() {
        let r = [1.5, 0.5, 0.5, 1.5];
        let z = [1.5, 1.5, 0.5, 0.5];
        let mut memory = vec![7; 3];
        assert_eq!(order(&r, &z, 1.0, 1, &mut memory), Some(&[2, 3, 1, 0][..]));
        assert_eq!(order(&[0.5, 1.5, 0.5, 1.5], &[0.5, 0.5, 1.5, 1.5], 1.0, 1, &mut memory), None);
    }

    #[test]
    fn cells_grow_where_a_key_has_not_enough_bits() {
        let r = [3.0, 1e6, 0.0];
        let mut memory = Vec::new();
        assert_eq!(order(&r, &[0.0; 3], 1.0, 1, &mut memory), Some(&[0, 2, 1][..]));
    }
}
