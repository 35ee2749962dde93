//! Normals and curvature from the colour field: where c = 1/2 along its gradient lies the surface.

use crate::colour_field::ColourField;
use crate::drops::{count, particles_of_drops};
use crate::equation_of_state::Packing;
use crate::fields;
use crate::rows::PackedState;
use crate::surface::{BOUNDARY, for_surface};
use crate::surface_interval::{COMPUTED, Tension};
use crate::surface_neighbours::SurfaceNeighbours;
use crate::surface_search::{Found, SHARPEST, Start, even, find};
use crate::wanted_size::MOST_REFINED;
use atomic_refcell::AtomicRefMut;
use meniscus_engine::field::clear;
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Read, Update, Write, bytes_of};
use meniscus_engine::wiring::Wiring;
use std::sync::{Arc, Mutex};

/// Settings of the colour-field curvature.
#[derive(Clone, Copy, Debug)]
pub struct ColourCurvature {
    /// The liquid's, and how often it is computed.
    pub tension: Tension,
    /// Support radius of the colour field in particle sizes. Between 10 and 12 the frequency of a drop
    /// changes by .02 %; a wider one keeps a drop at rest more quietly, a narrower one resolves necks.
    pub support: f64,
    /// Whether the gradient of the Laplace pressure along the surface is wanted, and the surface's tangent.
    pub with_slope: bool,
}

/// A drop of fewer particles, less than four across, has no shape to speak of, and no Laplace pressure: what
/// its curvature were taken for would drive it about.
const FEWEST: u32 = 12;

/// What varies along the surface.
#[derive(Clone, Copy)]
struct AlongSurface {
    slope: Update<f64>,
    slope_rate: Write<f64>,
    slope_last_rate: Update<f64>,
    tangent: [Write<f64>; 2],
}

/// The stage. It must follow the boundary detection of the same step, which takes up the particles in
/// the shared colour field.
pub struct CurvatureColour {
    settings: ColourCurvature,
    packing: Packing,
    field: Arc<Mutex<ColourField>>,
    position: [Read<f64>; 2],
    surface: Read<u32>,
    drop: Read<u32>,
    pressure: Update<f64>,
    rate: Write<f64>,
    last_rate: Update<f64>,
    offset: [Update<f64>; 2],
    along: Option<AlongSurface>,
    step_bound: f64,
    boundary: Vec<u32>,
    near_boundary: Vec<u32>,
    /// Whose values are set, and in the order that particles had when the list of that number was built.
    set: (u64, Vec<u32>),
    found: Vec<Found>,
    slopes: Vec<f64>,
    neighbours: SurfaceNeighbours,
}

impl CurvatureColour {
    /// Writes the Laplace pressure, its rate and, if wanted, its slope along the surface and the tangent.
    pub fn new(
        wiring: &mut Wiring,
        packing: Packing,
        settings: ColourCurvature,
        field: Arc<Mutex<ColourField>>,
    ) -> Self {
        wiring.stage("curvature");
        let size = 0.5 * packing.largest_size;
        CurvatureColour {
            settings,
            packing,
            field,
            position: fields::POSITION.map(|field| wiring.read(field)),
            surface: wiring.read(&fields::SURFACE),
            drop: wiring.read(&fields::DROP),
            pressure: wiring.update(&fields::LAPLACE_PRESSURE),
            rate: wiring.write(&fields::LAPLACE_PRESSURE_RATE),
            last_rate: wiring.update(&fields::LAPLACE_PRESSURE_LAST_RATE),
            offset: fields::SURFACE_OFFSET.map(|field| wiring.update(field)),
            step_bound: capillary_bound(&settings.tension, 0.25 * settings.support * size),
            along: settings.with_slope.then(|| AlongSurface {
                slope: wiring.update(&fields::LAPLACE_SLOPE),
                slope_rate: wiring.write(&fields::LAPLACE_SLOPE_RATE),
                slope_last_rate: wiring.update(&fields::LAPLACE_SLOPE_LAST_RATE),
                tangent: fields::SURFACE_TANGENT.map(|field| wiring.write(field)),
            }),
            boundary: Vec::new(),
            near_boundary: Vec::new(),
            set: (0, Vec::new()),
            found: Vec::new(),
            slopes: Vec::new(),
            neighbours: SurfaceNeighbours::default(),
        }
    }

    /// Looks for the surface from every boundary particle.
    fn measure(&mut self, world: &World) {
        let [r, z] = self.position.map(|field| world.store.read(field));
        let (packed, surface) = (PackedState(&world.rows), world.store.read(self.surface));
        let surface = &surface[..];
        self.boundary.clear();
        self.near_boundary.clear();
        for_surface(surface, |i| match surface[i] {
            BOUNDARY => self.boundary.push(i as u32),
            _ => self.near_boundary.push(i as u32),
        });
        let [offset_r, offset_z] = self.offset.map(|field| world.store.read(field));
        let (offset_r, offset_z) = (&offset_r[..], &offset_z[..]);
        self.found.clear();
        self.found.resize(self.boundary.len(), Found::default());
        let field = self.field.lock().expect("no stage panics while it holds the colour field");
        let (r, z, boundary) = (&r[..], &z[..], &self.boundary[..]);
        let (field, settings, packing) = (&*field, self.settings, self.packing);
        parallel::for_chunks_of(16, boundary.len(), &mut self.found[..], |start, found| {
            for (k, found) in found.iter_mut().enumerate() {
                let particle = boundary[start + k];
                let i = particle as usize;
                let size = packed.size(i).min(packing.largest_size);
                let support = settings.support * even(size, 0.5 * packing.largest_size);
                let known = field.known.binary_search_by_key(&particle, |(known, _)| *known);
                let offset = [offset_r[i], offset_z[i]];
                let start = match known {
                    _ if offset != [0.0; 2] => Start::Foot(offset),
                    Ok(place) => Start::Particle(field.known[place].1),
                    Err(_) => Start::Particle(field.at(r[i], z[i], support)),
                };
                *found = find(field, start, [r[i], z[i]], size, support, packing.domain.origin);
            }
        });
    }

    /// Spray has no Laplace pressure, nor does it take another drop's.
    fn leave_out_spray(&mut self, world: &World) {
        let drop = world.store.read(self.drop);
        if count(&drop) == 1 && drop.len() >= FEWEST as usize {
            return;
        }
        let particles = particles_of_drops(&drop, &world.arena);
        let is_spray = |i: u32| particles[drop[i as usize] as usize] < FEWEST;
        for (found, &i) in self.found.iter_mut().zip(&self.boundary) {
            if is_spray(i) {
                found.curvature = 0.0;
            }
        }
        self.near_boundary.retain(|&i| !is_spray(i));
    }

    /// Sets the Laplace pressure, and its rate where it was known before.
    fn store_pressure(&mut self, world: &World) {
        let elapsed = world.clock.time - world.clock.mark(COMPUTED);
        let packed = PackedState(&world.rows);
        let size = |i: u32| packed.size(i as usize).min(self.packing.largest_size);
        let mut columns = Columns {
            pressure: world.store.write(self.pressure),
            rate: world.store.write(self.rate),
            last_rate: world.store.write(self.last_rate),
            along: self.along.map(|along| AlongColumns {
                slope: world.store.write(along.slope),
                slope_rate: world.store.write(along.slope_rate),
                slope_last_rate: world.store.write(along.slope_last_rate),
                tangent: along.tangent.map(|field| world.store.write(field)),
            }),
            offset: self.offset.map(|field| world.store.write(field)),
        };
        let (boundary, near) = (&self.boundary, &self.near_boundary);
        let member = |k: usize| *boundary.get(k).unwrap_or_else(|| &near[k - boundary.len()]);
        let layer = &*world.arena.alloc_slice_fill_with(boundary.len() + near.len(), member);
        let before = |k: usize| {
            let i = layer[k] as usize;
            let along = columns.along.as_ref();
            let [slope, slope_rate] =
                along.map_or([0.0; 2], |along| [along.slope[i], along.slope_last_rate[i]]);
            [columns.pressure[i], columns.last_rate[i], slope, slope_rate]
        };
        let before = &*world.arena.alloc_slice_fill_with(layer.len(), before);
        let (order, mut set) = std::mem::take(&mut self.set);
        columns.clear((order == world.neighbours.builds()).then_some(&set[..]));
        for (k, &i) in self.boundary.iter().enumerate() {
            let Found { curvature, tangent, offset } = self.found[k];
            let bump = if self.found[k].tells_pressure() { self.found[k].bump(size(i)) } else { 0.0 };
            let pressure = self.settings.tension.surface_tension * (curvature + bump);
            columns.set(i, &AtSurface { pressure, slope: self.slopes[k], tangent, offset });
        }
        let [r, z] = self.position.map(|field| world.store.read(field));
        for &i in &self.near_boundary {
            columns.set(i, &self.beside([r[i as usize], z[i as usize]], size(i)));
        }
        let Columns { pressure, mut rate, mut last_rate, mut along, .. } = columns;
        for (&i, &[pressure_was, rate_was, slope_was, slope_rate_was]) in layer.iter().zip(before) {
            let (size, i) = (size(i), i as usize);
            let tension = &self.settings.tension;
            last_rate[i] = tension.rate([pressure_was, pressure[i]], elapsed, size);
            rate[i] = tension.carried_on([rate_was, last_rate[i]], size);
            if let Some(along) = &mut along
                && pressure_was != 0.0
            {
                // As fast as pressures change, their difference over a particle's size may.
                let now = tension.rate([slope_was * size, along.slope[i] * size], elapsed, size);
                along.slope_last_rate[i] = now / size;
                along.slope_rate[i] = tension.carried_on([slope_rate_was * size, now], size) / size;
            }
        }
        set.clear();
        set.extend_from_slice(layer);
        self.set = (world.neighbours.builds(), set);
    }

    /// Notes when the curvature was computed and until when it holds.
    fn set_marks(&self, world: &mut World) {
        let smallest = {
            let packed = PackedState(&world.rows);
            let with_surface =
                self.boundary.iter().zip(&self.found).filter(|(_, found)| found.tells_pressure());
            with_surface.map(|(&i, _)| packed.size(i as usize)).fold(self.packing.largest_size, f64::min)
        };
        self.settings.tension.note(&mut world.clock, smallest);
    }

    /// What belongs to a particle of some size beside the surface: that of the nearest boundary particle, carried on
    /// along the surface.
    fn beside(&self, [r, z]: [f64; 2], size: f64) -> AtSurface {
        let near = &self.neighbours;
        let is_known = |member: usize| self.found[near.source(member)].tells_pressure();
        let Some((member, way)) = near.nearest([r, z], 3.0 * self.packing.largest_size, is_known) else {
            return Default::default();
        };
        let k = near.source(member);
        let turned = |[r, z]: [f64; 2]| if near.is_mirrored(member) { [-r, z] } else { [r, z] };
        let (tangent, offset) = (turned(self.found[k].tangent), turned(self.found[k].offset));
        // Mirrored, the tangent would have the liquid on its other side.
        let direction = if near.is_mirrored(member) { -1.0 } else { 1.0 };
        let (tangent, slope) = (tangent.map(|t| direction * t), direction * self.slopes[k]);
        let pressure = self.settings.tension.surface_tension * self.found[k].curvature;
        let foot = [way[0] + offset[0], way[1] + offset[1]];
        let along = foot[0] * tangent[0] + foot[1] * tangent[1];
        // The slope's place is the boundary particle, the way to it is `way`.
        let carried = pressure - slope * (tangent[0] * way[0] + tangent[1] * way[1]);
        let most =
            SHARPEST * self.settings.tension.surface_tension / size.min(0.5 * self.packing.largest_size);
        let pressure = carried.clamp(-most, most);
        let offset = [foot[0] - along * tangent[0], foot[1] - along * tangent[1]];
        AtSurface { pressure, slope, tangent, offset }
    }

    /// dP_L/dt along the surface by weighted least squares over boundary particles within 3 D
    /// (method.md, section 10, "The surface error, later", T).
    fn measure_slope(&mut self, world: &World) {
        let [r, z] = self.position.map(|field| world.store.read(field));
        let packed = PackedState(&world.rows);
        let largest = self.packing.largest_size;
        self.neighbours.gather(&self.boundary, [&r, &z], 3.0 * largest, &self.packing.domain);
        let (near, boundary, found) = (&self.neighbours, &self.boundary[..], &self.found[..]);
        let tension = self.settings.tension.surface_tension;
        let slope = |k: usize| {
            if !found[k].tells_pressure() {
                return 0.0;
            }
            let own = packed.size(boundary[k] as usize).min(largest);
            let there = |member: u32| {
                let other = near.source(member as usize);
                found[other]
                    .tells_pressure()
                    .then(|| (packed.area(boundary[other] as usize), tension * found[other].curvature))
            };
            near.slope(k, tension * found[k].curvature, [3.0 * own, own], found[k].tangent, there)
        };
        self.slopes.clear();
        self.slopes.resize(boundary.len(), 0.0);
        parallel::for_chunks_of(32, boundary.len(), &mut self.slopes[..], |start, slopes| {
            for (k, slope_here) in slopes.iter_mut().enumerate() {
                *slope_here = slope(start + k);
            }
        });
    }
}

/// Laplace pressure, its slope, the surface's tangent and the way to it.
#[derive(Default)]
struct AtSurface {
    pressure: f64,
    slope: f64,
    tangent: [f64; 2],
    offset: [f64; 2],
}

/// What the stage writes.
struct Columns<'a> {
    pressure: AtomicRefMut<'a, [f64]>,
    rate: AtomicRefMut<'a, [f64]>,
    last_rate: AtomicRefMut<'a, [f64]>,
    along: Option<AlongColumns<'a>>,
    offset: [AtomicRefMut<'a, [f64]>; 2],
}

/// What of it varies along the surface.
struct AlongColumns<'a> {
    slope: AtomicRefMut<'a, [f64]>,
    slope_rate: AtomicRefMut<'a, [f64]>,
    slope_last_rate: AtomicRefMut<'a, [f64]>,
    tangent: [AtomicRefMut<'a, [f64]>; 2],
}

impl Columns<'_> {
    /// Sets to zero what is set, if it is known where that is.
    fn clear(&mut self, set: Option<&[u32]>) {
        let along = self.along.iter_mut().flat_map(|along| {
            let [tangent_r, tangent_z] = &mut along.tangent;
            [&mut along.slope, &mut along.slope_rate, &mut along.slope_last_rate, tangent_r, tangent_z]
        });
        let others =
            [&mut self.pressure, &mut self.rate, &mut self.last_rate].into_iter().chain(&mut self.offset);
        along.chain(others).for_each(|column| match set {
            Some(set) => set.iter().for_each(|&i| column[i as usize] = 0.0),
            None => clear(&mut column[..]),
        });
    }

    fn set(&mut self, particle: u32, here: &AtSurface) {
        let i = particle as usize;
        self.pressure[i] = here.pressure;
        for axis in 0..2 {
            self.offset[axis][i] = here.offset[axis];
        }
        if let Some(along) = &mut self.along {
            along.slope[i] = here.slope;
            for axis in 0..2 {
                along.tangent[axis][i] = here.tangent[axis];
            }
        }
    }
}

/// dt <= .25 sqrt(rho h^3/(2 pi sigma)) (method.md, section 6) with h the length that the curvature
/// resolves: shorter waves are not driven.
pub(crate) fn capillary_bound(tension: &Tension, length: f64) -> f64 {
    let Tension { density, surface_tension, .. } = tension;
    0.25 * (density * length.powi(3) / (2.0 * std::f64::consts::PI * surface_tension)).sqrt()
}

impl Stage for CurvatureColour {
    fn name(&self) -> &'static str {
        "curvature"
    }

    fn bytes(&self) -> usize {
        let numbers = bytes_of(&self.boundary) + bytes_of(&self.near_boundary);
        numbers
            + bytes_of(&self.set.1)
            + bytes_of(&self.found)
            + bytes_of(&self.slopes)
            + self.neighbours.bytes()
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        // Supports follow the sizes of the particles, and so does the length that is resolved, to whose power of 3/2 the bound is.
        let finest = (1.0 - world.clock.number(MOST_REFINED)).powf(0.75);
        world.clock.limit("surface tension", self.step_bound * finest);
        if !self.settings.tension.is_due(&world.clock) {
            return Ok(());
        }
        self.measure(world);
        self.leave_out_spray(world);
        self.measure_slope(world);
        self.store_pressure(world);
        self.set_marks(world);
        Ok(())
    }
}
