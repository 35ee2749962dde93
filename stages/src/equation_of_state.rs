//! Equation of state: pressure and sound speed from the density, and the packed rows for the pair pass.

use crate::fields;
use crate::record::{Flow, Gradient, image_of_flow, image_of_gradient};
use meniscus_engine::neighbours::Domain;
use meniscus_engine::parallel;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Read, Write};
use meniscus_engine::wiring::Wiring;
use std::f64::consts::PI;

/// Pressure as a function of density.
pub trait EquationOfState: Copy + Send + Sync + 'static {
    /// Pressure in Pa at a density in kg/m3.
    fn pressure(&self, density: f64) -> f64;
    /// Speed of sound in m/s at a density in kg/m3.
    fn sound_speed(&self, density: f64) -> f64;
}

/// P = C_0^2 (rho - rho_0) (method.md, section 5).
#[derive(Clone, Copy, Debug)]
pub struct Linear {
    /// C_0 in m/s.
    pub sound_speed: f64,
    /// rho_0 in kg/m3.
    pub reference_density: f64,
}

impl EquationOfState for Linear {
    fn pressure(&self, density: f64) -> f64 {
        self.sound_speed * self.sound_speed * (density - self.reference_density)
    }
    fn sound_speed(&self, _: f64) -> f64 {
        self.sound_speed
    }
}

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

/// Velocity gradients and kernel scale for the second row.
struct SecondRow {
    gradient: [Read<f64>; 4],
    rate: [Read<f64>; 4],
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
    reference_pressure: Read<f64>,
    second: Option<SecondRow>,
    size: Write<f64>,
    pressure: Write<f64>,
    sound_speed: Write<f64>,
}

impl<E: EquationOfState> State<E> {
    /// Rows of one slot line, or of two with the velocity gradient predicted for the present time.
    pub fn new(wiring: &mut Wiring, equation: E, packing: Packing, with_gradient: bool) -> Self {
        wiring.stage("equation-of-state");
        State {
            equation,
            packing,
            position: [wiring.read(&fields::RADIUS), wiring.read(&fields::AXIAL)],
            velocity: [
                wiring.read(&fields::VELOCITY_R),
                wiring.read(&fields::VELOCITY_Z),
            ],
            density: wiring.read(&fields::DENSITY),
            mass: wiring.read(&fields::MASS),
            reference_pressure: wiring.read(&fields::REFERENCE_PRESSURE),
            second: with_gradient.then(|| SecondRow::new(wiring)),
            size: wiring.write(&fields::SIZE),
            pressure: wiring.write(&fields::PRESSURE),
            sound_speed: wiring.write(&fields::SOUND_SPEED),
        }
    }

    fn pack_flow(&self, world: &mut World, rows_each: usize) {
        let store = &world.store;
        let [r, z] = self.position.map(|field| store.read(field));
        let [u, w] = self.velocity.map(|field| store.read(field));
        let (density, mass) = (store.read(self.density), store.read(self.mass));
        let reference = store.read(self.reference_pressure);
        let (mut size, mut pressure) = (store.write(self.size), store.write(self.pressure));
        let mut sound_speed = store.write(self.sound_speed);
        let columns = (&mut size[..], &mut pressure[..], &mut sound_speed[..]);
        let rows = Rows {
            rows: &mut world.rows.rows_mut()[..r.len() * rows_each],
            each: rows_each,
        };
        parallel::for_chunks(
            r.len(),
            (columns, rows),
            |start, ((size, pressure, sound_speed), rows)| {
                for (k, row) in rows.rows.chunks_exact_mut(rows_each).enumerate() {
                    let i = start + k;
                    let area =
                        mass[i] / (2.0 * PI * (r[i] + self.packing.domain.origin) * density[i]);
                    size[k] = area.sqrt();
                    pressure[k] = self.equation.pressure(density[i]) - reference[i];
                    sound_speed[k] = self.equation.sound_speed(density[i]);
                    row[0] = Flow {
                        r: r[i],
                        z: z[i],
                        reach: 2.0 * self.packing.theta * size[k].min(self.packing.largest_size),
                        area,
                        velocity_r: u[i],
                        velocity_z: w[i],
                        pressure: pressure[k],
                        impedance: density[i] * sound_speed[k],
                    }
                    .pack();
                }
            },
        );
    }
}

impl SecondRow {
    fn new(wiring: &mut Wiring) -> Self {
        let gradient = [
            &fields::GRADIENT_RR,
            &fields::GRADIENT_RZ,
            &fields::GRADIENT_ZR,
            &fields::GRADIENT_ZZ,
        ];
        let rate = [
            &fields::GRADIENT_RATE_RR,
            &fields::GRADIENT_RATE_RZ,
            &fields::GRADIENT_RATE_ZR,
            &fields::GRADIENT_RATE_ZZ,
        ];
        SecondRow {
            gradient: gradient.map(|field| wiring.read(field)),
            rate: rate.map(|field| wiring.read(field)),
            kernel_scale: wiring.read(&fields::KERNEL_SCALE),
        }
    }

    /// G^n = g^{n-1} + h s: the gradient of the step before, moved on to the present time
    /// (method.md, section 10, "One traversal a step").
    fn pack(&self, world: &mut World) {
        let elapsed = world.clock.previous_step_size;
        let store = &world.store;
        let gradient = self.gradient.map(|field| store.read(field));
        let rate = self.rate.map(|field| store.read(field));
        let scale = store.read(self.kernel_scale);
        let rows = Rows {
            rows: &mut world.rows.rows_mut()[..scale.len() * 2],
            each: 2,
        };
        parallel::for_chunks(scale.len(), rows, |start, rows| {
            for (k, row) in rows.rows.chunks_exact_mut(2).enumerate() {
                let i = start + k;
                let now = |c: usize| gradient[c][i] + elapsed * rate[c][i];
                row[1] = Gradient {
                    rr: now(0),
                    rz: now(1),
                    zr: now(2),
                    zz: now(3),
                    kernel_scale: scale[i],
                }
                .pack();
            }
        });
    }
}

impl<E: EquationOfState> Stage for State<E> {
    fn name(&self) -> &'static str {
        "equation-of-state"
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        let (particles, images) = (world.store.len(), world.neighbours.images().len());
        let rows_each = if self.second.is_some() { 2 } else { 1 };
        world.rows.resize(particles, images, rows_each);
        self.pack_flow(world, rows_each);
        if let Some(second) = &self.second {
            second.pack(world);
        }
        let (sources, copies) = world.rows.rows_mut().split_at_mut(particles * rows_each);
        for (image, copy) in world
            .neighbours
            .images()
            .iter()
            .zip(copies.chunks_exact_mut(rows_each))
        {
            let source = &sources[image.source as usize * rows_each..];
            copy[0] = image_of_flow(image, &self.packing.domain, &source[0]);
            if rows_each == 2 {
                copy[1] = image_of_gradient(image, &source[1]);
            }
        }
        Ok(())
    }
}

/// Rows of several slot lines per particle, to be cut at particles.
struct Rows<'a> {
    rows: &'a mut [meniscus_engine::lanes::Row],
    each: usize,
}

impl parallel::Split for Rows<'_> {
    fn split(self, at: usize) -> (Self, Self) {
        let (left, right) = self.rows.split_at_mut(at * self.each);
        (
            Rows {
                rows: left,
                each: self.each,
            },
            Rows {
                rows: right,
                each: self.each,
            },
        )
    }
}
