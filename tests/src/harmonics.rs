//! A nearly spherical surface as a sum of Legendre polynomials, fitted to its points, and its curvature.

/// s(x) = sum over l of c_l P_l(x): the distance from a point of the axis in the direction whose angle to the axis
/// has the cosine x.
#[derive(Clone, Debug)]
pub struct Harmonics {
    centre: f64,
    coefficients: Vec<f64>,
}

impl Harmonics {
    /// The least-squares fit of degree `degree` to points (r, z), about the height `centre`.
    pub fn fit(points: &[[f64; 2]], centre: f64, degree: usize) -> Self {
        let count = degree + 1;
        let mut rows = vec![vec![0.0; count + 1]; count];
        for &point in points {
            let (distance, cosine) = polar(point, centre);
            let values: Vec<f64> = (0..count).map(|l| legendre(l, cosine)[0]).collect();
            for (row, value) in rows.iter_mut().zip(&values) {
                for (entry, other) in row.iter_mut().zip(values.iter().chain([&distance])) {
                    *entry += value * other;
                }
            }
        }
        Harmonics { centre, coefficients: solve(rows) }
    }

    /// The sum of both principal curvatures in the direction of a point (r, z).
    ///
    /// With s' and s'' its derivatives by the angle and w^2 = s^2 + s'^2 they are (s^2 + 2 s'^2 - s s'')/w^3 (the
    /// curvature of a plane curve in polar coordinates) and (1 - s' cot/s)/w, the normal's part along r over r
    /// (do Carmo, Differential Geometry of Curves and Surfaces, section 3-3, example 4).
    pub fn curvature(&self, point: [f64; 2]) -> f64 {
        let (_, cosine) = polar(point, self.centre);
        let [mut s, mut by_cosine, mut twice] = [0.0; 3];
        for (l, coefficient) in self.coefficients.iter().enumerate() {
            let [value, first, second] = legendre(l, cosine);
            s += coefficient * value;
            by_cosine += coefficient * first;
            twice += coefficient * second;
        }
        let square = 1.0 - cosine * cosine;
        let (slope_square, second) = (square * by_cosine * by_cosine, square * twice - cosine * by_cosine);
        let w = (s * s + slope_square).sqrt();
        (s * s + 2.0 * slope_square - s * second) / w.powi(3) + (s + cosine * by_cosine) / (s * w)
    }
}

fn polar([r, z]: [f64; 2], centre: f64) -> (f64, f64) {
    let distance = r.hypot(z - centre);
    (distance, (z - centre) / distance)
}

/// P_l and its first two derivatives, by (l + 1) P_{l+1} = (2 l + 1) x P_l - l P_{l-1}.
fn legendre(degree: usize, x: f64) -> [f64; 3] {
    let (mut before, mut here) = ([0.0; 3], [1.0, 0.0, 0.0]);
    for l in 0..degree {
        let l = l as f64;
        let [value, first, second] = here;
        let times_x = [x * value, value + x * first, 2.0 * first + x * second];
        let next = std::array::from_fn(|k| ((2.0 * l + 1.0) * times_x[k] - l * before[k]) / (l + 1.0));
        (before, here) = (here, next);
    }
    here
}

/// The solution of the symmetric system whose last column is the right-hand side (Gauss).
fn solve(mut rows: Vec<Vec<f64>>) -> Vec<f64> {
    let count = rows.len();
    for k in 0..count {
        let pivot = rows[k].clone();
        for (other, row) in rows.iter_mut().enumerate() {
            if other != k {
                let factor = row[k] / pivot[k];
                row.iter_mut().zip(&pivot).for_each(|(entry, above)| *entry -= factor * above);
            }
        }
    }
    (0..count).map(|k| rows[k][count] / rows[k][k]).collect()
}
