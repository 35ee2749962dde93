use super::*;
use crate::measure::growth::slope;
use crate::measure::potential::PotentialDrop;
use std::f64::consts::PI;

/// Mean of s^2 P_2(cos theta) over the volume.
fn moment(flow: &Flow) -> f64 {
    let of_disc = |r: f64, z: f64| PI * (r * r * z * z - 0.25 * r.powi(4));
    flow.surface().integral(of_disc) / flow.surface().volume()
}

/// C of values' straight line in time, while other values lie in a range.
fn slope_within(times: &[f64], values: &[f64], within: impl Fn(usize) -> bool) -> f64 {
    let chosen = |of: &[f64]| (0..of.len()).filter(|k| within(*k)).map(|k| of[k]).collect::<Vec<f64>>();
    slope(&chosen(times), &chosen(values)).unwrap()
}

/// Legendre polynomials have the same large oscillation to 1e-6.
#[test]
fn a_drop_swings_like_polynomials() {
    for (aspect_ratio, speed) in [(1.5, 0.0), (1.0, 0.7), (0.7, 0.0)] {
        let times: Vec<f64> = (1..=10).map(|k| 0.25 * f64::from(k)).collect();
        let exact = PotentialDrop::default().moments((aspect_ratio, speed), &times);
        let mut flow = Flow::spheroid(aspect_ratio, speed, 0.15);
        let volume = flow.surface().volume();
        assert!((0.75 * volume / PI - 1.0).abs() < 1e-5, "{volume}");
        for (time, exact) in times.iter().zip(exact) {
            while flow.time() < *time {
                flow.advance(*time);
            }
            let found = moment(&flow);
            assert!((found - exact).abs() < 1e-4, "{aspect_ratio} {speed} {time}: {found} {exact}");
        }
        assert!((flow.surface().volume() / volume - 1.0).abs() < 1e-4);
    }
}

/// Rayleigh's rate of growth, q^2 = k I1(k)/I0(k) (1 - k^2), of a wave that starts in motion.
#[test]
fn a_weak_wave_grows_on_a_jet() {
    let (wavenumber, speed) = (0.2 * PI, 1e-4);
    let rate = 0.337_54;
    let mut flow = Flow::jet(wavenumber, speed, 0.25);
    while flow.time() < 4.0 {
        flow.advance(4.0);
    }
    // k I1/I0 times the potential's amplitude is the surface's speed at the start.
    let amplitude = speed / wavenumber * rate / (1.0 - wavenumber * wavenumber) * (4.0 * rate).sinh();
    let found = 1.0 - flow.surface().narrowest().unwrap();
    assert!((found / amplitude - 1.0).abs() < 2e-3, "{found} {amplitude}");
}

/// Day, Hinch and Lister (1998) have h = .7 tau^(2/3) in the end.
#[test]
fn a_jet_tears_by_the_law() {
    let [times, radii] =
        Flow::jet(0.2 * PI, 0.116_25, 0.25).observed(Surface::narrowest, |radius| radius < 0.02);
    let powers: Vec<f64> = radii.iter().map(|radius| radius.powf(1.5)).collect();
    let prefactor = (-slope_within(&times, &powers, |k| radii[k] < 0.03)).powf(2.0 / 3.0);
    assert!((prefactor / 0.7 - 1.0).abs() < 0.03, "{prefactor}");
    // With nodes .15 apart, and steps of three quarters.
    let quarter = times[radii.iter().position(|radius| *radius < 0.25).unwrap()];
    assert!((quarter - 8.190).abs() < 0.01, "{quarter}");
}

/// What a bridge starts from is forgotten where it is measured.
#[test]
fn a_bridge_forgets_its_start() {
    let prefactor = |start: f64| {
        let [times, radii] =
            Flow::bridge(1.0, start, 0.3).observed(Surface::narrowest, |radius| radius > 0.5);
        let squares: Vec<f64> = radii.iter().map(|radius| radius * radius).collect();
        slope_within(&times, &squares, |k| radii[k] > 0.25).sqrt()
    };
    let (narrow, wide) = (prefactor(0.1), prefactor(0.14));
    assert!((narrow / wide - 1.0).abs() < 0.01, "{narrow} {wide}");
}

/// Means of r^2 over heights: of a jet at its start, and a little more than the least one later.
#[test]
fn a_mean_over_heights_is_that_of_the_curve() {
    let mut flow = Flow::jet(0.2 * PI, 0.116_25, 0.25);
    for reach in [0.1, 1.0] {
        let found = flow.surface().least_mean_square(reach);
        assert!((found - 1.0).abs() < 1e-12, "{reach}: {found}");
    }
    while flow.time() < 8.0 {
        flow.advance(8.0);
    }
    let narrowest = flow.surface().narrowest().unwrap();
    let found = flow.surface().least_mean_square(0.1).sqrt();
    assert!(found > narrowest && found < 1.01 * narrowest, "{found} {narrowest}");
}
