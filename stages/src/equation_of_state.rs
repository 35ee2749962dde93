//! Equation of state: pressure and sound speed of every particle, and the packed rows for the pair pass.

use crate::fields;
use crate::liquids::EquationOfState;
use crate::record::{Deformation, Flow, Precision};
use crate::rows::{FirstPart, SecondPart, image_of_first, image_of_second, image_of_single};
use meniscus_engine::domain::Domain;
use meniscus_engine::lanes::{HalfRow, Lanes, Row, SingleRow, WIDTH};
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Read, Write};
use meniscus_engine::wiring::Wiring;
use std::f64::consts::PI;

/// How particles become rows.
#[derive(Clone, Copy, Debug)]
pub struct Packing {
    /// Axis and period.
    pub domain: Domain,
    /// Smoothing length parameter.
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

    /// D = sqrt(V), m, of a particle at r (m) with its density (kg/m3) and mass (kg).
    #[inline(always)]
    pub fn size(&self, r: f64, density: f64, mass: f64) -> f64 {
        (mass / (2.0 * PI * (r + self.domain.origin) * density)).sqrt()
    }

    /// Half the support radius of a pair of equals, 2 theta D, m.
    #[inline(always)]
    pub fn reach(&self, r: f64, density: f64, mass: f64) -> f64 {
        2.0 * self.theta * self.size(r, density, mass).min(self.largest_size)
    }
}

/// What the second half of a row holds, if anything.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Second {
    /// Nothing: there is no second half.
    Nothing,
    /// The rate of deformation predicted for the present time, and the kernel scale.
    Deformation,
    /// Density and kernel scale.
    Density,
}

/// The fields of the second row.
enum SecondRow {
    Deformation(DeformationFields),
    /// The kernel scale; the density is at hand.
    Density(Read<f64>),
}

/// Rate of deformation and kernel scale for the second row.
struct DeformationFields {
    deformation: [Read<f64>; 3],
    change: [Read<f64>; 3],
    kernel_scale: Read<f64>,
}

/// The stage.
pub struct State<E> {
    equation: E,
    packing: Packing,
    position: [Read<f64>; 2],
    velocity: [Read<f64>; 2],
    density: Read<f64>,
    mass: Read<f64>,
    energy: Option<Read<f64>>,
    reference_pressure: Read<f64>,
    second: Option<SecondRow>,
    precision: Precision,
    /// The unit of length of the rows, m.
    unit: f64,
    size: Write<f64>,
    pressure: Write<f64>,
    sound_speed: Write<f64>,
}

impl<E: EquationOfState> State<E> {
    /// Packs rows with the given second half.
    pub fn new(
        wiring: &mut Wiring,
        equation: E,
        packing: Packing,
        second: Second,
        precision: Precision,
    ) -> Self {
        wiring.stage("equation-of-state");
        State {
            equation,
            packing,
            position: [wiring.read(&fields::RADIUS), wiring.read(&fields::AXIAL)],
            velocity: [wiring.read(&fields::VELOCITY_R), wiring.read(&fields::VELOCITY_Z)],
            density: wiring.read(&fields::DENSITY),
            mass: wiring.read(&fields::MASS),
            energy: E::WITH_ENERGY.then(|| wiring.read(&fields::TOTAL_ENERGY)),
            reference_pressure: wiring.read(&fields::REFERENCE_PRESSURE),
            second: SecondRow::new(wiring, second),
            precision,
            unit: packing.unit(precision),
            size: wiring.write(&fields::SIZE),
            pressure: wiring.write(&fields::PRESSURE),
            sound_speed: wiring.write(&fields::SOUND_SPEED),
        }
    }

    /// Size, pressure and sound speed of every particle, and its row.
    fn evaluate<R: FirstPart>(&self, world: &mut World) {
        let store = &world.store;
        let [r, z] = self.position.map(|field| store.read(field));
        let [u, w] = self.velocity.map(|field| store.read(field));
        let (density, mass) = (store.read(self.density), store.read(self.mass));
        let reference = store.read(self.reference_pressure);
        let energy = self.energy.map(|field| store.read(field));
        let (mut size, mut pressure) = (store.write(self.size), store.write(self.pressure));
        let mut sound_speed = store.write(self.sound_speed);
        let columns = (
            (&r[..], &z[..], &u[..], &w[..]),
            (&density[..], &mass[..], &reference[..], energy.as_deref()),
            (&mut size[..], &mut pressure[..], &mut sound_speed[..]),
            &mut R::table(&mut world.rows)[..r.len()],
        );
        parallel::for_chunks(r.len(), columns, |_, (motion, state, results, rows)| {
            for (k, rows) in rows.chunks_mut(WIDTH).enumerate() {
                let range = k * WIDTH..k * WIDTH + rows.len();
                let of = |column: &[f64], fill| Lanes::load_or(&column[range.clone()], fill).to_array();
                let (r, z, u, w) =
                    (of(motion.0, 1.0), of(motion.1, 0.0), of(motion.2, 0.0), of(motion.3, 0.0));
                let (density, mass, reference) = (of(state.0, 1.0), of(state.1, 1.0), of(state.2, 0.0));
                let energy = state.3.map(|energy| of(energy, 0.0));
                let internal = |i: usize| match &energy {
                    Some(energy) => energy[i] - 0.5 * (u[i] * u[i] + w[i] * w[i]),
                    None => 0.0,
                };
                let radius = Lanes::load(&r) + Lanes::splat(self.packing.domain.origin);
                let around = Lanes::splat(2.0 * PI) * radius * Lanes::load(&density);
                let size = (Lanes::load(&mass) / around).sqrt().to_array();
                let pressure: [f64; WIDTH] =
                    std::array::from_fn(|i| self.equation.pressure(density[i], internal(i)) - reference[i]);
                let sound_speed: [f64; WIDTH] =
                    std::array::from_fn(|i| self.equation.sound_speed(density[i], internal(i)));
                for (column, values) in
                    [(&mut *results.0, &size), (&mut *results.1, &pressure), (&mut *results.2, &sound_speed)]
                {
                    column[range.clone()].copy_from_slice(&values[..rows.len()]);
                }
                let flow = Flow {
                    r,
                    z,
                    reach: size
                        .map(|size: f64| 2.0 * self.packing.theta * size.min(self.packing.largest_size)),
                    area: size.map(|size| size * size),
                    velocity_r: u,
                    velocity_z: w,
                    pressure,
                    impedance: std::array::from_fn(|i| density[i] * sound_speed[i]),
                };
                R::pack(&flow, rows, self.unit);
            }
        });
    }
}

impl<E: EquationOfState> State<E> {
    fn pack_double(&self, world: &mut World) {
        let (particles, images) = (world.store.len(), world.neighbours.images().len());
        world.rows.resize(particles, images, self.second.is_some());
        self.evaluate::<Row>(world);
        self.pack_second::<HalfRow>(world);
        let (images, domain) = (world.neighbours.images(), &self.packing.domain);
        let (own, copies) = world.rows.first.split_at_mut(particles);
        parallel::for_chunks(images.len(), (images, copies), |_, (images, copies)| {
            for (image, copy) in images.iter().zip(copies) {
                *copy = image_of_first(image, domain, &own[image.source as usize]);
            }
        });
        if self.second.is_some() {
            let (own, copies) = world.rows.second.split_at_mut(particles);
            parallel::for_chunks(images.len(), (images, copies), |_, (images, copies)| {
                for (image, copy) in images.iter().zip(copies) {
                    *copy = image_of_second(image, &own[image.source as usize]);
                }
            });
        }
    }

    fn pack_mixed(&self, world: &mut World) {
        let (particles, images) = (world.store.len(), world.neighbours.images().len());
        let (domain, unit) = (&self.packing.domain, self.unit);
        world.rows.resize_single(particles, images);
        self.evaluate::<SingleRow>(world);
        self.pack_second::<SingleRow>(world);
        let images = world.neighbours.images();
        let (own, copies) = world.rows.single.split_at_mut(particles);
        parallel::for_chunks(images.len(), (images, copies), |_, (images, copies)| {
            for (image, copy) in images.iter().zip(copies) {
                *copy = image_of_single(image, domain, unit, &own[image.source as usize]);
            }
        });
    }

    fn pack_density<R: SecondPart>(&self, world: &mut World, kernel_scale: Read<f64>) {
        let (density, scale) = (world.store.read(self.density), world.store.read(kernel_scale));
        let columns = (&density[..], &scale[..], &mut R::table(&mut world.rows)[..density.len()]);
        parallel::for_chunks(density.len(), columns, |_, (density, scale, rows)| {
            for ((row, density), scale) in rows.iter_mut().zip(density).zip(scale) {
                row.set_density(*density, *scale);
            }
        });
    }

    /// The second rows, or the second part of rows of single precision.
    fn pack_second<R: SecondPart>(&self, world: &mut World) {
        match &self.second {
            Some(SecondRow::Deformation(fields)) => fields.pack::<R>(world, self.unit),
            Some(SecondRow::Density(scale)) => self.pack_density::<R>(world, *scale),
            None => {}
        }
    }
}

impl SecondRow {
    fn new(wiring: &mut Wiring, second: Second) -> Option<Self> {
        match second {
            Second::Nothing => None,
            Second::Deformation => Some(SecondRow::Deformation(DeformationFields::new(wiring))),
            Second::Density => Some(SecondRow::Density(wiring.read(&fields::KERNEL_SCALE))),
        }
    }
}

impl DeformationFields {
    fn new(wiring: &mut Wiring) -> Self {
        let deformation = [&fields::DEFORMATION_RR, &fields::DEFORMATION_SHEAR, &fields::DEFORMATION_ZZ];
        let change = [
            &fields::DEFORMATION_CHANGE_RR,
            &fields::DEFORMATION_CHANGE_SHEAR,
            &fields::DEFORMATION_CHANGE_ZZ,
        ];
        DeformationFields {
            deformation: deformation.map(|field| wiring.read(field)),
            change: change.map(|field| wiring.read(field)),
            kernel_scale: wiring.read(&fields::KERNEL_SCALE),
        }
    }

    /// G^n = g^{n-1} + h s: the gradient of the step before, moved on to the present time
    /// (method.md, section 10, "One traversal a step").
    fn pack<R: SecondPart>(&self, world: &mut World, unit: f64) {
        let elapsed = world.clock.previous_step_size;
        let store = &world.store;
        let [rr, shear, zz] = self.deformation.map(|field| store.read(field));
        let [change_rr, change_shear, change_zz] = self.change.map(|field| store.read(field));
        let scale = store.read(self.kernel_scale);
        let columns = (
            (&rr[..], &shear[..], &zz[..], &scale[..]),
            (&change_rr[..], &change_shear[..], &change_zz[..]),
            &mut R::table(&mut world.rows)[..rr.len()],
        );
        parallel::for_chunks(rr.len(), columns, |_, ((rr, shear, zz, scale), change, rows)| {
            let len = rows.len();
            let (rr, shear, zz, scale) = (&rr[..len], &shear[..len], &zz[..len], &scale[..len]);
            let change = (&change.0[..len], &change.1[..len], &change.2[..len]);
            for i in 0..len {
                let deformation = Deformation {
                    rr: rr[i] + elapsed * change.0[i],
                    shear: shear[i] + elapsed * change.1[i],
                    zz: zz[i] + elapsed * change.2[i],
                    kernel_scale: scale[i],
                };
                rows[i].set_deformation(&deformation, unit);
            }
        });
    }
}

impl<E: EquationOfState> Stage for State<E> {
    fn name(&self) -> &'static str {
        "equation-of-state"
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        match self.precision {
            Precision::Double => self.pack_double(world),
            Precision::Mixed => self.pack_mixed(world),
        }
        Ok(())
    }
}
