//! Equation of state: sound speed of every particle, and the packed rows for the pair pass, which hold size and pressure.

use crate::fields;
use crate::geometry::Support;
use crate::liquids::EquationOfState;
use crate::record::{Deformation, Flow, Precision};
use crate::reference_pressure::FIRST_REFERENCE;
use crate::rows::{Rest, RowState, StateRow, image_of_double, image_of_single};
use crate::sort_bin::WIDEST_SKIN;
use meniscus_engine::domain::{Domain, Image};
use meniscus_engine::group::{Around, Chunk, ChunkStage, Partial};
use meniscus_engine::lanes::{Lanes, Row, SingleRow, WIDTH};
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, World};
use meniscus_engine::store::{Read, Write};
use meniscus_engine::wiring::Wiring;
use std::cell::Ref;
use std::f64::consts::PI;
use std::ops::Range;

/// How particles become rows.
#[derive(Clone, Copy, Debug)]
pub struct Packing {
    /// Axis and period.
    pub domain: Domain,
    /// Smoothing length over the sum of two particles' sizes.
    pub theta: f64,
    /// Largest particle size for which the support grows, m: near the axis D grows without bound.
    pub largest_size: f64,
}

impl Packing {
    /// The unit of length of the rows, m: with that of single precision, a power of two, no product of a pair
    /// runs out of its range.
    pub fn unit(&self, precision: Precision) -> f64 {
        match precision {
            Precision::Double => 1.0,
            Precision::Mixed => (0.5 * self.largest_size).log2().floor().exp2(),
        }
    }

    /// V = m/(2 pi R rho), m2, of a particle at r (m) with its density (kg/m3) and mass (kg).
    #[inline(always)]
    pub fn area(&self, r: f64, density: f64, mass: f64) -> f64 {
        mass / (2.0 * PI * (r + self.domain.origin) * density)
    }

    /// D = sqrt(V), m.
    #[inline(always)]
    pub fn size(&self, r: f64, density: f64, mass: f64) -> f64 {
        self.area(r, density, mass).sqrt()
    }

    /// Half the support radius of a pair of equals of that size, 2 theta D, m.
    #[inline(always)]
    pub fn reach(&self, size: f64) -> f64 {
        2.0 * self.theta * size.min(self.largest_size)
    }

    /// How far anyone may have moved since the list was built, m.
    pub fn slack(&self) -> f64 {
        0.25 * WIDEST_SKIN * self.largest_size
    }

    /// The supports of pairs, in the rows' unit of length.
    pub fn support(&self, precision: Precision) -> Support {
        Support { theta: self.theta, largest_size: self.largest_size / self.unit(precision) }
    }
}

/// What rows hold besides the flow state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Besides {
    /// Nothing.
    Nothing,
    /// The kernel scale.
    KernelScale,
    /// The kernel scale, and the rate of deformation predicted for the present time.
    Deformation,
    /// Kernel scale and density.
    Density,
}

/// Rate of deformation and how fast it changes.
#[derive(Clone)]
struct DeformationFields {
    deformation: [Read<f64>; 3],
    change: [Read<f64>; 3],
}

/// When the state is evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum When {
    /// At the end of a step, for the next one, while the particles lie in the cache.
    Ahead,
    /// At the start of a step where that doesn't hold: it is the first one, the list was built anew, particles were split, merged
    /// or evened, or somebody has set columns from outside.
    Anew,
}

impl When {
    fn name(self) -> &'static str {
        match self {
            When::Ahead => "equation-of-state",
            When::Anew => "state-anew",
        }
    }
}

/// The stage.
#[derive(Clone)]
pub struct State<E> {
    equation: E,
    packing: Packing,
    position: [Read<f64>; 2],
    velocity: [Read<f64>; 2],
    density: Read<f64>,
    mass: Read<f64>,
    energy: Option<Read<f64>>,
    reference_pressure: Read<f64>,
    /// That of the first drop, Pa.
    first_reference: f64,
    besides: Besides,
    kernel_scale: Option<Read<f64>>,
    deformation: Option<DeformationFields>,
    precision: Precision,
    /// The unit of length of the rows, m.
    unit: f64,
    /// None where it is constant.
    sound_speed: Option<Write<f64>>,
    when: When,
    /// From the rates of deformation to the time of the rows, s.
    elapsed: f64,
}

impl<E: EquationOfState> State<E> {
    /// Packs rows at the start of a step where that is needed.
    pub fn anew(
        wiring: &mut Wiring,
        equation: E,
        packing: Packing,
        besides: Besides,
        precision: Precision,
    ) -> Self {
        wiring.stage(When::Anew.name());
        let is_constant = equation.constant_sound_speed().is_some();
        State {
            equation,
            packing,
            position: fields::POSITION.map(|field| wiring.read(field)),
            velocity: fields::VELOCITY.map(|field| wiring.read(field)),
            density: wiring.read(&fields::DENSITY),
            mass: wiring.read(&fields::MASS),
            energy: E::WITH_ENERGY.then(|| wiring.read(&fields::TOTAL_ENERGY)),
            reference_pressure: wiring.read(&fields::REFERENCE_PRESSURE),
            first_reference: 0.0,
            besides,
            kernel_scale: (besides != Besides::Nothing).then(|| wiring.read(&fields::KERNEL_SCALE)),
            deformation: (besides == Besides::Deformation).then(|| DeformationFields::new(wiring)),
            precision,
            unit: packing.unit(precision),
            sound_speed: (!is_constant).then(|| wiring.write(&fields::SOUND_SPEED)),
            when: When::Anew,
            elapsed: 0.0,
        }
    }

    /// The same at the end of every step, for the next one.
    pub fn ahead(self, wiring: &mut Wiring) -> Self {
        wiring.repeat(When::Anew.name(), When::Ahead.name());
        State { when: When::Ahead, ..self }
    }

    /// Sound speed of the particles of a chunk, and their rows; by how much, m, any reach has grown over that in the rows
    /// before.
    fn evaluate<R: StateRow>(&self, chunk: &Chunk) -> f64 {
        let [r, z] = self.position.map(|field| chunk.read(field));
        let [u, w] = self.velocity.map(|field| chunk.read(field));
        let (density, mass) = (chunk.read(self.density), chunk.read(self.mass));
        let reference = chunk.read(self.reference_pressure);
        let energy = self.energy.map(|field| chunk.read(field));
        let kernel_scale = self.kernel_scale.map(|field| chunk.read(field));
        let deformation = self.deformation.as_ref().map(|fields| fields.columns(chunk));
        let mut sound_speeds = self.sound_speed.map(|field| chunk.write(field));
        let mut rows = chunk.rows();
        let mut growth = Lanes::ZERO;
        let largest = Lanes::splat(self.packing.largest_size);
        for (k, rows) in R::of(&mut rows).chunks_mut(WIDTH).enumerate() {
            let range = k * WIDTH..k * WIDTH + rows.len();
            let of = |column: &[f64], fill| Lanes::load_or(&column[range.clone()], fill).to_array();
            let (r, z, u, w) = (of(&r, 1.0), of(&z, 0.0), of(&u, 0.0), of(&w, 0.0));
            let (density, mass, reference) = (of(&density, 1.0), of(&mass, 1.0), of(&reference, 0.0));
            let energy = energy.as_ref().map(|energy| of(energy, 0.0));
            let internal = |i: usize| match &energy {
                Some(energy) => energy[i] - 0.5 * (u[i] * u[i] + w[i] * w[i]),
                None => 0.0,
            };
            let radius = Lanes::load(&r) + Lanes::splat(self.packing.domain.origin);
            let around = Lanes::splat(2.0 * PI) * radius * Lanes::load(&density);
            let size = (Lanes::load(&mass) / around).sqrt();
            let before = |i: usize| rows.get(i).map_or(f64::MAX, |row| row.least_size(self.unit));
            let before = Lanes::load(&std::array::from_fn::<f64, WIDTH, _>(before));
            growth = growth.max(size.min(largest) - before.min(largest));
            let pressure: [f64; WIDTH] = std::array::from_fn(|i| {
                self.equation.pressure(density[i], internal(i)) - (self.first_reference + reference[i])
            });
            let sound_speed: [f64; WIDTH] =
                std::array::from_fn(|i| self.equation.sound_speed(density[i], internal(i)));
            if let Some(sound_speeds) = &mut sound_speeds {
                sound_speeds[range.clone()].copy_from_slice(&sound_speed[..rows.len()]);
            }
            let flow = Flow {
                r,
                z,
                size: size.to_array(),
                velocity_r: u,
                velocity_z: w,
                pressure,
                impedance: std::array::from_fn(|i| density[i] * sound_speed[i]),
            };
            let rest = match &deformation {
                Some(columns) => Rest::Deformation(columns.predicted(range.clone(), self.elapsed)),
                None if self.besides == Besides::Density => Rest::Density(density),
                None => Rest::Nothing,
            };
            let kernel_scale = kernel_scale.as_ref().map_or([1.0; WIDTH], |column| of(column, 1.0));
            R::pack(&RowState { flow, kernel_scale, rest }, rows, self.unit);
        }
        2.0 * self.packing.theta * growth.to_array().into_iter().fold(0.0, f64::max)
    }

    /// The rows of images.
    fn mirror(&self, world: &mut World) {
        let particles = world.store.len();
        let (images, domain, unit) = (world.neighbours.images(), &self.packing.domain, self.unit);
        let deforms = self.besides == Besides::Deformation;
        match self.precision {
            Precision::Double => copy_rows(images, &mut world.rows.double, particles, |image, row| {
                image_of_double(image, domain, deforms, row)
            }),
            Precision::Mixed => copy_rows(images, &mut world.rows.single, particles, |image, row| {
                image_of_single(image, domain, unit, row)
            }),
        }
    }
}

/// Writes the rows of images behind those of the particles.
fn copy_rows<R: Send + Sync>(
    images: &[Image],
    rows: &mut [R],
    particles: usize,
    copy: impl Fn(&Image, &R) -> R + Sync,
) {
    let (own, copies) = rows.split_at_mut(particles);
    parallel::for_chunks(images.len(), (images, copies), |_, (images, copies)| {
        for (image, row) in images.iter().zip(copies) {
            *row = copy(image, &own[image.source as usize]);
        }
    });
}

impl DeformationFields {
    fn new(wiring: &mut Wiring) -> Self {
        DeformationFields {
            deformation: fields::DEFORMATION.map(|field| wiring.read(field)),
            change: fields::DEFORMATION_CHANGE.map(|field| wiring.read(field)),
        }
    }

    fn columns<'a>(&self, chunk: &'a Chunk) -> DeformationColumns<'a> {
        DeformationColumns {
            deformation: self.deformation.map(|field| chunk.read(field)),
            change: self.change.map(|field| chunk.read(field)),
        }
    }
}

/// Those of a chunk.
struct DeformationColumns<'a> {
    deformation: [Ref<'a, [f64]>; 3],
    change: [Ref<'a, [f64]>; 3],
}

impl DeformationColumns<'_> {
    /// G^n = g^{n-1} + h s: the gradient of the step before, moved on by h to the present time
    /// (method.md, section 10, "One traversal a step").
    #[inline(always)]
    fn predicted(&self, range: Range<usize>, elapsed: f64) -> Deformation<[f64; WIDTH]> {
        let component = |c: usize| {
            let of = |column: &[f64]| Lanes::load_or(&column[range.clone()], 0.0);
            Lanes::splat(elapsed).mul_add(of(&self.change[c]), of(&self.deformation[c])).to_array()
        };
        Deformation { rr: component(0), shear: component(1), zz: component(2) }
    }
}

impl<E: EquationOfState> ChunkStage for State<E> {
    fn name(&self) -> &'static str {
        self.when.name()
    }

    fn is_due(&self, world: &World) -> bool {
        self.when == When::Ahead || !world.rows.are_current || world.store.is_changed()
    }

    fn packs_rows(&self) -> bool {
        true
    }

    fn prepare(&mut self, world: &mut World) -> Result<(), Fault> {
        let (particles, images) = (world.store.len(), world.neighbours.images().len());
        match self.precision {
            Precision::Double => world.rows.resize(particles, images),
            Precision::Mixed => world.rows.resize_single(particles, images),
        }
        world.rows.unit = self.unit;
        self.first_reference = world.clock.number(FIRST_REFERENCE);
        self.elapsed = match (self.when, world.clock.bound()) {
            (When::Ahead, Some(bound)) => bound.step_size,
            _ => world.clock.previous_step_size,
        };
        Ok(())
    }

    /// By how much any reach has grown since the step before, m.
    fn chunk(&self, _: &Around, chunk: &Chunk) -> Partial {
        let growth = match self.precision {
            Precision::Double => self.evaluate::<Row>(chunk),
            Precision::Mixed => self.evaluate::<SingleRow>(chunk),
        };
        [growth, 0.0]
    }

    fn combine(&self, left: Partial, right: Partial) -> Partial {
        [left[0].max(right[0]), 0.0]
    }

    fn finish(&mut self, world: &mut World, [growth, _]: Partial) -> Result<(), Fault> {
        if self.when == When::Ahead {
            world.neighbours.note_motion(growth);
        }
        self.mirror(world);
        world.rows.are_current = true;
        world.store.forget_changes();
        Ok(())
    }
}
