//! Adaptive Gauss-Kronrod quadrature of chords over z.

use super::Shape;
use crate::region::Region;

/// Kronrod's 15 abscissae (the positive half) with their weights and, for every second one, Gauss's.
const NODES: [[f64; 3]; 8] = [
    [0.991_455_371_120_812_6, 0.022_935_322_010_529_224, 0.0],
    [0.949_107_912_342_758_5, 0.063_092_092_629_978_56, 0.129_484_966_168_869_7],
    [0.864_864_423_359_769_1, 0.104_790_010_322_250_18, 0.0],
    [0.741_531_185_599_394_4, 0.140_653_259_715_525_92, 0.279_705_391_489_276_64],
    [0.586_087_235_467_691_1, 0.169_004_726_639_267_9, 0.0],
    [0.405_845_151_377_397_2, 0.190_350_578_064_785_4, 0.381_830_050_505_118_9],
    [0.207_784_955_007_898_47, 0.204_432_940_075_298_9, 0.0],
    [0.0, 0.209_482_141_084_727_82, 0.417_959_183_673_469_4],
];

/// Stretches that every smooth part is first cut into, so that no narrow feature hides from the
/// error estimate.
const STRETCHES: usize = 16;

/// Halvings at most: a jump at an unknown height is then placed to 2^-40 of a stretch.
const DEPTH: usize = 40;

/// Halvings in all, so that a boundary too rough to integrate ends in an estimate, not in a hang.
const BUDGET: usize = 2000;

/// Tolerance of one stretch, relative to the whole.
const TOLERANCE: f64 = 1e-13;

/// Area of the section and its first moment about r = 0.
pub(super) fn moments(shape: &Shape) -> [f64; 2] {
    let [_, _, bottom, top] = shape.bounds();
    let mut heights = vec![bottom, top];
    shape.heights(&mut heights);
    heights.retain(|height| (bottom..=top).contains(height));
    heights.sort_by(f64::total_cmp);
    let stretches: Vec<[f64; 2]> = heights
        .windows(2)
        .filter(|pair| pair[0] < pair[1])
        .flat_map(|pair| {
            let step = (pair[1] - pair[0]) / STRETCHES as f64;
            (0..STRETCHES).map(move |index| {
                let start = pair[0] + step * index as f64;
                [start, start + step]
            })
        })
        .collect();
    let section = |z: f64| {
        shape.chords(z).iter().fold([0.0, 0.0], |[area, moment], [low, high]| {
            [area + high - low, moment + 0.5 * (high - low) * (high + low)]
        })
    };
    let estimates: Vec<Estimate> = stretches.iter().map(|stretch| estimate(&section, *stretch)).collect();
    let scale = estimates.iter().fold([0.0, 0.0], |total, estimate| add(total, estimate.value));
    let tolerance = scale.map(|value: f64| TOLERANCE * value.abs());
    let mut refinement = Refinement { section, tolerance, budget: BUDGET };
    stretches.iter().zip(estimates).fold([0.0, 0.0], |total, (stretch, estimate)| {
        add(total, refinement.refine(*stretch, estimate, DEPTH))
    })
}

struct Estimate {
    value: [f64; 2],
    error: [f64; 2],
}

struct Refinement<Section> {
    section: Section,
    tolerance: [f64; 2],
    budget: usize,
}

impl<Section: Fn(f64) -> [f64; 2]> Refinement<Section> {
    fn refine(&mut self, [low, high]: [f64; 2], whole: Estimate, depth: usize) -> [f64; 2] {
        let good = whole.error[0] <= self.tolerance[0] && whole.error[1] <= self.tolerance[1];
        if good || depth == 0 || self.budget == 0 {
            return whole.value;
        }
        self.budget -= 1;
        let middle = 0.5 * (low + high);
        [[low, middle], [middle, high]].into_iter().fold([0.0, 0.0], |total, half| {
            let estimate = estimate(&self.section, half);
            add(total, self.refine(half, estimate, depth - 1))
        })
    }
}

fn estimate(section: &impl Fn(f64) -> [f64; 2], [low, high]: [f64; 2]) -> Estimate {
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let (mut kronrod, mut gauss) = ([0.0, 0.0], [0.0, 0.0]);
    for [node, kronrod_weight, gauss_weight] in NODES {
        let mut value = section(middle + half * node);
        if node > 0.0 {
            value = add(value, section(middle - half * node));
        }
        kronrod = add(kronrod, value.map(|value| half * kronrod_weight * value));
        gauss = add(gauss, value.map(|value| half * gauss_weight * value));
    }
    let error = [(kronrod[0] - gauss[0]).abs(), (kronrod[1] - gauss[1]).abs()];
    Estimate { value: kronrod, error }
}

fn add(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] + b[0], a[1] + b[1]]
}
