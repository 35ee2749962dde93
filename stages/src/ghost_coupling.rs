//! Ghost coupling: every surface particle meets one ghost that holds the Laplace pressure.

use crate::fields;
use crate::reference_pressure::FIRST_REFERENCE;
use crate::rows::PackedState;
use crate::sound_speed::SoundSpeed;
use crate::surface::{for_surface, length, outward};
use crate::surface_interval::COMPUTED;
use crate::work::Work;
use meniscus_engine::field::clear;
use meniscus_engine::group::{Around, Chunk, ChunkStage, Partial};
use meniscus_engine::pipeline::{Fault, World};
use meniscus_engine::store::{Add, Read, Write};
use meniscus_engine::wiring::Wiring;

/// Impedance of a ghost relative to its particle's: nearly vacuum (method.md, section 8).
const IMPEDANCE_RATIO: f64 = 1e-6;

/// The stage: d eps += 2 (U* - U_a . e)|bw| and the surface force -2 P* bw, with e = bw/|bw|,
/// U_g = U_a and P_g = P_L, and with the
/// energy equation rho dE += -2 P* U*|bw| (equations (24) to (26); method.md, section 8).
///
/// The tension deficit (f in `tension_balance`) acts where bw points outward: its part across the surface
/// belongs to P_g, that along it is the force -2 (bw . n)(f . t) t.
pub struct GhostCoupling {
    laplace: Read<f64>,
    laplace_rate: Read<f64>,
    surface: Read<u32>,
    weight: [Read<f64>; 2],
    balance: Option<Balance>,
    reference_pressure: Read<f64>,
    density: Read<f64>,
    sound_speed: SoundSpeed,
    strain_rate: Add<f64>,
    force: [Write<f64>; 2],
    work: Option<Work>,
    /// Number of the list with which the force was last cleared, and whether it is in this step.
    cleared: (u64, bool),
}

/// The tension deficit, and the tangent that parts it.
struct Balance {
    deficit: [Read<f64>; 2],
    tangent: [Read<f64>; 2],
}

impl GhostCoupling {
    /// Ghosts hold the Laplace pressure, and `with_balance` the tension deficit; `constant_sound_speed` is the liquid's in
    /// m/s, if it has one.
    pub fn new(
        wiring: &mut Wiring,
        constant_sound_speed: Option<f64>,
        with_balance: bool,
        with_energy: bool,
    ) -> Self {
        wiring.stage("ghost-coupling");
        GhostCoupling {
            laplace: wiring.read(&fields::LAPLACE_PRESSURE),
            laplace_rate: wiring.read(&fields::LAPLACE_PRESSURE_RATE),
            surface: wiring.read(&fields::SURFACE),
            weight: fields::GHOST_WEIGHT.map(|field| wiring.read(field)),
            balance: with_balance.then(|| Balance {
                deficit: fields::TENSION_DEFICIT.map(|field| wiring.read(field)),
                tangent: fields::SURFACE_TANGENT.map(|field| wiring.read(field)),
            }),
            reference_pressure: wiring.read(&fields::REFERENCE_PRESSURE),
            density: wiring.read(&fields::DENSITY),
            sound_speed: SoundSpeed::new(wiring, constant_sound_speed),
            strain_rate: wiring.add(&fields::STRAIN_RATE),
            force: fields::SURFACE_FORCE.map(|field| wiring.write(field)),
            work: Work::new(wiring, with_energy),
            cleared: (0, true),
        }
    }
}

impl ChunkStage for GhostCoupling {
    fn name(&self) -> &'static str {
        "ghost-coupling"
    }

    fn prepare(&mut self, world: &mut World) -> Result<(), Fault> {
        // Away from the surface the force stays zero until the surface is found anew or particles change their order.
        let (clock, builds) = (&world.clock, world.neighbours.builds());
        self.cleared = (builds, builds != self.cleared.0 || clock.mark(COMPUTED) == clock.time);
        Ok(())
    }

    fn chunk(&self, around: &Around, chunk: &Chunk) -> Partial {
        let [weight_r, weight_z] = self.weight.map(|field| chunk.read(field));
        let (packed, reference) = (PackedState(around.rows), chunk.read(self.reference_pressure));
        let first_reference = around.clock.number(FIRST_REFERENCE);
        let (density, sound_speed) = (chunk.read(self.density), self.sound_speed.of(chunk));
        let (laplace, laplace_rate) = (chunk.read(self.laplace), chunk.read(self.laplace_rate));
        // Between two computations of the curvature its pressure is carried on at the last rate:
        // a lag would feed the oscillation (method.md, section 10).
        let elapsed = around.clock.time - around.clock.mark(COMPUTED);
        let mut strain_rate = chunk.write(self.strain_rate);
        let [mut force_r, mut force_z] = self.force.map(|field| chunk.write(field));
        let balance = self.balance.as_ref().map(|balance| {
            (balance.deficit.map(|field| chunk.read(field)), balance.tangent.map(|field| chunk.read(field)))
        });
        let mut work = self.work.as_ref().map(|work| work.of(chunk));

        if self.cleared.1 {
            clear(&mut force_r);
            clear(&mut force_z);
        }
        for_surface(&chunk.read(self.surface), |i| {
            let weight = [weight_r[i], weight_z[i]];
            let reference = first_reference + reference[i];
            let mut ghost_pressure = laplace[i] + elapsed * laplace_rate[i] - reference;
            let mut along = [0.0; 2];
            if let Some((deficit, tangent)) = &balance {
                let (deficit, tangent) =
                    (deficit.each_ref().map(|deficit| deficit[i]), tangent.each_ref().map(|t| t[i]));
                let open = outward(weight, tangent);
                if open > 0.0 {
                    ghost_pressure += outward(deficit, tangent);
                    let pull = 2.0 * open * (deficit[0] * tangent[0] + deficit[1] * tangent[1]);
                    along = tangent.map(|tangent| pull * tangent);
                }
            }
            let pressure = packed.pressure(chunk.start + i);
            let impedance = density[i] * sound_speed.at(i);
            let ghost_impedance = IMPEDANCE_RATIO * impedance;
            let both = impedance + ghost_impedance;
            let star = (ghost_pressure * impedance + pressure * ghost_impedance) / both;
            let rise = (pressure - ghost_pressure) / both;
            let length = length(weight);
            strain_rate[i] += 2.0 * rise * length;
            let force = [0, 1].map(|axis| -2.0 * star * weight[axis] - along[axis]);
            if let Some(work) = &mut work {
                // U* |bw| = U_a . bw + rise |bw|.
                work.add(i, force, -2.0 * star * rise * length);
            }
            [force_r[i], force_z[i]] = force;
        });
        [0.0; 2]
    }
}
