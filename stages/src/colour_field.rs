//! The colour field c = sum_b V_b W_b and its first and second derivatives anywhere in the plane.

use crate::surface_points::{Particles, SurfacePoints};
use meniscus_engine::domain::Domain;
use meniscus_engine::lanes::{Lanes, WIDTH};
use meniscus_engine::store::bytes_of;
use std::f64::consts::PI;

/// Colour and derivatives at a point, SI units.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Colour {
    /// c, one inside the liquid and one half at the surface.
    pub value: f64,
    /// dc/dr, dc/dz.
    pub gradient: [f64; 2],
    /// c_rr, c_rz, c_zz.
    pub second: [f64; 3],
}

/// The particles that the colour field sums.
#[derive(Debug, Default)]
pub struct ColourField {
    points: SurfacePoints,
    /// The field at the places of some particles since the last refresh, in the order of particles.
    pub known: Vec<(u32, Colour)>,
}

impl ColourField {
    /// Takes up the particles' present positions (m) and areas (m2). `list_build` counts the builds of
    /// the neighbour list, between which no particle moves farther than `slack` metres. The field may then be asked for
    /// with all that lies within a reach (m) of each of the `wanted` particles.
    pub fn refresh(
        &mut self,
        source: &Particles,
        area: impl Fn(usize) -> f64,
        wanted: impl Iterator<Item = (u32, f64)> + Clone,
        list_build: u64,
        motion: (f64, &Domain),
    ) {
        self.known.clear();
        self.points.refresh(source, area, wanted, list_build, motion);
    }

    /// Bytes that the particles take in it.
    pub fn bytes(&self) -> usize {
        bytes_of(&self.known) + self.points.bytes()
    }

    /// The field at (r, z) with the given support radius, all in metres.
    ///
    /// The kernel is the Wendland C6 kernel times 1 - 8 q^2, of fourth order: the second moment along a
    /// line through its centre vanishes. So the contour c = 1/2 of a wavy surface keeps the wave's
    /// amplitude but for terms of (k H)^4, and that of a sphere its radius, where the plain kernel loses
    /// (2/91)(k H)^2. With w = (1-q)^8 (32 q^3 + 25 q^2 + 8 q + 1), phi = w'/q = -22 (16 q^2 + 7 q + 1)(1-q)^7
    /// and psi = phi'/q = 528 (6 q + 1)(1-q)^6, the kernel (390/(11 pi H^2)) w p, p = 1 - 8 q^2, has
    /// Phi = p phi - 16 w and Psi = p psi - 32 phi in
    /// grad W = Phi d/H^2 and d_i d_j W = (Phi delta_ij + Psi d_i d_j/H^2)/H^2.
    pub fn at(&self, r: f64, z: f64, support: f64) -> Colour {
        let inverse = 1.0 / support;
        let (lr, lz, linverse) = (Lanes::splat(r), Lanes::splat(z), Lanes::splat(inverse));
        let mut sums = [Lanes::ZERO; 6];
        let points = &self.points;
        points.within(r, z, support, |start, left| {
            let area = Lanes::load(&points.area[start..]);
            let area = if left < WIDTH { area.keep_first(left) } else { area };
            let x = (lr - Lanes::load(&points.r[start..])) * linverse;
            let y = (lz - Lanes::load(&points.z[start..])) * linverse;
            add_kernel(x, y, area, &mut sums);
        });
        let constant = 390.0 / (11.0 * PI) * inverse * inverse;
        let first = constant * inverse;
        let second = constant * inverse * inverse;
        let sum = sums.map(|lanes| lanes.sum());
        Colour {
            value: constant * sum[0],
            gradient: [first * sum[1], first * sum[2]],
            second: [second * sum[3], second * sum[4], second * sum[5]],
        }
    }
}

/// Adds eight particles at (x, y) = d/H with their areas.
#[inline(always)]
fn add_kernel(x: Lanes, y: Lanes, area: Lanes, sums: &mut [Lanes; 6]) {
    let number = Lanes::splat;
    let q = x.mul_add(x, y * y).sqrt();
    let inside = (Lanes::ONE - q).max(Lanes::ZERO);
    let square = inside * inside;
    let sixth = square * square * square * area;
    let seventh = sixth * inside;
    let shape = number(32.0).mul_add(q, number(25.0)).mul_add(q, number(8.0)).mul_add(q, Lanes::ONE);
    let w = shape * seventh * inside;
    let phi = number(-22.0) * number(16.0).mul_add(q, number(7.0)).mul_add(q, Lanes::ONE) * seventh;
    let psi = number(528.0) * number(6.0).mul_add(q, Lanes::ONE) * sixth;
    let order = number(8.0).neg_mul_add(q * q, Lanes::ONE);
    let first = order.mul_add(phi, number(-16.0) * w);
    let second = order.mul_add(psi, number(-32.0) * phi);
    sums[0] = order.mul_add(w, sums[0]);
    sums[1] = first.mul_add(x, sums[1]);
    sums[2] = first.mul_add(y, sums[2]);
    sums[3] += (second * x).mul_add(x, first);
    sums[4] = (second * x).mul_add(y, sums[4]);
    sums[5] += (second * y).mul_add(y, first);
}

#[cfg(test)]
mod tests {
    use super::*;

    const DOMAIN: Domain = Domain { origin: 0.0, period: None };
    const AREA: fn(usize) -> f64 = |_| 0.1 * 0.1;

    /// Whoever sees the whole lattice.
    fn all(count: usize) -> impl Iterator<Item = (u32, f64)> + Clone {
        (0..count as u32).map(|i| (i, 1.0))
    }

    fn lattice() -> ColourField {
        let (mut r, mut z) = (Vec::new(), Vec::new());
        for i in 0..40 {
            for j in 0..40 {
                r.push(5.0 + 0.1 * f64::from(i));
                z.push(0.1 * f64::from(j));
            }
        }
        let mut field = ColourField::default();
        let source = Particles { r: &r, z: &z, list_r: &r, list_z: &z, support: 0.8 };
        field.refresh(&source, AREA, all(r.len()), 1, (0.0, &DOMAIN));
        field
    }

    #[test]
    fn one_inside_and_one_half_at_a_straight_edge() {
        let field = lattice();
        let inside = field.at(7.0, 2.0, 0.8);
        assert!((inside.value - 1.0).abs() < 1e-4, "{inside:?}");
        let edge = field.at(4.95, 2.0, 0.8);
        assert!((edge.value - 0.5).abs() < 1e-4, "{edge:?}");
        assert!(edge.gradient[0] > 0.0 && edge.gradient[1].abs() < 1e-6 * edge.gradient[0]);
    }

    #[test]
    fn derivatives_match_differences() {
        let field = lattice();
        let (r, z, step) = (5.05, 0.13, 1e-5);
        let here = field.at(r, z, 0.8);
        let (east, west) = (field.at(r + step, z, 0.8), field.at(r - step, z, 0.8));
        let (north, south) = (field.at(r, z + step, 0.8), field.at(r, z - step, 0.8));
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-7 * (1.0 + a.abs()), "{a} {b}");
        close(here.gradient[0], (east.value - west.value) / (2.0 * step));
        close(here.gradient[1], (north.value - south.value) / (2.0 * step));
        close(here.second[0], (east.gradient[0] - west.gradient[0]) / (2.0 * step));
        close(here.second[1], (north.gradient[0] - south.gradient[0]) / (2.0 * step));
        close(here.second[2], (north.gradient[1] - south.gradient[1]) / (2.0 * step));
    }

    #[test]
    fn what_is_not_asked_for_changes_no_bit() {
        let spiral = |k: u32, at: f64| 3.0 + 0.08 * f64::from(k).sqrt() * (at + 2.4 * f64::from(k)).sin();
        let r: Vec<f64> = (0..2000).map(|k| spiral(k, 0.5 * std::f64::consts::PI)).collect();
        let z: Vec<f64> = (0..2000).map(|k| spiral(k, 0.0)).collect();
        let now: Vec<f64> = z.iter().map(|z| z + 0.01).collect();
        let source = Particles { r: &r, z: &now, list_r: &r, list_z: &z, support: 0.8 };
        let mut whole = ColourField::default();
        whole.refresh(&source, AREA, all(2000), 1, (0.02, &DOMAIN));
        let mut part = ColourField::default();
        for centre in [1999, 3, 700] {
            part.refresh(&source, AREA, [(centre, 1.0)].into_iter(), 1, (0.02, &DOMAIN));
            assert!(part.points.len() < 1500);
            let i = centre as usize;
            for (dr, dz) in [(0.0, 0.0), (0.1, 0.15), (-0.19, 0.0)] {
                let at = [r[i] + dr, now[i] + dz];
                assert_eq!(part.at(at[0], at[1], 0.8), whole.at(at[0], at[1], 0.8), "{centre} {dr} {dz}");
            }
        }
    }
}
