//! How the flow goes on: the equations at the nodes, and steps.

use super::element::{AT_START, BEYOND, Place, Rules, TWO_POINTS, interpolate};
use super::ring::Ring;
use super::surface::{End, Shape, Surface};
use faer::Mat;
use faer::linalg::solvers::Solve;

/// The longest step over the power 3/2 of the shortest distance of nodes. The shortest wave on them, of two
/// distances d, has the frequency (pi/d)^(3/2): 2.5 radians, of 2.8 where Runge and Kutta's method becomes
/// unstable.
const LONGEST: f64 = 0.45;
/// A flow that has not come where it should after so many steps, or with so many nodes, some times what any has
/// needed, is given up.
const STEPS: usize = 6000;
const NODES: usize = 300;
/// Hurwitz's zeta functions sum n^-3, n^-5 and n^-7 over n = 2, 3, ... and over n = 5/2, 7/2, ...
const WHOLE: [f64; 3] = [0.202_056_903_2, 0.036_927_755_1, 0.008_349_277_4];
const HALF: [f64; 3] = [0.118_102_025_8, 0.013_073_166_1, 0.001_830_564_8];

/// The surface, or what is seen of it in the planes at its ends: z becomes `sign` z + `shift`.
struct Image {
    sign: f64,
    shift: f64,
    /// If this stands for a whole row of far images, the sums for [`Ring::of_row`].
    row: Option<[f64; 3]>,
}

impl Image {
    fn all(surface: &Surface) -> Vec<Self> {
        let [low, high] = [0, surface.nodes.len() - 1].map(|k| surface.nodes[k][1]);
        let image = |sign: f64, shift: f64| Image { sign, shift, row: None };
        let mut images = vec![image(1.0, 0.0)];
        match surface.ends {
            [End::Axis, End::Axis] => {}
            [End::Mirror, End::Axis] => images.push(image(-1.0, 2.0 * low)),
            [End::Axis, End::Mirror] => images.push(image(-1.0, 2.0 * high)),
            [End::Mirror, End::Mirror] => {
                let period = 2.0 * (high - low);
                images.extend([-1.0, 1.0].map(|n| image(1.0, n * period)));
                images.extend([-1.0, 0.0, 1.0, 2.0].map(|n| image(-1.0, 2.0 * low + n * period)));
                let sums = |zeta: [f64; 3]| {
                    Some(std::array::from_fn(|k| 2.0 * zeta[k] / period.powi(2 * k as i32 + 3)))
                };
                images.push(Image { row: sums(WHOLE), ..image(1.0, 0.0) });
                images.push(Image { row: sums(HALF), ..image(-1.0, 2.0 * low + 0.5 * period) });
            }
        }
        images
    }
}

/// A point of an element.
struct Sample {
    radius: f64,
    height: f64,
    potential: f64,
    /// r ds times the weight.
    source: f64,
    /// The outward normal (radial, axial) times ds and the weight.
    normal: [f64; 2],
}

/// A liquid that moves without viscosity.
pub struct Flow {
    surface: Surface,
    time: f64,
    fineness: f64,
    steps: usize,
    rules: Rules,
}

impl Flow {
    /// Nodes are `fineness` times the smaller radius of curvature apart, at most `fineness`.
    pub(super) fn new(mut surface: Surface, fineness: f64) -> Self {
        // Each time the spacing changes by a bounded part from node to node of what was there.
        for _ in 0..6 {
            surface = surface.spread(fineness);
        }
        Flow { surface, time: 0.0, fineness, steps: 0, rules: Rules::new() }
    }

    /// The surface now.
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// Time since the start.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Times and what is measured of the surface after every step, until `reached` says so or there is nothing to
    /// measure.
    pub fn observed(
        mut self,
        measure: impl Fn(&Surface) -> Option<f64>,
        reached: impl Fn(f64) -> bool,
    ) -> [Vec<f64>; 2] {
        let (mut times, mut values) = (Vec::new(), Vec::new());
        while self.steps < STEPS && self.surface.nodes.len() < NODES {
            let Some(value) = measure(&self.surface).filter(|value| value.is_finite()) else { break };
            times.push(self.time);
            values.push(value);
            if reached(value) {
                break;
            }
            self.advance(f64::INFINITY);
        }
        [times, values]
    }

    /// One step, not beyond a time.
    pub fn advance(&mut self, until: f64) {
        let shapes = self.surface.shapes();
        let shortest = shapes.iter().fold(f64::INFINITY, |least, shape| shape.stretch.min(least));
        let step = (LONGEST * shortest.powf(1.5)).min(until - self.time);
        let first = self.rates(&self.surface);
        let second = self.rates(&self.surface.moved(&first, 0.5 * step));
        let third = self.rates(&self.surface.moved(&second, 0.5 * step));
        let fourth = self.rates(&self.surface.moved(&third, step));
        let mean = |k: usize| {
            [0, 1, 2].map(|of| (first[k][of] + 2.0 * (second[k][of] + third[k][of]) + fourth[k][of]) / 6.0)
        };
        let mean: Vec<[f64; 3]> = (0..first.len()).map(mean).collect();
        // Polynomials through six nodes damp what only two of them resolve: no waves grow from node to node.
        self.surface = self.surface.moved(&mean, step).spread(self.fineness);
        self.time += step;
        self.steps += 1;
    }

    /// Nodes move with the liquid, and there Bernoulli's law holds: dphi/dt = u^2/2 - kappa.
    fn rates(&self, surface: &Surface) -> Vec<[f64; 3]> {
        let outward = self.outward_speed(surface);
        let rate = |(shape, outward): (Shape, &f64)| {
            let [radial, axial, along] = shape.slope.map(|slope| slope / shape.stretch);
            let square = outward * outward + along * along;
            let pressure = shape.curvatures[0] + shape.curvatures[1];
            [outward * axial + along * radial, along * axial - outward * radial, 0.5 * square - pressure]
        };
        let mut rates: Vec<[f64; 3]> = surface.shapes().into_iter().zip(&outward).map(rate).collect();
        let last = rates.len() - 1;
        for (k, end) in [(0, surface.ends[0]), (last, surface.ends[1])] {
            // Rounding must not take a pole from the axis.
            rates[k][if end == End::Axis { 0 } else { 1 }] = 0.0;
        }
        rates
    }

    /// Outward speed of the liquid at every node: Green's third identity less that for a constant potential,
    /// ```text
    /// integral of G dphi/dn = integral of (phi - phi_0) dG/dn
    /// ```
    /// over the surface and its images, with the potential phi_0 at the node.
    fn outward_speed(&self, surface: &Surface) -> Vec<f64> {
        let (images, samples, count) = (Image::all(surface), self.samples(surface), surface.nodes.len());
        let mut matrix = Mat::<f64>::zeros(count, count);
        let mut right = Mat::<f64>::zeros(count, 1);
        let mut row = vec![0.0; count + 2 * BEYOND];
        for node in 0..count {
            row.fill(0.0);
            right[(node, 0)] =
                images.iter().map(|image| self.add(image, (surface, &samples), node, &mut row)).sum();
            // A node beyond an end is that before it.
            let last = count - 1;
            for (k, entry) in row.iter().enumerate() {
                let before = k.abs_diff(BEYOND);
                matrix[(node, if before > last { 2 * last - before } else { before })] += entry;
            }
        }
        let solution = matrix.partial_piv_lu().solve(&right);
        (0..count).map(|k| solution[(k, 0)]).collect()
    }

    /// The points of every element by every rule.
    fn samples(&self, surface: &Surface) -> Vec<[Vec<Sample>; 6]> {
        let all = surface.continued();
        let sample = |element: usize, place: &Place| {
            let [[radius, height, potential], [outward, rise, _]] = interpolate(&all, element, place);
            let source = radius * outward.hypot(rise) * place.weight;
            let normal = [rise * place.weight, -outward * place.weight];
            Sample { radius, height, potential, source, normal }
        };
        let element = |element: usize| {
            std::array::from_fn(|rule| {
                self.rules.0[rule].iter().map(|place| sample(element, place)).collect()
            })
        };
        (0..surface.nodes.len() - 1).map(element).collect()
    }

    /// Adds to a row, by nodes with those beyond the ends, what sources on an image make at a node; returns what
    /// its dipoles make there.
    fn add(
        &self,
        image: &Image,
        (surface, samples): (&Surface, &[[Vec<Sample>; 6]]),
        node: usize,
        row: &mut [f64],
    ) -> f64 {
        let [point, level, own] = surface.nodes[node];
        let height = |z: f64| image.sign * z + image.shift - level;
        let mut sum = 0.0;
        for (element, by_rule) in samples.iter().enumerate() {
            let [start, end] = [surface.nodes[element], surface.nodes[element + 1]];
            let rule = if image.row.is_some() {
                TWO_POINTS
            } else {
                let square = (end[0] - start[0]).powi(2) + (end[1] - start[1]).powi(2);
                let far = |r: f64, z: f64| ((r - point).powi(2) + height(z).powi(2)) / square;
                let by_distance =
                    Rules::by_distance(far(0.5 * (start[0] + end[0]), 0.5 * (start[1] + end[1])));
                match [start, end].map(|[r, z, _]| far(r, z) < 1e-18) {
                    [true, _] => AT_START,
                    [_, true] => AT_START + 1,
                    _ => by_distance,
                }
            };
            for (sample, place) in by_rule[rule].iter().zip(&self.rules.0[rule]) {
                let ring = match &image.row {
                    None => Ring::new(point, sample.radius, height(sample.height)),
                    Some(sums) => Ring::of_row(point, sample.radius, height(sample.height), sums),
                };
                let dipole =
                    ring.dipole[0] * sample.normal[0] + image.sign * ring.dipole[1] * sample.normal[1];
                sum += (sample.potential - own) * dipole;
                for (entry, value) in row[element + BEYOND - 2..].iter_mut().zip(&place.value) {
                    *entry += sample.source * ring.source * value;
                }
            }
        }
        sum
    }
}
