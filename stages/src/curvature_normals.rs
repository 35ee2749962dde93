//! The paper's curvature: the divergence of normals that are taken with a wider kernel.

use crate::curvature_colour::capillary_bound;
use crate::equation_of_state::Packing;
use crate::fields;
use crate::rows::PackedState;
use crate::surface::{for_surface, length};
use crate::surface_interval::{COMPUTED, Tension};
use crate::surface_points::{Particles, SurfacePoints};
use meniscus_engine::field::clear;
use meniscus_engine::lanes::{Lanes, WIDTH};
use meniscus_engine::neighbours::NeighbourList;
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Read, Update, Write, bytes_of};
use meniscus_engine::wiring::Wiring;

/// n_a = -nu_a/|nu_a| with nu_a = sum_b V_b grad_a W_ab at theta_n, then
/// kappa_a = 2 [sum V_b (n_b - n_a) . grad_a W_ab]/[sum V_b (r_b - r_a) . grad_a W_ab] + n_r/R at
/// theta (method.md, section 9; section 2.3 of the paper with the normal's sign corrected).
///
/// No factor that all of a particle's pairs share matters: directions and ratios are what is asked for.
pub struct CurvatureNormals {
    tension: Tension,
    normal_theta: f64,
    packing: Packing,
    position: [Read<f64>; 2],
    listed: [Read<f64>; 2],
    surface: Read<u32>,
    pressure: Update<f64>,
    rate: Write<f64>,
    last_rate: Update<f64>,
    /// Particles at the surface, and those and their neighbours, whose normals count.
    flagged: Vec<u32>,
    with_normal: Vec<u32>,
    /// Where a particle stands among the latter, or [`NOWHERE`].
    number: Vec<u32>,
    normals: Vec<[f64; 2]>,
    curvatures: Vec<f64>,
    /// What lies near the surface: sizes, m, up to that for which supports grow, and normals, zero where they don't count.
    points: SurfacePoints,
    sizes: Vec<f64>,
    point_normals: [Vec<f64>; 2],
    largest: f64,
    step_bound: f64,
}

const NOWHERE: u32 = u32::MAX;

impl CurvatureNormals {
    /// Writes the Laplace pressure and its rate.
    pub fn new(wiring: &mut Wiring, packing: Packing, tension: Tension, normal_theta: f64) -> Self {
        wiring.stage("curvature");
        CurvatureNormals {
            tension,
            normal_theta,
            packing,
            position: fields::POSITION.map(|field| wiring.read(field)),
            listed: [wiring.read(&fields::LIST_RADIUS), wiring.read(&fields::LIST_AXIAL)],
            surface: wiring.read(&fields::SURFACE),
            pressure: wiring.update(&fields::LAPLACE_PRESSURE),
            rate: wiring.write(&fields::LAPLACE_PRESSURE_RATE),
            last_rate: wiring.update(&fields::LAPLACE_PRESSURE_LAST_RATE),
            flagged: Vec::new(),
            with_normal: Vec::new(),
            number: Vec::new(),
            normals: Vec::new(),
            curvatures: Vec::new(),
            points: SurfacePoints::default(),
            sizes: Vec::new(),
            point_normals: Default::default(),
            largest: 0.0,
            step_bound: capillary_bound(&tension, packing.theta * packing.largest_size),
        }
    }

    /// A surface particle's neighbours lie within two supports of the surface; their normals count.
    fn choose(&mut self, surface: &[u32], list: &NeighbourList) {
        self.number.clear();
        self.number.resize(surface.len(), NOWHERE);
        self.flagged.clear();
        self.with_normal.clear();
        for_surface(surface, |a| {
            self.flagged.push(a as u32);
            for b in list.of(a).map(|number| list.source(number)).chain([a]) {
                if self.number[b] == NOWHERE {
                    self.number[b] = self.with_normal.len() as u32;
                    self.with_normal.push(b as u32);
                }
            }
        });
    }

    /// Takes up what those see whose normals count.
    fn gather(&mut self, world: &World) {
        let [r, z] = self.position.map(|field| world.store.read(field));
        let [list_r, list_z] = self.listed.map(|field| world.store.read(field));
        let (packed, Packing { domain, theta, largest_size }) = (PackedState(&world.rows), self.packing);
        self.largest = parallel::maximum(r.len(), |i| packed.area(i)).sqrt().min(largest_size);
        let widest = 4.0 * theta.max(self.normal_theta);
        let source =
            Particles { r: &r, z: &z, list_r: &list_r, list_z: &list_z, support: widest * largest_size };
        let wanted = self.with_normal.iter().map(|&i| (i, widest * self.largest));
        let slack = self.packing.slack();
        let build = world.neighbours.builds();
        self.points.refresh(&source, |i| packed.area(i), wanted, build, (slack, &domain));
        self.sizes.clear();
        self.sizes.extend(self.points.area.iter().map(|area| area.sqrt().min(self.largest)));
    }

    /// Gives their normals to all points.
    fn hand_out_normals(&mut self) {
        let len = self.points.area.len();
        self.point_normals.iter_mut().for_each(Vec::clear);
        for (source, is_mirrored) in self.points.sources() {
            let normal = self.normals.get(self.number[source] as usize);
            let [normal_r, normal_z] = normal.copied().unwrap_or_default();
            self.point_normals[0].push(if is_mirrored { -normal_r } else { normal_r });
            self.point_normals[1].push(normal_z);
        }
        self.point_normals.iter_mut().for_each(|column| column.resize(len, 0.0));
    }

    /// Visits what lies within the support of a particle, with 2 theta: which eight points, the ways to them, m, and
    /// V_b g_ab/|d| but for a constant factor.
    #[inline(always)]
    fn around(
        &self,
        [r_a, z_a, size_a]: [f64; 3],
        two_theta: f64,
        mut visit: impl FnMut(usize, [Lanes; 2], Lanes),
    ) {
        let (points, sizes) = (&self.points, &self.sizes[..]);
        let at = [Lanes::splat(r_a), Lanes::splat(z_a)];
        let (own, two_theta_lanes) = (Lanes::splat(size_a.min(self.largest)), Lanes::splat(two_theta));
        points.within(r_a, z_a, two_theta * (size_a.min(self.largest) + self.largest), |start, left| {
            let area = Lanes::load(&points.area[start..]).keep_first(left.min(WIDTH));
            let d = [Lanes::load(&points.r[start..]) - at[0], Lanes::load(&points.z[start..]) - at[1]];
            let inverse = Lanes::ONE / (two_theta_lanes * (own + Lanes::load(&sizes[start..])));
            let distance = d[0].mul_add(d[0], d[1] * d[1]).sqrt();
            let inside = distance.neg_mul_add(inverse, Lanes::ONE).max(Lanes::ZERO) * inverse;
            visit(start, d, area * inverse * (inside * inside * inside));
        });
    }

    fn normal(&self, particle: [f64; 3]) -> [f64; 2] {
        let mut sum = [Lanes::ZERO; 2];
        self.around(particle, 2.0 * self.normal_theta, |_, d, weight| {
            sum = [weight.neg_mul_add(d[0], sum[0]), weight.neg_mul_add(d[1], sum[1])];
        });
        let sum = sum.map(|lanes| lanes.sum());
        let length = length(sum);
        if length > 0.0 { [sum[0] / length, sum[1] / length] } else { sum }
    }

    /// The particle itself adds nothing, for it lies at no distance.
    fn curvature(&self, n_a: [f64; 2], particle: [f64; 3]) -> f64 {
        let [normal_r, normal_z] = &self.point_normals;
        let own = n_a.map(Lanes::splat);
        let (mut upper, mut lower) = (Lanes::ZERO, Lanes::ZERO);
        self.around(particle, 2.0 * self.packing.theta, |start, d, weight| {
            let change_r = Lanes::load(&normal_r[start..]) - own[0];
            let change_z = Lanes::load(&normal_z[start..]) - own[1];
            upper = weight.mul_add(change_r.mul_add(d[0], change_z * d[1]), upper);
            lower = weight.mul_add(d[0].mul_add(d[0], d[1] * d[1]), lower);
        });
        let lower = lower.sum();
        let planar = if lower > 0.0 { 2.0 * upper.sum() / lower } else { 0.0 };
        planar + n_a[0] / (particle[0] + self.packing.domain.origin)
    }

    /// `value(particle)` of all in a list, on all threads.
    fn of_all<T: Copy + Default + Send>(
        found: &mut Vec<T>,
        particles: &[u32],
        value: impl Fn(usize) -> T + Sync,
    ) {
        found.clear();
        found.resize(particles.len(), T::default());
        parallel::for_chunks_of(32, particles.len(), &mut found[..], |start, found| {
            for (k, found) in found.iter_mut().enumerate() {
                *found = value(particles[start + k] as usize);
            }
        });
    }

    /// Sets the Laplace pressure, and its rate where it was known before; the size of the smallest particle that has one.
    fn store_pressure(&self, world: &World) -> f64 {
        let elapsed = world.clock.time - world.clock.mark(COMPUTED);
        let packed = PackedState(&world.rows);
        let (mut pressure, mut rate) = (world.store.write(self.pressure), world.store.write(self.rate));
        let mut last_rate = world.store.write(self.last_rate);
        let before = world.arena.alloc_slice_fill_with(self.flagged.len(), |k| {
            let a = self.flagged[k] as usize;
            [pressure[a], last_rate[a]]
        });
        [&mut pressure, &mut rate, &mut last_rate].into_iter().for_each(|column| clear(&mut column[..]));
        let mut smallest = self.packing.largest_size;
        for ((&a, &[before, rate_before]), curvature) in
            self.flagged.iter().zip(&*before).zip(&self.curvatures)
        {
            let (a, now) = (a as usize, self.tension.surface_tension * curvature);
            let size = packed.size(a).min(self.packing.largest_size);
            smallest = smallest.min(size);
            pressure[a] = now;
            last_rate[a] = self.tension.rate([before, now], elapsed, size);
            rate[a] = self.tension.carried_on([rate_before, last_rate[a]], size);
        }
        smallest
    }
}

impl Stage for CurvatureNormals {
    fn name(&self) -> &'static str {
        "curvature"
    }

    fn bytes(&self) -> usize {
        let numbers = [&self.flagged, &self.with_normal, &self.number].map(bytes_of).iter().sum::<usize>();
        let normals = bytes_of(&self.normals) + self.point_normals.iter().map(bytes_of).sum::<usize>();
        numbers + normals + bytes_of(&self.curvatures) + bytes_of(&self.sizes) + self.points.bytes()
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        world.clock.limit("surface tension", self.step_bound);
        if !self.tension.is_due(&world.clock) {
            return Ok(());
        }
        self.choose(&world.store.read(self.surface), &world.neighbours);
        self.gather(world);
        {
            let [r, z] = self.position.map(|field| world.store.read(field));
            let (r, z, packed) = (&r[..], &z[..], PackedState(&world.rows));
            let particle = |a: usize| [r[a], z[a], packed.size(a)];
            let mut normals = std::mem::take(&mut self.normals);
            Self::of_all(&mut normals, &self.with_normal, |a| self.normal(particle(a)));
            self.normals = normals;
            self.hand_out_normals();
            let mut curvatures = std::mem::take(&mut self.curvatures);
            let normal = |a: usize| self.normals[self.number[a] as usize];
            Self::of_all(&mut curvatures, &self.flagged, |a| self.curvature(normal(a), particle(a)));
            self.curvatures = curvatures;
        }
        let smallest = self.store_pressure(world);
        self.tension.note(&mut world.clock, smallest);
        Ok(())
    }
}
