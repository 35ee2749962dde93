//! The contour of the surface as a polygon of feet, and what the ghosts' areas lack of its length.

use meniscus_engine::bins::Bins;
use meniscus_engine::domain::{Domain, Image};
use meniscus_engine::lanes::{Lanes, WIDTH};
use meniscus_engine::parallel;
use meniscus_engine::store::bytes_of;

/// Support radius of W in particle sizes.
const SUPPORT: f64 = 4.0;
/// Feet of one contour lie next to each other within so many particle sizes.
const APART: f64 = 2.0;
/// Feet that lie across the contour by so many particle sizes more than along it belong to another one.
const ACROSS: f64 = 0.2;
/// Largest component of delta: in a crack or in spray there is no contour to speak of.
const LARGEST: f64 = 0.05;

/// A particle at the surface or near it, lengths in metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfaceParticle {
    /// Whether it lies at the boundary: then its foot is a corner of the contour.
    pub is_boundary: bool,
    /// Its size.
    pub size: f64,
    /// The place on the surface next to it.
    pub foot: [f64; 2],
    /// Unit tangent t of the surface there, (-t_z, t_r) being outward.
    pub tangent: [f64; 2],
    /// A, with the particle's distance from the axis over its foot's.
    pub area: [f64; 2],
    /// V (I - L) t, likewise.
    pub missing: [f64; 2],
}

/// What enters the sums, in the order of the cells: the place of the foot, t, V (I - L) t, n ds - A, |A| and
/// t_r/R.
const COLUMNS: usize = 10;

/// The particles and their images in rows of cells.
#[derive(Default)]
pub(crate) struct Contour {
    images: Vec<Image>,
    places: [Vec<f64>; 2],
    bins: Bins,
    segments: Vec<[f64; 2]>,
    columns: [Vec<f64>; COLUMNS],
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

impl Contour {
    /// Takes up the particles, none of them larger than `largest` metres.
    pub fn gather(&mut self, particles: &[SurfaceParticle], largest: f64, domain: &Domain) {
        for (axis, places) in self.places.iter_mut().enumerate() {
            places.clear();
            places.extend(particles.iter().map(|particle| particle.foot[axis]));
        }
        domain.images(&self.places[0], &self.places[1], SUPPORT * largest, &mut self.images);
        for image in &self.images {
            let [r, z] = particles[image.source as usize].foot;
            let (r, z) = domain.place(image, r, z);
            self.places[0].push(r);
            self.places[1].push(z);
        }
        self.bins.build(&self.places[0], &self.places[1], 0.5 * SUPPORT * largest);

        let mut segments = std::mem::take(&mut self.segments);
        segments.clear();
        segments.resize(particles.len(), [0.0; 2]);
        parallel::for_chunks_of(128, particles.len(), &mut segments[..], |start, segments| {
            for (k, segment) in segments.iter_mut().enumerate() {
                if particles[start + k].is_boundary {
                    *segment = self.segment(particles, start + k);
                }
            }
        });
        self.segments = segments;
        for column in &mut self.columns {
            column.clear();
            column.resize(self.places[0].len() + WIDTH, 0.0);
        }
        for (place, &member) in self.bins.members().iter().enumerate() {
            let member = member as usize;
            let (source, mirrored) = self.source(member, particles.len());
            let SurfaceParticle { size, foot, tangent, area, missing, .. } = particles[source];
            let lack = [self.segments[source][0] - area[0], self.segments[source][1] - area[1]];
            let sign = if mirrored { -1.0 } else { 1.0 };
            let values = [
                self.places[0][member],
                self.places[1][member],
                sign * tangent[0],
                tangent[1],
                sign * missing[0],
                missing[1],
                sign * lack[0],
                lack[1],
                area[0].hypot(area[1]),
                tangent[0] / (foot[0] + domain.origin).max(0.5 * size),
            ];
            for (column, value) in self.columns.iter_mut().zip(values) {
                column[place] = value;
            }
        }
    }

    /// Bytes that it holds.
    pub fn bytes(&self) -> usize {
        let columns = self.places.iter().chain(&self.columns).map(bytes_of).sum::<usize>();
        columns + bytes_of(&self.segments) + self.bins.bytes()
    }

    /// The particle behind a member, and whether that is mirrored.
    fn source(&self, member: usize, particles: usize) -> (usize, bool) {
        match member.checked_sub(particles) {
            Some(image) => (self.images[image].source as usize, self.images[image].mirrored),
            None => (member, false),
        }
    }

    /// n ds: half the way along the contour from the foot before a boundary particle's foot to the one
    /// after, turned outward.
    fn segment(&self, particles: &[SurfaceParticle], k: usize) -> [f64; 2] {
        let SurfaceParticle { size, foot, tangent, .. } = particles[k];
        // Where the contour ends, half a particle's size belongs to its last foot.
        let mut ways = [-size, size].map(|along| tangent.map(|component| along * component));
        let mut nearest = [APART * APART * size * size; 2];
        self.bins.near(foot[0], foot[1], APART * size, |range| {
            for &member in &self.bins.members()[range] {
                let member = member as usize;
                let (source, mirrored) = self.source(member, particles.len());
                let other = &particles[source];
                let way = [self.places[0][member] - foot[0], self.places[1][member] - foot[1]];
                let distance = dot(way, way);
                let [r, z] = other.tangent;
                // Mirrored, its normal would point inward: the tangent turns round.
                let direction = if mirrored { [r, -z] } else { [r, z] };
                let along = dot(way, tangent);
                let across = (way[0] * tangent[1] - way[1] * tangent[0]).abs();
                let is_next = other.is_boundary && member != k && dot(direction, tangent) > 0.0;
                let side = usize::from(along > 0.0 || (along == 0.0 && member > k));
                if is_next && across <= along.abs() + ACROSS * size && distance < nearest[side] {
                    (nearest[side], ways[side]) = (distance, way);
                }
            }
        });
        let [before, after] = ways;
        [-0.5 * (after[1] - before[1]), 0.5 * (after[0] - before[0])]
    }

    /// delta at a particle's foot: the sum of W (n ds - A) - R grad_s (W/R) V (I - L) over that of W |A|, with
    /// W = (1 - q)^4 (1 + 4 q) and dW/dq = -20 q (1 - q)^3.
    pub fn lack(&self, at: &SurfaceParticle) -> [f64; 2] {
        let support = SUPPORT * at.size;
        let inverse = Lanes::splat(1.0 / support);
        let (r, z) = (Lanes::splat(at.foot[0]), Lanes::splat(at.foot[1]));
        let steepest = Lanes::splat(-20.0 / support);
        let mut sums = [Lanes::ZERO; 3];
        self.bins.near(at.foot[0], at.foot[1], support, |range| {
            for start in range.clone().step_by(WIDTH) {
                let lanes = |column: usize| Lanes::load(&self.columns[column][start..]);
                let left = range.end - start;
                let only = |lanes: Lanes| if left < WIDTH { lanes.keep_first(left) } else { lanes };
                let x = (lanes(0) - r) * inverse;
                let y = (lanes(1) - z) * inverse;
                let q = x.mul_add(x, y * y).sqrt();
                let inside = only((Lanes::ONE - q).max(Lanes::ZERO));
                let cube = inside * inside * inside;
                let kernel = cube * inside * Lanes::splat(4.0).mul_add(q, Lanes::ONE);
                let along = x.mul_add(lanes(2), y * lanes(3));
                let slope = steepest * cube * along - kernel * lanes(9);
                sums[0] += kernel * lanes(6) - slope * lanes(4);
                sums[1] += kernel * lanes(7) - slope * lanes(5);
                sums[2] = kernel.mul_add(lanes(8), sums[2]);
            }
        });
        let [r, z, area] = sums.map(|lanes| lanes.sum());
        if area > 0.0 { [r / area, z / area].map(|lack| lack.clamp(-LARGEST, LARGEST)) } else { [0.0; 2] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const SIZE: f64 = 0.03;

    /// Boundary particles around half a circle of radius one at the origin, or all around one far from the
    /// axis. `depth` is the sum of V (I - L) t over the length of the contour; by the definition of the
    /// surface's area A then is n (1 - depth) + depth (t_r/R) t, here times `excess`.
    fn circle(origin: f64, depth: f64, excess: f64) -> Vec<SurfaceParticle> {
        let turn = if origin > 0.0 { 2.0 * PI } else { PI };
        let count = (turn / SIZE) as usize;
        let step = turn / count as f64;
        let particle = |k: usize| {
            let (sine, cosine) = ((k as f64 + 0.5) * step).sin_cos();
            let (normal, tangent) = ([sine, cosine], [cosine, -sine]);
            let slope = depth * tangent[0] / (sine + origin);
            let area = |axis: usize| step * excess * (normal[axis] * (1.0 - depth) + slope * tangent[axis]);
            SurfaceParticle {
                is_boundary: true,
                size: SIZE,
                foot: normal,
                tangent,
                area: [area(0), area(1)],
                missing: tangent.map(|component| step * depth * component),
            }
        };
        (0..count).map(particle).collect()
    }

    fn taken_up(particles: &[SurfaceParticle], origin: f64) -> Contour {
        let mut contour = Contour::default();
        contour.gather(particles, SIZE, &Domain { origin, period: None });
        contour
    }

    #[test]
    fn the_polygon_is_closed_and_as_long_as_the_circle() {
        let particles = circle(1e3, 0.0, 1.0);
        let contour = taken_up(&particles, 1e3);
        let sum = |axis: usize| contour.segments.iter().map(|segment| segment[axis]).sum::<f64>();
        assert!(sum(0).abs() < 1e-12 && sum(1).abs() < 1e-12, "{} {}", sum(0), sum(1));
        for (segment, particle) in contour.segments.iter().zip(&particles) {
            let length = particle.area[0].hypot(particle.area[1]);
            let outward = dot(*segment, particle.foot);
            assert!((outward / length - 1.0).abs() < 1e-3, "{outward} {length}");
        }
    }

    #[test]
    fn what_is_too_much_is_lacking_with_the_other_sign() {
        let particles = circle(1e3, 0.0, 1.04);
        let contour = taken_up(&particles, 1e3);
        for particle in &particles {
            let lack = contour.lack(particle);
            let along_normal = dot(lack, particle.foot);
            assert!((along_normal + 0.04 / 1.04).abs() < 1e-3, "{along_normal}");
            assert!(dot(lack, particle.tangent).abs() < 1e-6);
        }
    }

    #[test]
    fn what_the_tangential_pressure_adds_is_not_lacking() {
        for origin in [1e3, 0.0] {
            let particles = circle(origin, 0.4 * SIZE, 1.0);
            let contour = taken_up(&particles, origin);
            for particle in &particles {
                let lack = contour.lack(particle);
                assert!(lack[0].hypot(lack[1]) < 2e-3, "{lack:?} at {:?}", particle.foot);
            }
        }
    }
}
