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
    let is_near = |a: usize, number: usize| {
        let b = list.source(number);
        let (r_b, z_b) = match number.checked_sub(list.len()) {
            Some(image) => domain.place(&list.images()[image], r[b], z[b]),
            None => (r[b], z[b]),
        };
        let support = 2.0 * theta * (size[a].min(largest_size) + size[b].min(largest_size));
        let (dr, dz) = (r_b - r[a], z_b - z[a]);
        dr * dr + dz * dz < support * support
    };
    // Everyone follows a neighbour that comes earlier; few have none.
    let parent = arena.alloc_slice_fill_copy(r.len(), 0);
    let mut left = 0;
    for a in 0..r.len() {
        let earlier = list.of(a).find(|&number| number < a && is_near(a, number));
        parent[a] = earlier.map_or(a as u32, |b| parent[b]);
        left += usize::from(earlier.is_none());
    }
    let mut join_neighbours = |parent: &mut [u32], a: usize| {
        let mut root_a = root(parent, a as u32);
        for number in list.of(a) {
            // Most neighbours belong to the same component already, and need not be measured. (To leave out those
            // with b > a would take longer: half of all guesses of that branch are wrong.)
            let root_b = root(parent, list.source(number) as u32);
            if root_b != root_a && is_near(a, number) {
                let least = root_a.min(root_b);
                parent[root_a.max(root_b) as usize] = least;
                root_a = least;
                left -= 1;
            }
        }
        left
    };
    // Their neighbours bring most of these together: mostly to one component, and that can't become less.
    let is_one = (0..r.len()).any(|a| parent[a] == a as u32 && join_neighbours(parent, a) == 1);
    if !is_one {
        for a in 0..r.len() {
            join_neighbours(parent, a);
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

#[cfg(test)]
mod tests {
    use super::*;
    use meniscus_engine::domain::Domain;

    /// Components by joining all listed pairs that are near, one by one.
    fn by_pairs(list: &NeighbourList, packing: &Packing, r: &[f64], z: &[f64], size: f64) -> Vec<u32> {
        let mut names: Vec<u32> = (0..r.len() as u32).collect();
        let mut has_changed = true;
        while has_changed {
            has_changed = false;
            for a in 0..r.len() {
                for b in list.of(a).filter(|&b| b < r.len()) {
                    let is_near = (r[b] - r[a]).hypot(z[b] - z[a]) < 4.0 * packing.theta * size;
                    let least = names[a].min(names[b]);
                    if is_near && names[a] != names[b] {
                        (names[a], names[b], has_changed) = (least, least, true);
                    }
                }
            }
        }
        names
    }

    #[test]
    fn components_are_those_of_the_pairs() {
        let domain = Domain { origin: 10.0, period: None };
        let packing = Packing { domain, theta: 0.5, largest_size: 1.0 };
        for spread in [0.02, 0.05, 0.07, 0.1, 0.3] {
            let r: Vec<f64> = (0..900).map(|i| (f64::from(i) * 0.754_877_666).fract()).collect();
            let z: Vec<f64> = (0..900).map(|i| (f64::from(i) * 0.569_840_291).fract()).collect();
            let (size, reach) = (vec![0.5 * spread; 900], vec![0.6 * spread; 900]);
            let mut list = NeighbourList::default();
            list.build([&r, &z, &reach], &domain);
            let arena = Bump::new();
            let found = components(&list, &packing, [&r, &z, &size], &arena);
            let expected = by_pairs(&list, &packing, &r, &z, 0.5 * spread);
            assert_eq!(found, expected, "within {spread}");
        }
    }
}
