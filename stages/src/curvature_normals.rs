//! The paper's curvature: the divergence of normals that are taken with a wider kernel.

use crate::curvature_colour::capillary_bound;
use crate::equation_of_state::Packing;
use crate::fields;
use crate::surface::INSIDE;
use meniscus_engine::bins::Bins;
use meniscus_engine::neighbours::Image;
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
    size: Read<f64>,
    surface: Read<u32>,
    pressure: Write<f64>,
    rate: Write<f64>,
    images: Vec<Image>,
    points: [Vec<f64>; 3],
    bins: Bins,
    normals: Vec<[f64; 2]>,
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
            size: wiring.read(&fields::SIZE),
            surface: wiring.read(&fields::SURFACE),
            pressure: wiring.write(&fields::LAPLACE_PRESSURE),
            rate: wiring.write(&fields::LAPLACE_PRESSURE_RATE),
            images: Vec::new(),
            points: Default::default(),
            bins: Bins::default(),
            normals: Vec::new(),
            largest: 0.0,
            step_bound: capillary_bound(surface_tension, density, packing.theta * packing.largest_size),
        }
    }

    /// Particles and images, sorted for a search within the wider support.
    fn gather(&mut self, r: &[f64], z: &[f64], size: &[f64]) {
        let Packing { domain, largest_size, .. } = self.packing;
        self.largest = parallel::maximum(size.len(), |i| size[i]).min(largest_size);
        let support = 4.0 * self.normal_theta * self.largest;
        domain.images(r, z, support, &mut self.images);
        for (points, own) in self.points.iter_mut().zip([r, z, size]) {
            points.clear();
            points.extend(own);
        }
        for image in &self.images {
            let source = image.source as usize;
            let (image_r, image_z) = domain.place(image, r[source], z[source]);
            self.points[0].push(image_r);
            self.points[1].push(image_z);
            self.points[2].push(size[source]);
        }
        self.bins.build(&self.points[0], &self.points[1], 0.25 * support);
    }

    /// Calls `visit(b, dr, dz, V_b g/d)` for every point within the pair's support radius.
    fn neighbours(&self, a: usize, theta: f64, mut visit: impl FnMut(usize, [f64; 2], f64)) {
        let [r, z, size] = &self.points;
        let most = self.largest;
        self.bins.near(r[a], z[a], 4.0 * theta * most, |range| {
            for &b in &self.bins.members()[range] {
                let b = b as usize;
                let d = [r[b] - r[a], z[b] - z[a]];
                let support = 2.0 * theta * (size[a].min(most) + size[b].min(most));
                let square = d[0] * d[0] + d[1] * d[1];
                if b != a && square < support * support {
                    let inside = 1.0 - square.sqrt() / support;
                    let kernel = 140.0 / PI * (inside * inside * inside) / support.powi(4);
                    visit(b, d, size[b] * size[b] * kernel);
                }
            }
        });
    }

    fn normal(&self, a: usize) -> [f64; 2] {
        let mut sum = [0.0; 2];
        self.neighbours(a, self.normal_theta, |_, d, weight| {
            sum[0] -= weight * d[0];
            sum[1] -= weight * d[1];
        });
        let length = sum[0].hypot(sum[1]);
        if length > 0.0 { [sum[0] / length, sum[1] / length] } else { sum }
    }

    fn curvature(&self, a: usize, particles: usize) -> f64 {
        let n_a = self.normals[a];
        let (mut upper, mut lower) = (0.0, 0.0);
        self.neighbours(a, self.packing.theta, |b, d, weight| {
            let n_b = match b.checked_sub(particles) {
                None => self.normals[b],
                Some(image) => {
                    let image = &self.images[image];
                    let [r, z] = self.normals[image.source as usize];
                    if image.mirrored { [-r, z] } else { [r, z] }
                }
            };
            upper += weight * ((n_b[0] - n_a[0]) * d[0] + (n_b[1] - n_a[1]) * d[1]);
            lower += weight * (d[0] * d[0] + d[1] * d[1]);
        });
        let planar = if lower > 0.0 { 2.0 * upper / lower } else { 0.0 };
        planar + n_a[0] / (self.points[0][a] + self.packing.domain.origin)
    }
}

impl Stage for CurvatureNormals {
    fn name(&self) -> &'static str {
        "curvature"
    }

    fn bytes(&self) -> usize {
        self.points.iter().map(bytes_of).sum::<usize>() + bytes_of(&self.normals) + self.bins.bytes()
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        let [r, z] = self.position.map(|field| world.store.read(field));
        let (size, surface) = (world.store.read(self.size), world.store.read(self.surface));
        self.gather(&r, &z, &size);
        let mut normals = std::mem::take(&mut self.normals);
        normals.resize(r.len(), [0.0; 2]);
        // A surface particle's neighbours lie within two supports of the surface; their normals count.
        let list = &world.neighbours;
        let wanted = |a: usize| {
            surface[a] != INSIDE || list.of(a).any(|number| surface[list.source(number)] != INSIDE)
        };
        let this = &*self;
        parallel::for_chunks(r.len(), &mut normals[..], |start, normals| {
            for (k, normal) in normals.iter_mut().enumerate() {
                *normal = if wanted(start + k) { this.normal(start + k) } else { [0.0; 2] };
            }
        });
        self.normals = normals;
        let this = &*self;
        let (mut pressure, mut rate) = (world.store.write(self.pressure), world.store.write(self.rate));
        rate.fill(0.0);
        world.clock.limit("surface tension", self.step_bound);
        parallel::for_chunks(r.len(), &mut pressure[..], |start, pressure| {
            for (k, pressure) in pressure.iter_mut().enumerate() {
                let a = start + k;
                let flagged = surface[a] != INSIDE;
                *pressure = if flagged { this.surface_tension * this.curvature(a, r.len()) } else { 0.0 };
            }
        });
        Ok(())
    }
}
