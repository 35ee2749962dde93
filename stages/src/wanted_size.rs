//! Wanted sizes: where a thread is thin its particles are to be small.

use crate::equation_of_state::Packing;
use crate::fields;
use crate::size_evening::is_due;
use crate::surface::for_surface;
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Read, Update};
use meniscus_engine::wiring::Wiring;

/// The largest part of the area at the start that anyone lacks of it, a number of the clock.
pub const MOST_REFINED: &str = "largest refinement";

/// Radius of a thread, in particle sizes of the start, below which its particles are to be smaller. With 14 jets tear no better;
/// with 7 half of the error is left (`cases/rayleigh-plateau-jet` has the variants' figures).
const PARTICLES: f64 = 10.0;

/// Least wanted area over that at the start: with a quarter a fifth more of the error is left.
const LEAST: f64 = 0.125;

/// How many times as large as the least wanted area around a particle its own may be.
const GRADE: f64 = 1.3;

/// By how much a wanted area falls from one look to the next, at most: what is thin for a moment is roughness, which a thread
/// outlasts. (At once fast collisions won twice as much energy and took 21 % more steps; so they win as much as without, in 2 %
/// more.)
const FALL: f64 = 1.15;

/// A place on the surface counts as no nearer to the axis than so many particle sizes.
const NEAREST: f64 = 0.5;

/// Sizes for thin threads, which neither the paper nor method.md has.
///
/// A thread that thins to a few particle sizes has a peak of pressure beside its waist which is narrower than their supports, so
/// it tears too slowly (`cases/rayleigh-plateau-jet`). There particles are to have the areas
///
///   V_w = V_0 min(1, max(LEAST, 1/(PARTICLES D_0 k)^2)),  k = n_r/R - max(0, P_L/sigma - n_r/R),
///
/// k the curvature around the axis less that along the outline: one over the radius of a thread, zero for a sphere. So drops keep
/// their sizes, however coarse they are, and rims and films theirs. Nobody wants more than GRADE times what the least of its
/// listed neighbours, or itself, wanted at the look before: sizes differ by a bounded factor from one to the next, inside as at
/// the surface, and where a thread has torn they come back within some looks.
///
/// Particles are split, merged and evened by their V/V_w (`split_and_merge`, `size_evening`). Where nobody is refined nothing
/// changes, not a bit. The column holds 1 - V_w/V_0, which is zero then.
pub struct WantedSize {
    packing: Packing,
    /// sigma, N/m.
    tension: f64,
    position: [Read<f64>; 2],
    velocity: [Read<f64>; 2],
    surface: Read<u32>,
    pressure: Read<f64>,
    tangent: Read<f64>,
    offset: Read<f64>,
    refinement: Update<f64>,
}

impl WantedSize {
    /// It must end the step, before sizes are evened. `tension` is the liquid's in N/m.
    pub fn new(wiring: &mut Wiring, packing: Packing, tension: f64) -> Self {
        wiring.stage("wanted-size");
        WantedSize {
            packing,
            tension,
            position: fields::POSITION.map(|field| wiring.read(field)),
            velocity: fields::VELOCITY.map(|field| wiring.read(field)),
            surface: wiring.read(&fields::SURFACE),
            pressure: wiring.read(&fields::LAPLACE_PRESSURE),
            tangent: wiring.read(&fields::SURFACE_TANGENT_Z),
            offset: wiring.read(&fields::SURFACE_OFFSET_R),
            refinement: wiring.update(&fields::REFINEMENT),
        }
    }

    /// Who lies at a thread that is too thin, and V_w/V_0 there.
    fn find_thin<'a>(&self, world: &'a World) -> &'a [(u32, f64)] {
        let [r, _] = self.position.map(|field| world.store.read(field));
        let (surface, pressure) = (world.store.read(self.surface), world.store.read(self.pressure));
        let (tangent, offset) = (world.store.read(self.tangent), world.store.read(self.offset));
        let size = 0.5 * self.packing.largest_size;
        let mut thin = bumpalo::collections::Vec::new_in(&world.arena);
        for_surface(&surface, |i| {
            // Spray has no surface to speak of.
            if pressure[i] == 0.0 {
                return;
            }
            let radius = (r[i] + offset[i] + self.packing.domain.origin).max(NEAREST * size);
            let around = -tangent[i] / radius;
            let slender = around - (pressure[i] / self.tension - around).max(0.0);
            let over = PARTICLES * size * slender;
            if over > 1.0 {
                thin.push((i as u32, (over * over).recip().max(LEAST)));
            }
        });
        thin.into_bump_slice()
    }

    /// The wanted areas from those at the last look; the least of them.
    fn refine(&self, world: &World, thin: &[(u32, f64)]) -> f64 {
        let mut refinement = world.store.write(self.refinement);
        let last = &*world.arena.alloc_slice_fill_with(refinement.len(), |i| 1.0 - refinement[i]);
        let list = &world.neighbours;
        let body = |start: usize, refinement: &mut [f64], _: usize| {
            let first = thin.partition_point(|(particle, _)| (*particle as usize) < start);
            let mut thin = thin[first..].iter().peekable();
            let mut least = 1.0_f64;
            for (i, refinement) in (start..).zip(refinement) {
                let own = match thin.next_if(|(particle, _)| *particle as usize == i) {
                    Some((_, area)) => area.max(last[i] / FALL),
                    None => 1.0,
                };
                let around = list.of(i).map(|number| last[list.source(number)]).fold(last[i], f64::min);
                let wanted = own.min(GRADE * around);
                *refinement = 1.0 - wanted;
                least = least.min(wanted);
            }
            least
        };
        parallel::fold_chunks(last.len(), &mut refinement[..], &body, &f64::min)
    }
}

impl Stage for WantedSize {
    fn name(&self) -> &'static str {
        "wanted-size"
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        if !is_due(world, self.velocity, &self.packing) {
            return Ok(());
        }
        let thin = self.find_thin(world);
        if thin.is_empty() && world.clock.number(MOST_REFINED) == 0.0 {
            return Ok(());
        }
        let least = self.refine(world, thin);
        world.clock.set_number(MOST_REFINED, 1.0 - least);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::{BOUNDARY, INSIDE};
    use meniscus_engine::clock::Clock;
    use meniscus_engine::domain::Domain;

    const SIZE: f64 = 1e-6;
    const TENSION: f64 = 0.07;

    /// Wanted areas over that at the start, after each of some looks, of a row of particles from the axis to a surface `radius`
    /// sizes away, where the Laplace pressure is so many times that of a thread.
    fn wanted(radius: f64, threads: f64, looks: usize) -> Vec<Vec<f64>> {
        let packing = Packing { domain: Domain::default(), theta: 0.5, largest_size: 2.0 * SIZE };
        let mut wiring = Wiring::new();
        let mut stage = WantedSize::new(&mut wiring, packing, TENSION);
        let r: Vec<f64> = (0..radius as usize).map(|k| SIZE * (k as f64 + 0.5)).collect();
        let (count, last) = (r.len(), r.len() - 1);
        let at_surface =
            |value: f64| (0..count).map(|i| if i == last { value } else { 0.0 }).collect::<Vec<_>>();
        let mut store = wiring.allocate(count);
        let columns = [
            ("radius", r.clone()),
            ("surface_tangent_z", at_surface(-1.0)),
            ("surface_offset_r", at_surface(0.5 * SIZE)),
            ("laplace_pressure", at_surface(threads * TENSION / (radius * SIZE))),
        ];
        assert!(columns.iter().all(|(name, values)| store.set(name, values)));
        let surface: Vec<u32> = (0..count).map(|i| if i == last { BOUNDARY } else { INSIDE }).collect();
        assert!(store.set("surface", &surface));
        let mut world = World::new(store, Clock::default());
        let (z, reach) = (vec![0.0; count], vec![2.0 * packing.reach(SIZE); count]);
        world.neighbours.build([&r, &z, &reach], &packing.domain);
        let look = |_| {
            stage.run(&mut world).expect("no fault");
            let refinement = world.store.by_name::<f64>("refinement").expect("a column").to_vec();
            let most = refinement.iter().copied().fold(0.0, f64::max);
            assert_eq!(world.clock.number(MOST_REFINED), most);
            refinement.into_iter().map(|refinement| 1.0 - refinement).collect()
        };
        (0..looks).map(look).collect()
    }

    #[test]
    fn only_thin_threads_are_refined() {
        let all_as_at_start = |looks: Vec<Vec<f64>>| looks.iter().flatten().all(|area| *area == 1.0);
        assert!(all_as_at_start(wanted(11.0, 1.0, 9)), "eleven particles are enough");
        assert!(all_as_at_start(wanted(4.0, 2.0, 9)), "a sphere");
        assert!(all_as_at_start(wanted(4.0, 0.0, 9)), "spray");
        assert!(!all_as_at_start(wanted(8.0, 1.0, 1)));
    }

    #[test]
    fn wanted_areas_fall_slowly_and_are_graded() {
        let looks = wanted(5.0, 1.0, 30);
        assert!((looks[0][4] - 1.0 / FALL).abs() < 1e-12, "{looks:?}");
        let last = looks.last().expect("some looks");
        assert!((last[4] - 0.25).abs() < 1e-12, "(5/10)^2: {last:?}");
        for pair in last.windows(2) {
            assert!(pair[0] / pair[1] < GRADE + 1e-12 && pair[0] >= pair[1], "{last:?}");
        }
        let thinnest = wanted(2.0, 1.0, 30).pop().expect("some looks");
        assert!((thinnest[1] - LEAST).abs() < 1e-12);
    }
}
