//! Boundary detection: which particles lie at the free surface, and which have such a neighbour.

use crate::colour_field::{Colour, ColourField, Particles};
use crate::equation_of_state::Packing;
use crate::fields;
use crate::moment::Moment;
use crate::surface::{BOUNDARY, INSIDE, NEAR_BOUNDARY};
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Read, Write};
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
    /// Highest colour of a boundary particle.
    pub highest: f64,
    /// Support radius of the colour field in particle sizes.
    pub support: f64,
    /// Distance that a particle may move before the neighbour list is built anew, m.
    pub slack: f64,
}

/// The stage.
pub struct BoundaryDetect {
    packing: Packing,
    interval: u64,
    guard: Option<ColourGuard>,
    position: [Read<f64>; 2],
    listed: [Read<f64>; 2],
    size: Read<f64>,
    moment: [Read<f64>; 3],
    surface: Write<u32>,
    candidates: Vec<u32>,
    accepted: Vec<bool>,
}

impl BoundaryDetect {
    /// Detects every `interval` steps; `packing` gives the support of a pair.
    pub fn new(wiring: &mut Wiring, packing: Packing, interval: u64, guard: Option<ColourGuard>) -> Self {
        wiring.stage("boundary-detect");
        let moment = [&fields::MOMENT_RR, &fields::MOMENT_RZ, &fields::MOMENT_ZZ];
        BoundaryDetect {
            packing,
            interval,
            guard,
            position: [wiring.read(&fields::RADIUS), wiring.read(&fields::AXIAL)],
            listed: [wiring.read(&fields::LIST_RADIUS), wiring.read(&fields::LIST_AXIAL)],
            size: wiring.read(&fields::SIZE),
            moment: moment.map(|field| wiring.read(field)),
            surface: wiring.write(&fields::SURFACE),
            candidates: Vec::new(),
            accepted: Vec::new(),
        }
    }

    fn find_candidates(&mut self, world: &World) {
        let [rr, rz, zz] = self.moment.map(|field| world.store.read(field));
        self.candidates.clear();
        for i in 0..rr.len() {
            let moment = Moment { rr: rr[i], rz: rz[i], zz: zz[i] };
            if !moment.eigenvalues_at_least(EIGENVALUE) {
                self.candidates.push(i as u32);
            }
        }
    }

    /// Takes up the particles in the shared colour field and asks it about every candidate.
    fn ask_guard(&mut self, world: &World) {
        self.accepted.clear();
        self.accepted.resize(self.candidates.len(), true);
        let Some(guard) = &self.guard else { return };
        let [r, z] = self.position.map(|field| world.store.read(field));
        let [list_r, list_z] = self.listed.map(|field| world.store.read(field));
        let size = world.store.read(self.size);
        let support = guard.support * self.packing.largest_size;
        let area = world.arena.alloc_slice_fill_with(size.len(), |i| size[i] * size[i]);
        let source = Particles { r: &r, z: &z, area, list_r: &list_r, list_z: &list_z, support };
        let mut field = guard.field.lock().expect("no stage panics while it holds the colour field");
        field.refresh(&source, world.neighbours.builds(), guard.slack, &self.packing.domain);
        let (r, z, size, candidates) = (&r[..], &z[..], &size[..], &self.candidates[..]);
        let largest = self.packing.largest_size;
        let mut known = std::mem::take(&mut field.known);
        known.resize(candidates.len(), (0, Colour::default()));
        let look = &*field;
        parallel::for_chunks_of(16, candidates.len(), &mut known[..], |start, known| {
            for (k, known) in known.iter_mut().enumerate() {
                let i = candidates[start + k] as usize;
                let support = guard.support * size[i].min(largest);
                *known = (candidates[start + k], look.at(r[i], z[i], support));
            }
        });
        for (accepted, (_, colour)) in self.accepted.iter_mut().zip(&known) {
            *accepted = colour.value <= guard.highest;
        }
        field.known = known;
    }

    fn mark(&self, world: &World) {
        let mut surface = world.store.write(self.surface);
        let [r, z] = self.position.map(|field| world.store.read(field));
        let size = world.store.read(self.size);
        let Packing { domain, theta, largest_size } = self.packing;
        surface.fill(INSIDE);
        for (&candidate, _) in self.candidates.iter().zip(&self.accepted).filter(|(_, a)| **a) {
            surface[candidate as usize] = BOUNDARY;
        }
        let list = &world.neighbours;
        for (&candidate, _) in self.candidates.iter().zip(&self.accepted).filter(|(_, a)| **a) {
            let a = candidate as usize;
            for number in list.of(a) {
                let b = list.source(number);
                if surface[b] != INSIDE {
                    continue;
                }
                let (r_b, z_b) = match number.checked_sub(list.len()) {
                    Some(image) => domain.place(&list.images()[image], r[b], z[b]),
                    None => (r[b], z[b]),
                };
                let support = 2.0 * theta * (size[a].min(largest_size) + size[b].min(largest_size));
                if (r_b - r[a]).hypot(z_b - z[a]) < support {
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

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        if !world.clock.step.is_multiple_of(self.interval) {
            return Ok(());
        }
        self.find_candidates(world);
        self.ask_guard(world);
        self.mark(world);
        Ok(())
    }
}
