//! Sums over all particles, eight at a time and in chunks: the same for any number of threads.

use super::observe::Particles;
use meniscus_engine::lanes::{Lanes, WIDTH};
use meniscus_engine::parallel;
use std::ops::Range;

/// Sum of mass times value, and of mass, from the values of the particles of a range, eight at most, and their
/// masses (kg). Lanes beyond them must have no mass and a finite value.
pub(super) fn mass_sum(len: usize, of: impl Fn(Range<usize>) -> [Lanes; 2] + Sync) -> (f64, f64) {
    let ([sum], mass) = mass_sums(len, |eight| {
        let [value, mass] = of(eight);
        ([value], mass)
    });
    (sum, mass)
}

/// The same of several values.
pub(super) fn mass_sums<const N: usize>(
    len: usize,
    of: impl Fn(Range<usize>) -> ([Lanes; N], Lanes) + Sync,
) -> ([f64; N], f64) {
    let body = |start: usize, (), len: usize| {
        let (mut sums, mut total) = ([Lanes::ZERO; N], Lanes::ZERO);
        for eight in eights(start..start + len) {
            let (values, mass) = of(eight);
            sums.iter_mut().zip(values).for_each(|(sum, value)| *sum = mass.mul_add(value, *sum));
            total += mass;
        }
        (sums.map(|sum| sum.sum()), total.sum())
    };
    let add = |(a, mass): ([f64; N], f64), (b, more): ([f64; N], f64)| {
        (std::array::from_fn(|k| a[k] + b[k]), mass + more)
    };
    parallel::fold_chunks(len, (), &body, &add)
}

/// A range in pieces of eight; the last one may be shorter.
pub(super) fn eights(range: Range<usize>) -> impl Iterator<Item = Range<usize>> {
    range.clone().step_by(WIDTH).map(move |first| first..range.end.min(first + WIDTH))
}

/// What is summed over some particles, and their extents, in SI units.
pub(super) struct Motion {
    pub(super) mass: f64,
    pub(super) momentum: f64,
    pub(super) scale: f64,
    pub(super) kinetic: f64,
    pub(super) internal: f64,
    pub(super) fastest_square: f64,
    /// Largest r, smallest and largest z.
    pub(super) extents: [f64; 3],
}

impl Motion {
    /// That of all particles; `stored` gives the specific internal energies (J/kg) of eight.
    pub(super) fn of(particles: &Particles, stored: impl Fn(Range<usize>) -> Lanes + Sync) -> Self {
        let body = |start: usize, (), len: usize| Motion::of_range(particles, start..start + len, &stored);
        parallel::fold_chunks(particles.r.len(), (), &body, &Motion::add)
    }

    fn of_range(particles: &Particles, range: Range<usize>, stored: impl Fn(Range<usize>) -> Lanes) -> Self {
        let [u, w] = particles.velocity;
        let [mut mass, mut momentum, mut scale, mut twice, mut internal, mut fastest] = [Lanes::ZERO; 6];
        let first = range.start.min(u.len() - 1);
        let [mut r_most, mut z_least, mut z_most] =
            [particles.r, particles.z, particles.z].map(|column| Lanes::splat(column[first]));
        for eight in eights(range) {
            let load = |column: &[f64], fill| Lanes::load_or(&column[eight.clone()], fill);
            let (m, u, w) = (load(particles.mass, 0.0), load(u, 0.0), load(w, 0.0));
            let square = u.mul_add(u, w * w);
            mass += m;
            momentum = m.mul_add(w, momentum);
            scale += (m * w).abs();
            twice = m.mul_add(square, twice);
            internal = m.mul_add(stored(eight.clone()), internal);
            fastest = fastest.max(square);
            r_most = r_most.max(load(particles.r, particles.r[first]));
            let z = load(particles.z, particles.z[first]);
            (z_least, z_most) = (z_least.min(z), z_most.max(z));
        }
        let most = |lanes: Lanes| lanes.to_array().into_iter().fold(f64::NEG_INFINITY, f64::max);
        Motion {
            mass: mass.sum(),
            momentum: momentum.sum(),
            scale: scale.sum(),
            kinetic: 0.5 * twice.sum(),
            internal: internal.sum(),
            fastest_square: most(fastest),
            extents: [most(r_most), -most(-z_least), most(z_most)],
        }
    }

    fn add(self, other: Motion) -> Motion {
        let ([r_most, z_least, z_most], [other_r, other_least, other_most]) = (self.extents, other.extents);
        Motion {
            mass: self.mass + other.mass,
            momentum: self.momentum + other.momentum,
            scale: self.scale + other.scale,
            kinetic: self.kinetic + other.kinetic,
            internal: self.internal + other.internal,
            fastest_square: self.fastest_square.max(other.fastest_square),
            extents: [r_most.max(other_r), z_least.min(other_least), z_most.max(other_most)],
        }
    }
}
