//! The contour of the surface as a polygon of feet, and the tension deficit: what surface forces lack of its pull on it.

use crate::surface::{length, outward};
use meniscus_engine::bins::Bins;
use meniscus_engine::domain::{Domain, Image};
use meniscus_engine::lanes::{Lanes, WIDTH};
use meniscus_engine::parallel;
use meniscus_engine::store::bytes_of;

/// Support radius of W in particle sizes.
const SUPPORT: f64 = 4.0;
/// Feet of one contour lie next to each other within so many particle sizes: where the flow draws the surface out,
/// gaps of nearly five open between its particles, and a contour that ended there would pull on its ends.
const APART: f64 = 5.0;
/// Feet that lie across the contour by so many particle sizes more than along it belong to another one.
const ACROSS: f64 = 0.2;
/// Largest f over the mean pressure of the ghosts around: in a crack or in spray there is no contour to speak of. Where no
/// ghost around faces outward f is zero.
const LARGEST: f64 = 1.0;

/// A foot counts as no nearer to the axis than so many particle sizes where it is divided by its distance.
const NEAREST: f64 = 0.5;

/// Part of what is still lacking that is handed on each time: where the surface is rough that is noise, and taken at once it
/// would drive the roughness on. (With .5 and .35 of it f lags behind the flow: films with 11 to the thickness gain .7 and .9 % too little.)
const RELAXATION: f64 = 0.75;

/// f at a place of the surface.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Deficit {
    /// f, Pa.
    pub f: [f64; 2],
    /// The slope along the surface of its part across it, Pa/m.
    pub slope: f64,
}

/// A particle at the surface or near it. Pressures are in Pa, lengths in m; what belongs to a particle is
/// multiplied by its distance from the axis over its foot's.
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
    /// Its ghost's area A, m, outward.
    pub ghost: [f64; 2],
    /// V (I - L) t, m2.
    pub deep: [f64; 2],
    /// Its Laplace pressure P.
    pub pressure: f64,
    /// The slope of that along the surface, Pa/m.
    pub slope: f64,
    /// The reference that all its pressures act less.
    pub reference: f64,
    /// What is added to its surface force so far.
    pub deficit: Deficit,
}

impl SurfaceParticle {
    /// Distance of its foot from the axis, m.
    fn radius(&self, domain: &Domain) -> f64 {
        (self.foot[0] + domain.origin).max(NEAREST * self.size)
    }

    /// A . n, m; not negative.
    fn area(&self) -> f64 {
        outward(self.ghost, self.tangent).max(0.0)
    }

    /// The length of contour above it, m: A . n is what lies at the particle, which a curved surface makes shorter.
    fn length(&self, domain: &Domain, tension: f64) -> f64 {
        let (area, depth) = (self.area(), dot(self.deep, self.tangent));
        let curvature = (self.pressure - self.hoop(domain, tension)) / tension;
        (area + curvature * depth).clamp(0.5 * area, 2.0 * area)
    }

    /// P - P_ref and what f adds, Pa.
    fn acting_pressure(&self) -> f64 {
        let deficit = if self.area() > 0.0 { outward(self.deficit.f, self.tangent) } else { 0.0 };
        self.pressure - self.reference + deficit
    }

    /// Its surface force, N/m, outward, as `ghost_coupling` and the tangential pressure exert it.
    fn force(&self) -> [f64; 2] {
        let (pressure, slope) = (self.acting_pressure(), self.slope + self.deficit.slope);
        let along = self.area() * dot(self.deficit.f, self.tangent);
        [0, 1].map(|axis| pressure * self.ghost[axis] + slope * self.deep[axis] + along * self.tangent[axis])
    }

    /// The pressure of the curvature around the axis, sigma n_r/R, Pa. On the axis both curvatures are the same. (With that at
    /// the nearest distance instead the poles become rough: a curvature was 40 % off in a drop with 56 to the radius
    /// that had swung once.)
    fn hoop(&self, domain: &Domain, tension: f64) -> f64 {
        let on_axis = self.foot[0] + domain.origin < NEAREST * self.size;
        if on_axis { 0.5 * self.pressure } else { -tension * self.tangent[1] / self.radius(domain) }
    }
}

/// What belongs to a corner of the polygon, from half the way to the foot before it to half the way to the next.
#[derive(Clone, Copy, Debug, Default)]
struct Corner {
    /// n ds, m.
    area: [f64; 2],
    /// dt.
    turn: [f64; 2],
}

/// How much surface lies around a foot.
#[derive(Clone, Copy, Debug, Default)]
struct Around {
    /// N, the sum of W l, m.
    length: f64,
    /// The sum of W A . n, m.
    area: f64,
    /// t . grad N.
    slope: f64,
    /// Mean of |P| with the weights W A . n, Pa.
    pressure: f64,
}

/// What enters the sums, in the order of the cells: the place of the foot, the length of contour, A . n, that times |P|,
/// the tangent, t_r/R, and what f becomes and V (I - L) t times the acting pressure, both over N; then f where what f becomes was.
const COLUMNS: usize = 12;

/// The particles and their images in rows of cells.
#[derive(Default)]
pub(crate) struct Contour {
    images: Vec<Image>,
    places: [Vec<f64>; 2],
    bins: Bins,
    corners: Vec<Corner>,
    around: Vec<Around>,
    columns: [Vec<f64>; COLUMNS],
}

/// W = (1 - q)^4 (1 + 4 q) and dW/dq/q = -20 (1 - q)^3.
struct Kernel {
    x: Lanes,
    y: Lanes,
    value: Lanes,
    steepness: Lanes,
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

impl Contour {
    /// Takes up the particles, none of them larger than `largest` metres, of a liquid with the given surface
    /// tension in N/m.
    pub fn gather(&mut self, particles: &[SurfaceParticle], largest: f64, domain: &Domain, tension: f64) {
        for (axis, places) in self.places.iter_mut().enumerate() {
            places.clear();
            places.extend(particles.iter().map(|particle| particle.foot[axis]));
        }
        domain.images(&self.places[0], &self.places[1], SUPPORT.max(APART) * largest, &mut self.images);
        for image in &self.images {
            let [r, z] = particles[image.source as usize].foot;
            let (r, z) = domain.place(image, r, z);
            self.places[0].push(r);
            self.places[1].push(z);
        }
        self.bins.build(&self.places[0], &self.places[1], 0.5 * SUPPORT * largest);

        let mut corners = std::mem::take(&mut self.corners);
        corners.clear();
        corners.resize(particles.len(), Corner::default());
        parallel::for_chunks_of(128, particles.len(), &mut corners[..], |start, corners| {
            for (k, corner) in corners.iter_mut().enumerate() {
                if particles[start + k].is_boundary {
                    *corner = self.corner(particles, start + k);
                }
            }
        });
        self.corners = corners;
        self.fill(particles, 0, |at, k, _| {
            let particle = &particles[k];
            let area = particle.area();
            [at[0], at[1], particle.length(domain, tension), area, area * particle.pressure.abs()]
        });
        let mut around = std::mem::take(&mut self.around);
        around.clear();
        around.resize(particles.len(), Around::default());
        parallel::for_chunks_of(64, particles.len(), &mut around[..], |start, around| {
            for (k, around) in around.iter_mut().enumerate() {
                *around = self.around(&particles[start + k]);
            }
        });
        let corners = std::mem::take(&mut self.corners);
        self.fill(particles, 5, |_, k, sign| {
            let particle = &particles[k];
            let SurfaceParticle { tangent, deep, reference, deficit, .. } = *particle;
            let Around { length, area, slope, .. } = around[k];
            let Corner { area: ds, turn } = corners[k];
            let hoop = particle.hoop(domain, tension) - reference;
            let inverse = if area > 0.0 { 1.0 / length } else { 0.0 };
            // Along the surface f acts on A . n.
            let along = if area > 0.0 { 1.0 / area } else { 0.0 } - inverse;
            let share = |sum: [f64; 2]| {
                let more = along * dot(sum, tangent);
                [0, 1].map(|axis| RELAXATION * (inverse * sum[axis] + more * tangent[axis]))
            };
            let (force, pressure) = (particle.force(), particle.acting_pressure());
            let missing = deep.map(|deep| pressure * deep);
            // The pull of the tension: sigma (n_r/R n ds - dt).
            let rest = share([0, 1].map(|axis| {
                let pull = hoop * ds[axis] - tension * turn[axis];
                pull - force[axis] + missing[axis] * slope * inverse
            }));
            let kept = inverse * particle.length(domain, tension);
            let [f_r, f_z] = [0, 1].map(|axis| rest[axis] + kept * deficit.f[axis]);
            let [missing_r, missing_z] = share(missing);
            let [r, z] = tangent;
            let divergence = r / particle.radius(domain);
            [sign * r, z, divergence, sign * f_r, f_z, sign * missing_r, missing_z]
        });
        (self.corners, self.around) = (corners, around);
    }

    /// Fills columns from the `first` one on with what belongs to a place, to the particle behind it and to the
    /// sign of its radial direction.
    fn fill<const N: usize>(
        &mut self,
        particles: &[SurfaceParticle],
        first: usize,
        values: impl Fn([f64; 2], usize, f64) -> [f64; N],
    ) {
        let mut columns = std::mem::take(&mut self.columns);
        for column in &mut columns[first..first + N] {
            column.clear();
            column.resize(self.places[0].len() + WIDTH, 0.0);
        }
        for (place, &member) in self.bins.members().iter().enumerate() {
            let member = member as usize;
            let (source, mirrored) = self.source(member, particles.len());
            let at = [self.places[0][member], self.places[1][member]];
            let values = values(at, source, if mirrored { -1.0 } else { 1.0 });
            for (column, value) in columns[first..].iter_mut().zip(values) {
                column[place] = value;
            }
        }
        self.columns = columns;
    }

    /// Bytes that it holds.
    pub fn bytes(&self) -> usize {
        let columns = self.places.iter().chain(&self.columns).map(bytes_of).sum::<usize>();
        let rest = bytes_of(&self.images) + bytes_of(&self.corners) + bytes_of(&self.around);
        columns + rest + self.bins.bytes()
    }

    /// The particle behind a member, and whether that is mirrored.
    fn source(&self, member: usize, particles: usize) -> (usize, bool) {
        match member.checked_sub(particles) {
            Some(image) => (self.images[image].source as usize, self.images[image].mirrored),
            None => (member, false),
        }
    }

    /// The corner at a boundary particle's foot.
    fn corner(&self, particles: &[SurfaceParticle], k: usize) -> Corner {
        let SurfaceParticle { size, foot, tangent, .. } = particles[k];
        // Where the contour ends, half a particle's size belongs to its last foot.
        let mut ways = [-size, size].map(|along| tangent.map(|component| along * component));
        let mut turns = [tangent; 2];
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
                    (nearest[side], ways[side], turns[side]) = (distance, way, direction);
                }
            }
        });
        let [before, after] = ways;
        Corner {
            area: [-0.5 * (after[1] - before[1]), 0.5 * (after[0] - before[0])],
            turn: [0.5 * (turns[1][0] - turns[0][0]), 0.5 * (turns[1][1] - turns[0][1])],
        }
    }

    /// Calls `add` with W of eight places after the other around a place, and with what loads their columns.
    fn for_places(&self, at: &SurfaceParticle, mut add: impl FnMut(Kernel, &dyn Fn(usize) -> Lanes)) {
        let support = SUPPORT * at.size;
        let inverse = Lanes::splat(1.0 / support);
        let (r, z) = (Lanes::splat(at.foot[0]), Lanes::splat(at.foot[1]));
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
                let value = cube * inside * Lanes::splat(4.0).mul_add(q, Lanes::ONE);
                add(Kernel { x, y, value, steepness: Lanes::splat(-20.0) * cube }, &lanes);
            }
        });
    }

    /// N, its slope and the mean pressure at a particle's foot.
    fn around(&self, at: &SurfaceParticle) -> Around {
        let mut sums = [Lanes::ZERO; 4];
        let [r, z] = at.tangent.map(Lanes::splat);
        self.for_places(at, |kernel, lanes| {
            let along = kernel.x.mul_add(r, kernel.y * z);
            sums[0] -= kernel.steepness * along * lanes(2);
            for column in 2..5 {
                sums[column - 1] = kernel.value.mul_add(lanes(column), sums[column - 1]);
            }
        });
        let [slope, length, area, force] = sums.map(|lanes| lanes.sum());
        let pressure = if area > 0.0 { force / area } else { 0.0 };
        Around { length, area, slope: slope / (SUPPORT * at.size), pressure }
    }

    /// f so far and a part of what is still lacking, both handed to the particles around: the sum of W/N times them, less R
    /// grad_s (W/(R N)) V (I - L) (P - P_ref + f_n) of the deficit.
    fn smoothed(&self, at: &SurfaceParticle) -> [f64; 2] {
        let mut sums = [Lanes::ZERO; 2];
        let inverse = Lanes::splat(1.0 / (SUPPORT * at.size));
        self.for_places(at, |kernel, lanes| {
            let along = kernel.x.mul_add(lanes(5), kernel.y * lanes(6));
            let slope = (inverse * kernel.steepness).mul_add(along, -(kernel.value * lanes(7)));
            sums[0] += kernel.value.mul_add(lanes(8), -(slope * lanes(10)));
            sums[1] += kernel.value.mul_add(lanes(9), -(slope * lanes(11)));
        });
        sums.map(|lanes| lanes.sum())
    }

    /// f within bounds, and the slope of its part across the surface.
    fn with_slope(&self, at: &SurfaceParticle, around: &Around, f: [f64; 2]) -> Deficit {
        let mut sums = [Lanes::ZERO; 2];
        let [r, z] = at.tangent.map(Lanes::splat);
        self.for_places(at, |kernel, lanes| {
            let slope = kernel.steepness * kernel.x.mul_add(r, kernel.y * z) * lanes(2);
            sums[0] -= slope * lanes(8);
            sums[1] -= slope * lanes(9);
        });
        if around.area <= 0.0 {
            return Deficit::default();
        }
        let inverse = 1.0 / (SUPPORT * at.size);
        let slope = [0, 1].map(|axis| (inverse * sums[axis].sum() - around.slope * f[axis]) / around.length);
        let (length, most) = (length(f), LARGEST * around.pressure);
        let within = if length > most { most / length } else { 1.0 };
        // Where all others are at the edge of W, N changes from nothing to something within no distance: slopes of 1e19 Pa/m threw
        // particles out of a drop of 720.
        let steepest = most / at.size;
        Deficit { f: f.map(|f| within * f), slope: outward(slope, at.tangent).clamp(-steepest, steepest) }
    }

    /// f at the feet of all particles.
    pub fn deficit(&mut self, particles: &[SurfaceParticle], found: &mut Vec<Deficit>) {
        found.clear();
        found.resize(particles.len(), Deficit::default());
        parallel::for_chunks_of(64, particles.len(), &mut found[..], |start, found| {
            for (k, found) in found.iter_mut().enumerate() {
                found.f = self.smoothed(&particles[start + k]);
            }
        });
        self.fill(particles, 8, |_, k, sign| {
            let [r, z] = found[k].f;
            [sign * r, z]
        });
        parallel::for_chunks_of(64, particles.len(), &mut found[..], |start, found| {
            for (k, found) in (start..).zip(found) {
                *found = self.with_slope(&particles[k], &self.around[k], found.f);
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const SIZE: f64 = 0.03;

    /// Boundary particles around half a circle of radius one at the origin, or all around one far from the
    /// axis, with a tension of one. `depth` is the sum of V (I - L) t over the length of the contour; by the
    /// definition of the surface's area A then is n (1 - depth) + depth (t_r/R) t, here times `excess`.
    fn circle(origin: f64, depth: f64, excess: f64) -> Vec<SurfaceParticle> {
        let (turn, pressure) = if origin > 0.0 { (2.0 * PI, 1.0) } else { (PI, 2.0) };
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
                ghost: [area(0), area(1)],
                deep: tangent.map(|component| step * depth * component),
                pressure,
                slope: 0.0,
                reference: 0.0,
                deficit: Deficit::default(),
            }
        };
        (0..count).map(particle).collect()
    }

    /// Finds f so many times.
    fn balance(particles: &mut [SurfaceParticle], origin: f64, times: usize) {
        let mut found = Vec::new();
        for _ in 0..times {
            taken_up(particles, origin).deficit(particles, &mut found);
            particles.iter_mut().zip(&found).for_each(|(particle, deficit)| particle.deficit = *deficit);
        }
    }

    fn taken_up(particles: &[SurfaceParticle], origin: f64) -> Contour {
        let mut contour = Contour::default();
        contour.gather(particles, SIZE, &Domain { origin, period: None }, 1.0);
        contour
    }

    fn sum(of: impl Iterator<Item = [f64; 2]>) -> [f64; 2] {
        of.fold([0.0; 2], |sum, part| [sum[0] + part[0], sum[1] + part[1]])
    }

    #[test]
    fn it_tells_the_memory_of_its_images() {
        let mut contour = taken_up(&circle(0.0, 0.0, 1.0), 0.0);
        let all = contour.bytes();
        let images = std::mem::take(&mut contour.images);
        assert!(!images.is_empty());
        assert_eq!(all - contour.bytes(), bytes_of(&images));
    }

    #[test]
    fn the_polygon_is_closed_and_as_long_as_the_circle() {
        let whole = circle(1e6, 0.0, 1.0);
        // A gap of four particle sizes.
        let open = [&whole[..40], &whole[43..]].concat();
        for particles in [&whole, &open] {
            let corners = taken_up(particles, 1e6).corners;
            for parts in
                [sum(corners.iter().map(|corner| corner.area)), sum(corners.iter().map(|corner| corner.turn))]
            {
                assert!(length(parts) < 1e-12, "{parts:?}");
            }
        }
        let contour = taken_up(&whole, 1e6);
        for (corner, particle) in contour.corners.iter().zip(&whole) {
            let outward = dot(corner.area, particle.foot);
            assert!((outward / particle.area() - 1.0).abs() < 1e-3, "{outward} {}", particle.area());
        }
    }

    #[test]
    fn what_is_too_much_is_lacking_with_the_other_sign() {
        let mut particles = circle(1e6, 0.0, 1.04);
        balance(&mut particles, 1e6, 20);
        for SurfaceParticle { foot, tangent, deficit, .. } in particles {
            let along_normal = dot(deficit.f, foot);
            assert!((along_normal + 0.04 / 1.04).abs() < 1e-3, "{along_normal}");
            assert!(dot(deficit.f, tangent).abs() < 1e-6);
        }
    }

    #[test]
    fn what_the_tangential_pressure_adds_is_not_lacking() {
        for origin in [1e6, 0.0] {
            let mut particles = circle(origin, 0.4 * SIZE, 1.0);
            balance(&mut particles, origin, 20);
            for SurfaceParticle { foot, deficit, .. } in particles {
                assert!(length(deficit.f) < 4e-3, "{deficit:?} at {foot:?}");
            }
        }
    }

    #[test]
    fn a_reference_acts_on_nothing() {
        let mut particles = circle(1e6, 0.0, 1.0);
        particles.iter_mut().for_each(|particle| particle.reference = 0.7);
        balance(&mut particles, 1e6, 20);
        for SurfaceParticle { deficit, .. } in particles {
            assert!(length(deficit.f) < 1e-3, "{deficit:?}");
        }
    }

    /// As spray does: of three particles that follow each other only the last one's ghost faces outward, by next to nothing.
    #[test]
    fn what_hardly_faces_outward_lacks_nothing_beyond_bounds() {
        let places = [(0.0, [1.0, 0.0], 0.0), (3.0, [1.0, 0.0], 0.0), (6.5, [0.8, -0.6], 1e-15)];
        let mut particles = places.map(|(along, tangent, area)| SurfaceParticle {
            foot: [along * SIZE, 0.0],
            tangent,
            ghost: [-tangent[1] * area * SIZE, tangent[0] * area * SIZE],
            deep: [0.0; 2],
            ..circle(1e6, 0.0, 1.0)[0]
        });
        balance(&mut particles, 1e6, 20);
        for SurfaceParticle { foot, deficit, pressure, .. } in particles {
            assert!(length(deficit.f) <= LARGEST * pressure, "{deficit:?} at {foot:?}");
        }
    }

    #[test]
    fn what_lacks_at_the_edge_of_sight_has_a_bounded_slope() {
        let places = [(0.0, 1.0), (0.999 * SUPPORT, 0.0)];
        let mut particles = places.map(|(along, area)| SurfaceParticle {
            foot: [along * SIZE, 0.0],
            tangent: [1.0, 0.0],
            ghost: [0.0, area * SIZE],
            deep: [0.0; 2],
            ..circle(1e6, 0.0, 1.0)[0]
        });
        balance(&mut particles, 1e6, 20);
        for SurfaceParticle { foot, deficit, pressure, size, .. } in particles {
            assert!(deficit.slope.abs() <= LARGEST * pressure / size, "{deficit:?} at {foot:?}");
        }
    }

    /// Areas are uneven from particle to particle, too, and lean along the surface, as where the flow has drawn the packing out.
    #[test]
    fn a_closed_contour_is_not_driven_by_pressures_that_differ() {
        let mut particles = circle(1e6, 0.4 * SIZE, 1.0);
        for (k, particle) in particles.iter_mut().enumerate() {
            let uneven = 1.0 - 0.2 * particle.foot[0] + 0.3 * (5.0 * k as f64).sin();
            let leaning = 0.3 * SIZE * (7.0 * k as f64).sin() * particle.foot[0];
            particle.pressure *= 1.0 + 0.3 * particle.foot[0];
            particle.ghost =
                [0, 1].map(|axis| uneven * particle.ghost[axis] + leaning * particle.tangent[axis]);
        }
        let before = sum(particles.iter().map(SurfaceParticle::force));
        assert!(length(before) > 0.25, "{before:?}");
        // Found but once, f leaves .001.
        balance(&mut particles, 1e6, 30);
        let after = sum(particles.iter().map(SurfaceParticle::force));
        assert!(length(after) < 2e-4, "{after:?}");
    }
}
