//! Connected components: which particles belong to one drop.

use crate::equation_of_state::Packing;
use bumpalo::Bump;
use meniscus_engine::neighbours::NeighbourList;

/// Joins every two particles within each other's support; a component's name is its least particle.
/// Columns are r, z and size in metres.
pub fn components<'a>(
    list: &NeighbourList,
    packing: &Packing,
    [r, z, size]: [&[f64]; 3],
    arena: &'a Bump,
) -> &'a mut [u32] {
    let Packing { domain, theta, largest_size } = *packing;
    let parent = arena.alloc_slice_fill_with(r.len(), |i| i as u32);
    for a in 0..r.len() {
        let mut root_a = root(parent, a as u32);
        for number in list.of(a) {
            let b = list.source(number);
            // Most neighbours belong to the same component already, and need not be measured. (To leave out those
            // with b > a would take longer: half of all guesses of that branch are wrong.)
            if root(parent, b as u32) == root_a {
                continue;
            }
            let (r_b, z_b) = match number.checked_sub(list.len()) {
                Some(image) => domain.place(&list.images()[image], r[b], z[b]),
                None => (r[b], z[b]),
            };
            let support = 2.0 * theta * (size[a].min(largest_size) + size[b].min(largest_size));
            let (dr, dz) = (r_b - r[a], z_b - z[a]);
            if dr * dr + dz * dz < support * support {
                root_a = join(parent, root_a, b as u32);
            }
        }
    }
    for i in 0..parent.len() {
        parent[i] = root(parent, i as u32);
    }
    parent
}

fn root(parent: &mut [u32], mut i: u32) -> u32 {
    while parent[i as usize] != i {
        let above = parent[parent[i as usize] as usize];
        parent[i as usize] = above;
        i = above;
    }
    i
}

/// Joins two components and returns the root of both.
fn join(parent: &mut [u32], a: u32, b: u32) -> u32 {
    let (a, b) = (root(parent, a), root(parent, b));
    parent[a.max(b) as usize] = a.min(b);
    a.min(b)
}
