//! Fills a region of the half plane with particles of nearly equal area.
//!
//! The outermost layer follows the boundary at half a particle size, without staircase, and the
//! inside is disordered or locally hexagonal. A pair repulsion levels the density: every particle
//! moves away from its neighbours by `0.25 D^2 sum V grad W`, with the planar Wendland C2 kernel of
//! support 2.8 D at first, then less. Beyond the boundary the plane is filled with fixed dust of the
//! same density, beyond the axis with mirror images, so that nothing pulls a particle to either.
//! No particle comes closer to the boundary than D/2, and those not much deeper are drawn there.
//!
//! Where the contour of the particles still undulates about the boundary, the outermost ones get some per cent more
//! or less of the liquid.
//!
//! In large regions the inside is filled with copies of a settled tile, and only the rest is settled.
//!
//! The result depends on the region and the options alone, not on the number of threads.

mod cells;
mod domain;
mod level;
mod relax;
mod share;
mod start;
#[cfg(test)]
mod tests;

use crate::region::Region;
use domain::{Domain, Point};
use std::f64::consts::TAU;
use std::ops::ControlFlow;

/// Particles that fill a region: positions in metres and areas in square metres.
#[derive(Debug, Clone, PartialEq)]
pub struct Packing {
    /// Distance from the origin radius in metres.
    pub r: Vec<f64>,
    /// Position along the axis in metres.
    pub z: Vec<f64>,
    /// Area in the half plane in square metres, the same for every particle but for some per cent in the outermost
    /// layer, and such that `sum 2 pi (origin + r) area` is the volume.
    pub area: Vec<f64>,
}

/// How to fill a region.
#[derive(Debug, Clone, PartialEq)]
pub struct PackingOptions {
    /// Particle size D in metres; a particle's area is about D^2.
    pub particle_size: f64,
    /// Number of relaxation steps; 400 settle a packing.
    pub iterations: usize,
    /// Selects one of many equally good packings.
    pub seed: u64,
    /// Period in z in metres: the region spans a whole period and has no surface at its z ends.
    pub period: Option<f64>,
    /// Radius of r = 0 in metres; where it is positive there is no axis and nothing is mirrored.
    pub origin: f64,
    /// Volume of the revolved region in cubic metres that the particles share; without it, the
    /// region's own volume, which is about the axis r = 0.
    pub volume: Option<f64>,
}

impl PackingOptions {
    /// The defaults for particles of size `particle_size` (metres): 400 steps, an axis at r = 0.
    pub fn new(particle_size: f64) -> Self {
        Self { particle_size, iterations: 400, seed: 1, period: None, origin: 0.0, volume: None }
    }

    /// Relaxation steps after each levelling of the outermost layer.
    fn levelling(&self) -> usize {
        self.iterations / 20
    }
}

/// Why a region could not be filled.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PackingError {
    /// A length or volume among the options is not finite or has the wrong sign.
    #[error("{name} must be {expected}, but is {value}")]
    Option {
        /// What the option is called.
        name: &'static str,
        /// What it has to be.
        expected: &'static str,
        /// What it is, in SI units.
        value: f64,
    },
    /// The region's bounds or distances are not finite, or its bounds are reversed.
    #[error("the region has no finite bounds and distances")]
    Region,
    /// The region's cross-section is less than half a particle.
    #[error("the region's cross-section holds less than one particle of size {particle_size} m")]
    Empty {
        /// Particle size in metres.
        particle_size: f64,
    },
    /// Away from the axis the region's own volume does not count.
    #[error("with an origin radius of {origin} m the volume must be given")]
    NoVolume {
        /// Radius of r = 0 in metres.
        origin: f64,
    },
    /// More particles than the limit.
    #[error("the region takes {count:.3e} particles of this size, more than {limit:.0e}")]
    TooMany {
        /// Number of particles the region takes.
        count: f64,
        /// The largest number allowed.
        limit: f64,
    },
    /// The particles' volume is not that of the region: the packing is bad, or the volume is wrong.
    #[error("the packing's volume is {found:e} m^3 where the region's is {expected:e} m^3")]
    Volume {
        /// Volume of the particles at area D^2, in cubic metres.
        found: f64,
        /// Volume they should share, in cubic metres.
        expected: f64,
    },
    /// Whoever followed the progress did not want it to go on.
    #[error("stopped before the region was filled")]
    Stopped,
}

/// A larger number is taken for a mistake in the particle size.
pub const MOST_PARTICLES: f64 = 1e8;

/// From so many particles on most of them lie so deep that they know nothing of the surface.
const LARGE: usize = 50_000;

/// Depth in particle sizes down to which particles start from the lattice, and down to which they move; below they
/// stay where a settled tile has put them. What one place has too much or too little diffuses by some twenty sizes
/// in the usual number of relaxation steps: so neither boundary nor seam meets a wall.
const BAND: [f64; 2] = [32.0, 64.0];

/// How often the outermost layer is brought to another depth.
const LEVELLINGS: usize = 6;

/// By how much at most, in particle sizes, its depth changes; some hundredths are usual.
const MOST_LIFT: f64 = 0.1;

/// Particles that move while a region is filled, and those that stay where a settled tile has put them.
struct Filling {
    moving: Vec<Point>,
    still: Vec<Point>,
    /// Those of `still` that the moving ones meet.
    met: Vec<Point>,
}

impl Filling {
    fn start(domain: &Domain, options: &PackingOptions) -> Self {
        if domain.count < LARGE {
            let moving = start::points(domain, options.seed, domain.count, |_| true);
            return Filling { moving, still: Vec::new(), met: Vec::new() };
        }
        // The inside is filled with copies of a tile that is settled already; what lies near the surface, the
        // axis and the ends of a period, where copies do not fit, settles.
        let [seam, still] = BAND;
        let is_deep = |point: &Point| domain.depth(*point) > seam;
        let deep = start::settled_points(domain, options.seed, options.iterations, is_deep);
        let rest = domain.count.saturating_sub(deep.len());
        let mut moving = start::points(domain, options.seed, rest, |point| !is_deep(point));
        let (core, shell): (Vec<Point>, Vec<Point>) =
            deep.into_iter().partition(|point| domain.depth(*point) > still);
        moving.extend(shell);
        let is_met = |point: &&Point| domain.depth(**point) < still + 2.0 * relax::REACH;
        let met = core.iter().filter(is_met).copied().collect();
        Filling { moving, still: core, met }
    }

    /// What each of them gets of a volume in m3, in squares of the particle size.
    fn area(&self, options: &PackingOptions, volume: f64) -> f64 {
        let size = options.particle_size;
        let points = self.still.iter().chain(&self.moving);
        volume / points.map(|point| TAU * (options.origin + point[0] * size) * size * size).sum::<f64>()
    }

    /// Relaxes all that move, and then lifts or lowers the outermost layer until the contour is at the boundary.
    fn settle(
        &mut self,
        domain: &Domain,
        options: &PackingOptions,
        volume: f64,
        moved: &mut dyn FnMut() -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let surroundings = relax::surroundings(domain, &self.met);
        relax::relax(domain, (&mut self.moving, &surroundings), options.iterations, moved)?;
        let (mut layer, outside) = (relax::DEPTH, level::outside(domain));
        for _ in 0..LEVELLINGS {
            let area = self.area(options, volume);
            layer -= level::gap(domain, (&self.moving, &self.met), &outside, area);
            // In a body of a few particles there is no layer to speak of.
            layer = layer.clamp(relax::DEPTH - MOST_LIFT, relax::DEPTH + MOST_LIFT);
            relax::go_on(domain, (&mut self.moving, &surroundings), (options.levelling(), layer), moved)?;
        }
        ControlFlow::Continue(())
    }
}

/// Fills `region` with particles of equal area, but for some per cent at its boundary. `progress` is told which
/// part of that is done, from 0 to 1, and says whether to go on.
///
/// # Errors
/// Options or a region that make no sense, no or too many particles, or particles at area D^2 whose
/// volume is more than 2 % (and the rounding to whole particles) off the region's; or it was not to go on.
pub fn pack(
    region: &dyn Region,
    options: &PackingOptions,
    progress: &mut dyn FnMut(f64) -> ControlFlow<()>,
) -> Result<Packing, PackingError> {
    let domain = Domain::new(region, options)?;
    let expected = options.volume.unwrap_or_else(|| region.volume());
    let mut filling = Filling::start(&domain, options);
    let steps = options.iterations + LEVELLINGS * options.levelling();
    let mut done = 0;
    let settled = filling.settle(&domain, options, expected, &mut || {
        done += 1;
        progress(done as f64 / steps as f64)
    });
    if settled.is_break() {
        return Err(PackingError::Stopped);
    }
    let area = filling.area(options, expected);
    let mut shares = vec![1.0; filling.still.len()];
    shares.extend(share::shares(&domain, &filling.moving, &filling.met, area));
    let points = [filling.still, filling.moving].concat();

    let size = options.particle_size;
    let r: Vec<f64> = points.iter().map(|point| point[0] * size).collect();
    let z: Vec<f64> = points.iter().map(|point| domain.metres_z(point[1])).collect();
    let ring: f64 = r.iter().map(|r| TAU * (options.origin + r)).sum();
    let found = ring * size * size;
    let deviation = (expected / found - 1.0).abs();
    // A whole number of particles can be half a particle off; twice that is still no bad packing.
    let allowed = 0.02 + 1.0 / points.len() as f64;
    if deviation.is_nan() || deviation > allowed {
        return Err(PackingError::Volume { found, expected });
    }
    // In the mean over the liquid they share it all.
    let shared: f64 = r.iter().zip(&shares).map(|(r, share)| TAU * (options.origin + r) * share).sum();
    let area = shares.iter().map(|share| share * expected / shared).collect();
    Ok(Packing { r, z, area })
}
