//! Small motions of viscous drops and jets: the exact rates, from their dispersion relations.

use faer::c64;

/// A damped oscillation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    /// Angular frequency in rad/s.
    pub angular_frequency: f64,
    /// Rate of decay in 1/s.
    pub decay: f64,
}

/// The steps in which the viscosity rises from none to the liquid's: the root of one is the first guess for
/// that of the next.
const STEPS: u32 = 64;

/// Iterations of a secant at most; five or so are usual.
const ITERATIONS: usize = 40;

/// Mode n of a drop of radius R (m) and kinematic viscosity nu (m2/s) that oscillates with omega (rad/s)
/// without viscosity; `None` where viscosity lets it creep back instead (Reid 1960; Chandrasekhar 1961,
/// section 98): e^{s t} with
///
/// ```text
/// s^2 + omega^2 + 2 (n - 1) nu s/R^2 [n + (n + 1)(x - 2 n Q)/(x - 2 Q)] = 0
/// Q = j_{n+1}(x)/j_n(x), x^2 = -s R^2/nu
/// ```
///
/// For a small viscosity the bracket is 2 n + 1: Lamb's law, s = -(n - 1)(2 n + 1) nu/R^2 +- i omega.
pub fn drop_mode(mode: u32, angular_frequency: f64, radius: f64, viscosity: f64) -> Option<Mode> {
    let n = f64::from(mode);
    // In units of omega and R.
    let largest = viscosity / (radius * radius * angular_frequency);
    let mut root = c64::new(0.0, 1.0);
    for step in 1..=if largest > 0.0 { STEPS } else { 0 } {
        let viscosity = largest * f64::from(step) / f64::from(STEPS);
        let equation = |s: c64| {
            let x = (-s / viscosity).sqrt();
            let ratio = bessel_ratio(mode, x);
            let bracket = n + (n + 1.0) * (x - 2.0 * n * ratio) / (x - 2.0 * ratio);
            s * s + 1.0 + 2.0 * (n - 1.0) * viscosity * s * bracket
        };
        root = secant(equation, root)?;
        if root.im < 1e-3 {
            return None;
        }
    }
    Some(Mode { angular_frequency: root.im * angular_frequency, decay: -root.re * angular_frequency })
}

fn secant(equation: impl Fn(c64) -> c64, guess: c64) -> Option<c64> {
    let (mut last, mut root) = (guess, guess * c64::new(1.0, 1e-4));
    let mut last_value = equation(last);
    for _ in 0..ITERATIONS {
        let value = equation(root);
        let step = value * (root - last) / (value - last_value);
        if !step.norm().is_finite() {
            // Both values are equal: the last step was too short to tell.
            break;
        }
        (last, last_value, root) = (root, value, root - step);
        if step.norm() < 1e-14 {
            break;
        }
    }
    (equation(root).norm() < 1e-9).then_some(root)
}

/// j_{n+1}(x)/j_n(x) of spherical Bessel functions for Im x < 0.
fn bessel_ratio(mode: u32, x: c64) -> c64 {
    let n = f64::from(mode);
    if x.norm() > 50.0 + n * n {
        // Upwards from j_1/j_0 = 1/x - cot x, where cot x = i but for e^{2 Im x}.
        let first = x.inv() - c64::new(0.0, 1.0);
        return (1..=mode).fold(first, |ratio, k| (2.0 * f64::from(k) + 1.0) / x - ratio.inv());
    }
    // Downwards from where the ratio is small: exact for any x.
    let highest = mode + 60 + 2 * x.norm() as u32;
    let zero = c64::new(0.0, 0.0);
    (mode..highest).rev().fold(zero, |ratio, k| ((2.0 * f64::from(k) + 3.0) / x - ratio).inv())
}

/// The rate of growth in 1/s of a wave on a jet of radius R (m) and kinematic viscosity nu (m2/s), that grows
/// with q0 (1/s) without viscosity (Rayleigh 1892; Chandrasekhar 1961, section 111); k is the wavenumber times
/// the radius:
///
/// ```text
/// s^2 + 2 nu k^2/R^2 [1 - I1(k)/(k I0(k)) - 2 k l/(l^2 + k^2) I1(k)/I0(k) (I0(l)/I1(l) - 1/l)] s
///     = q0^2 (l^2 - k^2)/(l^2 + k^2),  l^2 = k^2 + s R^2/nu
/// ```
pub fn jet_growth_rate(wavenumber: f64, inviscid_rate: f64, radius: f64, viscosity: f64) -> f64 {
    let (k, scaled) = (wavenumber, viscosity / (radius * radius * inviscid_rate));
    if scaled == 0.0 {
        return inviscid_rate;
    }
    let bessel = modified_ratio(k);
    // In units of q0, divided by s: l = k is no motion.
    let excess = |s: f64| {
        let l = (k * k + s / scaled).sqrt();
        let twisted = 2.0 * k * l / (l * l + k * k) * bessel * (1.0 / modified_ratio(l) - 1.0 / l);
        let resistance = 2.0 * scaled * k * k * (1.0 - bessel / k - twisted);
        s + resistance - 1.0 / (2.0 * k * k * scaled + s)
    };
    // It rises with s: halve the interval until no number lies between.
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if excess(middle) > 0.0 { high = middle } else { low = middle }
    }
    0.5 * (low + high) * inviscid_rate
}

/// I1(x)/I0(x) of modified Bessel functions for x > 0.
fn modified_ratio(x: f64) -> f64 {
    if x > 500.0 {
        // Asymptotic: the next term is 1/x^4.
        return 1.0 - 0.5 / x - 0.125 / (x * x) - 0.125 / (x * x * x);
    }
    let highest = 60 + 2 * x as u32;
    (0..highest).rev().fold(0.0, |ratio, k| 1.0 / (2.0 * (f64::from(k) + 1.0) / x + ratio))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Roots found with 30 digits, of the relations as Chandrasekhar writes them, for rho = sigma = R = 1.
    #[test]
    fn drops() {
        let exact = [
            (2, 0.001, -0.004920017988, 2.828345264),
            (2, 0.01, -0.04741484376, 2.825742374),
            (2, 0.1, -0.4066758797, 2.75122591),
            (2, 0.5, -1.796436026, 2.066875409),
            (3, 0.01, -0.1301252479, 5.467166441),
            (3, 0.1, -1.048045689, 5.189390931),
            (4, 0.01, -0.2477068584, 8.462821541),
        ];
        for (n, viscosity, decay, frequency) in exact {
            let order = f64::from(n);
            let inviscid = (order * (order - 1.0) * (order + 2.0)).sqrt();
            let mode = drop_mode(n, inviscid, 1.0, viscosity).expect("an oscillation");
            assert!((mode.decay / -decay - 1.0).abs() < 1e-8, "{n} {viscosity}: {mode:?}");
            assert!((mode.angular_frequency / frequency - 1.0).abs() < 1e-8, "{n} {viscosity}: {mode:?}");
        }
        // Lamb's law holds for the smallest viscosities, where the ratio of Bessel functions is found upwards.
        let mode = drop_mode(2, 8f64.sqrt(), 1.0, 1e-9).expect("an oscillation");
        assert!((mode.decay / 5e-9 - 1.0).abs() < 1e-3, "{mode:?}");
        assert_eq!(drop_mode(2, 8f64.sqrt(), 1.0, 5.0), None);
        let inviscid = drop_mode(2, 3.0, 1.0, 0.0).expect("an oscillation");
        assert_eq!((inviscid.angular_frequency, inviscid.decay), (3.0, 0.0));
    }

    #[test]
    fn jets() {
        let (k, inviscid) = (0.2 * PI, 0.33754);
        let exact = [(0.001, 0.3369458272), (0.01, 0.3317678503), (0.1, 0.2854144476), (1.0, 0.09308076374)];
        for (viscosity, rate) in exact {
            let found = jet_growth_rate(k, inviscid, 1.0, viscosity);
            // The inviscid rate above has five digits.
            assert!((found / rate - 1.0).abs() < 2e-5, "{viscosity}: {found}");
        }
        let found = jet_growth_rate(k, inviscid, 1.0, 1e-7);
        assert!(found < inviscid && found > 0.9999 * inviscid, "{found}");
        assert_eq!(jet_growth_rate(k, inviscid, 1.0, 0.0), inviscid);
    }
}
