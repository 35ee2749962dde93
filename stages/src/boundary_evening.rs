//! Boundary evening: particles at the boundary keep their distances along the surface.

use crate::equation_of_state::Packing;
use crate::fields;
use crate::rows::PackedState;
use crate::surface::{BOUNDARY, for_surface};
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Read, Update, bytes_of};
use meniscus_engine::wiring::Wiring;

/// Steps between two times that particles give way.
const INTERVAL: u64 = 16;
/// Part of the distance to the middle between both neighbours by which a particle moves, ...
const PART: f64 = 0.03;
/// ... of what these are nearer or farther than a particle size by more than so much of it, ...
const TOLERANCE: f64 = 0.2;
/// ... and no more than so many sizes at once.
const FARTHEST: f64 = 0.02;
/// Distance from the axis, in particle sizes, below which rings go with the flow alone: drawn to the axis or off it their
/// areas V = m/(2 pi R rho) change at once. (From one size on pairs of rings at the poles came within .3 D.)
const NEAR_AXIS: f64 = 3.0;

/// Evening of the boundary, which neither the paper nor method.md has.
///
/// The nearest particles of the boundary along the surface, one to either side, are at the distances a and b. Where one of them is
/// crowded or far a particle moves along the surface's tangent by
///
///   PART (e(b) - e(a))/2,  e(a) = a - min(max(a, (1 - TOLERANCE) D), (1 + TOLERANCE) D).
///
/// A drop that swings leaves drift along its surface behind, which adds up: the boundary's particles come nearer to each other
/// here, and part there. Shifting evens the interior and leaves the boundary alone. With 35 particles to the radius
/// and an amplitude of .085 (`cases/oscillating-drop`) they were .66 to 1.5 D apart after 25 periods, now .73 to 1.35; with 200 and
/// .02 such a crowd swung after 39 periods and threw particles about, and it came to rest within ten thousand steps of this.
///
/// A swing takes particles apart and brings them back, and must not be evened: without a tolerance drops of 17.5 and 35 to the
/// radius that swing gently lost .009 and .0025 a period. With it nothing at all changes in them. With a PART of .1
/// drops that swing far (aspect ratio 1.5) are .06 % faster, with .2 and a tolerance of .3 they are not, but .70 D remain.
pub struct BoundaryEvening {
    packing: Packing,
    position: [Update<f64>; 2],
    surface: Read<u32>,
    tangent: [Read<f64>; 2],
    moves: Vec<(u32, [f64; 2])>,
}

impl BoundaryEvening {
    /// Moves particles before the step; it must follow the curvature, which finds tangents.
    pub fn new(wiring: &mut Wiring, packing: Packing) -> Self {
        wiring.stage("boundary-evening");
        BoundaryEvening {
            packing,
            position: fields::POSITION.map(|field| wiring.update(field)),
            surface: wiring.read(&fields::SURFACE),
            tangent: fields::SURFACE_TANGENT.map(|field| wiring.read(field)),
            moves: Vec::new(),
        }
    }

    /// Finds who gives way, and by how much, m.
    fn find_moves(&mut self, world: &World) {
        let Packing { domain, largest_size, .. } = &self.packing;
        let (packed, list) = (PackedState(&world.rows), &world.neighbours);
        let surface = world.store.read(self.surface);
        let [r, z] = self.position.map(|field| world.store.read(field));
        let [tangent_r, tangent_z] = self.tangent.map(|field| world.store.read(field));
        self.moves.clear();
        for_surface(&surface, |a| {
            let size = packed.size(a).min(*largest_size);
            if surface[a] != BOUNDARY || r[a] + domain.origin < NEAR_AXIS * size {
                return;
            }
            let tangent = [tangent_r[a], tangent_z[a]];
            let mut nearest = [f64::INFINITY; 2];
            for number in list.of(a) {
                let b = list.source(number);
                if surface[b] != BOUNDARY {
                    continue;
                }
                let (r_b, z_b) = list.place_of(number, domain, [&r, &z]);
                // Mirrored, a tangent turns round: its normal points outward still.
                let turn = if list.is_mirrored(number) { -1.0 } else { 1.0 };
                let way = [r_b - r[a], z_b - z[a]];
                let along = way[0] * tangent[0] + way[1] * tangent[1];
                let across = way[0] * tangent[1] - way[1] * tangent[0];
                let is_of_this_side = tangent_r[b] * tangent[0] + turn * tangent_z[b] * tangent[1] > 0.0;
                if is_of_this_side && across.abs() < along.abs() {
                    let side = &mut nearest[usize::from(along > 0.0)];
                    *side = side.min(along.abs());
                }
            }
            let way = way(nearest, size);
            if way != 0.0 {
                self.moves.push((a as u32, tangent.map(|component| way * component)));
            }
        });
    }
}

/// The way along the surface, m, of a particle with neighbours at the given distances (m) against the tangent and along it.
fn way([behind, ahead]: [f64; 2], size: f64) -> f64 {
    if behind.max(ahead) == f64::INFINITY {
        return 0.0;
    }
    let excess =
        |distance: f64| distance - distance.clamp((1.0 - TOLERANCE) * size, (1.0 + TOLERANCE) * size);
    let farthest = FARTHEST * size;
    (0.5 * PART * (excess(ahead) - excess(behind))).clamp(-farthest, farthest)
}

impl Stage for BoundaryEvening {
    fn name(&self) -> &'static str {
        "boundary-evening"
    }

    fn bytes(&self) -> usize {
        bytes_of(&self.moves)
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        if !world.clock.step.is_multiple_of(INTERVAL) {
            return Ok(());
        }
        self.find_moves(world);
        let [mut r, mut z] = self.position.map(|field| world.store.write(field));
        let mut farthest = 0.0_f64;
        for &(i, [dr, dz]) in &self.moves {
            r[i as usize] += dr;
            z[i as usize] += dz;
            farthest = farthest.max((dr * dr + dz * dz).sqrt());
        }
        drop((r, z));
        world.neighbours.note_motion(farthest);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn particles_move_from_the_crowd_to_the_gap() {
        assert_eq!(way([0.8, 1.2], 1.0), 0.0);
        assert_eq!(way([f64::INFINITY, 0.5], 1.0), 0.0);
        let crowded = way([0.7, 1.0], 1.0);
        assert!((crowded / (0.5 * PART * (1.0 - TOLERANCE - 0.7)) - 1.0).abs() < 1e-9, "{crowded}");
        assert_eq!(way([1.0, 0.7], 1.0), -crowded);
        assert_eq!(way([1.0, 9.0], 1.0), FARTHEST);
    }
}
