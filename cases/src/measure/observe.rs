//! What is observed of a run on its way: energies, momentum, extents, and what the scene's measures need.

use super::columns::{columns_of, with_index};
use super::exact::Drop;
use super::motion::{Motion, mass_sum};
use super::surface::Surface;
use super::{bridge, film, flow, free_surface, jet, large, spread, thread};
use crate::assemble::Physics;
use crate::scene::{Liquid, Measure, Scene};
use crate::simulation::Simulation;
use meniscus_engine::field::Field;
use meniscus_engine::lanes::{Lanes, WIDTH};
use meniscus_engine::parallel;
use meniscus_stages::drops::count;
use meniscus_stages::fields;
use std::f64::consts::PI;
use std::ops::Range;

/// Name and SI unit of what is observed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// Its name, unique in a run.
    pub name: String,
    /// Its SI unit; "1" for a plain number.
    pub unit: &'static str,
}

/// Observes a run. Sums run over the particles in their memory order, chunks in a fixed one: the same for any
/// number of threads, and for a resumed run.
pub struct Observer {
    physics: Physics,
    liquid: Liquid,
    origin: f64,
    surface: Option<Surface>,
    measures: Vec<Measure>,
}

/// Part of the drop's radius within which its pressure is measured, away from the surface's particles.
const CORE: f64 = 0.7;
/// Part of its volume by which a drop may differ from the sphere about which it oscillates.
const ALIKE: f64 = 0.5;

const GENERAL: [(&str, &str); 12] = [
    ("time", "s"),
    ("step size", "s"),
    ("mass", "kg"),
    ("momentum z", "kg m/s"),
    ("momentum scale", "kg m/s"),
    ("kinetic energy", "J"),
    ("internal energy", "J"),
    ("rms velocity", "m/s"),
    ("largest r", "m"),
    ("smallest z", "m"),
    ("largest z", "m"),
    ("largest speed", "m/s"),
];

/// The particles' columns that observations need.
pub(super) struct Particles<'a> {
    pub(super) r: &'a [f64],
    pub(super) z: &'a [f64],
    pub(super) mass: &'a [f64],
    pub(super) density: &'a [f64],
    pub(super) velocity: [&'a [f64]; 2],
    /// Specific kinetic and internal energy, where the pressure depends on it.
    energy: Option<&'a [f64]>,
    /// Numbers of the drops that they belong to, where these are told apart.
    drop: Option<&'a [u32]>,
    /// Points of the surface, r and z in m, where something tells of them.
    pub(super) surface: Option<(Vec<f64>, Vec<f64>)>,
}

impl Particles<'_> {
    /// Specific internal energy in J/kg; 0 where the pressure does not depend on it.
    pub(super) fn internal_energy(&self, i: usize) -> f64 {
        let [u, w] = self.velocity.map(|velocity| velocity[i]);
        self.energy.map_or(0.0, |energy| energy[i] - 0.5 * (u * u + w * w))
    }

    /// Number of the drop that a particle belongs to.
    fn drop_of(&self, i: usize) -> usize {
        self.drop.map_or(0, |drop| drop[i] as usize)
    }

    /// The masses of eight particles, none for those of other drops.
    fn masses_of(&self, drop: usize, eight: Range<usize>) -> Lanes {
        let mut masses = [0.0; WIDTH];
        let of = |i| if self.drop_of(i) == drop { self.mass[i] } else { 0.0 };
        eight.zip(&mut masses).for_each(|(i, mass)| *mass = of(i));
        Lanes::load(&masses)
    }

    /// Mass, axial momentum and volume of each drop.
    fn drops(&self) -> Vec<[f64; 3]> {
        let count = self.drop.map_or(1, count);
        let body = |start: usize, (), len: usize| {
            let mut drops = vec![[0.0; 3]; count];
            for i in start..start + len {
                let [mass, momentum, volume] = &mut drops[self.drop_of(i)];
                *mass += self.mass[i];
                *momentum += self.mass[i] * self.velocity[1][i];
                *volume += self.mass[i] / self.density[i];
            }
            drops
        };
        let add = |mut one: Vec<[f64; 3]>, other: Vec<[f64; 3]>| {
            one.iter_mut().flatten().zip(other.iter().flatten()).for_each(|(sum, more)| *sum += more);
            one
        };
        parallel::fold_chunks(self.mass.len(), (), &body, &add)
    }
}

impl Observer {
    /// An observer of the scene's runs.
    pub fn new(scene: &Scene, simulation: &Simulation) -> Self {
        Observer {
            physics: simulation.physics.clone(),
            liquid: scene.liquid.clone(),
            origin: scene.domain.origin,
            surface: Surface::of(scene, &simulation.physics, &simulation.world.store),
            measures: scene.measures.clone(),
        }
    }

    /// What a row holds, in its order; `time` in s comes first.
    pub fn quantities(&self) -> Vec<Quantity> {
        let mut quantities: Vec<Quantity> =
            GENERAL.iter().map(|&(name, unit)| Quantity { name: name.to_owned(), unit }).collect();
        if self.surface.is_some() {
            quantities.push(Quantity { name: "surface energy".to_owned(), unit: "J" });
        }
        if self.physics.central_force > 0.0 {
            quantities.push(Quantity { name: "potential energy".to_owned(), unit: "J" });
        }
        quantities.extend(with_index(&self.measures).flat_map(|(measure, index)| columns_of(measure, index)));
        quantities
    }

    /// One row about the present state.
    pub fn observe(&self, simulation: &Simulation) -> Vec<f64> {
        let store = &simulation.world.store;
        let column = |field: &Field<f64>| {
            let column = store.by_name::<f64>(field.description.name);
            column.expect("every pipeline moves particles of a mass and density")
        };
        let (r, z) = (column(&fields::RADIUS), column(&fields::AXIAL));
        let (mass, density) = (column(&fields::MASS), column(&fields::DENSITY));
        let velocity = (column(&fields::VELOCITY_R), column(&fields::VELOCITY_Z));
        let velocity: [&[f64]; 2] = [&velocity.0, &velocity.1];
        let energy = store.by_name::<f64>(fields::TOTAL_ENERGY.description.name);
        let drop = store.by_name::<u32>(fields::DROP.description.name);
        let particles = Particles {
            r: &r,
            z: &z,
            mass: &mass,
            density: &density,
            velocity,
            energy: energy.as_deref(),
            drop: drop.as_deref(),
            surface: free_surface::feet(store),
        };
        let clock = &simulation.world.clock;
        let mut row = vec![clock.time, clock.previous_step_size];
        self.observe_motion(&particles, &mut row);
        let (time, rms) = (clock.time, row[7]);
        let observe = |measure| self.observe_measure(&particles, measure, (time, rms));
        let of_measures: Vec<Vec<f64>> = self.measures.iter().map(observe).collect();
        if let Some(surface) = &self.surface {
            row.push(surface.energy((&self.physics, store), &particles, &self.measures, &of_measures));
        }
        if self.physics.central_force > 0.0 {
            row.push(self.potential_energy(&particles));
        }
        row.extend(of_measures.into_iter().flatten());
        row
    }

    fn observe_motion(&self, particles: &Particles, row: &mut Vec<f64>) {
        let motion = Motion::of(particles, |eight| self.stored_energy(particles, eight));
        let Motion { mass, momentum, scale, kinetic, internal, fastest_square, extents } = motion;
        let rms = (2.0 * kinetic / mass).sqrt();
        row.extend([mass, momentum, scale, kinetic, internal, rms]);
        row.extend(extents);
        row.push(fastest_square.sqrt());
    }

    /// That of the central force, m B^2 x^2/2 of every particle, in J.
    fn potential_energy(&self, particles: &Particles) -> f64 {
        let (sum, _) = mass_sum(particles.r.len(), |eight| {
            let [r, z] = self.place(particles, eight.clone(), 0.0);
            [r.mul_add(r, z * z), Lanes::load_or(&particles.mass[eight], 0.0)]
        });
        0.5 * self.physics.central_force * sum
    }

    /// Specific internal energies in J/kg, or what compression alone has stored.
    fn stored_energy(&self, particles: &Particles, eight: Range<usize>) -> Lanes {
        if particles.energy.is_some() {
            let mut stored = [0.0; WIDTH];
            eight.zip(&mut stored).for_each(|(i, stored)| *stored = particles.internal_energy(i));
            return Lanes::load(&stored);
        }
        let rest = self.physics.reference_density;
        self.compression_energy(Lanes::load_or(&particles.density[eight], rest))
    }

    /// The integral of P/rho^2 over the density from that at rest, in J/kg.
    fn compression_energy(&self, density: Lanes) -> Lanes {
        let rest = Lanes::splat(self.physics.reference_density);
        let excess = (density - rest) * Lanes::splat(1.0 / self.physics.reference_density);
        Lanes::splat(self.physics.sound_speed.powi(2)) * compression_integral(excess)
    }

    /// The drop of about the volume of a sphere that has come from near a centre, by its number, and its axial centre of
    /// mass. What nothing pushes flies straight, so its velocity tells where it was at the start: nothing has to be
    /// remembered, and a resumed run finds the same.
    fn drop_from(&self, particles: &Particles, radius: f64, centre: f64, time: f64) -> Option<(usize, f64)> {
        let sphere = 4.0 / 3.0 * PI * radius.powi(3);
        let drops = particles.drops().into_iter().enumerate();
        let alike = drops.filter(|(_, [_, _, volume])| (volume / sphere - 1.0).abs() < ALIKE);
        let found = alike.map(|(number, [mass, momentum, _])| {
            let expected = centre + momentum / mass * time;
            let (sum, mass) = mass_sum(particles.z.len(), |eight| {
                let [_, z] = self.place(particles, eight.clone(), expected);
                [self.nearest(z), particles.masses_of(number, eight)]
            });
            (number, expected, sum / mass)
        });
        let near = found.filter(|(_, _, away)| away.abs() < 2.0 * radius);
        let nearest = near.min_by(|one, other| one.2.abs().total_cmp(&other.2.abs()));
        nearest.map(|(number, expected, away)| (number, expected + away))
    }

    /// Heights above a place by the nearest image, where z has a period.
    fn nearest(&self, z: Lanes) -> Lanes {
        let Some((_, length)) = self.physics.domain.period else { return z };
        Lanes::load(&z.to_array().map(|z| z - length * (z / length).round()))
    }

    /// Distances from the axis, and along it from a centre, of eight particles, m.
    fn place(&self, particles: &Particles, eight: Range<usize>, centre: f64) -> [Lanes; 2] {
        let [r, z] = [particles.r, particles.z].map(|column| Lanes::load_or(&column[eight.clone()], 0.0));
        [r + Lanes::splat(self.origin), z - Lanes::splat(centre)]
    }

    fn observe_measure(&self, particles: &Particles, measure: &Measure, (time, rms): (f64, f64)) -> Vec<f64> {
        let all = 0..particles.r.len();
        let near = self.physics.particle_size;
        match *measure {
            Measure::LaplacePressure { radius, centre } => {
                let square = (CORE * radius).powi(2);
                let inside = all.filter(|&i| {
                    let (r, z) = (particles.r[i] + self.origin, particles.z[i] - centre);
                    r * r + z * z < square
                });
                let (sum, mass) = inside.fold((0.0, 0.0), |(sum, mass), i| {
                    let m = particles.mass[i];
                    // The whole pressure, whatever part of it the forces leave out.
                    let energy = particles.internal_energy(i);
                    let pressure = self.physics.equation.pressure(particles.density[i], energy);
                    (sum + m * pressure, mass + m)
                });
                vec![sum / mass]
            }
            Measure::Oscillation { mode, radius, centre, .. } => {
                let Some((drop, centre)) = self.drop_from(particles, radius, centre, time) else {
                    return vec![f64::NAN];
                };
                let (sum, mass) = mass_sum(all.len(), |eight| {
                    let [r, z] = self.place(particles, eight.clone(), centre);
                    let place = [r, self.nearest(z)].map(|length| length * Lanes::splat(1.0 / radius));
                    [solid_harmonic(mode, place), particles.masses_of(drop, eight)]
                });
                vec![sum / mass]
            }
            Measure::SpuriousVelocity { radius } => {
                vec![rms / Drop::of(&self.liquid, radius).capillary_velocity()]
            }
            Measure::GrowthRate { wavenumber, radius } => {
                jet::observe(particles, &self.physics, wavenumber, radius)
            }
            Measure::FilmRetraction { thickness } => film::observe(particles, &self.physics, thickness),
            Measure::MomentumDrift | Measure::EnergyDrift | Measure::EnergyGain => Vec::new(),
            Measure::LargeOscillation { radial, axial, speed } => {
                large::observe(particles, large::Start { radial, axial, speed })
            }
            Measure::Spread { .. } => spread::observe(particles),
            Measure::Coalescence { radius, other } => {
                // Of surfaces that meet at z = 0 the poles are farther away.
                let reach = radius.min(other);
                bridge::observe(particles, [-0.5 * reach, 0.5 * reach], near)
            }
            Measure::PinchOff { .. } => thread::observe(particles, &self.physics),
            Measure::SemiAxis { .. } => flow::observe_semi_axes(particles),
            Measure::PlateauDensity { dimensions, speed } => {
                flow::observe_plateau(particles, &self.physics, &self.liquid, (dimensions, speed, time))
            }
            Measure::ShockSpeed { speed, length } => {
                flow::observe_shock(particles, &self.physics, speed, length)
            }
        }
    }
}

/// Up to so much compression or expansion a series is exact to rounding.
const SERIES: f64 = 0.05;

/// ln(1 + x) - x/(1 + x) = x^2/2 - 2 x^3/3 + 3 x^4/4 - ...: the series where it is exact to rounding, for there the
/// difference of both would cancel, and a logarithm takes long.
fn compression_integral(x: Lanes) -> Lanes {
    if (Lanes::splat(SERIES) - x.abs()).all_positive() {
        let term = |sum: Lanes, k: i32| x.neg_mul_add(sum, Lanes::splat(f64::from(k - 1) / f64::from(k)));
        x * x * (2..=13).rev().fold(Lanes::ZERO, term)
    } else {
        Lanes::load(&x.to_array().map(|x| x.ln_1p() - x / (1.0 + x)))
    }
}

/// s^n P_n(z/s) of places (r, z) at a distance s from the origin, by the recurrence of the Legendre polynomials,
/// n H_n = (2 n - 1) z H_(n-1) - (n - 1) s^2 H_(n-2).
fn solid_harmonic(degree: u32, [r, z]: [Lanes; 2]) -> Lanes {
    let square = r.mul_add(r, z * z);
    let next = |[before, last]: [Lanes; 2], n: u32| {
        let n = f64::from(n);
        let [upper, lower] = [(2.0 * n - 1.0) / n, (n - 1.0) / n].map(Lanes::splat);
        [last, (upper * z).mul_add(last, -(lower * square * before))]
    };
    (1..=degree).fold([Lanes::ZERO, Lanes::ONE], next)[1]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{legendre, parse};
    use crate::simulation::to_the_end;
    use meniscus_engine::pipeline::World;

    /// The amplitude of a drop of 1 mm radius, elongated a tenth, in a scene with more to it: at the start, and when it has
    /// flown for 50 ms.
    fn amplitudes(more: &str, centre: &str, velocity: f64) -> [f64; 2] {
        let text = format!(
            "format = 1\n[liquid]\ndensity = \"1000 kg/m3\"\nsurface_tension = \"72 mN/m\"\n[[body]]\n\
             shape = {{ spheroid = {{ radial = \"0.95 mm\", axial = \"1.108 mm\" }} }}\n\
             velocity = {{ z = \"{velocity} m/s\" }}\n{more}\n[particles]\nsize = \"0.15 mm\"\n[run]\nuntil = \"15 ms\"\n\
             [[measure]]\noscillation = {{ mode = 2, radius = \"1 mm\", centre = \"{centre}\" }}\n"
        );
        let scene = parse("drop.toml", &text, &[]).unwrap();
        let mut simulation = Simulation::new(&scene, &mut to_the_end).unwrap();
        let observer = Observer::new(&scene, &simulation);
        let column =
            observer.quantities().iter().position(|quantity| quantity.name == "mode amplitude").unwrap();
        let start = observer.observe(&simulation)[column];
        let World { store, clock, .. } = &mut simulation.world;
        clock.time = 0.05;
        let flown: Vec<f64> = store.by_name::<f64>(fields::VELOCITY_Z.description.name).unwrap().to_vec();
        let z = store.by_name_mut::<f64>(fields::AXIAL.description.name).unwrap();
        let wrap = |z: f64| {
            simulation.physics.domain.period.map_or(z, |(low, length)| low + (z - low).rem_euclid(length))
        };
        z.iter_mut().zip(flown).for_each(|(z, velocity)| *z = wrap(*z + 0.05 * velocity));
        [start, observer.observe(&simulation)[column]]
    }

    #[test]
    fn a_drop_is_followed_whatever_else_there_is() {
        let second = |velocity: &str| {
            let sphere = "shape = { sphere = { radius = \"1.1 mm\", centre = \"4 mm\" } }";
            format!("[[body]]\n{sphere}\nvelocity = {{ z = \"{velocity} m/s\" }}")
        };
        let periodic = "[domain]\nperiod = \"5 mm\"";
        for (rest, more, velocity) in [
            ("", String::new(), 0.1),
            (periodic, periodic.to_owned(), 0.08),
            ("", second("0"), 0.0),
            ("", second("-0.1"), -0.1),
            ("", second("0.3"), 0.1),
        ] {
            let [alone, _] = amplitudes(rest, "0 mm", 0.0);
            assert!(alone > 0.05, "{alone}");
            for amplitude in amplitudes(&more, "0.2 mm", velocity) {
                assert!((amplitude / alone - 1.0).abs() < 1e-9, "{more} {velocity}: {amplitude} {alone}");
            }
        }
        assert!(amplitudes("", "8 mm", 0.0).iter().all(|amplitude| amplitude.is_nan()));
    }

    #[test]
    fn compression_stores_the_same_by_the_series_and_by_the_logarithm() {
        for x in [-0.999 * SERIES, 0.999 * SERIES] {
            // One lane beyond takes all of them to the logarithm.
            let [series, logarithm] = [x, 2.0 * SERIES].map(|other| {
                let lanes: [f64; WIDTH] = std::array::from_fn(|lane| if lane == 0 { x } else { other });
                compression_integral(Lanes::load(&lanes)).to_array()[0]
            });
            // The difference of ln(1 + x) and x/(1 + x) is 1/40 of each: it loses a digit and a half.
            assert!((series / logarithm - 1.0).abs() < 2e-14, "{series} instead of {logarithm}");
        }
    }

    #[test]
    fn solid_harmonics_are_legendre_polynomials() {
        for degree in 0..7u32 {
            for (r, z) in [(0.3f64, 0.7f64), (1.2, -0.4), (0.0, 0.9), (0.5, 0.0)] {
                let s = r.hypot(z);
                let expected = s.powi(degree as i32) * legendre(degree as usize, z / s)[0];
                let found = solid_harmonic(degree, [r, z].map(Lanes::splat)).to_array()[0];
                assert!((found - expected).abs() < 1e-14, "{degree} at {r} {z}: {found} {expected}");
            }
        }
    }
}
