//! Normals and curvature from the colour field: where c = 1/2 along its gradient lies the surface.

use crate::colour_field::{Colour, ColourField};
use crate::equation_of_state::Packing;
use crate::fields;
use crate::surface::INSIDE;
use meniscus_engine::bins::Bins;
use meniscus_engine::neighbours::Image;
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Read, Update, Write};
use meniscus_engine::wiring::Wiring;
use std::sync::{Arc, Mutex};

/// What the stage finds for one particle.
#[derive(Clone, Copy, Debug, Default)]
struct Found {
    /// Mean of the two principal curvatures times two, 1/m.
    curvature: f64,
    /// Unit tangent of the surface at the particle.
    tangent: [f64; 2],
}

/// Settings of the colour-field curvature.
#[derive(Clone, Copy, Debug)]
pub struct ColourCurvature {
    /// sigma in N/m.
    pub surface_tension: f64,
    /// Support radius of the colour field in particle sizes; 8 or more (method.md, section 10).
    pub support: f64,
    /// Steps between two computations; in between the Laplace pressure is extrapolated.
    pub interval: u64,
    /// Whether the gradient of the Laplace pressure along the surface is wanted.
    pub with_slope: bool,
}

/// The stage. It must follow the boundary detection of the same step, which takes up the particles in
/// the shared colour field.
pub struct CurvatureColour {
    settings: ColourCurvature,
    packing: Packing,
    field: Arc<Mutex<ColourField>>,
    position: [Read<f64>; 2],
    size: Read<f64>,
    surface: Read<u32>,
    pressure: Update<f64>,
    rate: Write<f64>,
    slope: Option<[Write<f64>; 2]>,
    flagged: Vec<u32>,
    found: Vec<Found>,
    neighbours: SurfaceNeighbours,
}

/// Flagged particles and their images, to be searched.
#[derive(Default)]
struct SurfaceNeighbours {
    r: Vec<f64>,
    z: Vec<f64>,
    images: Vec<Image>,
    points: [Vec<f64>; 2],
    bins: Bins,
}

impl CurvatureColour {
    /// Writes the Laplace pressure, its rate and, if wanted, its slope along the surface.
    pub fn new(
        wiring: &mut Wiring,
        packing: Packing,
        settings: ColourCurvature,
        field: Arc<Mutex<ColourField>>,
    ) -> Self {
        wiring.stage("curvature");
        let slope = [&fields::LAPLACE_SLOPE_R, &fields::LAPLACE_SLOPE_Z];
        CurvatureColour {
            settings,
            packing,
            field,
            position: [wiring.read(&fields::RADIUS), wiring.read(&fields::AXIAL)],
            size: wiring.read(&fields::SIZE),
            surface: wiring.read(&fields::SURFACE),
            pressure: wiring.update(&fields::LAPLACE_PRESSURE),
            rate: wiring.write(&fields::LAPLACE_PRESSURE_RATE),
            slope: settings.with_slope.then(|| slope.map(|field| wiring.write(field))),
            flagged: Vec::new(),
            found: Vec::new(),
            neighbours: SurfaceNeighbours::default(),
        }
    }

    fn measure(&mut self, world: &World) {
        let [r, z] = self.position.map(|field| world.store.read(field));
        let (size, surface) = (world.store.read(self.size), world.store.read(self.surface));
        self.flagged.clear();
        self.flagged.extend((0..r.len() as u32).filter(|&i| surface[i as usize] != INSIDE));
        self.found.clear();
        self.found.resize(self.flagged.len(), Found::default());
        let field = self.field.lock().expect("no stage panics while it holds the colour field");
        let (r, z, size, flagged) = (&r[..], &z[..], &size[..], &self.flagged[..]);
        let (field, settings, packing) = (&*field, self.settings, self.packing);
        parallel::for_chunks_of(16, flagged.len(), &mut self.found[..], |start, found| {
            for (k, found) in found.iter_mut().enumerate() {
                let i = flagged[start + k] as usize;
                let size = size[i].min(packing.largest_size);
                *found = find(field, [r[i], z[i]], size, &settings, packing.domain.origin);
            }
        });
    }

    /// Sets the Laplace pressure, and its rate where it was known before.
    fn store_pressure(&self, world: &mut World) {
        let elapsed = world.clock.time - world.clock.mark("curvature");
        let mut pressure = world.store.write(self.pressure);
        let mut rate = world.store.write(self.rate);
        rate.fill(0.0);
        let before: &[f64] = world.arena.alloc_slice_copy(&pressure);
        pressure.fill(0.0);
        for (&i, found) in self.flagged.iter().zip(&self.found) {
            let i = i as usize;
            pressure[i] = self.settings.surface_tension * found.curvature;
            if before[i] != 0.0 && elapsed > 0.0 {
                rate[i] = (pressure[i] - before[i]) / elapsed;
            }
        }
        world.clock.set_mark("curvature");
    }

    /// dP_L/dt along the surface by weighted least squares over flagged particles within 3 D
    /// (method.md, section 10, "The surface error, later", T).
    fn store_slope(&mut self, world: &World) {
        let Some(slope) = self.slope else { return };
        let [r, z] = self.position.map(|field| world.store.read(field));
        let (size, pressure) = (world.store.read(self.size), world.store.write(self.pressure));
        let [mut slope_r, mut slope_z] = slope.map(|field| world.store.write(field));
        let largest = self.packing.largest_size;
        let near = &mut self.neighbours;
        for (picked, from) in [(&mut near.r, &r), (&mut near.z, &z)] {
            picked.clear();
            picked.extend(self.flagged.iter().map(|&i| from[i as usize]));
        }
        self.packing.domain.images(&near.r, &near.z, 3.0 * largest, &mut near.images);
        for (points, own) in near.points.iter_mut().zip([&near.r, &near.z]) {
            points.clear();
            points.extend_from_slice(own);
        }
        for image in &near.images {
            let s = image.source as usize;
            let (image_r, image_z) = self.packing.domain.place(image, near.r[s], near.z[s]);
            near.points[0].push(image_r);
            near.points[1].push(image_z);
        }
        near.bins.build(&near.points[0], &near.points[1], 3.0 * largest);
        let source = |member: usize| match member.checked_sub(self.flagged.len()) {
            Some(image) => near.images[image].source as usize,
            None => member,
        };
        slope_r.fill(0.0);
        slope_z.fill(0.0);
        for (k, (&i, found)) in self.flagged.iter().zip(&self.found).enumerate() {
            let i = i as usize;
            let reach = 3.0 * size[i].min(largest);
            let (mut upper, mut lower) = (0.0, 0.0);
            near.bins.near(r[i], z[i], reach, |range| {
                for &member in &near.bins.members()[range] {
                    let member = member as usize;
                    let (dr, dz) = (near.points[0][member] - r[i], near.points[1][member] - z[i]);
                    let q = dr.hypot(dz) / reach;
                    if q >= 1.0 || member == k {
                        continue;
                    }
                    let b = self.flagged[source(member)] as usize;
                    let along = dr * found.tangent[0] + dz * found.tangent[1];
                    let weight = size[b] * size[b] * (1.0 - q).powi(3);
                    upper += weight * (pressure[b] - pressure[i]) * along;
                    lower += weight * along * along;
                }
            });
            if lower > 0.0 {
                slope_r[i] = found.tangent[0] * upper / lower;
                slope_z[i] = found.tangent[1] * upper / lower;
            }
        }
    }
}

/// From a particle at most four Newton steps along grad c to c = 1/2; the curvature there.
fn find(field: &ColourField, at: [f64; 2], size: f64, settings: &ColourCurvature, origin: f64) -> Found {
    let support = settings.support * size;
    let here = field.at(at[0], at[1], support);
    let length = here.gradient[0].hypot(here.gradient[1]);
    let tangent = [-here.gradient[1] / length, here.gradient[0] / length];
    let (mut foot, mut colour) = (at, here);
    for _ in 0..4 {
        let square = colour.gradient[0].powi(2) + colour.gradient[1].powi(2);
        let wanted = (0.5 - colour.value) / square.sqrt();
        if wanted.abs() < 1e-4 * size {
            break;
        }
        let step = wanted.clamp(-2.0 * size, 2.0 * size) / square.sqrt();
        foot = [foot[0] + step * colour.gradient[0], foot[1] + step * colour.gradient[1]];
        colour = field.at(foot[0], foot[1], support);
    }
    let curvature = curvature(&colour, foot[0] + origin, size);
    // Nothing smaller than a particle is resolved: the sum of both curvatures stays below 2/D.
    let most = 2.0 / size;
    let curvature = if curvature.is_finite() { curvature.clamp(-most, most) } else { 0.0 };
    Found { curvature, tangent: if length > 0.0 { tangent } else { [0.0; 2] } }
}

/// kappa = -(c_rr c_z^2 - 2 c_r c_z c_rz + c_zz c_r^2)/|grad c|^3 - c_r/(R |grad c|), with c_rr for
/// c_r/R on the axis (method.md, section 9).
fn curvature(colour: &Colour, radius: f64, size: f64) -> f64 {
    let [r, z] = colour.gradient;
    let [rr, rz, zz] = colour.second;
    let length = r.hypot(z);
    let hoop = if radius.abs() > 1e-3 * size { r / radius } else { rr };
    -(rr * z * z - 2.0 * r * z * rz + zz * r * r) / length.powi(3) - hoop / length
}

impl Stage for CurvatureColour {
    fn name(&self) -> &'static str {
        "curvature"
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        if !world.clock.step.is_multiple_of(self.settings.interval) {
            return Ok(());
        }
        self.measure(world);
        self.store_pressure(world);
        self.store_slope(world);
        Ok(())
    }
}
