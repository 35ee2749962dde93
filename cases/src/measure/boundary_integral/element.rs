//! Values between nodes, and rules to integrate over what lies between two of them.

use crate::scene::legendre;
use std::f64::consts::PI;

/// Values at six nodes give those between the middle two.
pub(super) const STENCIL: usize = 6;
/// So many nodes are needed beyond an end, for derivatives at the last one.
pub(super) const BEYOND: usize = 3;

/// A place between two nodes, x from 0 to 1, and what the nodes at -2 to 3 weigh there.
pub(super) struct Place {
    /// Of an integral over x.
    pub(super) weight: f64,
    pub(super) value: [f64; STENCIL],
    /// d/dx.
    pub(super) slope: [f64; STENCIL],
}

impl Place {
    /// Lagrange's polynomial through the six nodes.
    pub(super) fn new(x: f64, weight: f64) -> Self {
        let node = |k: usize| k as f64 - 2.0;
        let others = |k: usize| (0..STENCIL).filter(move |j| *j != k);
        let factor = |k: usize, j: usize| (x - node(j)) / (node(k) - node(j));
        let value = std::array::from_fn(|k| others(k).map(|j| factor(k, j)).product());
        let slope = std::array::from_fn(|k| {
            let without = |j: usize| others(k).filter(|i| *i != j).map(|i| factor(k, i)).product::<f64>();
            others(k).map(|j| without(j) / (node(k) - node(j))).sum()
        });
        Place { weight, value, slope }
    }
}

/// Values and their slopes at a place after a node of the continued curve.
pub(super) fn interpolate(continued: &[[f64; 3]], element: usize, place: &Place) -> [[f64; 3]; 2] {
    let nodes = &continued[element + BEYOND - 2..];
    let sum = |weights: &[f64; STENCIL]| {
        let terms = nodes.iter().zip(weights);
        terms.fold([0.0; 3], |sum, (node, weight)| [0, 1, 2].map(|of| sum[of] + weight * node[of]))
    };
    [sum(&place.value), sum(&place.slope)]
}

/// Rules for the integral over an element: Gauss's with 1, 2, 4 and 8 points, the nearer the more, and two for a
/// logarithm at x = 0 or 1, with ten of Gauss's points after the substitution x = u^3, which leaves u^2 ln u.
pub(super) struct Rules(pub(super) [Vec<Place>; 6]);

/// Index of the rule for a logarithm at x = 0; the next is for one at 1.
pub(super) const AT_START: usize = 4;
/// Index of Gauss's rule with two points.
pub(super) const TWO_POINTS: usize = 1;

impl Rules {
    pub(super) fn new() -> Self {
        let plain = |count| gauss(count).into_iter().map(|[x, weight]| Place::new(x, weight)).collect();
        let graded = |from: fn(f64) -> f64| {
            let graded = gauss(10).into_iter().map(|[u, weight]| (from(u * u * u), 3.0 * u * u * weight));
            graded.map(|(x, weight)| Place::new(x, weight)).collect()
        };
        Rules([plain(1), plain(2), plain(4), plain(8), graded(|x| x), graded(|x| 1.0 - x)])
    }

    /// The rule for an element, by the square of a point's distance to its middle over its length.
    pub(super) fn by_distance(square: f64) -> usize {
        match square {
            900.0.. => 0,
            16.0.. => TWO_POINTS,
            1.5.. => 2,
            _ => 3,
        }
    }
}

/// Gauss's points between 0 and 1 and their weights.
pub(super) fn gauss(count: usize) -> Vec<[f64; 2]> {
    let point = |k: usize| {
        // A zero of Legendre's polynomial by Newton's method.
        let mut x = (PI * (k as f64 + 0.75) / (count as f64 + 0.5)).cos();
        for _ in 0..8 {
            let [value, slope] = legendre(count, x);
            x -= value / slope;
        }
        let slope = legendre(count, x)[1];
        [0.5 + 0.5 * x, 1.0 / ((1.0 - x * x) * slope * slope)]
    };
    (0..count).map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_are_exact_for_their_kind() {
        let rules = Rules::new();
        let integral = |rule: usize, of: &dyn Fn(f64) -> f64| -> f64 {
            // The polynomial x through the nodes is x.
            let x = |place: &Place| place.value.iter().enumerate().map(|(k, w)| w * (k as f64 - 2.0)).sum();
            rules.0[rule].iter().map(|place| place.weight * of(x(place))).sum()
        };
        for (rule, degree) in [(0, 1), (1, 3), (2, 7), (3, 15)] {
            let found = integral(rule, &|x| x.powi(degree));
            assert!((found * f64::from(degree + 1) - 1.0).abs() < 1e-12, "{degree}: {found}");
        }
        // ln x (1 + x) has the integral -5/4.
        for (rule, from) in [(AT_START, 0.0), (AT_START + 1, 1.0)] {
            let found = integral(rule, &|x: f64| (x - from).abs().ln() * (1.0 + (x - from).abs()));
            assert!((found + 1.25).abs() < 3e-6, "{rule}: {found}");
        }
    }

    #[test]
    fn six_nodes_give_a_polynomial_of_fifth_degree() {
        let curve = |x: f64| 1.0 - x + 0.3 * x.powi(2) + 0.01 * x.powi(5);
        let nodes: Vec<[f64; 3]> = (0..8).map(|k| f64::from(k) - 3.0).map(|x| [x, curve(x), 0.0]).collect();
        let [value, slope] = interpolate(&nodes, 1, &Place::new(0.3, 0.0));
        assert!((value[0] - 1.3).abs() < 1e-12 && (slope[0] - 1.0).abs() < 1e-12);
        assert!((value[1] - curve(1.3)).abs() < 1e-12, "{value:?}");
        let exact = -1.0 + 0.6 * 1.3 + 0.05 * 1.3f64.powi(4);
        assert!((slope[1] - exact).abs() < 1e-12, "{slope:?}");
    }
}
