//! How well the particles' contour meets the region's boundary.
//!
//! Relaxed particles are spread evenly, but as a body they lie some hundredths of a size too deep: a layer at half a
//! size would be right for rows of them, and what the number of particles lacks, being whole, the boundary shows.
//! Surface tension would find a drop of a smaller radius than asked for.

use super::cells::Cells;
use super::domain::{Domain, Point, Source};
use super::relax::{CAPTURE, DUST, add_images, dust};
use meniscus_engine::lanes::Lanes;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Support radius, in particle sizes, of the kernel that smears particles over some layers.
const SUPPORT: f64 = 6.0;

/// The continuum outside of the region that [`gap`] asks for.
pub(super) fn outside(domain: &Domain) -> Vec<Source> {
    dust(domain, within_period(domain, SUPPORT), DUST)
}

/// A support radius of a kernel that one image on either side covers.
pub(super) fn within_period(domain: &Domain, support: f64) -> f64 {
    domain.period.map_or(support, |period| period.min(support))
}

/// The point of the boundary next to a particle of the outermost layer.
pub(super) fn foot(domain: &Domain, point: Point) -> Option<Point> {
    let depth = -domain.signed_distance(point);
    let (outward, slope) = domain.outward(point).filter(|_| depth < CAPTURE)?;
    Some([0, 1].map(|axis| point[axis] + depth / slope * outward[axis]))
}

/// How far, in particle sizes, the contour of `points` and `fixed`, each with `area` in squares of a particle
/// size, lies below the boundary in the mean.
///
/// At the boundary the particles inside and the continuum outside add up to one where both meet there. What they
/// lack, over the slope that the particles' part has at an edge, is how far one is from the other.
pub(super) fn gap(
    domain: &Domain,
    (points, fixed): (&[Point], &[Point]),
    outside: &[Source],
    area: f64,
) -> f64 {
    let support = within_period(domain, SUPPORT);
    let particles = points.iter().chain(fixed);
    let mut sources: Vec<Source> = particles.map(|&point| Source { point, area }).collect();
    sources.extend_from_slice(outside);
    add_images(domain, support, &mut sources);
    let mut cells = Cells::default();
    cells.fill(&sources);
    let gap_at = |point: &Point| foot(domain, *point).map(|foot| 1.0 - sum(&cells, foot, support));
    let gaps: Vec<f64> = points.par_iter().filter_map(gap_at).collect();
    // A straight edge's slope: the integral of the kernel along a line through its centre.
    let slope = 14.0 / (3.0 * PI * support);
    if gaps.is_empty() { 0.0 } else { gaps.iter().sum::<f64>() / gaps.len() as f64 / slope }
}

/// `sum area W` at a point with the planar Wendland C2 kernel.
fn sum(cells: &Cells, point: Point, support: f64) -> f64 {
    let inverse_support = Lanes::splat(1.0 / support);
    let mut sum = Lanes::ZERO;
    cells.around(point, support, |_, distance, area| {
        let q = distance * inverse_support;
        let inside = (Lanes::ONE - q).max(Lanes::ZERO);
        let fourth = inside * inside * inside * inside;
        sum = (area * fourth).mul_add(Lanes::splat(4.0).mul_add(q, Lanes::ONE), sum);
    });
    7.0 / (PI * support * support) * sum.sum()
}
