//! Correction: the surface force joins the others, without moving the whole.

use crate::drops::count;
use crate::fields;
use crate::surface::for_surface;
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
    surface: Read<u32>,
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
            surface: wiring.read(&fields::SURFACE),
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
        let surface = store.read(self.surface);
        let [surface_r, surface_z] = self.surface_force.map(|field| store.read(field));
        let [mut force_r, mut force_z] = self.force.map(|field| store.write(field));
        let (mass, density, surface) = (&mass[..], &density[..], &surface[..]);
        let (surface_r, surface_z) = (&surface_r[..], &surface_z[..]);
        parallel::for_chunks(
            mass.len(),
            (&mut force_r[..], &mut force_z[..]),
            |start, (force_r, force_z)| {
                for_surface(&surface[start..start + force_r.len()], |k| {
                    force_r[k] += surface_r[start + k];
                    force_z[k] += surface_z[start + k];
                });
            },
        );
        let drop = self.drop.map(|drop| store.read(drop));
        let drops = drop.as_deref().map_or(1, count);
        if let Some(drop) = drop.as_deref().filter(|_| drops > 1) {
            // Of each drop: mass and force.
            let sums = world.arena.alloc_slice_fill_copy(drops, [0.0f64; 2]);
            for (&number, mass) in drop.iter().zip(mass) {
                sums[number as usize][0] += mass;
            }
            for_surface(surface, |i| sums[drop[i] as usize][1] += mass[i] / density[i] * surface_z[i]);
            let sums = &*sums;
            parallel::for_chunks(mass.len(), &mut force_z[..], |start, force_z| {
                for (k, force_z) in force_z.iter_mut().enumerate() {
                    let [mass, force] = sums[drop[start + k] as usize];
                    *force_z -= density[start + k] * (force / mass);
                }
            });
        } else if self.recoil != Recoil::None {
            let whole = parallel::sum_of(mass);
            let body = |start: usize, (), len: usize| {
                let mut force = 0.0;
                for_surface(&surface[start..start + len], |k| {
                    let i = start + k;
                    force += mass[i] / density[i] * surface_z[i];
                });
                force
            };
            let force = parallel::fold_chunks(mass.len(), (), &body, &|a, b| a + b);
            let acceleration = force / whole;
            parallel::for_chunks(mass.len(), (&mut force_z[..], density), |_, (force_z, density)| {
                for (force_z, density) in force_z.iter_mut().zip(density) {
                    *force_z -= density * acceleration;
                }
            });
        }
        Ok(())
    }
}
