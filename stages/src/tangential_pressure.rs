//! The tangential pressure: what the surface layer lacks of the Laplace pressure's gradient, where a particle's neighbourhood is
//! incomplete (method.md, section 10, "The surface error, later").

use crate::fields;
use crate::moment::Moment;
use crate::surface::for_surface;
use crate::surface_interval::COMPUTED;
use crate::work::Work;
use meniscus_engine::group::{Around, Chunk, ChunkStage, Partial};
use meniscus_engine::store::{Add, Read};
use meniscus_engine::wiring::Wiring;

/// T: one ghost carries no gradient of the Laplace pressure along the surface. The missing force is
/// -(I - L) grad_s P_L.
pub struct TangentialPressure {
    surface: Read<u32>,
    deficiency: [Read<f64>; 3],
    slope: Read<f64>,
    slope_rate: Read<f64>,
    deficit_slope: Read<f64>,
    tangent: [Read<f64>; 2],
    force: [Add<f64>; 2],
    work: Option<Work>,
}

impl TangentialPressure {
    /// Adds to the surface force, and `with_energy` its work to that of the others.
    pub fn new(wiring: &mut Wiring, with_energy: bool) -> Self {
        wiring.stage("tangential-pressure");
        TangentialPressure {
            surface: wiring.read(&fields::SURFACE),
            deficiency: fields::SUPPORT_DEFICIENCY.map(|field| wiring.read(field)),
            slope: wiring.read(&fields::LAPLACE_SLOPE),
            slope_rate: wiring.read(&fields::LAPLACE_SLOPE_RATE),
            deficit_slope: wiring.read(&fields::TENSION_DEFICIT_SLOPE),
            tangent: fields::SURFACE_TANGENT.map(|field| wiring.read(field)),
            force: fields::SURFACE_FORCE.map(|field| wiring.add(field)),
            work: Work::new(wiring, with_energy),
        }
    }
}

impl ChunkStage for TangentialPressure {
    fn name(&self) -> &'static str {
        "tangential-pressure"
    }

    fn chunk(&self, around: &Around, chunk: &Chunk) -> Partial {
        let [rr, rz, zz] = self.deficiency.map(|field| chunk.read(field));
        let [tangent_r, tangent_z] = self.tangent.map(|field| chunk.read(field));
        let (slope, slope_rate) = (chunk.read(self.slope), chunk.read(self.slope_rate));
        let deficit_slope = chunk.read(self.deficit_slope);
        // Carried on as the Laplace pressure is (`ghost_coupling`).
        let elapsed = around.clock.time - around.clock.mark(COMPUTED);
        let [mut force_r, mut force_z] = self.force.map(|field| chunk.write(field));
        let mut work = self.work.as_ref().map(|work| work.of(chunk));
        for_surface(&chunk.read(self.surface), |i| {
            let missing = Moment { rr: rr[i], rz: rz[i], zz: zz[i] };
            let slope = slope[i] + elapsed * slope_rate[i] + deficit_slope[i];
            let force = missing.apply([tangent_r[i], tangent_z[i]]).map(|component| -slope * component);
            force_r[i] += force[0];
            force_z[i] += force[1];
            if let Some(work) = &mut work {
                work.add(i, force, 0.0);
            }
        });
        [0.0; 2]
    }
}
