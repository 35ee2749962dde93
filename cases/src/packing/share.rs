//! Shares the liquid out among the outermost particles so that the contour of all meets the boundary everywhere.
//!
//! The disorder of the particles inside shows at the surface: with equal areas the contour of a relaxed packing
//! undulates by up to a hundredth of a particle size about the boundary. That is little, but a wave of a third of that
//! height, eleven sizes long, has a curvature of .001 over a particle size: with 56 of them to the radius of a drop 3 %
//! of its own, and more the finer the particles are. What the contour lacks the particles beneath it get: some per
//! cent more or less of the liquid each.

use super::cells::Cells;
use super::domain::{Domain, Point, Source};
use super::level::{foot, within_period};
use super::relax::{add_images, dust};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Support radius of the colour field in particle sizes: that of the flow's usual one.
const SUPPORT: f64 = 11.0;

/// Side of the pieces of the continuum outside, in particle sizes: with half of it the curvature is no better.
const SIDE: f64 = 0.125;

/// Polyak's heavy ball: every step goes on with a part of the step before. It solves a system with eigenvalues between
/// m and one fastest, by the root of MOMENTUM a step, with STEP = 4/(1 + sqrt m)^2 and MOMENTUM =
/// ((1 - sqrt m)/(1 + sqrt m))^2 (B. T. Polyak, USSR Computational Mathematics and Mathematical Physics 4(5), 1964).
/// Here m = .001: the colour field leaves that much of a wave three particle sizes long; shorter ones stay in part.
const STEP: f64 = 3.759;
const MOMENTUM: f64 = 0.881;
const STEPS: usize = 200;

/// No particle gets so much more or less than others, in parts of its area.
const MOST: f64 = 0.1;

/// What each of the `points` gets, one in the mean; `fixed` are particles that have one.
pub(super) fn shares(domain: &Domain, points: &[Point], fixed: &[Point], area: f64) -> Vec<f64> {
    let support = within_period(domain, SUPPORT);
    let mut shares = vec![1.0; points.len()];
    let outermost: Vec<(usize, Point)> =
        (0..points.len()).filter_map(|number| foot(domain, points[number]).map(|at| (number, at))).collect();
    let mut outside = dust(domain, support, SIDE);
    outside.extend(points.iter().chain(fixed).map(|&point| Source { point, area }));
    let missing = |sources: &mut Vec<Source>, all: f64| -> Vec<f64> {
        add_images(domain, support, sources);
        let mut cells = Cells::default();
        cells.fill(sources);
        outermost.par_iter().map(|(_, foot)| all - colour(&cells, *foot, support)).collect()
    };
    let at_first = missing(&mut outside, 1.0);
    // A straight row of particles, each with an area of one: the integral of the kernel along a line.
    let row = 1.0 / (0.255_99 * support);
    let (mut more, mut last) = (vec![0.0; outermost.len()], vec![0.0; outermost.len()]);
    for _ in 0..STEPS {
        let sources = outermost.iter().zip(&more);
        let mut sources: Vec<Source> =
            sources.map(|((number, _), more)| Source { point: points[*number], area: *more }).collect();
        let changed = missing(&mut sources, 0.0);
        for (k, more) in more.iter_mut().enumerate() {
            let step = STEP * (at_first[k] + changed[k]) / row + MOMENTUM * last[k];
            let next = (*more + step).clamp(-MOST * area, MOST * area);
            (last[k], *more) = (next - *more, next);
        }
    }
    for ((number, _), more) in outermost.iter().zip(more) {
        shares[*number] += more / area;
    }
    shares
}

/// `sum area W` at a point, with the kernel of the flow's colour field
/// ([`ColourField::at`](meniscus_stages::colour_field::ColourField::at)).
fn colour(cells: &Cells, point: Point, support: f64) -> f64 {
    let [r, z, area] = &cells.sorted;
    let weight = |k: usize| {
        let square = ((r[k] - point[0]).powi(2) + (z[k] - point[1]).powi(2)) / (support * support);
        let q = square.sqrt();
        let inside = (1.0 - q).max(0.0);
        let fourth = inside * inside * inside * inside;
        let shape = ((32.0 * q + 25.0) * q + 8.0) * q + 1.0;
        area[k] * fourth * fourth * shape * (1.0 - 8.0 * square)
    };
    390.0 / (11.0 * PI * support * support) * cells.near(point, support).flatten().map(weight).sum::<f64>()
}
