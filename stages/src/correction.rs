//! Correction: the surface force joins the others, without moving the whole.

use crate::drops::count;
use crate::fields;
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Add, Read};
use meniscus_engine::wiring::Wiring;

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
    surface_force: [Read<f64>; 2],
    force: [Add<f64>; 2],
}

impl MomentumCorrection {
    /// Adds the surface force to the others.
    pub fn new(wiring: &mut Wiring, recoil: Recoil) -> Self {
        wiring.stage("correction");
        let surface_force = [&fields::SURFACE_FORCE_R, &fields::SURFACE_FORCE_Z];
        MomentumCorrection {
            recoil,
            drop: (recoil == Recoil::Drop).then(|| wiring.read(&fields::DROP)),
            mass: wiring.read(&fields::MASS),
            density: wiring.read(&fields::DENSITY),
            surface_force: surface_force.map(|field| wiring.read(field)),
            force: [wiring.add(&fields::FORCE_R), wiring.add(&fields::FORCE_Z)],
        }
    }
}

impl Stage for MomentumCorrection {
    fn name(&self) -> &'static str {
        "correction"
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        let store = &world.store;
        let (mass, density) = (store.read(self.mass), store.read(self.density));
        let [surface_r, surface_z] = self.surface_force.map(|field| store.read(field));
        let [mut force_r, mut force_z] = self.force.map(|field| store.write(field));
        let (mass, density) = (&mass[..], &density[..]);
        let (surface_r, surface_z) = (&surface_r[..], &surface_z[..]);
        let drop = self.drop.map(|drop| store.read(drop));
        let columns = (&mut force_r[..], &mut force_z[..]);
        let drops = drop.as_deref().map_or(1, count);
        if let Some(drop) = drop.as_deref().filter(|_| drops > 1) {
            // Of each drop: mass and force.
            let sums = world.arena.alloc_slice_fill_copy(drops, [0.0f64; 2]);
            for (i, &number) in drop.iter().enumerate() {
                let sum = &mut sums[number as usize];
                sum[0] += mass[i];
                sum[1] += mass[i] / density[i] * surface_z[i];
            }
            let sums = &*sums;
            parallel::for_chunks(mass.len(), columns, |start, (force_r, force_z)| {
                for k in 0..force_r.len() {
                    let i = start + k;
                    let [mass, force] = sums[drop[i] as usize];
                    force_r[k] += surface_r[i];
                    force_z[k] += surface_z[i] - density[i] * (force / mass);
                }
            });
            return Ok(());
        }
        let acceleration = if self.recoil == Recoil::None {
            0.0
        } else {
            let force = parallel::sum(mass.len(), |i| mass[i] / density[i] * surface_z[i]);
            force / parallel::sum(mass.len(), |i| mass[i])
        };
        parallel::for_chunks(mass.len(), columns, |start, (force_r, force_z)| {
            for k in 0..force_r.len() {
                let i = start + k;
                force_r[k] += surface_r[i];
                force_z[k] += surface_z[i] - density[i] * acceleration;
            }
        });
        Ok(())
    }
}
