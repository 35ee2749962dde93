//! Levels the density: every particle moves away from its neighbours, fixed dust and images.
//!
//! ```text
//! repeat, stage by stage
//!   sources = particles + dust outside, then their images at the axis, then those of the period
//!   for each particle   x -= 0.25 D^2 sum over sources of V grad W
//!                       hold it at the depth of the outermost layer
//! ```

use super::cells::Cells;
use super::domain::{Domain, Point, Source};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Largest support radius of the kernel, and so the reach of dust and images, in particle sizes.
pub(super) const REACH: f64 = 2.8;
const STEP: f64 = 0.25;
/// Depth of the outermost layer in particle sizes.
pub(super) const DEPTH: f64 = 0.5;

struct Stage {
    /// Share of the iterations.
    share: f64,
    /// Support radius of the kernel in particle sizes.
    support: f64,
    /// Shallower particles are moved to `DEPTH`, be it outwards or inwards.
    capture: f64,
}

/// A wide kernel levels the density and prefers no lattice: the square and the hexagonal one have
/// the same energy at support 2.8. A short one evens the distances to the next neighbours. The last
/// has the support of the flow's usual kernel, so that it starts near its equilibrium. (At support
/// 3 the square lattice would win, and single particles stay below the outermost layer unless they
/// are drawn into it.)
const STAGES: [Stage; 3] = [
    Stage { share: 0.4, support: REACH, capture: DEPTH },
    Stage { share: 0.4, support: 1.8, capture: 0.75 },
    Stage { share: 0.2, support: 2.0, capture: 0.75 },
];

pub(super) fn relax(domain: &Domain, points: &mut [Point], iterations: usize) {
    let outside = dust(domain);
    let mut cells = Cells::default();
    // A lower bound of each particle's depth: only those that may be too shallow are looked up.
    let mut depths = vec![0.0; points.len()];
    let mut end = 0.0;
    let mut done = 0;
    for stage in &STAGES {
        end += stage.share * iterations as f64;
        while (done as f64) < end && done < iterations {
            cells.fill(&sources(domain, points, &outside));
            points.par_iter_mut().zip(&mut depths).for_each(|(point, depth)| {
                let [push_r, push_z] = gradient(&cells, *point, stage.support);
                *point = [point[0] - STEP * push_r, point[1] - STEP * push_z];
                *depth -= STEP * push_r.hypot(push_z);
                if *depth < stage.capture {
                    *depth = hold(domain, point, stage.capture);
                }
                wrap(domain, point);
            });
            done += 1;
        }
    }
}

/// `sum V grad W` at `point`, with the planar Wendland C2 kernel; it points to the neighbours.
pub(super) fn gradient(cells: &Cells, point: Point, support: f64) -> Point {
    let mut sum = [0.0; 2];
    for source in cells.near(point, support) {
        let offset = [source.point[0] - point[0], source.point[1] - point[1]];
        let square = offset[0] * offset[0] + offset[1] * offset[1];
        if square < support * support {
            let rest = 1.0 - square.sqrt() / support;
            let weight = source.area * rest * rest * rest;
            sum[0] += weight * offset[0];
            sum[1] += weight * offset[1];
        }
    }
    let factor = 140.0 / (PI * support.powi(4));
    [factor * sum[0], factor * sum[1]]
}

/// Particles, dust and the images of both.
pub(super) fn sources(domain: &Domain, points: &[Point], outside: &[Source]) -> Vec<Source> {
    let particles = points.iter().map(|&point| Source { point, area: 1.0 });
    let mut sources: Vec<Source> = particles.chain(outside.iter().copied()).collect();
    let mut add_images = |within: &dyn Fn(Point) -> bool, image: &dyn Fn(Point) -> Point| {
        for index in 0..sources.len() {
            let Source { point, area } = sources[index];
            if within(point) {
                sources.push(Source { point: image(point), area });
            }
        }
    };
    if domain.has_axis {
        add_images(&|[r, _]| r < REACH, &|[r, z]| [-r, z]);
    }
    if let Some(period) = domain.period {
        add_images(&|[_, z]| z < REACH, &|[r, z]| [r, z + period]);
        // The images just added lie above the period and have none of their own.
        let top = period - REACH..period;
        add_images(&|[_, z]| top.contains(&z), &|[r, z]| [r, z - period]);
    }
    sources
}

/// The plane outside, within reach of a particle, in pieces: each at its centroid with its area.
pub(super) fn dust(domain: &Domain) -> Vec<Source> {
    const SIDE: f64 = 0.5;
    let [r_min, r_max, z_min, z_max] = domain.bounds;
    let first_r = if domain.has_axis { 0.0 } else { r_min - REACH };
    let columns = ((r_max + REACH - first_r) / SIDE).ceil() as usize;
    let (first_z, rows, height) = match domain.period {
        Some(period) => {
            let rows = (period / SIDE).ceil();
            (0.0, rows as usize, period / rows)
        }
        None => {
            let rows = ((z_max - z_min + 2.0 * REACH) / SIDE).ceil();
            (z_min - REACH, rows as usize, SIDE)
        }
    };
    let half = [SIDE / 2.0, height / 2.0];
    let full = SIDE * height;
    let piece = |index: usize| {
        let centre = [
            first_r + (2 * (index % columns) + 1) as f64 * half[0],
            first_z + (2 * (index / columns) + 1) as f64 * half[1],
        ];
        let distance = domain.signed_distance(centre);
        if !(-SIDE..REACH).contains(&distance) {
            return None;
        }
        let [inside, moment_r, moment_z] = domain.inside(centre, half, 0.03);
        let area = full - inside;
        let centroid = [(full * centre[0] - moment_r) / area, (full * centre[1] - moment_z) / area];
        (area > 1e-6 * full).then_some(Source { point: centroid, area })
    };
    (0..columns * rows).into_par_iter().filter_map(piece).collect()
}

/// Moves `point`, if it is shallower than `capture`, to depth `DEPTH` along the gradient of the
/// signed distance. Returns its depth.
fn hold(domain: &Domain, point: &mut Point, capture: f64) -> f64 {
    let mut distance = domain.signed_distance(*point);
    if distance < -capture {
        return -distance;
    }
    // A few steps settle it at a corner or where the distance is only a bound.
    for _ in 0..4 {
        let excess = distance + DEPTH;
        if excess.abs() <= 1e-9 {
            break;
        }
        let Some((outward, slope)) = domain.outward(*point) else {
            break;
        };
        point[0] -= excess / slope * outward[0];
        point[1] -= excess / slope * outward[1];
        distance = domain.signed_distance(*point);
    }
    -distance
}

/// Brings `point` back to r >= 0 and into the period.
fn wrap(domain: &Domain, point: &mut Point) {
    if domain.has_axis {
        point[0] = point[0].abs();
    }
    if let Some(period) = domain.period {
        point[1] = point[1].rem_euclid(period);
    }
}
