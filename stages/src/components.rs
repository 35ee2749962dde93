//! Connected components: which particles belong to one drop.

use bumpalo::Bump;
use meniscus_engine::domain::Domain;
use meniscus_engine::neighbours::NeighbourList;

/// One in so many particles is asked first which components meet at it.
const SOME: usize = 16;

/// Joins every two particles within each other's support; a component's name is its least particle.
/// Columns are r and z in metres; a particle's reach in metres is half the support radius of a pair of equals.
pub fn components<'a>(
    list: &NeighbourList,
    domain: &Domain,
    [r, z]: [&[f64]; 2],
    reach: impl Fn(usize) -> f64,
    arena: &'a Bump,
) -> &'a mut [u32] {
    let is_near = |[r_a, z_a, reach_a]: [f64; 3], number: usize| {
        let (r_b, z_b) = list.place_of(number, domain, [r, z]);
        let support = reach_a + reach(list.source(number));
        let (dr, dz) = (r_b - r_a, z_b - z_a);
        dr * dr + dz * dz < support * support
    };
    // Everyone follows a neighbour that comes earlier; few have none.
    let parent = arena.alloc_slice_fill_copy(r.len(), 0);
    let mut left = 0;
    for a in 0..r.len() {
        let here = [r[a], z[a], reach(a)];
        let earlier = list.of(a).find(|&number| number < a && is_near(here, number));
        parent[a] = earlier.map_or(a as u32, |b| parent[b]);
        left += usize::from(earlier.is_none());
    }
    let mut join_neighbours = |parent: &mut [u32], a: usize| {
        let here = [r[a], z[a], reach(a)];
        let mut root_a = root(parent, a as u32);
        for number in list.of(a) {
            // Most neighbours belong to the same component already, and need not be measured. (To leave out those
            // with b > a would take longer: half of all guesses of that branch are wrong.)
            let root_b = root(parent, list.source(number) as u32);
            if root_b != root_a && is_near(here, number) {
                let least = root_a.min(root_b);
                parent[root_a.max(root_b) as usize] = least;
                root_a = least;
                left -= 1;
            }
        }
        left
    };
    // The neighbours of those that have none bring most of these together, then those of one in some, for what is left
    // meets along borders, and then those of all: mostly to one component, and that can't become less.
    let is_one = (0..r.len()).any(|a| parent[a] == a as u32 && join_neighbours(parent, a) == 1)
        || (0..r.len()).step_by(SOME).any(|a| join_neighbours(parent, a) == 1);
    if !is_one {
        (0..r.len()).for_each(|a| _ = join_neighbours(parent, a));
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

    /// Components by joining all listed pairs that are near, one by one.
    fn by_pairs(list: &NeighbourList, r: &[f64], z: &[f64], support: f64) -> Vec<u32> {
        let mut names: Vec<u32> = (0..r.len() as u32).collect();
        let mut has_changed = true;
        while has_changed {
            has_changed = false;
            for a in 0..r.len() {
                for b in list.of(a).filter(|&b| b < r.len()) {
                    let is_near = (r[b] - r[a]).hypot(z[b] - z[a]) < support;
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
        for spread in [0.02, 0.05, 0.07, 0.1, 0.3] {
            let r: Vec<f64> = (0..900).map(|i| (f64::from(i) * 0.754_877_666).fract()).collect();
            let z: Vec<f64> = (0..900).map(|i| (f64::from(i) * 0.569_840_291).fract()).collect();
            let listed = vec![0.6 * spread; 900];
            let mut list = NeighbourList::default();
            list.build([&r, &z, &listed], &domain);
            let arena = Bump::new();
            let found = components(&list, &domain, [&r, &z], |_| 0.5 * spread, &arena);
            let expected = by_pairs(&list, &r, &z, spread);
            assert_eq!(found, expected, "within {spread}");
        }
    }
}
