//! What neighbours tell: connected drops, how many neighbours particles have, how evenly they lie.

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};

use bumpalo::Bump;
use meniscus_cases::assemble::Physics;
use meniscus_cases::scene::Scene;
use meniscus_engine::checkpoint::ColumnView;
use meniscus_engine::neighbours::NeighbourList;
use meniscus_stages::components::components;
use meniscus_stages::equation_of_state::Packing;
use serde::Serialize;

use super::columns::{sizes, values};
use super::failure::Failure;
use super::statistics::{Gathering, Statistics};

/// A connected component: particles within each other's support. SI units.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Drop {
    pub particles: usize,
    pub mass: f64,
    pub volume: f64,
    /// Of the sphere of the same volume.
    pub radius: f64,
    /// Axial velocity of the centre of mass.
    pub velocity_z: f64,
    /// Axial position of the centre of mass.
    pub centre_z: f64,
}

/// What the neighbours of all particles tell.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Neighbourhood {
    /// The largest first.
    pub drops: Vec<Drop>,
    /// How many particles have how many neighbours in their support, mirror images included.
    pub neighbours: BTreeMap<usize, usize>,
    /// Distance of the nearest neighbour over the particle size: 1 on a square lattice, 1.07 on a
    /// hexagonal one.
    pub nearest_distance: Statistics,
    /// Particles nearer to the axis than half their size.
    pub near_axis: usize,
    /// Particles on the axis or beyond it.
    pub beyond_axis: usize,
    /// Particles without a finite place or size: they are left out.
    pub left_out: usize,
}

struct Particles {
    r: Vec<f64>,
    z: Vec<f64>,
    size: Vec<f64>,
    mass: Vec<f64>,
    density: Vec<f64>,
    velocity: Vec<f64>,
}

/// Looks for the neighbours of all particles of a checkpoint.
pub fn neighbourhood(columns: &[ColumnView<'_>], scene: &Scene) -> Result<Neighbourhood, Failure> {
    let domain = Physics::of(scene).domain;
    let all = Particles {
        r: values(columns, "radius")?,
        z: values(columns, "axial")?,
        size: sizes(columns, Some(scene))?,
        mass: values(columns, "mass")?,
        density: values(columns, "density")?,
        velocity: values(columns, "velocity_z")?,
    };
    // A run that blew up has thrown particles far away: they are near nothing.
    let far = 1e4 * scene.particle_size * (all.r.len() as f64).sqrt().max(1.0);
    let sound = |&i: &usize| all.r[i].abs() + all.z[i].abs() < far && all.size[i] > 0.0;
    let kept: Vec<usize> = (0..all.r.len()).filter(sound).collect();
    let pick = |values: &[f64]| kept.iter().map(|&i| values[i]).collect();
    let particles = Particles {
        r: pick(&all.r),
        z: pick(&all.z),
        size: pick(&all.size),
        mass: pick(&all.mass),
        density: pick(&all.density),
        velocity: pick(&all.velocity),
    };
    let packing = Packing { domain, theta: scene.method.theta, largest_size: 2.0 * scene.particle_size };
    let reach: Vec<f64> = particles.size.iter().map(|size| 2.0 * packing.theta * size).collect();
    let mut list = NeighbourList::default();
    list.build([&particles.r, &particles.z, &reach], &domain);
    let mut found = Neighbourhood {
        drops: drops(&particles, &list, &packing),
        left_out: all.r.len() - kept.len(),
        ..Neighbourhood::default()
    };
    let mut distances = Vec::new();
    for particle in 0..particles.r.len() {
        let (r, z, size) = (particles.r[particle], particles.z[particle], particles.size[particle]);
        *found.neighbours.entry(list.of(particle).count()).or_default() += 1;
        let real = list.of(particle).filter(|&number| number < list.len());
        let distance = |other: usize| (particles.r[other] - r).hypot(particles.z[other] - z);
        distances.extend(real.map(distance).min_by(f64::total_cmp).map(|nearest| nearest / size));
        found.beyond_axis += usize::from(r + domain.origin <= 0.0);
        found.near_axis += usize::from((0.0..0.5 * size).contains(&(r + domain.origin)));
    }
    let mut gathering = Gathering::default();
    gathering.add(&distances);
    found.nearest_distance = gathering.statistics();
    Ok(found)
}

fn drops(particles: &Particles, list: &NeighbourList, packing: &Packing) -> Vec<Drop> {
    let arena = Bump::new();
    let reach = |i: usize| 2.0 * packing.theta * particles.size[i].min(packing.largest_size);
    let names = components(list, &packing.domain, [&particles.r, &particles.z], reach, &arena);
    let period = packing.domain.period;
    // Where z repeats, the mean direction on the circle that it then is tells which images lie together.
    let mut middles: BTreeMap<u32, [f64; 2]> = BTreeMap::new();
    for (particle, name) in names.iter().enumerate() {
        let turn = period.map_or(0.0, |(_, length)| TAU * particles.z[particle] / length);
        let [x, y] = middles.entry(*name).or_default();
        *x += particles.mass[particle] * turn.cos();
        *y += particles.mass[particle] * turn.sin();
    }
    let mut drops: BTreeMap<u32, Drop> = BTreeMap::new();
    for (particle, name) in names.iter().enumerate() {
        let mass = particles.mass[particle];
        let z = particles.z[particle];
        let image = period.map_or(z, |(_, length)| {
            let [x, y] = middles[name];
            z - length * (z / length - y.atan2(x) / TAU).round()
        });
        let drop = drops.entry(*name).or_default();
        drop.particles += 1;
        drop.mass += mass;
        drop.volume += mass / particles.density[particle];
        drop.velocity_z += mass * particles.velocity[particle];
        drop.centre_z += mass * image;
    }
    let mut drops: Vec<Drop> = drops.into_values().collect();
    for drop in &mut drops {
        drop.velocity_z /= drop.mass;
        drop.centre_z /= drop.mass;
        if let Some((bottom, length)) = period {
            drop.centre_z = bottom + (drop.centre_z - bottom).rem_euclid(length);
        }
        drop.radius = (0.75 * drop.volume / PI).cbrt();
    }
    drops.sort_by(|one, other| other.mass.total_cmp(&one.mass));
    drops
}

#[cfg(test)]
mod tests {
    use super::*;
    use meniscus_engine::domain::Domain;

    #[test]
    fn a_drop_across_the_edge_of_a_period_has_its_centre_there() {
        let domain = Domain { origin: 0.0, period: Some((1.0, 10.0)) };
        let packing = Packing { domain, theta: 0.5, largest_size: 2.0 };
        // One of four particles and one of two, across the edge.
        for (z, centre) in [(&[1.2, 2.0, 9.4, 10.2][..], 10.7), (&[1.1, 10.5], 10.8), (&[4.0, 5.0], 4.5)] {
            let all = |value: f64| vec![value; z.len()];
            let particles = Particles {
                r: all(3.0),
                z: z.to_vec(),
                size: all(1.0),
                mass: all(2.0),
                density: all(1.0),
                velocity: all(0.0),
            };
            let mut list = NeighbourList::default();
            list.build([&particles.r, &particles.z, &all(1.0)], &domain);
            let drops = drops(&particles, &list, &packing);
            assert_eq!(drops.len(), 1, "{drops:?}");
            assert!((drops[0].centre_z - centre).abs() < 1e-12, "{drops:?}");
        }
    }
}
