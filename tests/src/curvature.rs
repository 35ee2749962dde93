//! Surfaces of known curvature, and how far the curvature that the pipeline finds is from it.

use crate::drops::{self, column};
use meniscus_cases::simulation::Simulation;
use meniscus_stages::surface::{BOUNDARY, NEAR_BOUNDARY};
use meniscus_stages::surface_interval::COMPUTED;
use std::f64::consts::FRAC_PI_2;

/// Surface tension of the scenes, N/m.
pub const TENSION: f64 = 0.074;

/// Unit of length of the scenes, m.
pub const UNIT: f64 = 1e-6;

/// A surface whose curvature is known everywhere, lengths in [`UNIT`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Surface {
    /// Of radius 1.
    Sphere,
    /// Of radius 1, endless.
    Cylinder,
    /// A tube of radius 1 bent to a ring of radius 2.
    Torus,
    /// An ellipsoid of revolution with these semi-axes across and along its axis.
    Spheroid {
        /// Semi-axis in r.
        radial: f64,
        /// Semi-axis in z.
        axial: f64,
    },
}

/// The surfaces that are measured, all with a smallest semi-axis or tube of radius 1.
pub const SURFACES: [Surface; 5] = [
    Surface::Sphere,
    Surface::Cylinder,
    Surface::Torus,
    Surface::Spheroid { radial: 1.5, axial: 1.0 },
    Surface::Spheroid { radial: 1.0, axial: 1.5 },
];

impl Surface {
    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Surface::Sphere => "sphere",
            Surface::Cylinder => "cylinder",
            Surface::Torus => "torus",
            Surface::Spheroid { radial, axial } if radial > axial => "oblate spheroid",
            Surface::Spheroid { .. } => "prolate spheroid",
        }
    }

    fn body(self) -> (String, &'static str) {
        match self {
            Surface::Sphere => ("sphere = { radius = \"1 um\" }".into(), ""),
            Surface::Cylinder => (
                "cylinder = { radius = \"1 um\", bottom = \"-1 um\", top = \"1 um\" }".into(),
                "[domain]\nperiod = \"2 um\"\n",
            ),
            Surface::Torus => ("torus = { major = \"2 um\", minor = \"1 um\" }".into(), ""),
            Surface::Spheroid { radial, axial } => {
                (format!("spheroid = {{ radial = \"{radial} um\", axial = \"{axial} um\" }}"), "")
            }
        }
    }

    /// The sum of both principal curvatures, over one over [`UNIT`], at the point next to (r, z).
    ///
    /// Torus: 1/a + cos(phi)/(R + a cos(phi)) at the angle phi around its tube. Spheroid with the semi-axes a and
    /// c, at (a sin t, c cos t): with w^2 = a^2 cos^2 t + c^2 sin^2 t the curvatures are a c/w^3 and c/(a w)
    /// (do Carmo, Differential Geometry of Curves and Surfaces, section 3-3, example 4).
    pub fn curvature(self, [r, z]: [f64; 2]) -> f64 {
        match self {
            Surface::Sphere => 2.0,
            Surface::Cylinder => 1.0,
            Surface::Torus => {
                let cosine = (r - 2.0) / (r - 2.0).hypot(z);
                1.0 + cosine / (2.0 + cosine)
            }
            Surface::Spheroid { radial: a, axial: c } => {
                let (sine, cosine) = nearest_angle([a, c], [r, z.abs()]).sin_cos();
                let w = (a * cosine).hypot(c * sine);
                a * c / w.powi(3) + c / (a * w)
            }
        }
    }

    /// A scene of it at rest, with so many particles to its radius 1.
    pub fn start(self, resolution: f64) -> Simulation {
        let (shape, domain) = self.body();
        scene(&format!("{domain}[[body]]\nshape = {{ {shape} }}\n"), resolution)
    }
}

/// The angle t of the point (a sin t, c cos t) of the first quadrant's arc next to a point of that quadrant:
/// there the way to it has no part along the tangent. That part changes its sign once in between.
fn nearest_angle([a, c]: [f64; 2], [r, z]: [f64; 2]) -> f64 {
    let (mut low, mut high) = (0.0, FRAC_PI_2);
    for _ in 0..60 {
        let middle: f64 = 0.5 * (low + high);
        let (sine, cosine) = middle.sin_cos();
        let along = (r - a * sine) * a * cosine - (z - c * cosine) * c * sine;
        if along > 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// The start of a scene with the given bodies, so many particles to a [`UNIT`].
pub fn scene(bodies: &str, resolution: f64) -> Simulation {
    let text = format!(
        "format = 1\n[liquid]\ndensity = \"1000 kg/m3\"\nsurface_tension = \"{TENSION} N/m\"\n{bodies}\n\
         [particles]\nsize = \"{} um\"\n[run]\nuntil = \"1 ms\"\n",
        1.0 / resolution
    );
    drops::start(&drops::scene(&text, &[]))
}

/// What a particle at the surface knows about it, lengths in [`UNIT`].
#[derive(Clone, Copy, Debug)]
pub struct Foot {
    /// The point of the surface next to the particle.
    pub place: [f64; 2],
    /// The sum of both principal curvatures there.
    pub curvature: f64,
    /// Whether it was measured there, not carried over from a particle nearby.
    pub is_measured: bool,
}

/// What every particle at the surface or near it knows about it: the curvature of the Laplace pressure that acts, which is
/// carried on since the surface was looked for.
pub fn feet(simulation: &Simulation) -> Vec<Foot> {
    let [r, z, way_r, way_z] =
        ["radius", "axial", "surface_offset_r", "surface_offset_z"].map(|name| column(simulation, name));
    let [pressure, rate] = ["laplace_pressure", "laplace_pressure_rate"].map(|name| column(simulation, name));
    let clock = &simulation.world.clock;
    let elapsed = clock.time - clock.mark(COMPUTED);
    let surface = simulation.world.store.by_name::<u32>("surface");
    let surface = surface.map_or_else(Vec::new, |surface| surface.to_vec());
    let at_surface = (0..r.len()).filter(|&i| surface[i] == BOUNDARY || surface[i] == NEAR_BOUNDARY);
    let foot = |i: usize| Foot {
        place: [(r[i] + way_r[i]) / UNIT, (z[i] + way_z[i]) / UNIT],
        curvature: (pressure[i] + elapsed * rate[i]) / TENSION * UNIT,
        is_measured: surface[i] == BOUNDARY,
    };
    at_surface.map(foot).collect()
}

/// Errors of the curvature, over the mean of the exact one's magnitude.
#[derive(Clone, Copy, Debug, Default)]
pub struct Errors {
    /// Mean of the error's magnitude.
    pub mean: f64,
    /// Mean of the error with its sign.
    pub bias: f64,
    /// Root of the mean square.
    pub rms: f64,
    /// Largest magnitude.
    pub largest: f64,
}

impl Errors {
    /// Of feet at a surface of the given curvature.
    pub fn of(feet: &[Foot], exact: impl Fn([f64; 2]) -> f64) -> Self {
        let mut errors = Errors::default();
        let mut scale = 0.0;
        for foot in feet {
            let exact = exact(foot.place);
            let error = foot.curvature - exact;
            scale += exact.abs();
            errors.mean += error.abs();
            errors.bias += error;
            errors.rms += error * error;
            errors.largest = errors.largest.max(error.abs());
        }
        let count = feet.len() as f64;
        let scale = scale / count;
        Errors {
            mean: errors.mean / count / scale,
            bias: errors.bias / count / scale,
            rms: (errors.rms / count).sqrt() / scale,
            largest: errors.largest / scale,
        }
    }

    /// The larger of each.
    pub fn mean_of(several: &[Errors]) -> Self {
        let mean = |part: fn(&Errors) -> f64| several.iter().map(part).sum::<f64>() / several.len() as f64;
        Errors {
            mean: mean(|e| e.mean),
            bias: mean(|e| e.bias),
            rms: mean(|e| e.rms * e.rms).sqrt(),
            largest: mean(|e| e.largest),
        }
    }
}
