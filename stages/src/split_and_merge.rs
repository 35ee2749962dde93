//! Splitting and merging: a ring that has grown large where the flow drew it in to the axis becomes two, and small ones
//! that were drawn out become one.

use crate::equation_of_state::Packing;
use crate::fields;
use crate::size_evening::{Carried, carried_by_mass, is_due};
use crate::surface::{BOUNDARY, INSIDE};
use bumpalo::Bump;
use bumpalo::collections::{CollectIn, Vec as ArenaVec};
use meniscus_engine::neighbours::NeighbourList;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Read, Store, Update};
use meniscus_engine::wiring::Wiring;
use std::f64::consts::FRAC_PI_2;

/// The identity of the next particle that is split off, among the numbers of the clock.
const NEXT_IDENTITY: &str = "next identity";

/// Area, over the wanted one, above which a particle becomes two: each has about the wanted area then.
const LARGEST: f64 = 2.0;
/// Area below which a particle looks for one to merge with; no more than twice this both may have. With .25 fast collisions and
/// long drops take 18 and 19 % more steps, for about the same energy won (while particles at the surface merged, too).
const SMALLEST: f64 = 0.5;
/// Area below which it does so at the surface, too.
const SPRAY: f64 = 0.125;

/// Distance of both from where the one was, in its sizes: there its halves have their middles.
const APART: f64 = 0.25;

/// No other may lie nearer to either place, in the same sizes.
const NEAREST: f64 = 0.2;

/// Least determinant of a moment matrix over its trace squared: with less all neighbours lie in one row.
const DISTINCT: f64 = 0.01;

/// Particles are split and merged (Feldman and Bonet 2007; Vacondio et al. 2013), so that they stay about as large as the
/// scene says wherever the flow takes them.
///
/// A ring keeps its mass m = 2 pi R V rho, so its area V grows as the flow draws it in to the axis. A thread that has thinned to a
/// tenth of a jet's radius consists of rings that are 3.2 times as large as the jet's were: 30 particles to the jet's radius are
/// one to the thread's, and it tears too slowly (`cases/rayleigh-plateau-jet`).
///
/// V_0 stands for what a particle is to have: its area at the start, and less where a thread is thin (`wanted_size`).
///
/// *Splitting.* V > 2 V_0 becomes two of equal areas, D/4 to either side along the direction in which the fewest
/// neighbours lie; along the boundary where the particle belongs to it, and along the axis where R < D. With
/// e = D/4 (e_r, e_z) and l = D e_r/(4 R)
///
///   m_1,2 = m (1 +- l)/2,  x_1,2 = x +- (1 -+ l) e,  U_1,2 = U +- (1 -+ l) (grad U) e,
///
/// but not while another particle lies within .2 D of either place. grad U by least squares over the neighbours. Mass, its first moment, momentum and total energy are kept; kinetic energy
/// rises by m (1 - l^2) |(grad U) e|^2/2, what the flow moves about the middle, which heat gives where it is solved for.
///
/// *Merging.* V < V_0/2 becomes one with the nearest neighbour of its drop with which it has less than V_0, if both lie inside, with no boundary
/// in their support: a film of some particles' thickness keeps them. With V < V_0/8, as spray has that flies outward, it does so wherever both are. Mass, volume, first moment, momentum and total energy are kept. The smallest
/// particle holds everyone's step: where flow goes outward, as in a drop that is spread to a disc, particles would become ever smaller.
pub struct SplitAndMerge {
    packing: Packing,
    /// V_0, m2.
    first_area: f64,
    position: [Update<f64>; 2],
    velocity: [Read<f64>; 2],
    density: Update<f64>,
    mass: Update<f64>,
    listed: [Update<f64>; 3],
    identity: Update<u32>,
    surface: Read<u32>,
    drop: Read<u32>,
    refinement: Read<f64>,
    carried: Carried,
    energy: Option<Update<f64>>,
}

/// One becomes two.
#[derive(Clone, Copy, Debug)]
struct Split {
    particle: u32,
    /// Which way the two lie from it, m.
    way: [f64; 2],
    /// By how much velocities rise on it, m/s.
    rise: [f64; 2],
}

/// Two become one.
#[derive(Clone, Copy, Debug)]
struct Merger {
    kept: u32,
    gone: u32,
}

impl SplitAndMerge {
    /// It must end the step: forces are balanced for the masses they were computed with. `two_step` where the
    /// accelerations of the step before still count.
    pub fn new(wiring: &mut Wiring, packing: Packing, two_step: bool, with_energy: bool) -> Self {
        wiring.stage("split-and-merge");
        SplitAndMerge {
            packing,
            first_area: (0.5 * packing.largest_size).powi(2),
            position: fields::POSITION.map(|field| wiring.update(field)),
            velocity: fields::VELOCITY.map(|field| wiring.read(field)),
            density: wiring.update(&fields::DENSITY),
            mass: wiring.update(&fields::MASS),
            listed: fields::LISTED.map(|field| wiring.update(field)),
            identity: wiring.update(&fields::IDENTITY),
            surface: wiring.read(&fields::SURFACE),
            drop: wiring.read(&fields::DROP),
            refinement: wiring.read(&fields::REFINEMENT),
            carried: carried_by_mass(wiring, two_step, with_energy),
            energy: with_energy.then(|| wiring.update(&fields::TOTAL_ENERGY)),
        }
    }

    /// V/V_w of a particle from its radius, density, mass and refinement.
    fn area(&self, r: f64, density: f64, mass: f64, refinement: f64) -> f64 {
        self.packing.area(r, density, mass) / self.first_area / (1.0 - refinement)
    }

    /// Who is too large, and who is too small.
    fn find<'a>(&self, store: &Store, arena: &'a Bump) -> [ArenaVec<'a, u32>; 2] {
        let [r, _] = self.position.map(|field| store.read(field));
        let (density, mass) = (store.read(self.density), store.read(self.mass));
        let refinement = store.read(self.refinement);
        let mut found = [ArenaVec::new_in(arena), ArenaVec::new_in(arena)];
        for i in 0..r.len() {
            let area = self.area(r[i], density[i], mass[i], refinement[i]);
            if area > LARGEST {
                found[0].push(i as u32);
            }
            if area < SMALLEST {
                found[1].push(i as u32);
            }
        }
        found
    }

    /// How one becomes two; not yet where somebody lies too near.
    fn split(&self, store: &Store, list: &NeighbourList, particle: u32, splits: &[Split]) -> Option<Split> {
        let (i, domain) = (particle as usize, &self.packing.domain);
        let [r, z] = self.position.map(|field| store.read(field));
        let [u, w] = self.velocity.map(|field| store.read(field));
        let (density, mass) = (store.read(self.density), store.read(self.mass));
        let size_of = |i: usize| self.packing.size(r[i], density[i], mass[i]);
        let size = size_of(i);
        let surface = store.read(self.surface);
        let is_boundary = surface[i] == BOUNDARY;
        // Sums of k d d^T and of k (U_b - U_a) d^T, with k = (1 - q)/d^2; the first also over the boundary alone.
        let (mut moment, mut differences, mut row) = ([0.0; 3], [[0.0; 2]; 2], [0.0; 3]);
        for number in list.of(i) {
            let b = list.source(number);
            let (r_b, z_b) = list.place_of(number, domain, [&r, &z]);
            let (dr, dz) = (r_b - r[i], z_b - z[i]);
            let square = dr * dr + dz * dz;
            let support = self.packing.reach(size) + self.packing.reach(size_of(b));
            let weight = (1.0 - square.sqrt() / support).max(0.0) / square;
            for ((sum, row), term) in moment.iter_mut().zip(&mut row).zip([dr * dr, dr * dz, dz * dz]) {
                *sum += weight * term;
                *row += if surface[b] == BOUNDARY { weight * term } else { 0.0 };
            }
            let u_b = if list.is_mirrored(number) { -u[b] } else { u[b] };
            for (sum, difference) in differences.iter_mut().zip([u_b - u[i], w[b] - w[i]]) {
                sum[0] += weight * difference * dr;
                sum[1] += weight * difference * dz;
            }
        }
        // Along `most` the most of them lie.
        let most = |[rr, rz, zz]: [f64; 3]| 0.5 * (2.0 * rz).atan2(rr - zz);
        let (sine, cosine) = if is_boundary { most(row) } else { most(moment) + FRAC_PI_2 }.sin_cos();
        let [rr, rz, zz] = moment;
        let at_axis = r[i] + domain.origin < size;
        let way = if at_axis { [0.0, 1.0] } else { [cosine, sine] }.map(|e| APART * size * e);
        let is_free = list.of(i).all(|number| {
            let b = list.source(number);
            let (r_b, z_b) = list.place_of(number, domain, [&r, &z]);
            let (dr, dz) = (r_b - r[i], z_b - z[i]);
            let other = splits.binary_search_by_key(&(b as u32), |split| split.particle);
            let other = other.map_or([0.0; 2], |place| splits[place].way);
            let other = if list.is_mirrored(number) { [-other[0], other[1]] } else { other };
            // The four, or two, places that both may have: as far apart as half of the two of one.
            [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]].into_iter().all(|[own, its]| {
                let [dr, dz] = [dr + its * other[0] - own * way[0], dz + its * other[1] - own * way[1]];
                dr * dr + dz * dz > (NEAREST * size).powi(2)
            })
        });
        if !is_free {
            return None;
        }
        let determinant = rr * zz - rz * rz;
        let rise = differences.map(|[r, z]| {
            if determinant > DISTINCT * (rr + zz).powi(2) {
                ((r * zz - z * rz) * way[0] + (z * rr - r * rz) * way[1]) / determinant
            } else {
                0.0
            }
        });
        Some(Split { particle, way, rise })
    }

    /// Pairs that become one.
    fn find_mergers<'a>(
        &self,
        (store, list): (&Store, &NeighbourList),
        small: &[u32],
        arena: &'a Bump,
    ) -> ArenaVec<'a, Merger> {
        let mut mergers = ArenaVec::new_in(arena);
        if small.is_empty() {
            return mergers;
        }
        let [r, z] = self.position.map(|field| store.read(field));
        let (density, mass) = (store.read(self.density), store.read(self.mass));
        let (surface, drop) = (store.read(self.surface), store.read(self.drop));
        let refinement = store.read(self.refinement);
        let area = |i: usize| self.area(r[i], density[i], mass[i], refinement[i]);
        let is_taken = arena.alloc_slice_fill_copy(store.len(), false);
        for a in small.iter().map(|&particle| particle as usize) {
            if is_taken[a] {
                continue;
            }
            let square = |b: usize| (r[b] - r[a]).powi(2) + (z[b] - z[a]).powi(2);
            let reach = |i: usize| self.packing.reach(self.packing.size(r[i], density[i], mass[i]));
            let fits = |b: usize| {
                let is_near = square(b) < (reach(a) + reach(b)).powi(2) && drop[a] == drop[b];
                let may_merge = area(a) < SPRAY || (surface[a] == INSIDE && surface[b] == INSIDE);
                is_near && may_merge && area(a) + area(b) < 2.0 * SMALLEST
            };
            // Images are no particles of their own.
            let others = list.of(a).filter(|&b| b < store.len() && !is_taken[b] && fits(b));
            if let Some(b) = others.min_by(|&b, &c| square(b).total_cmp(&square(c))) {
                (is_taken[a], is_taken[b]) = (true, true);
                let [kept, gone] = if mass[b] > mass[a] { [b, a] } else { [a, b] };
                mergers.push(Merger { kept: kept as u32, gone: gone as u32 });
            }
        }
        mergers
    }

    /// Moves particle i, and the place for which its neighbours were listed: they must be anew.
    fn relocate(&self, store: &Store, i: usize, way: [f64; 2]) {
        let [list_r, list_z, list_reach] = self.listed;
        for (columns, way) in [[self.position[0], list_r], [self.position[1], list_z]].into_iter().zip(way) {
            columns.into_iter().for_each(|column| store.write(column)[i] += way);
        }
        store.write(list_reach)[i] = 0.0;
    }

    /// What becomes of those that are kept.
    fn merge(&self, store: &Store, mergers: &[Merger]) {
        for merger in mergers {
            let (a, b) = (merger.kept as usize, merger.gone as usize);
            let [mass_a, mass_b] = [a, b].map(|i| store.read(self.mass)[i]);
            let part = mass_b / (mass_a + mass_b);
            let between = |column: Update<f64>| {
                let column = store.read(column);
                part * (column[b] - column[a])
            };
            self.relocate(store, a, self.position.map(between));
            for &column in &self.carried {
                let difference = between(column);
                store.write(column)[a] += difference;
            }
            let mut density = store.write(self.density);
            density[a] = 1.0 / ((1.0 - part) / density[a] + part / density[b]);
            store.write(self.mass)[a] = mass_a + mass_b;
        }
    }

    /// What becomes of those that are split and of their copies, which lie in the same order from `first` on.
    /// They get the identities from `next` on.
    fn divide(&self, store: &Store, splits: &[Split], (first, next): (usize, u32)) {
        for ((split, copy), identity) in splits.iter().zip(first..).zip(next..) {
            let a = split.particle as usize;
            let lean = split.way[0] / (store.read(self.position[0])[a] + self.packing.domain.origin);
            let whole = store.read(self.mass)[a];
            let velocity = self.velocity.map(|field| store.read(field)[a]);
            for (i, sign) in [(a, 1.0), (copy, -1.0)] {
                let part = sign - lean;
                self.relocate(store, i, split.way.map(|way| part * way));
                for (&column, rise) in self.carried.iter().zip(split.rise) {
                    store.write(column)[i] += part * rise;
                }
                // The heat of both remains that of the one, but for what is of second order in the rise.
                if let Some(energy) = self.energy {
                    store.write(energy)[i] +=
                        part * (velocity[0] * split.rise[0] + velocity[1] * split.rise[1]);
                }
                store.write(self.mass)[i] = 0.5 * (1.0 + sign * lean) * whole;
            }
            store.write(self.identity)[copy] = identity;
        }
    }
}

impl Stage for SplitAndMerge {
    fn name(&self) -> &'static str {
        "split-and-merge"
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        if !is_due(world, self.velocity, &self.packing) {
            return Ok(());
        }
        let World { store, neighbours, arena, clock, .. } = world;
        let arena = &*arena;
        let [large, small] = self.find(store, arena);
        let mergers = self.find_mergers((store, neighbours), &small, arena);
        let mut splits = ArenaVec::new_in(arena);
        for &particle in &large {
            splits.extend(self.split(store, neighbours, particle, &splits));
        }
        let parents: ArenaVec<u32> = splits.iter().map(|split| split.particle).collect_in(arena);
        if mergers.is_empty() && splits.is_empty() {
            return Ok(());
        }
        // Nobody gets the identity of one that has merged away.
        let largest = store.read(self.identity).iter().max().copied().unwrap_or(0);
        let next = (clock.number(NEXT_IDENTITY) as u32).max(largest + 1);
        clock.set_number(NEXT_IDENTITY, f64::from(next) + splits.len() as f64);
        self.merge(store, &mergers);
        let first = store.len();
        store.add_copies(&parents);
        self.divide(store, &splits, (first, next));
        let mut gone: ArenaVec<u32> = mergers.iter().map(|merger| merger.gone).collect_in(arena);
        gone.sort_unstable();
        store.remove(&gone);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use meniscus_engine::clock::Clock;
    use meniscus_engine::domain::Domain;
    use std::f64::consts::PI;

    const SIZE: f64 = 1e-6;
    const DENSITY: f64 = 1000.0;
    /// J/kg.
    const HEAT: f64 = 1000.0;
    /// m/s.
    const WIND: f64 = 100.0;

    /// A particle: r and z over the size, its area over that of the start.
    type Placed = ([f64; 2], f64);

    /// Nine by nine of them about (r, 0), all like at the start but the one in the middle.
    fn lattice(r: f64, middle: f64) -> Vec<Placed> {
        let row = |i: i32| (-4..=4).map(move |j| [f64::from(i), f64::from(j)]);
        let places = (-4..=4).flat_map(row).map(|[i, j]| [r + i, j]).filter(|[r, _]| *r > 0.0);
        places.map(|[i, j]| ([i, j], if (i, j) == (r, 0.0) { middle } else { 1.0 })).collect()
    }

    /// What the stage makes of them inside the liquid in a flow that is linear in the place; m, kg, s.
    fn run(particles: &[Placed], wind: f64) -> World {
        run_at(INSIDE, particles, wind)
    }

    /// The same where all have one place relative to the surface.
    fn run_at(surface: u32, particles: &[Placed], wind: f64) -> World {
        let (mut stage, mut world) = set_up(surface, particles, wind);
        stage.run(&mut world).expect("no fault");
        world
    }

    fn set_up(surface: u32, particles: &[Placed], wind: f64) -> (SplitAndMerge, World) {
        let packing = Packing { domain: Domain::default(), theta: 0.5, largest_size: 2.0 * SIZE };
        let mut wiring = Wiring::new();
        let stage = SplitAndMerge::new(&mut wiring, packing, false, true);
        let mut store = wiring.allocate(particles.len());
        let of = |value: &dyn Fn(&Placed) -> f64| particles.iter().map(value).collect::<Vec<f64>>();
        let [r, z] = [0, 1].map(|k| of(&|(place, _)| SIZE * place[k]));
        let mass = of(&|(place, area)| 2.0 * PI * SIZE.powi(3) * DENSITY * place[0] * area);
        let reach = of(&|(_, area)| 2.0 * packing.reach(SIZE * area.sqrt()));
        let flow = |k: usize| of(&|(place, _)| linear(place.map(|x| SIZE * x), wind)[k]);
        let speeds = flow(0).into_iter().zip(flow(1)).map(|(u, w)| u.hypot(w));
        let energy = speeds.map(|speed| HEAT + 0.5 * speed * speed).collect();
        let columns = [
            ("radius", &r),
            ("axial", &z),
            ("mass", &mass),
            ("density", &vec![DENSITY; r.len()]),
            ("velocity_r", &flow(0)),
            ("velocity_z", &flow(1)),
            ("total_energy", &energy),
        ];
        assert!(columns.into_iter().all(|(name, values)| store.set(name, values)));
        assert!(store.set("identity", &(0..r.len() as u32).collect::<Vec<_>>()));
        assert!(store.set("surface", &vec![surface; r.len()]));
        let mut world = World::new(store, Clock::default());
        world.neighbours.build([&r, &z, &reach], &packing.domain);
        (stage, world)
    }

    fn linear([r, z]: [f64; 2], wind: f64) -> [f64; 2] {
        [-2e5 * r, 3e5 * z + 1e5 * r + wind]
    }

    fn column(world: &World, name: &str) -> Vec<f64> {
        world.store.by_name::<f64>(name).expect("a column").to_vec()
    }

    /// Sums of m, m r, m z, m U_z and V R.
    fn sums(world: &World) -> [f64; 5] {
        let [m, r, z, w, density] =
            ["mass", "radius", "axial", "velocity_z", "density"].map(|name| column(world, name));
        let sum = |value: &dyn Fn(usize) -> f64| (0..m.len()).map(|i| m[i] * value(i)).sum::<f64>();
        [sum(&|_| 1.0), sum(&|i| r[i]), sum(&|i| z[i]), sum(&|i| w[i]), sum(&|i| 1.0 / density[i])]
    }

    /// Whether those sums are what they were before the stage ran.
    fn kept(particles: &[Placed], after: &World) -> bool {
        let whole = |value: &dyn Fn([f64; 2]) -> f64| {
            let mass = |(place, area): &Placed| 2.0 * PI * SIZE.powi(3) * DENSITY * place[0] * area;
            particles.iter().map(|one| mass(one) * value(one.0.map(|x| SIZE * x))).sum::<f64>()
        };
        let expected = [
            whole(&|_| 1.0),
            whole(&|[r, _]| r),
            whole(&|[_, z]| z),
            whole(&|x| linear(x, WIND)[1]),
            whole(&|_| 1.0 / DENSITY),
        ];
        let scales = [expected[0], expected[1], expected[1], expected[3], expected[4]];
        let found = sums(after).into_iter().zip(expected).zip(scales);
        found.into_iter().all(|((found, expected), scale)| (found - expected).abs() < 1e-13 * scale.abs())
    }

    #[test]
    fn a_large_one_becomes_two_equal_ones_that_go_with_the_flow() {
        let before = run(&lattice(20.0, 1.0), WIND);
        assert_eq!(before.store.len(), 81, "all are as at the start");
        let particles = lattice(20.0, 2.2);
        let after = run(&particles, WIND);
        assert_eq!(after.store.len(), 82);
        let [m, r, z] = ["mass", "radius", "axial"].map(|name| column(&after, name));
        let [u, w] = ["velocity_r", "velocity_z"].map(|name| column(&after, name));
        let energy = column(&after, "total_energy");
        let of_middle: Vec<usize> =
            (0..82).filter(|&i| (r[i] / SIZE - 20.0).hypot(z[i] / SIZE) < 0.9).collect();
        assert_eq!(of_middle.len(), 2);
        let areas = of_middle.iter().map(|&i| m[i] / (2.0 * PI * r[i] * DENSITY * SIZE * SIZE));
        assert!(areas.into_iter().all(|area| (area - 1.1).abs() < 1e-3));
        for i in of_middle {
            let [expected_u, expected_w] = linear([r[i], z[i]], WIND);
            assert!((u[i] / expected_u - 1.0).abs() < 1e-9 && (w[i] / expected_w - 1.0).abs() < 1e-9);
            let heat = energy[i] - 0.5 * (u[i] * u[i] + w[i] * w[i]);
            assert!((heat - HEAT).abs() < 0.1, "{heat} J/kg, whatever the wind");
        }
        assert!(kept(&particles, &after));
    }

    #[test]
    fn two_small_neighbours_become_one() {
        let mut particles = lattice(20.0, 1.0);
        particles
            .iter_mut()
            .filter(|(place, _)| place[1] == 0.0 && place[0] < 19.0)
            .for_each(|one| one.1 = 0.4);
        assert_eq!(particles.iter().filter(|(_, area)| *area < 1.0).count(), 3);
        let after = run(&particles, WIND);
        assert_eq!(after.store.len(), 80, "one of three is left alone");
        assert!(kept(&particles, &after));
    }

    #[test]
    fn an_identity_is_given_once() {
        let two = [([20.0, 0.0], 0.4), ([20.0, 0.5], 0.4)];
        let (mut stage, mut world) = set_up(INSIDE, &two, WIND);
        stage.run(&mut world).expect("no fault");
        let large: Vec<f64> = column(&world, "mass").iter().map(|mass| 4.0 * mass).collect();
        assert_eq!(large.len(), 1, "0 and 1 merge");
        assert!(world.store.set("mass", &large));
        let [r, z] = ["radius", "axial"].map(|name| column(&world, name));
        world.neighbours.build([&r, &z, &[4.0 * SIZE]], &Domain::default());
        stage.run(&mut world).expect("no fault");
        let identities = world.store.by_name::<u32>("identity").expect("a column").to_vec();
        assert_eq!(identities, [0, 2]);
    }

    #[test]
    fn lone_ones_far_from_each_other_stay_two() {
        for (apart, expected) in [(1.2, 1), (1.5, 2)] {
            // Listed for a reach twice as wide as their support's, 1.26 sizes.
            let after = run(&[([20.0, 0.0], 0.4), ([20.0, apart], 0.4)], WIND);
            assert_eq!(after.store.len(), expected, "{apart}");
        }
    }

    #[test]
    fn at_the_surface_spray_alone_merges() {
        for (areas, expected) in [([0.4, 0.4], 2), ([0.1, 0.1], 1), ([0.1, 0.8], 1), ([0.1, 1.0], 2)] {
            let after = run_at(BOUNDARY, &[([20.0, 0.0], areas[0]), ([20.0, 0.5], areas[1])], WIND);
            assert_eq!(after.store.len(), expected, "{areas:?}");
        }
    }

    #[test]
    fn nobody_is_split_where_another_one_lies() {
        // Near the axis both lie along it, a quarter of their size away.
        let alone = run(&lattice(0.8, 2.2), WIND);
        let size = 2.2_f64.sqrt();
        let mut particles = lattice(0.8, 2.2);
        let count = particles.len();
        assert_eq!(alone.store.len(), count + 1);
        particles.push(([0.85, APART * size], 0.8));
        assert_eq!(run(&particles, WIND).store.len(), count + 1);
    }
}
