//! The curve that makes a surface when it turns about the axis, and the potential on it.

use super::element::{BEYOND, Place, gauss, interpolate};
use std::f64::consts::PI;

/// How the surface goes on beyond an end of the curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum End {
    /// On the other side of the axis.
    Axis,
    /// Mirrored by a plane at the end's height.
    Mirror,
}

/// Steepest change of the nodes' distances along the curve.
const STEEPEST: f64 = 0.15;
/// A curve that asks for more nodes than this has come to nothing: it stays as it is.
const MOST: f64 = 500.0;
/// Rounds of means that take kinks from the nodes' density.
const SMOOTHINGS: usize = 4;

/// Nodes on the curve from below to above, smooth functions of their number. The liquid lies between the curve and
/// the axis.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Radius, height and potential of each.
    pub nodes: Vec<[f64; 3]>,
    /// At the first and the last node.
    pub ends: [End; 2],
}

/// What the curve is at a node.
pub(super) struct Shape {
    /// Derivatives of radius, height and potential by the node's number.
    pub(super) slope: [f64; 3],
    /// Length of the curve by the node's number.
    pub(super) stretch: f64,
    /// In the plane of the axis and across; positive for a sphere.
    pub(super) curvatures: [f64; 2],
}

/// Weight 3/4 (1 - x^2) for means over -1 < x < 1 (Epanechnikov).
pub fn weight(x: f64) -> f64 {
    0.75 * (1.0 - x * x).max(0.0)
}

impl Surface {
    /// The nodes with three more beyond each end.
    pub(super) fn continued(&self) -> Vec<[f64; 3]> {
        let last = self.nodes.len() - 1;
        let beyond = |end: usize, k: usize| {
            let plane = self.nodes[[0, last][end]][1];
            let [radius, height, potential] = self.nodes[if end == 0 { k } else { last - k }];
            match self.ends[end] {
                End::Axis => [-radius, height, potential],
                End::Mirror => [radius, 2.0 * plane - height, potential],
            }
        };
        let below = (1..=BEYOND).rev().map(|k| beyond(0, k));
        let above = (1..=BEYOND).map(|k| beyond(1, k));
        below.chain(self.nodes.iter().copied()).chain(above).collect()
    }

    /// By differences of sixth order.
    pub(super) fn shapes(&self) -> Vec<Shape> {
        let all = self.continued();
        let shape = |k: usize| {
            let at = |offset: isize, of: usize| all[(k + BEYOND).wrapping_add_signed(offset)][of];
            let odd = |of: usize, j: isize| at(j, of) - at(-j, of);
            let even = |of: usize, j: isize| at(j, of) + at(-j, of) - 2.0 * at(0, of);
            let first = |of: usize| (45.0 * odd(of, 1) - 9.0 * odd(of, 2) + odd(of, 3)) / 60.0;
            let second = |of: usize| (270.0 * even(of, 1) - 27.0 * even(of, 2) + 2.0 * even(of, 3)) / 180.0;
            let slope = [first(0), first(1), first(2)];
            let stretch = slope[0].hypot(slope[1]);
            let along = (slope[0] * second(1) - slope[1] * second(0)) / stretch.powi(3);
            let radius = self.nodes[k][0];
            let across = if radius > 0.0 { slope[1] / (stretch * radius) } else { along };
            Shape { slope, stretch, curvatures: [along, across] }
        };
        (0..self.nodes.len()).map(shape).collect()
    }

    /// Integral over the enclosed liquid of a density by radius r and height z, whose integral over the disc of
    /// radius r is `of_disc`.
    pub fn integral(&self, of_disc: impl Fn(f64, f64) -> f64) -> f64 {
        self.discs(4).iter().map(|[radius, height, thickness]| thickness * of_disc(*radius, *height)).sum()
    }

    /// Radius, height and thickness of discs that stand for the liquid, so many of Gauss's to an element.
    fn discs(&self, count: usize) -> Vec<[f64; 3]> {
        let all = self.continued();
        let places: Vec<Place> = gauss(count).into_iter().map(|[x, part]| Place::new(x, part)).collect();
        let disc = |element: usize, place: &Place| {
            let [[radius, height, _], [_, rise, _]] = interpolate(&all, element, place);
            [radius, height, rise * place.weight]
        };
        let elements = 0..self.nodes.len() - 1;
        elements
            .flat_map(|element| places.iter().map(move |place| disc(element, place)).collect::<Vec<_>>())
            .collect()
    }

    /// Volume of the liquid.
    pub fn volume(&self) -> f64 {
        self.integral(|radius, _| PI * radius * radius)
    }

    /// The smallest radius of a waist, by parabolas through three nodes; `None` for a curve without one.
    pub fn narrowest(&self) -> Option<f64> {
        let all = self.continued();
        let waist = |nodes: &[[f64; 3]]| {
            let [before, here, after] = [0, 1, 2].map(|k| nodes[k][0]);
            let (slope, bend) = (0.5 * (after - before), after - 2.0 * here + before);
            let is_waist = here <= before && here <= after && here > 0.0;
            is_waist.then(|| if bend > 0.0 { here - 0.5 * slope * slope / bend } else { here })
        };
        let inner = &all[BEYOND - 1..=all.len() - BEYOND];
        inner.windows(3).filter_map(waist).min_by(f64::total_cmp)
    }

    /// The least mean of r^2 over the heights closer than `reach` to that of a node, with the weight [`weight`];
    /// planes at the ends mirror the surface.
    pub fn least_mean_square(&self, reach: f64) -> f64 {
        let [low, high] = [0, self.nodes.len() - 1].map(|k| self.nodes[k][1]);
        let mirrored = self.ends.map(|end| end == End::Mirror);
        // The weight has kinks, and elements may be longer than the reach: many discs, and a mean of what they are.
        let discs = self.discs(16);
        let mean = |[_, centre, _]: &[f64; 3]| {
            let images =
                [(true, *centre), (mirrored[0], 2.0 * low - centre), (mirrored[1], 2.0 * high - centre)];
            let seen = images.iter().filter(|(seen, _)| *seen);
            let parts = seen.flat_map(|(_, image)| {
                discs.iter().map(move |[r, z, thickness]| (r * r, thickness * weight((z - image) / reach)))
            });
            let (sum, whole) =
                parts.fold((0.0, 0.0), |(sum, whole), (square, part)| (sum + square * part, whole + part));
            sum / whole
        };
        self.nodes.iter().map(mean).fold(f64::INFINITY, f64::min)
    }

    /// All nodes moved and their potentials changed at rates (radius, height, potential) for a time.
    pub(super) fn moved(&self, rates: &[[f64; 3]], time: f64) -> Surface {
        let moved = self.nodes.iter().zip(rates);
        let nodes = moved.map(|(node, rate)| [0, 1, 2].map(|of| node[of] + time * rate[of])).collect();
        Surface { nodes, ends: self.ends }
    }

    /// The same curve with nodes as far apart as `fineness` times the smaller radius of curvature, and nowhere
    /// farther than `fineness`.
    pub(super) fn spread(&self, fineness: f64) -> Surface {
        let last = self.nodes.len() - 1;
        let numbers = self.numbers(fineness);
        let wanted = numbers[last];
        if !(1.0..MOST).contains(&wanted) {
            return self.clone();
        }
        // As many nodes as there were, unless they are far too few or too many.
        let count = if (0.9..1.1).contains(&(wanted / last as f64)) { last } else { wanted.ceil() as usize };
        // Like the curve's length it is continued oddly about both ends.
        let below = (1..=BEYOND).rev().map(|k| -numbers[k]);
        let above = (1..=BEYOND).map(|k| 2.0 * wanted - numbers[last - k]);
        let continued = below.chain(numbers.iter().copied()).chain(above);
        let continued: Vec<[f64; 3]> = continued.map(|number| [number, 0.0, 0.0]).collect();
        let all = self.continued();
        let node = |k: usize| {
            let number = k as f64 * wanted / count as f64;
            let element = numbers.partition_point(|before| *before <= number).clamp(1, last) - 1;
            let mut x = (number - numbers[element]) / (numbers[element + 1] - numbers[element]);
            for _ in 0..4 {
                let [value, slope] = interpolate(&continued, element, &Place::new(x, 0.0));
                x -= (value[0] - number) / slope[0];
            }
            interpolate(&all, element, &Place::new(x, 0.0))[0]
        };
        let inner = (1..count).map(node);
        let nodes = [self.nodes[0]].into_iter().chain(inner).chain([self.nodes[last]]).collect();
        Surface { nodes, ends: self.ends }
    }

    /// How many nodes there should be up to each one.
    fn numbers(&self, fineness: f64) -> Vec<f64> {
        let shapes = self.shapes();
        let last = shapes.len() - 1;
        let largest = |shape: &Shape| shape.curvatures.iter().fold(1.0, |most: f64, c| most.max(c.abs()));
        let mut sizes: Vec<f64> = shapes.iter().map(|shape| fineness / largest(shape)).collect();
        for k in 1..=last {
            sizes[k] = sizes[k].min(sizes[k - 1] + STEEPEST * shapes[k].stretch);
        }
        for k in (0..last).rev() {
            sizes[k] = sizes[k].min(sizes[k + 1] + STEEPEST * shapes[k].stretch);
        }
        let mut density: Vec<f64> =
            shapes.iter().zip(&sizes).map(|(shape, size)| shape.stretch / size).collect();
        // Even about both ends.
        let at = |density: &[f64], k: isize| {
            let k = k.unsigned_abs();
            density[if k > last { 2 * last - k } else { k }]
        };
        for _ in 0..SMOOTHINGS {
            let mean = |k: isize| 0.25 * (at(&density, k - 1) + at(&density, k + 1)) + 0.5 * at(&density, k);
            density = (0..=last as isize).map(mean).collect();
        }
        let mut numbers = vec![0.0];
        for k in 0..last as isize {
            // The integral between two nodes of the cubic through four.
            let [before, start, end, after] = [k - 1, k, k + 1, k + 2].map(|k| at(&density, k));
            numbers.push(numbers[k as usize] + (13.0 * (start + end) - before - after) / 24.0);
        }
        numbers
    }
}
