//! Boundary detection: which particles lie at the free surface, and which have such a neighbour.

use crate::colour_field::{Colour, ColourField};
use crate::equation_of_state::Packing;
use crate::fields;
use crate::moment::Moment;
use crate::rows::PackedState;
use crate::surface::{BOUNDARY, INSIDE, NEAR_BOUNDARY, length};
use crate::surface_interval::is_due;
use crate::surface_points::Particles;
use crate::surface_search::{FARTHEST, even, reach};
use meniscus_engine::field::clear;
use meniscus_engine::lanes::{Lanes, WIDTH};
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Read, Write, bytes_of};
use meniscus_engine::wiring::Wiring;
use std::sync::{Arc, Mutex};

/// A particle is at the boundary where the smaller eigenvalue of L is below this
/// (method.md, section 7).
pub const EIGENVALUE: f64 = 0.75;

/// Refuses boundary particles that the colour field sees deep inside: voids are no surface
/// (method.md, section 10, "Colour guard").
pub struct ColourGuard {
    /// The colour field, shared with the curvature.
    pub field: Arc<Mutex<ColourField>>,
    /// Highest colour of a boundary particle; none for no guard, where the field is wanted by the curvature alone.
    pub highest: Option<f64>,
    /// Support radius of the colour field in particle sizes.
    pub support: f64,
    /// Whether the curvature notes the way from a particle to the surface.
    pub with_offset: bool,
}

/// A particle that lay no deeper than so many particle sizes below the surface when it was last looked
/// for is not deep inside: the guard needn't look.
const SHALLOW: f64 = 0.8;

/// Nor can a particle lie at the surface from which the colour falls to one half only beyond so many
/// particle sizes: where the packing is thin the colour is low, but flat.
const FAR: f64 = 2.5;

impl ColourGuard {
    /// Whether a particle of the given size (m) that sees this colour at its own place lies deep inside, where
    /// particles have `usual` sizes.
    ///
    /// Too high a colour alone doesn't say so of rings that have come near to the axis and have grown in the plane: the
    /// tip of a splash on the axis was packed so densely by them that the colour was 1.4 inside and .88 at its surface.
    /// But it is as much steeper there. So for them it must also fall to one half no nearer than where it is the
    /// highest in an even packing. (For all of them, holes between drops that collide were taken for surface.)
    fn is_deep(&self, colour: &Colour, size: f64, usual: f64) -> bool {
        let Some(highest) = self.highest else { return false };
        let excess = colour.value - 0.5;
        let fall = size * length(colour.gradient);
        let has_grown = even(size, usual) > usual;
        let is_far = || !has_grown || excess > self.support * reach(highest - 0.5) * fall;
        excess > FAR * fall || (colour.value > highest && is_far())
    }
}

/// The stage.
pub struct BoundaryDetect {
    packing: Packing,
    interval: u64,
    guard: Option<ColourGuard>,
    position: [Read<f64>; 2],
    listed: [Read<f64>; 2],
    deficiency: [Read<f64>; 3],
    offset: Option<[Read<f64>; 2]>,
    surface: Write<u32>,
    candidates: Vec<u32>,
    doubtful: Vec<u32>,
    refused: Vec<u32>,
}

impl BoundaryDetect {
    /// Detects every `interval` steps, more often where the curvature is needed more often; `packing` gives the
    /// support of a pair.
    pub fn new(wiring: &mut Wiring, packing: Packing, interval: u64, guard: Option<ColourGuard>) -> Self {
        wiring.stage("boundary-detect");
        let with_offset = guard.as_ref().is_some_and(|guard| guard.with_offset);
        BoundaryDetect {
            packing,
            interval,
            guard,
            position: fields::POSITION.map(|field| wiring.read(field)),
            listed: [wiring.read(&fields::LIST_RADIUS), wiring.read(&fields::LIST_AXIAL)],
            deficiency: fields::SUPPORT_DEFICIENCY.map(|field| wiring.read(field)),
            offset: with_offset.then(|| fields::SURFACE_OFFSET.map(|field| wiring.read(field))),
            surface: wiring.write(&fields::SURFACE),
            candidates: Vec::new(),
            doubtful: Vec::new(),
            refused: Vec::new(),
        }
    }

    fn find_candidates(&mut self, world: &World) {
        let [rr, rz, zz] = self.deficiency.map(|field| world.store.read(field));
        self.candidates.clear();
        for first in (0..rr.len()).step_by(WIDTH) {
            let eight = first..rr.len().min(first + WIDTH);
            let load = |column: &[f64]| Lanes::load_or(&column[eight.clone()], 0.0);
            let deficiency = load(&rr).abs() + load(&rz).abs() + load(&zz).abs();
            // Most lack nothing: eight of them are tested at once.
            if deficiency.less_bits(Lanes::splat(f64::MIN_POSITIVE)) != 0xff {
                let is_candidate = |i: &usize| {
                    !Moment::of_deficiency([rr[*i], rz[*i], zz[*i]]).eigenvalues_at_least(EIGENVALUE)
                };
                self.candidates.extend(eight.filter(is_candidate).map(|i| i as u32));
            }
        }
    }

    /// Candidates whose depth below the surface is not known to be small.
    fn find_doubtful(&mut self, world: &World) {
        let packed = PackedState(&world.rows);
        let offset = self.offset.map(|fields| fields.map(|field| world.store.read(field)));
        let is_shallow = |i: usize| {
            let Some([r, z]) = &offset else { return false };
            let depth = length([r[i], z[i]]);
            depth > 0.0 && depth < SHALLOW * packed.size(i).min(self.packing.largest_size)
        };
        self.doubtful.clear();
        self.doubtful.extend(self.candidates.iter().filter(|&&i| !is_shallow(i as usize)));
    }

    /// Takes up the particles in the shared colour field and asks it about every doubtful candidate.
    fn ask_guard(&mut self, world: &World) {
        self.refused.clear();
        let Some(guard) = &self.guard else { return };
        let [r, z] = self.position.map(|field| world.store.read(field));
        let [list_r, list_z] = self.listed.map(|field| world.store.read(field));
        let packed = PackedState(&world.rows);
        let support = guard.support * self.packing.largest_size;
        let source = Particles { r: &r, z: &z, list_r: &list_r, list_z: &list_z, support };
        let mut field = guard.field.lock().expect("no stage panics while it holds the colour field");
        let (r, z, doubtful) = (&r[..], &z[..], &self.doubtful[..]);
        let largest = self.packing.largest_size;
        let wanted = self.candidates.iter().map(|&i| {
            let size = packed.size(i as usize).min(largest);
            (i, guard.support * even(size, 0.5 * largest).max(size) + FARTHEST * size)
        });
        field.refresh(
            &source,
            |i| packed.area(i),
            wanted,
            world.neighbours.builds(),
            (self.packing.slack(), &self.packing.domain),
        );
        let mut known = std::mem::take(&mut field.known);
        known.resize(doubtful.len(), (0, Colour::default()));
        let look = &*field;
        parallel::for_chunks_of(16, doubtful.len(), &mut known[..], |start, known| {
            for (k, known) in known.iter_mut().enumerate() {
                let i = doubtful[start + k] as usize;
                let support = guard.support * even(packed.size(i).min(largest), 0.5 * largest);
                *known = (doubtful[start + k], look.at(r[i], z[i], support));
            }
        });
        let deep = known.iter().filter(|(i, colour)| {
            guard.is_deep(colour, packed.size(*i as usize).min(largest), 0.5 * largest)
        });
        self.refused.extend(deep.map(|(particle, _)| *particle));
        field.known = known;
    }

    fn mark(&self, world: &World) {
        let mut surface = world.store.write(self.surface);
        let [r, z] = self.position.map(|field| world.store.read(field));
        let packed = PackedState(&world.rows);
        let domain = &self.packing.domain;
        clear(&mut surface[..]);
        for &candidate in &self.candidates {
            surface[candidate as usize] = BOUNDARY;
        }
        for &candidate in &self.refused {
            surface[candidate as usize] = INSIDE;
        }
        let list = &world.neighbours;
        for &candidate in &self.candidates {
            let a = candidate as usize;
            if surface[a] != BOUNDARY {
                continue;
            }
            for number in list.of(a) {
                let b = list.source(number);
                if surface[b] != INSIDE {
                    continue;
                }
                let (r_b, z_b) = list.place_of(number, domain, [&r, &z]);
                let support = self.packing.reach(packed.size(a)) + self.packing.reach(packed.size(b));
                let (dr, dz) = (r_b - r[a], z_b - z[a]);
                if dr * dr + dz * dz < support * support {
                    surface[b] = NEAR_BOUNDARY;
                }
            }
        }
    }
}

impl Stage for BoundaryDetect {
    fn name(&self) -> &'static str {
        "boundary-detect"
    }

    fn bytes(&self) -> usize {
        // Other stages share the field; this one takes it up.
        let field = self.guard.as_ref().and_then(|guard| guard.field.lock().ok());
        let numbers = [&self.candidates, &self.doubtful, &self.refused].map(bytes_of);
        field.map_or(0, |field| field.bytes()) + numbers.iter().sum::<usize>()
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        if !is_due(&world.clock, self.interval) {
            return Ok(());
        }
        self.find_candidates(world);
        self.find_doubtful(world);
        self.ask_guard(world);
        self.mark(world);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use meniscus_engine::domain::Domain;

    /// Support radius in particle sizes.
    const SUPPORT: f64 = 11.0;

    /// Whether a particle is deep so many spacings below the surface z = 0 of liquid that fills `density` times the
    /// room there is, with a hole of two spacings across around z = -`void`; and the colour that it sees.
    fn is_deep(density: f64, void: f64, depth: f64) -> (bool, f64) {
        const ROWS: i32 = 30;
        let lattice = (-ROWS..ROWS).flat_map(|i| (0..ROWS).map(move |j| [i, -j].map(f64::from)));
        let places = lattice.map(|[r, z]| [r + 100.5, z - 0.5]);
        let (r, z): (Vec<f64>, Vec<f64>) =
            places.filter(|[r, z]| length([r - 100.0, z + void]) > 1.0).map(|[r, z]| (r, z)).unzip();
        let (size, support) = (density.sqrt(), SUPPORT * density.sqrt());
        let source = Particles { r: &r, z: &z, list_r: &r, list_z: &z, support };
        let mut field = ColourField::default();
        let all = (0..r.len() as u32).map(|i| (i, support));
        field.refresh(&source, |_| density, all, 1, (0.0, &Domain { origin: 0.0, period: None }));
        let guard =
            ColourGuard { field: Arc::default(), highest: Some(0.85), support: SUPPORT, with_offset: false };
        let colour = field.at(100.0, -depth, support);
        (guard.is_deep(&colour, size, 1.0), colour.value)
    }

    #[test]
    fn it_tells_the_memory_of_its_lists() {
        let domain = Domain { origin: 0.0, period: None };
        let packing = Packing { domain, theta: 0.5, largest_size: 1.0 };
        let mut stage = BoundaryDetect::new(&mut Wiring::new(), packing, 1, None);
        for list in [&mut stage.candidates, &mut stage.doubtful, &mut stage.refused] {
            list.reserve_exact(100);
        }
        assert_eq!(stage.bytes(), 3 * 100 * size_of::<u32>());
    }

    /// In the tip of a splash the colour was 1.4 inside, and .88 at the particle on the axis.
    #[test]
    fn a_dense_packing_is_not_deep_at_its_surface() {
        for density in [0.9, 1.0, 1.3, 1.4] {
            for depth in [0.3, 0.5, 0.7] {
                let (is_deep, colour) = is_deep(density, 100.0, depth);
                assert!(!is_deep, "{density} {depth} {colour}");
            }
        }
        assert!(is_deep(1.4, 100.0, 0.5).1 > 0.85);
    }

    #[test]
    fn voids_are_no_surface() {
        for density in [0.9, 1.0, 1.2, 1.4] {
            for void in [3.5, 4.5, 6.5, 9.5] {
                for depth in [void - 1.5, void + 1.5] {
                    let (is_deep, colour) = is_deep(density, void, depth);
                    assert!(is_deep, "{density} {void} {depth} {colour}");
                }
            }
        }
    }

    #[test]
    fn without_a_highest_colour_nobody_is_refused() {
        let deep = Colour { value: 1.0, ..Colour::default() };
        for (highest, expected) in [(None, false), (Some(0.85), true)] {
            let guard = ColourGuard { field: Arc::default(), highest, support: SUPPORT, with_offset: false };
            assert_eq!(guard.is_deep(&deep, 1.0, 1.0), expected);
        }
    }
}
