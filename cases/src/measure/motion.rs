//! Sums over all particles, in chunks: the same for any number of threads.

use meniscus_engine::parallel;

/// Sum of mass times value, and of mass, from value and mass (kg) of every particle.
pub(super) fn mass_sum(len: usize, of: impl Fn(usize) -> (f64, f64) + Sync) -> (f64, f64) {
    let add = |a: (f64, f64), b: (f64, f64)| (a.0 + b.0, a.1 + b.1);
    let body = |start: usize, (), len: usize| {
        let each = (start..start + len).map(&of).map(|(value, mass)| (mass * value, mass));
        each.fold((0.0, 0.0), add)
    };
    parallel::fold_chunks(len, (), &body, &add)
}

/// What is summed over some particles, and their extents, in SI units.
pub(super) struct Motion {
    pub(super) mass: f64,
    pub(super) momentum: f64,
    pub(super) scale: f64,
    pub(super) kinetic: f64,
    pub(super) compression: f64,
    pub(super) fastest_square: f64,
    /// Largest r, smallest and largest z.
    pub(super) extents: [f64; 3],
}

impl Default for Motion {
    fn default() -> Self {
        let extents = [f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
        let (mass, momentum, scale, kinetic, compression, fastest_square) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        Motion { mass, momentum, scale, kinetic, compression, fastest_square, extents }
    }
}

impl Motion {
    pub(super) fn add(self, other: Motion) -> Motion {
        let ([r_most, z_least, z_most], [other_r, other_least, other_most]) = (self.extents, other.extents);
        Motion {
            mass: self.mass + other.mass,
            momentum: self.momentum + other.momentum,
            scale: self.scale + other.scale,
            kinetic: self.kinetic + other.kinetic,
            compression: self.compression + other.compression,
            fastest_square: self.fastest_square.max(other.fastest_square),
            extents: [r_most.max(other_r), z_least.min(other_least), z_most.max(other_most)],
        }
    }
}
