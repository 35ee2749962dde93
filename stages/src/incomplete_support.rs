//! Incomplete support: its deficiency I - L, what particles that may lie at the surface lack of their neighbours.

use crate::boundary_detect::EIGENVALUE;
use crate::fields;
use crate::moment::eigenvalue_margin;
use crate::surface::INSIDE;
use meniscus_engine::group::{Around, Chunk, ChunkStage, Partial};
use meniscus_engine::lanes::{Lanes, WIDTH};
use meniscus_engine::store::{Read, Write};
use meniscus_engine::wiring::Wiring;

/// Keeps I - L and the ghost's weight of particles that
///
/// - may lie at the surface: an eigenvalue of L is below 3/4;
/// - lay at or near it when it was last looked for;
///
/// and of those that share a block of eight with them. Everywhere else these fields are zero: nobody asks for them,
/// and what is never written takes no memory. Who has come near the surface since it was last looked for has
/// them a step later; his neighbourhood is still complete, and his ghost has no weight to speak of.
pub struct IncompleteSupport {
    surface: Read<u32>,
    moment: [Read<f64>; 3],
    deficiency: [Write<f64>; 3],
    /// The sum and where it is kept, in scenes with ghosts.
    weight: Option<[(Read<f64>, Write<f64>); 2]>,
}

impl IncompleteSupport {
    /// Keeps what the surface's stages read; `with_ghosts` where there are ghosts.
    pub fn new(wiring: &mut Wiring, with_ghosts: bool) -> Self {
        wiring.stage("incomplete-support");
        let weight = [
            (&fields::GHOST_WEIGHT_SUM_R, &fields::GHOST_WEIGHT_R),
            (&fields::GHOST_WEIGHT_SUM_Z, &fields::GHOST_WEIGHT_Z),
        ];
        IncompleteSupport {
            surface: wiring.read(&fields::SURFACE),
            moment: fields::MOMENT.map(|field| wiring.read(field)),
            deficiency: fields::SUPPORT_DEFICIENCY.map(|field| wiring.write(field)),
            weight: with_ghosts.then(|| weight.map(|(sum, kept)| (wiring.read(sum), wiring.write(kept)))),
        }
    }
}

impl ChunkStage for IncompleteSupport {
    fn name(&self) -> &'static str {
        "incomplete-support"
    }

    fn chunk(&self, _: &Around, chunk: &Chunk) -> Partial {
        let surface = chunk.read(self.surface);
        let [rr, rz, zz] = self.moment.map(|field| chunk.read(field));
        let [mut deficiency_rr, mut deficiency_rz, mut deficiency_zz] =
            self.deficiency.map(|field| chunk.write(field));
        let mut weight = self.weight.map(|both| both.map(|(sum, kept)| (chunk.read(sum), chunk.write(kept))));
        for first in (0..chunk.len()).step_by(WIDTH) {
            let eight = first..chunk.len().min(first + WIDTH);
            let load = |column: &[f64], fill| Lanes::load_or(&column[eight.clone()], fill);
            let (rr, rz, zz) = (load(&rr, 1.0), load(&rz, 0.0), load(&zz, 1.0));
            let is_inside = surface[eight.clone()].iter().fold(INSIDE, |any, code| any | code) == INSIDE;
            if is_inside && eigenvalue_margin([rr, rz, zz], EIGENVALUE).all_positive() {
                // Written only where they are not zero already: then 1 - L_rr is not, for one of eight at least.
                if load(&deficiency_rr, 0.0).abs().less_bits(Lanes::splat(f64::MIN_POSITIVE)) != 0xff {
                    for column in [&mut deficiency_rr, &mut deficiency_rz, &mut deficiency_zz] {
                        column[eight.clone()].fill(0.0);
                    }
                    for (_, kept) in weight.iter_mut().flatten() {
                        kept[eight.clone()].fill(0.0);
                    }
                }
            } else {
                (Lanes::ONE - rr).store(&mut deficiency_rr[eight.clone()]);
                (-rz).store(&mut deficiency_rz[eight.clone()]);
                (Lanes::ONE - zz).store(&mut deficiency_zz[eight.clone()]);
                for (sum, kept) in weight.iter_mut().flatten() {
                    kept[eight.clone()].copy_from_slice(&sum[eight.clone()]);
                }
            }
        }
        [0.0; 2]
    }
}
