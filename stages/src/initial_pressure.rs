//! The pressure at the start: every drop begins at the mean Laplace pressure of its surface.

use crate::components::components;
use crate::equation_of_state::Packing;
use crate::fields;
use crate::liquids::EquationOfState;
use crate::reference_pressure::FIRST_REFERENCE;
use crate::rows::PackedState;
use crate::surface::BOUNDARY;
use meniscus_engine::pipeline::{Fault, Stage, World};
use meniscus_engine::store::{Read, Update, Write};
use meniscus_engine::wiring::Wiring;

/// Sets density, and reference pressure if there is one, so that a drop neither rings nor expands at
/// the start. The mean over boundary particles is weighted by their mass, that is by surface area.
pub struct InitialPressure<E> {
    equation: E,
    packing: Packing,
    with_reference: bool,
    identity: Read<u32>,
    position: [Read<f64>; 2],
    /// Total energy and velocity, where the pressure depends on the energy inside.
    energy: Option<[Read<f64>; 3]>,
    mass: Read<f64>,
    surface: Read<u32>,
    laplace_pressure: Read<f64>,
    density: Update<f64>,
    reference: Write<f64>,
}

impl<E: EquationOfState> InitialPressure<E> {
    /// Runs once, after the curvature has been computed for the particles at rest.
    pub fn new(wiring: &mut Wiring, equation: E, packing: Packing, with_reference: bool) -> Self {
        wiring.stage("initial-pressure");
        let energy = [&fields::TOTAL_ENERGY, &fields::VELOCITY_R, &fields::VELOCITY_Z];
        InitialPressure {
            equation,
            packing,
            with_reference,
            identity: wiring.read(&fields::IDENTITY),
            position: fields::POSITION.map(|field| wiring.read(field)),
            energy: E::WITH_ENERGY.then(|| energy.map(|field| wiring.read(field))),
            mass: wiring.read(&fields::MASS),
            surface: wiring.read(&fields::SURFACE),
            laplace_pressure: wiring.read(&fields::LAPLACE_PRESSURE),
            density: wiring.update(&fields::DENSITY),
            reference: wiring.write(&fields::REFERENCE_PRESSURE),
        }
    }
}

impl<E: EquationOfState> Stage for InitialPressure<E> {
    fn name(&self) -> &'static str {
        "initial-pressure"
    }

    fn run(&mut self, world: &mut World) -> Result<(), Fault> {
        let store = &world.store;
        let [r, z] = self.position.map(|field| store.read(field));
        let packed = PackedState(&world.rows);
        let reach = |i: usize| self.packing.reach(packed.size(i));
        let component = components(&world.neighbours, &self.packing.domain, [&r, &z], reach, &world.arena);
        let (mass, surface) = (store.read(self.mass), store.read(self.surface));
        let laplace = store.read(self.laplace_pressure);
        let sums = world.arena.alloc_slice_fill_copy(r.len(), [0.0f64; 2]);
        for (i, &root) in component.iter().enumerate() {
            if surface[i] == BOUNDARY {
                sums[root as usize][0] += mass[i] * laplace[i];
                sums[root as usize][1] += mass[i];
            }
        }
        let (mut density, mut reference) = (store.write(self.density), store.write(self.reference));
        let pressure_of = |root: u32| {
            let [upper, lower] = sums[root as usize];
            if lower > 0.0 { upper / lower } else { 0.0 }
        };
        let energy = self.energy.map(|fields| fields.map(|field| store.read(field)));
        let internal = |i: usize| {
            energy.as_ref().map_or(0.0, |[energy, u, w]| energy[i] - 0.5 * (u[i] * u[i] + w[i] * w[i]))
        };
        let first = component.first().map_or(0.0, |&root| pressure_of(root));
        for (i, &root) in component.iter().enumerate() {
            let pressure = pressure_of(root);
            // The linear relation about the present density; exact for the linear equation of state.
            let sound_speed = self.equation.sound_speed(density[i], internal(i));
            let excess = pressure - self.equation.pressure(density[i], internal(i));
            density[i] += excess / (sound_speed * sound_speed);
            let difference = if self.with_reference { pressure - first } else { 0.0 };
            if reference[i] != difference {
                reference[i] = difference;
            }
        }
        if self.with_reference {
            world.clock.set_number(FIRST_REFERENCE, first);
        }
        // Too low a sound speed makes the pressure ask for a density that there is not.
        match (0..r.len()).find(|&i| !(density[i] > 0.0 && density[i].is_finite())) {
            None => Ok(()),
            Some(i) => Err(Fault {
                stage: "initial-pressure",
                particle: store.read(self.identity)[i],
                quantity: "density",
                value: density[i],
                note: String::new(),
                r: r[i],
                z: z[i],
                step: world.clock.step,
            }),
        }
    }
}
