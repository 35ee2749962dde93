use super::exact::Drop;
use super::fit;
use super::viscous::Mode;
use super::*;
use crate::scene::{EquationOfState, Liquid, parse};
use std::f64::consts::PI;

#[test]
fn one_observation_tells_of_no_change_and_no_number_of_no_value() {
    let text = "format = 1\n[liquid]\ndensity = \"1 kg/m3\"\n[[body]]\nshape = { sphere = { radius = \"1 m\" } }\n\
                velocity = { z = \"1 m/s\" }\n[particles]\nsize = \"1 cm\"\n[run]\nuntil = \"1 s\"\n";
    let scene = parse("drop.toml", text, &[]).expect("a scene");
    let names = ["time", "momentum z", "momentum scale", "mass"];
    let mut history = History::new(names.map(|name| Quantity { name: name.to_owned(), unit: "1" }).to_vec());
    history.push(vec![0.0, 1.0, 1.0, 2.0]);
    assert!(conservation(&scene, &history).iter().all(|change| change.is_nan()));
    history.push(vec![1.0, 1.0, 1.0, 2.0]);
    let [momentum, _, mass] = conservation(&scene, &history);
    assert_eq!([momentum, mass], [0.0; 2]);
    let outcome = evaluate::Outcome::of("pressure".to_owned(), Some(f64::NAN), "Pa");
    assert!(outcome.doubt.expect("a doubt").contains("no particles are where it looks"));
}

/// What a central force takes from the motion it can give back.
#[test]
fn potential_energy_counts() {
    let text = "format = 1\n[liquid]\ndensity = \"1 kg/m3\"\n[[body]]\nshape = { sphere = { radius = \"1 m\" } }\n\
                velocity = { z = \"1 m/s\" }\n[forces]\ncentral = \"2 Hz^2\"\n[particles]\nsize = \"1 cm\"\n[run]\n\
                until = \"1 s\"\n";
    let scene = parse("drop.toml", text, &[]).expect("a scene");
    let names = ["time", "kinetic energy", "internal energy", "potential energy"];
    let mut history = History::new(names.map(|name| Quantity { name: name.to_owned(), unit: "1" }).to_vec());
    history.push(vec![0.0, 3.0, 1.0, 0.5]);
    history.push(vec![1.0, 1.0, 1.5, 2.0]);
    let [_, energy, _] = conservation(&scene, &history);
    assert_eq!(energy, 0.0);
}

const WATER: Drop = Drop { radius: 2.5e-6, density: 1000.0, surface_tension: 0.074, viscosity: 0.0 };

fn expected() -> Mode {
    WATER.mode(2).expect("an oscillation")
}

/// Times of 4 periods at 40 rows a period, and values of a damped oscillation at them.
fn damped(factor: f64, damping: f64) -> (Vec<f64>, Vec<f64>) {
    let expected = WATER.angular_frequency(2);
    let frequency = factor * expected;
    let rate = damping * frequency / (2.0 * PI);
    let times: Vec<f64> = (0..160).map(|k| f64::from(k) / 40.0 * 2.0 * PI / expected).collect();
    let value = |t: &f64| {
        let (sine, cosine) = (frequency * t).sin_cos();
        (-rate * t).exp() * (1e-3 * cosine + 7e-3 * sine) + 4e-4
    };
    let values = times.iter().map(value).collect();
    (times, values)
}

#[test]
fn a_damped_oscillation_is_recovered() {
    let (mode, expected) = (expected(), WATER.angular_frequency(2));
    for (factor, damping) in [(1.0, 0.0), (1.0031, 0.05), (0.87, 0.6), (1.21, -0.02)] {
        let (times, values) = damped(factor, damping);
        let fit = fit::oscillation(&times, &values, mode).expect("an oscillation");
        let near = |value: f64, exact: f64, scale: f64| {
            assert!((value - exact).abs() < 1e-10 * scale, "{value} {exact}");
        };
        near(fit.angular_frequency, factor * expected, expected);
        near(fit.damping_per_period(), damping, 1.0);
        for (value, exact) in fit.coefficients.iter().zip([1e-3, 7e-3, 4e-4]) {
            near(*value, exact, 1e-3);
        }
        assert!(fit.residual < 1e-10, "{}", fit.residual);
        near(fit.at(times[7]), values[7], 1e-3);
    }
}

#[test]
fn what_is_no_oscillation_has_no_fit() {
    let (times, values) = damped(1.0, 0.0);
    assert!(fit::oscillation(&times[..30], &values[..30], expected()).is_none());
    assert!(fit::oscillation(&times, &vec![0.0; times.len()], expected()).is_none());
    assert!(fit::oscillation(&times, &vec![f64::NAN; times.len()], expected()).is_none());
    assert!(fit::oscillation(&[], &[], expected()).is_none());
}

#[test]
fn exact_solutions() {
    assert!((WATER.laplace_pressure() - 59_200.0).abs() < 1e-9);
    // T = 2 pi sqrt(rho R^3/(8 sigma)).
    let period = 2.0 * PI * (1000.0 * 2.5e-6f64.powi(3) / (8.0 * 0.074)).sqrt();
    assert!((2.0 * PI / WATER.angular_frequency(2) / period - 1.0).abs() < 1e-14);
}

const SCENE: &str = r#"format = 1
[liquid]
density = "1000 kg/m3"
surface_tension = "0.074 N/m"
[[body]]
shape = { sphere = { radius = "1 um" } }
[particles]
size = "50 nm"
[run]
until = "1 us"
[[measure]]
laplace-pressure = { radius = "1 um" }
[[measure]]
laplace-pressure = { radius = "2 um" }
[[measure]]
oscillation = { mode = 2, radius = "1 um" }
[[measure]]
spurious-velocity = { radius = "1 um" }
[[measure]]
energy-gain = {}
[[measure]]
energy-gain = {}
"#;

fn history(rows: &[[f64; 5]]) -> History {
    let names = ["time", "core pressure", "core pressure-2", "mode amplitude", "spurious velocity"];
    let quantity = |name: &&str| Quantity { name: (*name).to_owned(), unit: "1" };
    let mut history = History::new(names.iter().map(quantity).collect());
    rows.iter().for_each(|row| history.push(row.to_vec()));
    history
}

#[test]
fn a_short_run_is_told_in_sentences() {
    let scene = parse("drop.toml", SCENE, &[]).unwrap();
    for rows in [&[][..], &[[0.0; 5]], &[[0.0; 5], [1e-9; 5]]] {
        let outcomes = evaluate(&scene, &history(rows));
        let frequency = outcomes.iter().find(|o| o.name == "frequency").unwrap();
        assert!(frequency.value.is_nan());
        assert!(frequency.doubt.as_ref().unwrap().contains("too short"));
    }
}

#[test]
fn means_are_taken_over_the_right_part() {
    let scene = parse("drop.toml", SCENE, &[]).unwrap();
    let rows: Vec<[f64; 5]> = (0..=100)
        .map(|k| {
            let time = f64::from(k) * 1e-8;
            let pressure = if k < 75 { 1e9 } else { 1.5e5 };
            [time, pressure, pressure, 0.0, 1.0 - time * 1e6]
        })
        .collect();
    let outcomes = evaluate(&scene, &history(&rows));
    let named = |name: &str| outcomes.iter().find(|o| o.name == name).unwrap();
    let first = named("laplace-pressure");
    assert!((first.value - 1.5e5).abs() < 1e-6);
    assert!((first.relative_error().unwrap() - (1.5e5 / 1.48e5 - 1.0)).abs() < 1e-12);
    assert!((named("laplace-pressure-2").reference.unwrap() - 7.4e4).abs() < 1e-6);
    assert!((named("spurious-velocity").value - 0.05).abs() < 1e-9);
    assert!((named("spurious-velocity-start").value - 0.95).abs() < 1e-9);
    assert_eq!(named("spurious-velocity").relative_error(), None);
    assert_eq!(named("energy-gain-2").doubt, named("energy-gain").doubt);
}

#[test]
fn growth_is_recovered() {
    let liquid = Liquid {
        density: 1.0,
        surface_tension: 1.0,
        viscosity: 0.0,
        sound_speed: None,
        equation_of_state: EquationOfState::Linear,
    };
    let (exact, decay) = growth_of_wave(&liquid, 0.2 * PI, 1.0).unwrap();
    assert!((exact - 0.33754).abs() < 5e-6 && (decay - 1.0).abs() < 1e-12, "{exact} {decay}");
    assert!((growth_of_wave(&liquid, 0.697, 1.0).unwrap().0 - 0.34334).abs() < 5e-6);
    assert!(growth_of_wave(&liquid, 1.1, 1.0).is_none());
    let viscous = growth_of_wave(&Liquid { viscosity: 0.1, ..liquid }, 0.2 * PI, 1.0).unwrap();
    assert!((viscous.0 - 0.285414).abs() < 1e-6, "{viscous:?}");
    let times: Vec<f64> = (0..90).map(|k| 3.0 + 0.05 * f64::from(k)).collect();
    for factor in [0.8, 1.0, 1.05] {
        let q = factor * exact;
        for p in [1.0, 1.4] {
            let value = |t: &f64| 0.006 * (q * t).exp() - 0.004 * (-p * q * t).exp() - 0.001;
            let values: Vec<f64> = times.iter().map(value).collect();
            let fit = growth::fit(&times, &values, (exact, p)).unwrap();
            assert!((fit / q - 1.0).abs() < 1e-8, "{factor}, {p}: {fit} {q}");
        }
    }
    let ratio = |sound_speed: f64| compressible_growth_ratio(&liquid, 0.2 * PI, 1.0, sound_speed);
    assert!((ratio(1e6) - 1.0).abs() < 1e-10);
    // To the first order (q R/C)^2/(2 k^2) times d ln(kappa I1/I0)/d ln(kappa^2), by its series 1 - kappa^2/8.
    let (k, rise) = (0.2 * PI, (exact / 10.0).powi(2));
    let series = 1.0 + 0.5 * rise / (k * k) * (1.0 - k * k / 8.0);
    assert!((ratio(10.0) - series).abs() < 1e-5, "{} {series}", ratio(10.0));
    assert!(growth::fit(&times[..5], &times[..5], (exact, 1.0)).is_none());
    let line: Vec<f64> = times.iter().map(|t| 2.0 - 0.7 * t).collect();
    assert!((growth::slope(&times, &line).unwrap() + 0.7).abs() < 1e-12);
}
