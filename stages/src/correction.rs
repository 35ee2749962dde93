//! Correction: the surface force joins the others, without moving the whole.

use crate::drops::count;
use crate::fields;
use crate::surface::for_surface;
use crate::work::Work;
use meniscus_engine::group::{Around, Chunk, ChunkStage, Partial};
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, World};
use meniscus_engine::store::{Add, Read};
use meniscus_engine::wiring::Wiring;

/// The whole mass, kg, among the numbers of the clock: it stays as it was first summed, whoever exchanges mass and
/// whatever order particles come to have, also after a restart.
pub const WHOLE_MASS: &str = "whole mass";

/// Over which particles the momentum is spread that surface forces would bring in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Recoil {
    /// Over those of the same drop: none drives itself or another one.
    Drop,
    /// Over all, as in the paper.
    Whole,
    /// It stays where it is.
    None,
}

/// f += f_s - rho F_z/m e_z with F_z = sum_a (m_a/rho_a) f_s,z and the mass m of one drop or of the whole: the
/// paper's momentum correction (method.md, section 8). Ghosts are no bodies that could take up momentum.
pub struct MomentumCorrection {
    recoil: Recoil,
    drop: Option<Read<u32>>,
    mass: Read<f64>,
    density: Read<f64>,
    surface: Read<u32>,
    surface_force: [Read<f64>; 2],
    force: [Add<f64>; 2],
    /// That of the recoil: the surface forces' own is in already.
    work: Option<Work>,
    /// F_z/m of each drop, m/s2; of the whole alone if there is one or they are not told apart; none without recoil.
    recoils: Vec<f64>,
}

impl MomentumCorrection {
    /// Adds the surface force to the others; `with_energy` where the scene solves for the total energy.
    pub fn new(wiring: &mut Wiring, recoil: Recoil, with_energy: bool) -> Self {
        wiring.stage("correction");
        MomentumCorrection {
            recoil,
            drop: (recoil == Recoil::Drop).then(|| wiring.read(&fields::DROP)),
            mass: wiring.read(&fields::MASS),
            density: wiring.read(&fields::DENSITY),
            surface: wiring.read(&fields::SURFACE),
            surface_force: fields::SURFACE_FORCE.map(|field| wiring.read(field)),
            force: fields::FORCE.map(|field| wiring.add(field)),
            work: Work::new(wiring, with_energy && recoil != Recoil::None),
            recoils: Vec::new(),
        }
    }
}

impl ChunkStage for MomentumCorrection {
    fn name(&self) -> &'static str {
        "correction"
    }

    fn prepare(&mut self, world: &mut World) -> Result<(), Fault> {
        self.recoils.clear();
        if self.recoil == Recoil::None {
            return Ok(());
        }
        let store = &world.store;
        let (mass, density) = (store.read(self.mass), store.read(self.density));
        let (surface, surface_z) = (store.read(self.surface), store.read(self.surface_force[1]));
        let force = |i: usize| mass[i] / density[i] * surface_z[i];
        let drop = self.drop.map(|drop| store.read(drop));
        let drops = drop.as_deref().map_or(1, count);
        if let Some(drop) = drop.as_deref().filter(|_| drops > 1) {
            // Of each drop: mass and force.
            let sums = world.arena.alloc_slice_fill_copy(drops, [0.0f64; 2]);
            // Neighbours in memory mostly belong together: each would wait for the sum with the one before.
            let mut start = 0;
            for same in drop.chunk_by(|a, b| a == b) {
                sums[same[0] as usize][0] += mass[start..start + same.len()].iter().sum::<f64>();
                start += same.len();
            }
            for_surface(&surface, |i| sums[drop[i] as usize][1] += force(i));
            self.recoils.extend(sums.iter().map(|[mass, force]| force / mass));
        } else {
            let body = |start: usize, (), len: usize| {
                let mut sum = 0.0;
                for_surface(&surface[start..start + len], |k| sum += force(start + k));
                sum
            };
            let sum = parallel::fold_chunks(mass.len(), (), &body, &|a, b| a + b);
            let mut whole = world.clock.number(WHOLE_MASS);
            if whole == 0.0 {
                whole = parallel::sum_of(&mass);
                world.clock.set_number(WHOLE_MASS, whole);
            }
            self.recoils.push(sum / whole);
        }
        Ok(())
    }

    fn chunk(&self, _: &Around, chunk: &Chunk) -> Partial {
        let surface_force = self.surface_force.map(|field| chunk.read(field));
        let mut force = self.force.map(|field| chunk.write(field));
        for_surface(&chunk.read(self.surface), |k| {
            for (force, surface_force) in force.iter_mut().zip(&surface_force) {
                force[k] += surface_force[k];
            }
        });
        let (density, [_, force_z]) = (chunk.read(self.density), &mut force);
        let forces = force_z.iter_mut().zip(&*density);
        let drop = self.drop.map(|drop| chunk.read(drop));
        let drop = drop.as_deref().unwrap_or_default();
        match &self.recoils[..] {
            [] => {}
            [recoil] => forces.for_each(|(force, density)| *force -= density * recoil),
            recoils => forces
                .zip(drop)
                .for_each(|((force, density), drop)| *force -= density * recoils[*drop as usize]),
        }
        if let Some(work) = &self.work {
            let mut work = work.of(chunk);
            match &self.recoils[..] {
                [recoil] => work.add_axial(|i| -density[i] * recoil),
                recoils => work.add_axial(|i| -density[i] * recoils[drop[i] as usize]),
            }
        }
        [0.0; 2]
    }
}
