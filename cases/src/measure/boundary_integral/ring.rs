//! The potential of a ring of sources, and of its images.

use std::f64::consts::PI;

/// Coefficients of K = p(x) - q(x) ln x and E = p(x) - q(x) ln x with x = 1 - m, lowest power first (Hastings 1955;
/// Abramowitz and Stegun 1964, equations 17.3.34 and 17.3.36): good to 2e-8.
const FIRST: [[f64; 5]; 2] = [
    [1.386_294_361_12, 0.096_663_442_59, 0.035_900_923_83, 0.037_425_637_13, 0.014_511_962_12],
    [0.5, 0.124_985_935_97, 0.068_802_485_76, 0.033_283_553_46, 0.004_417_870_12],
];
const SECOND: [[f64; 5]; 2] = [
    [1.0, 0.443_251_414_63, 0.062_606_012_20, 0.047_573_835_46, 0.017_365_064_51],
    [0.0, 0.249_983_683_10, 0.092_001_800_37, 0.040_696_975_26, 0.005_264_496_39],
];

/// Complete elliptic integrals K and E of the parameter m, by 1 - m in ]0, 1].
fn elliptic(complement: f64) -> [f64; 2] {
    let logarithm = complement.ln();
    let polynomial = |of: &[f64; 5]| of.iter().rev().fold(0.0, |sum, next| sum * complement + next);
    [FIRST, SECOND].map(|[plain, by_logarithm]| polynomial(&plain) - polynomial(&by_logarithm) * logarithm)
}

/// What a ring's sources make at a point, and what their dipoles make: the mean G of 1/(4 pi distance) times 2 pi,
/// and r dG/dr and r dG/dz by the ring's place.
#[derive(Clone, Copy, Default)]
pub(super) struct Ring {
    pub(super) source: f64,
    pub(super) dipole: [f64; 2],
}

impl Ring {
    /// Of a ring of radius r whose plane is `height` above a point with the radius `point`:
    /// ```text
    /// G = K/(pi S), S^2 = (r + r_0)^2 + z^2, D^2 = (r - r_0)^2 + z^2, m = 4 r r_0/S^2
    /// r dG/dr = [(r_0^2 - r^2 + z^2) E/D^2 - K]/(2 pi S), dG/dz = -z E/(pi S D^2)
    /// ```
    /// (Pozrikidis 2002, A Practical Guide to Boundary Element Methods, chapter 4; and its derivatives).
    pub(super) fn new(point: f64, radius: f64, height: f64) -> Self {
        let square = height * height;
        let far = (radius + point).powi(2) + square;
        let near = (radius - point).powi(2) + square;
        let [first, second] = elliptic(near / far);
        let scale = 1.0 / (PI * far.sqrt());
        let steep = second / near;
        let outward = 0.5 * scale * ((point * point - radius * radius + square) * steep - first);
        Ring { source: scale * first, dipole: [outward, -radius * scale * height * steep] }
    }

    /// Of rings at height + n `period` for n = +-first, +-(first + 1) and so on, less what does not depend on the
    /// places (it acts on the sum of all sources, which is zero): solid harmonics s^l P_l up to degree 6, averaged
    /// over the ring, times `sums` of 2/(n period)^(l + 1) for l = 2, 4 and 6.
    pub(super) fn of_row(point: f64, radius: f64, height: f64, sums: &[f64; 3]) -> Self {
        let (z, r2, p2) = (height * height, radius * radius, point * point);
        let (sum, product) = (r2 + p2, r2 * p2);
        // Means over the ring of the distance from the axis, squared and so on, and r d/dr of them.
        let means = [sum, sum * sum + 2.0 * product, sum * (sum * sum + 6.0 * product)];
        let slopes = [
            2.0 * r2,
            4.0 * r2 * sum + 4.0 * product,
            2.0 * r2 * (3.0 * sum * sum + 6.0 * product) + 12.0 * sum * product,
        ];
        let harmonics = |m: &[f64; 3], one: f64| {
            [
                one * z - 0.5 * m[0],
                one * z * z - 3.0 * z * m[0] + 0.375 * m[1],
                one * z * z * z - 7.5 * z * z * m[0] + 5.625 * z * m[1] - 0.3125 * m[2],
            ]
        };
        let along = [
            2.0 * height,
            height * (4.0 * z - 6.0 * means[0]),
            height * (6.0 * z * z - 30.0 * z * means[0] + 11.25 * means[1]),
        ];
        let total = |values: [f64; 3]| 0.5 * values.iter().zip(sums).map(|(a, b)| a * b).sum::<f64>();
        let dipole = [total(harmonics(&slopes, 0.0)), radius * total(along)];
        Ring { source: total(harmonics(&means, 1.0)), dipole }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the arithmetic-geometric mean (Abramowitz and Stegun, 17.6).
    fn by_means(complement: f64) -> [f64; 2] {
        let (mut a, mut g, mut power) = (1.0f64, complement.sqrt(), 0.5);
        let mut sum = power * (1.0 - complement);
        while (a - g).abs() > 1e-15 {
            let c = 0.5 * (a - g);
            (a, g) = (0.5 * (a + g), (a * g).sqrt());
            power *= 2.0;
            sum += power * c * c;
        }
        let first = 0.5 * PI / a;
        [first, first * (1.0 - sum)]
    }

    #[test]
    fn elliptic_integrals() {
        for k in 0..=400 {
            let complement = 10f64.powf(-0.02 * f64::from(k));
            let (found, exact) = (elliptic(complement), by_means(complement));
            for (found, exact) in found.iter().zip(exact) {
                assert!((found - exact).abs() < 3e-8, "{complement}: {found} {exact}");
            }
        }
    }

    /// 1/(4 pi distance) summed over the ring's points, and differences of that by the ring's place.
    #[test]
    fn rings() {
        let direct = |point: f64, radius: f64, height: f64| {
            let count = 4000;
            let distance = |k: i32| {
                let cosine = (2.0 * PI * f64::from(k) / f64::from(count)).cos();
                (point * point + radius * radius - 2.0 * point * radius * cosine + height * height).sqrt()
            };
            (0..count).map(|k| 0.5 / distance(k)).sum::<f64>() / f64::from(count)
        };
        let step = 1e-4;
        let check = |found: Ring, field: &dyn Fn(f64, f64) -> f64, radius: f64, height: f64| {
            let by_radius = (field(radius + step, height) - field(radius - step, height)) / (2.0 * step);
            let by_height = (field(radius, height + step) - field(radius, height - step)) / (2.0 * step);
            let near = |found: f64, exact: f64| {
                assert!(
                    (found - exact).abs() < 3e-6 * (1.0 + exact.abs()),
                    "{radius} {height}: {found} {exact}"
                );
            };
            near(found.source, field(radius, height));
            near(found.dipole[0], radius * by_radius);
            near(found.dipole[1], radius * by_height);
        };
        for (point, radius, height) in [(1.0, 1.2, 0.1), (0.0, 0.5, -0.3), (0.4, 0.2, 0.0), (0.7, 2.0, -3.0)]
        {
            let field = |radius: f64, height: f64| direct(point, radius, height);
            check(Ring::new(point, radius, height), &field, radius, height);
            // 20000 images: the rest of their sum of 1/n^3 is 1e-9.
            let (period, first) = (10.0, 3);
            let sums = [2, 4, 6].map(|degree| {
                (first..20_000).map(|n| 2.0 / (period * f64::from(n)).powi(degree + 1)).sum::<f64>()
            });
            let row = |radius: f64, height: f64| {
                let image = |n: i32| {
                    let far = period * f64::from(n);
                    let [up, down] = [height + far, height - far].map(|z| Ring::new(point, radius, z).source);
                    up + down - 1.0 / far
                };
                (first..400).map(image).sum::<f64>()
            };
            let found = Ring::of_row(point, radius, height, &sums);
            assert!(
                (found.source - row(radius, height)).abs() < 1e-5,
                "{} {}",
                found.source,
                row(radius, height)
            );
        }
    }
}
