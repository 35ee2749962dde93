//! The paper's curvature: the divergence of normals that are taken with a wider kernel.

use crate::curvature_colour::capillary_bound;
use crate::equation_of_state::Packing;
use crate::fields;
use crate::rows::PackedState;
use crate::surface::{for_surface, length};
use crate::surface_layer::SurfaceLayer;
use meniscus_engine::bins::Bins;
use meniscus_engine::domain::Image;
use meniscus_engine::field::clear;
use meniscus_engine::lanes::{Lanes, WIDTH};
use meniscus_engine::neighbours::NeighbourList;
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Read, Write, bytes_of};
use meniscus_engine::wiring::Wiring;
use std::f64::consts::PI;

/// n_a = -nu_a/|nu_a| with nu_a = sum_b V_b grad_a W_ab at theta_n, then
/// kappa_a = 2 [sum V_b (n_b - n_a) . grad_a W_ab]/[sum V_b (r_b - r_a) . grad_a W_ab] + n_r/R at
/// theta (method.md, section 9; section 2.3 of the paper with the normal's sign corrected).
pub struct CurvatureNormals {
    surface_tension: f64,
    normal_theta: f64,
    packing: Packing,
    position: [Read<f64>; 2],
    surface: Read<u32>,
    pressure: Write<f64>,
    rate: Write<f64>,
    /// Particles at the surface, and those and their neighbours, whose normals count.
    flagged: Vec<u32>,
    with_normal: Vec<u32>,
    has_normal: Vec<bool>,
    /// Normals, of those particles alone.
    normals: Vec<[f64; 2]>,
    found: Vec<[f64; 2]>,
    layer: SurfaceLayer,
    images: Vec<Image>,
    /// Particles and images near the surface: r, z and size in m; which particle each is, and whether mirrored.
    points: [Vec<f64>; 3],
    sources: Vec<(u32, bool)>,
    bins: Bins,
    sorted: [Vec<f64>; 3],
    largest: f64,
    step_bound: f64,
}

impl CurvatureNormals {
    /// Writes the Laplace pressure; surface tension in N/m, density at rest in kg/m3.
    pub fn new(
        wiring: &mut Wiring,
        packing: Packing,
        surface_tension: f64,
        density: f64,
        normal_theta: f64,
    ) -> Self {
        wiring.stage("curvature");
        CurvatureNormals {
            surface_tension,
            normal_theta,
            packing,
            position: [wiring.read(&fields::RADIUS), wiring.read(&fields::AXIAL)],
            surface: wiring.read(&fields::SURFACE),
            pressure: wiring.write(&fields::LAPLACE_PRESSURE),
            rate: wiring.write(&fields::LAPLACE_PRESSURE_RATE),
            flagged: Vec::new(),
            with_normal: Vec::new(),
            has_normal: Vec::new(),
            normals: Vec::new(),
            found: Vec::new(),
            layer: SurfaceLayer::default(),
            images: Vec::new(),
            points: Default::default(),
            sources: Vec::new(),
            bins: Bins::default(),
            sorted: Default::default(),
            largest: 0.0,
            step_bound: capillary_bound(surface_tension, density, packing.theta * packing.largest_size),
        }
    }

    /// A surface particle's neighbours lie within two supports of the surface; their normals count.
    fn choose(&mut self, surface: &[u32], list: &NeighbourList) {
        self.has_normal.clear();
        self.has_normal.resize(surface.len(), false);
        self.flagged.clear();
        self.with_normal.clear();
        for_surface(surface, |a| {
            self.flagged.push(a as u32);
            for b in list.of(a).map(|number| list.source(number)).chain([a]) {
                if !self.has_normal[b] {
                    self.has_normal[b] = true;
                    self.with_normal.push(b as u32);
                }
            }
        });
    }

    /// Particles and images near the surface, sorted for a search within the wider support.
    fn gather(&mut self, r: &[f64], z: &[f64], packed: PackedState) {
        let Packing { domain, largest_size, .. } = self.packing;
        self.largest = parallel::maximum(r.len(), |i| packed.area(i)).sqrt().min(largest_size);
        let support = 4.0 * self.normal_theta * self.largest;
        self.layer.mark([r, z], &self.with_normal, support);
        domain.images(r, z, support, &mut self.images);
        self.points.iter_mut().for_each(Vec::clear);
        self.sources.clear();
        let mut push = |source: usize, mirrored: bool, (r, z): (f64, f64)| {
            if self.layer.contains(r, z) {
                for (column, value) in self.points.iter_mut().zip([r, z, packed.size(source)]) {
                    column.push(value);
                }
                self.sources.push((source as u32, mirrored));
            }
        };
        for (source, place) in r.iter().copied().zip(z.iter().copied()).enumerate() {
            push(source, false, place);
        }
        for image in &self.images {
            let source = image.source as usize;
            push(source, image.mirrored, domain.place(image, r[source], z[source]));
        }
        self.bins.build(&self.points[0], &self.points[1], 0.25 * support);
        // From here on they stand in the order of the cells, and behind them fill for the last lanes.
        for (column, sorted) in self.points.iter().zip(&mut self.sorted) {
            sorted.clear();
            sorted.extend(self.bins.members().iter().map(|&member| column[member as usize]));
            sorted.resize(column.len() + WIDTH, 0.0);
        }
    }

    /// Eight points at a time: they are many within the wider support.
    fn normal(&self, [r_a, z_a, size_a]: [f64; 3]) -> [f64; 2] {
        let [r, z, size] = &self.sorted;
        let theta = Lanes::splat(2.0 * self.normal_theta);
        let most = Lanes::splat(self.largest);
        let own = Lanes::splat(size_a.min(self.largest));
        let mut sum = [Lanes::ZERO; 2];
        self.bins.near(r_a, z_a, 4.0 * self.normal_theta * self.largest, |range| {
            for start in range.clone().step_by(WIDTH) {
                let load = |column: &[f64]| Lanes::load(&column[start..]);
                let size = load(size).keep_first((range.end - start).min(WIDTH));
                let d = [load(r) - Lanes::splat(r_a), load(z) - Lanes::splat(z_a)];
                let support = theta * (own + size.min(most));
                let distance = d[0].mul_add(d[0], d[1] * d[1]).sqrt();
                let inside = (Lanes::ONE - distance / support).max(Lanes::ZERO);
                let square = support * support;
                // V_b g/d but for its constant factor, which a direction doesn't need.
                let weight = size * size * inside * inside * inside / (square * square);
                sum = [weight.neg_mul_add(d[0], sum[0]), weight.neg_mul_add(d[1], sum[1])];
            }
        });
        let sum = sum.map(|lanes| lanes.sum());
        let length = length(sum);
        if length > 0.0 { [sum[0] / length, sum[1] / length] } else { sum }
    }

    fn curvature(&self, n_a: [f64; 2], [r_a, z_a, size_a]: [f64; 3]) -> f64 {
        let ([r, z, size], theta, most) = (&self.sorted, self.packing.theta, self.largest);
        let (mut upper, mut lower) = (0.0, 0.0);
        self.bins.near(r_a, z_a, 4.0 * theta * most, |range| {
            for b in range {
                let d = [r[b] - r_a, z[b] - z_a];
                let support = 2.0 * theta * (size_a.min(most) + size[b].min(most));
                let square = d[0] * d[0] + d[1] * d[1];
                // At distance zero lies the particle itself.
                if square > 0.0 && square < support * support {
                    let inside = 1.0 - square.sqrt() / support;
                    let kernel = 140.0 / PI * (inside * inside * inside) / support.powi(4);
                    let weight = size[b] * size[b] * kernel;
                    let (source, mirrored) = self.sources[self.bins.members()[b] as usize];
                    let [normal_r, normal_z] = self.normals[source as usize];
                    let n_b = if mirrored { [-normal_r, normal_z] } else { [normal_r, normal_z] };
                    upper += weight * ((n_b[0] - n_a[0]) * d[0] + (n_b[1] - n_a[1]) * d[1]);
                    lower += weight * square;
                }
            }
        });
        let planar = if lower > 0.0 { 2.0 * upper / lower } else { 0.0 };
        planar + n_a[0] / (r_a + self.packing.domain.origin)
    }

    /// `value(particle)` of all in a list, on all threads.
    fn of_all(found: &mut Vec<[f64; 2]>, particles: &[u32], value: impl Fn(usize) -> [f64; 2] + Sync) {
        found.clear();
        found.resize(particles.len(), [0.0; 2]);
        parallel::for_chunks_of(32, particles.len(), &mut found[..], |start, found| {
            for (k, found) in found.iter_mut().enumerate() {
                *found = value(particles[start + k] as usize);
            }
        });
    }
}

impl Stage for CurvatureNormals {
    fn name(&self) -> &'static str {
        "curvature"
    }

    fn bytes(&self) -> usize {
        let numbers = [&self.flagged, &self.with_normal].map(bytes_of).iter().sum::<usize>();
        let points =
            self.points.iter().chain(&self.sorted).map(bytes_of).sum::<usize>() + bytes_of(&self.sources);
        let normals = bytes_of(&self.has_normal) + bytes_of(&self.normals) + bytes_of(&self.found);
        numbers + points + normals + self.bins.bytes() + self.layer.bytes()
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        let [r, z] = self.position.map(|field| world.store.read(field));
        let (packed, surface) = (PackedState(&world.rows), world.store.read(self.surface));
        self.choose(&surface, &world.neighbours);
        self.gather(&r, &z, packed);
        self.normals.resize(r.len(), [0.0; 2]);
        let (r, z) = (&r[..], &z[..]);
        let place = |a: usize| [r[a], z[a], packed.size(a)];
        let mut found = std::mem::take(&mut self.found);
        Self::of_all(&mut found, &self.with_normal, |a| self.normal(place(a)));
        for (&a, &normal) in self.with_normal.iter().zip(&found) {
            self.normals[a as usize] = normal;
        }
        Self::of_all(&mut found, &self.flagged, |a| [self.curvature(self.normals[a], place(a)), 0.0]);
        let (mut pressure, mut rate) = (world.store.write(self.pressure), world.store.write(self.rate));
        clear(&mut rate[..]);
        clear(&mut pressure[..]);
        for (&a, &[curvature, _]) in self.flagged.iter().zip(&found) {
            pressure[a as usize] = self.surface_tension * curvature;
        }
        self.found = found;
        world.clock.limit("surface tension", self.step_bound);
        Ok(())
    }
}
