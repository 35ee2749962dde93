//! Levels the density: every particle moves away from its neighbours, fixed dust and images.
//!
//! ```text
//! repeat, stage by stage
//!   sources = particles + dust outside, then their images at the axis, then those of the period
//!   for each particle   s = i s - 0.25 D^2 sum over sources of V grad W
//!                       x += s
//!                       hold it at the depth of the outermost layer
//! ```
//! To take the part i of the step before again (Polyak's heavy ball) levels what is too dense over many particles
//! 1/(1 - i) times as fast.

use super::cells::Cells;
use super::domain::{Domain, Point, Source};
use meniscus_engine::lanes::Lanes;
use rayon::prelude::*;
use std::f64::consts::PI;
use std::ops::ControlFlow;

/// Largest support radius of the kernel, and so the reach of dust and images, in particle sizes.
pub(super) const REACH: f64 = 2.8;
/// Side of the pieces of dust, in particle sizes.
pub(super) const DUST: f64 = 0.5;
const STEP: f64 = 0.25;
/// Depth of the outermost layer in particle sizes, to begin with.
pub(super) const DEPTH: f64 = 0.5;
/// Particles that are not much deeper belong to the outermost layer.
pub(super) const CAPTURE: f64 = 0.75;

#[derive(Clone, Copy)]
struct Stage {
    /// Share of the iterations.
    share: f64,
    /// Support radius of the kernel in particle sizes.
    support: f64,
    /// Shallower particles are moved to the depth of the outermost layer, be it outwards or inwards.
    capture: f64,
    /// Part of the step before that is taken again.
    inertia: f64,
}

/// A wide kernel levels the density and prefers no lattice: the square and the hexagonal one have
/// the same energy at support 2.8. A short one evens the distances to the next neighbours. The last
/// has the support of the flow's usual kernel, so that it starts near its equilibrium. (At support
/// 3 the square lattice would win, and single particles stay below the outermost layer unless they
/// are drawn into it.) With inertia the short kernels would order the particles in large crystals, whose stiffness
/// slows flows down: jets would grow .1 to .4 % too slowly.
const STAGES: [Stage; 3] = [
    Stage { share: 0.4, support: REACH, capture: DEPTH, inertia: 0.8 },
    Stage { share: 0.4, support: 1.8, capture: CAPTURE, inertia: 0.0 },
    Stage { share: 0.2, support: 2.0, capture: CAPTURE, inertia: 0.0 },
];

/// What lies outside of the region, and the particles `fixed` that stay where they are.
pub(super) fn surroundings(domain: &Domain, fixed: &[Point]) -> Vec<Source> {
    let mut sources = dust(domain, REACH, DUST);
    sources.extend(fixed.iter().map(|&point| Source { point, area: 1.0 }));
    sources
}

/// Moves particles among their surroundings. `moved` is called after each iteration, and says whether to go on.
pub(super) fn relax(
    domain: &Domain,
    bodies: (&mut [Point], &[Source]),
    iterations: usize,
    moved: &mut dyn FnMut() -> ControlFlow<()>,
) -> ControlFlow<()> {
    run(domain, bodies, &STAGES, (iterations, DEPTH), moved)
}

/// Goes on from where [`relax`] ended, with the outermost layer at another depth.
pub(super) fn go_on(
    domain: &Domain,
    bodies: (&mut [Point], &[Source]),
    (iterations, depth): (usize, f64),
    moved: &mut dyn FnMut() -> ControlFlow<()>,
) -> ControlFlow<()> {
    run(domain, bodies, &[Stage { share: 1.0, ..STAGES[2] }], (iterations, depth), moved)
}

fn run(
    domain: &Domain,
    (points, surroundings): (&mut [Point], &[Source]),
    stages: &[Stage],
    (iterations, layer): (usize, f64),
    moved: &mut dyn FnMut() -> ControlFlow<()>,
) -> ControlFlow<()> {
    let (mut sources, mut cells) = (Vec::new(), Cells::default());
    // A lower bound of each particle's depth: only those that may be too shallow are looked up.
    let mut depths = vec![0.0; points.len()];
    let mut steps = vec![[0.0; 2]; points.len()];
    let mut end = 0.0;
    let mut done = 0;
    for stage in stages {
        end += stage.share * iterations as f64;
        while (done as f64) < end && done < iterations {
            gather(domain, points, surroundings, &mut sources);
            cells.fill(&sources);
            points.par_iter_mut().zip(&mut steps).zip(&mut depths).for_each(|((point, step), depth)| {
                let push = gradient(&cells, *point, stage.support);
                *step = [0, 1].map(|axis| stage.inertia * step[axis] - STEP * push[axis]);
                let from = *point;
                *point = [point[0] + step[0], point[1] + step[1]];
                *depth -= (step[0] * step[0] + step[1] * step[1]).sqrt();
                if *depth < stage.capture {
                    *depth = hold(domain, point, stage.capture, layer);
                    *step = [point[0] - from[0], point[1] - from[1]];
                }
                wrap(domain, point, step);
            });
            done += 1;
            moved()?;
        }
    }
    ControlFlow::Continue(())
}

/// `sum V grad W` at `point`, with the planar Wendland C2 kernel; it points to the neighbours. Eight sources are
/// weighed side by side, and those beyond the support weigh nothing.
pub(super) fn gradient(cells: &Cells, point: Point, support: f64) -> Point {
    let inverse_support = Lanes::splat(1.0 / support);
    let mut sum = [Lanes::ZERO; 2];
    cells.around(point, support, |[dr, dz], distance, area| {
        let inside = distance.neg_mul_add(inverse_support, Lanes::ONE).max(Lanes::ZERO);
        let weight = area * inside * inside * inside;
        sum = [weight.mul_add(dr, sum[0]), weight.mul_add(dz, sum[1])];
    });
    let factor = 140.0 / (PI * support.powi(4));
    sum.map(|sum| factor * sum.sum())
}

/// Gathers particles, dust and the images of both in `sources`.
pub(super) fn gather(domain: &Domain, points: &[Point], outside: &[Source], sources: &mut Vec<Source>) {
    sources.clear();
    sources.extend(points.iter().map(|&point| Source { point, area: 1.0 }));
    sources.extend_from_slice(outside);
    add_images(domain, REACH, sources);
}

/// Adds the images of all sources that lie within `reach` of the axis or a period's ends.
pub(super) fn add_images(domain: &Domain, reach: f64, sources: &mut Vec<Source>) {
    let mut add = |within: &dyn Fn(Point) -> bool, image: &dyn Fn(Point) -> Point| {
        for index in 0..sources.len() {
            let Source { point, area } = sources[index];
            if within(point) {
                sources.push(Source { point: image(point), area });
            }
        }
    };
    if domain.has_axis {
        add(&|[r, _]| r < reach, &|[r, z]| [-r, z]);
    }
    if let Some(width) = domain.period_r {
        add(&|[r, _]| r < reach, &|[r, z]| [r + width, z]);
        let far = width - reach..width;
        add(&|[r, _]| far.contains(&r), &|[r, z]| [r - width, z]);
    }
    if let Some(period) = domain.period {
        add(&|[_, z]| z < reach, &|[r, z]| [r, z + period]);
        // The images just added lie above the period and have none of their own.
        let top = period - reach..period;
        add(&|[_, z]| top.contains(&z), &|[r, z]| [r, z - period]);
    }
}

/// The plane outside, not farther than `reach` from the region, in pieces with the given side: each at its centroid
/// with its area.
pub(super) fn dust(domain: &Domain, reach: f64, side: f64) -> Vec<Source> {
    let [r_min, r_max, z_min, z_max] = domain.bounds;
    let first_r = if domain.has_axis { 0.0 } else { r_min - reach };
    let columns = ((r_max + reach - first_r) / side).ceil() as usize;
    let (first_z, rows, height) = match domain.period {
        Some(period) => {
            let rows = (period / side).ceil();
            (0.0, rows as usize, period / rows)
        }
        None => {
            let rows = ((z_max - z_min + 2.0 * reach) / side).ceil();
            (z_min - reach, rows as usize, side)
        }
    };
    let half = [side / 2.0, height / 2.0];
    let full = side * height;
    let piece = |index: usize| {
        let centre = [
            first_r + (2 * (index % columns) + 1) as f64 * half[0],
            first_z + (2 * (index / columns) + 1) as f64 * half[1],
        ];
        let distance = domain.signed_distance(centre);
        if !(-side..reach).contains(&distance) {
            return None;
        }
        let [inside, moment_r, moment_z] = domain.inside(centre, half, 0.06 * side);
        let area = full - inside;
        let centroid = [(full * centre[0] - moment_r) / area, (full * centre[1] - moment_z) / area];
        (area > 1e-6 * full).then_some(Source { point: centroid, area })
    };
    (0..columns * rows).into_par_iter().filter_map(piece).collect()
}

/// Moves `point`, if it is shallower than `capture`, to the depth `layer` along the gradient of the
/// signed distance. Returns its depth.
fn hold(domain: &Domain, point: &mut Point, capture: f64, layer: f64) -> f64 {
    let mut distance = domain.signed_distance(*point);
    if distance < -capture {
        return -distance;
    }
    // A few steps settle it at a corner or where the distance is only a bound.
    for _ in 0..4 {
        let excess = distance + layer;
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

/// Brings `point`, which moves by `step`, back to r >= 0 and into the periods.
fn wrap(domain: &Domain, point: &mut Point, step: &mut Point) {
    if domain.has_axis && point[0] < 0.0 {
        (point[0], step[0]) = (-point[0], -step[0]);
    }
    if let Some(width) = domain.period_r {
        point[0] = point[0].rem_euclid(width);
    }
    if let Some(period) = domain.period {
        point[1] = point[1].rem_euclid(period);
    }
}
