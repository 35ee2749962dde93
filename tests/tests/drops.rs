//! Drops against exact solutions, and every choice of the method over some hundred steps.

use meniscus_cases::simulation::Simulation;
use meniscus_stages::liquids::{EquationOfState, MieGrueneisen};
use meniscus_stages::surface::BOUNDARY;
use meniscus_tests::drops::{self, is_finite, mean_speed, totals};
use std::f64::consts::PI;

/// A damped cosine about a constant, by least squares over a search in frequency and damping.
struct Fit {
    frequency: f64,
    damping: f64,
}

/// Squared residual of the best a e^{-gt} cos(wt) + b e^{-gt} sin(wt) + c.
fn residual(samples: &[(f64, f64)], frequency: f64, damping: f64) -> f64 {
    let basis = |t: f64| {
        let envelope = (-damping * t).exp();
        [envelope * (frequency * t).cos(), envelope * (frequency * t).sin(), 1.0]
    };
    // Gram-Schmidt on the three columns keeps the normal equations out.
    let mut columns: Vec<Vec<f64>> =
        (0..3).map(|k| samples.iter().map(|&(t, _)| basis(t)[k]).collect()).collect();
    let mut rest: Vec<f64> = samples.iter().map(|&(_, value)| value).collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    for k in 0..3 {
        let (done, open) = columns.split_at_mut(k + 1);
        let square = dot(&done[k], &done[k]);
        for other in open.iter_mut().chain(std::iter::once(&mut rest)) {
            let share = dot(&done[k], other) / square;
            for (other, column) in other.iter_mut().zip(&done[k]) {
                *other -= share * column;
            }
        }
    }
    dot(&rest, &rest)
}

/// Narrows a grid around the least residual.
fn fit(samples: &[(f64, f64)], guess: f64) -> Fit {
    let mut best = Fit { frequency: guess, damping: 0.0 };
    let (mut width, mut height) = (0.1 * guess, 0.05 * guess);
    for _ in 0..14 {
        let (centre, middle) = (best.frequency, best.damping);
        let mut least = f64::INFINITY;
        for i in -4..=4 {
            for j in -4..=4 {
                let frequency = centre + 0.25 * f64::from(i) * width;
                let damping = middle + 0.25 * f64::from(j) * height;
                let found = residual(samples, frequency, damping);
                if found < least {
                    (least, best) = (found, Fit { frequency, damping });
                }
            }
        }
        (width, height) = (0.5 * width, 0.5 * height);
    }
    best
}

/// Frequency over Rayleigh's, 1 exact, and damping a period of a drop in mode 2 over so many periods.
fn oscillation(settings: &[&str], periods: f64) -> (f64, f64) {
    let scene = drops::drop(settings);
    let mut simulation = drops::start(&scene);
    // omega^2 = l (l - 1)(l + 2) sigma/(rho R^3) with l = 2.
    let exact = 8.0f64.sqrt() / Simulation::capillary_time(&scene);
    let mut samples = Vec::new();
    while simulation.world.clock.time < periods * 2.0 * PI / exact {
        drops::advance(&mut simulation, 5);
        samples.push((simulation.world.clock.time * exact, totals(&simulation).quadrupole));
    }
    let scale = samples.iter().fold(0.0f64, |most, s| most.max(s.1.abs()));
    for sample in &mut samples {
        sample.1 /= scale;
    }
    let Fit { frequency, damping } = fit(&samples, 1.0);
    let damping = 2.0 * PI * damping;
    println!("{settings:?}: frequency {:+.4} %, damping {damping:+.5} per period", 100.0 * (frequency - 1.0));
    (frequency, damping)
}

#[test]
fn an_oscillating_drop_has_rayleighs_frequency() {
    let (frequency, damping) = oscillation(&[], 2.0);
    // -.13 % were measured at this resolution; packings scatter by .1 %.
    assert!((frequency - 1.0).abs() < 0.003, "{frequency}");
    // 2.6e-4 a period were measured; growth beyond .5 % a period would be a failure of the method.
    assert!(damping.abs() < 0.005, "{damping}");
}

/// Between two looks for the surface the slope of the Laplace pressure is carried on, too: held, it lags, and a coarse
/// drop with a wide support, which contacts hardly damp, grows by 2.5e-3 a period more than with the curvature in every step.
#[test]
fn what_is_carried_on_drives_no_drop() {
    let damping = |interval: &str| oscillation(&["method.theta=0.6", interval], 10.0).1;
    let carried_on = damping("method.curvature_interval=8");
    let always_new = damping("method.curvature_interval=1");
    assert!((carried_on - always_new).abs() < 2e-4, "{carried_on}, not {always_new}");
}

/// What a resting drop shows in so many capillary times: relative error of the mean pressure over the last one, and
/// the speed over the capillary velocity after the first and the last.
fn rest(resolution: u32, times: f64) -> (f64, f64, f64) {
    let resolution = format!("resolution={resolution}");
    let scene = drops::drop(&["amplitude=0", &resolution]);
    let mut simulation = drops::start(&scene);
    let unit = Simulation::capillary_time(&scene);
    let (mut early, mut pressure, mut count) = (0.0, 0.0, 0.0);
    while simulation.world.clock.time < times * unit {
        drops::advance(&mut simulation, 1);
        if simulation.world.clock.time < unit {
            early = mean_speed(&simulation) / scene.capillary_velocity();
        }
        if simulation.world.clock.time > (times - 1.0) * unit {
            let [density, mass] = ["density", "mass"].map(|name| drops::column(&simulation, name));
            let of = |density: f64| simulation.physics.equation.pressure(density, 0.0);
            let sum: f64 = density.iter().zip(&mass).map(|(density, mass)| mass * of(*density)).sum();
            pressure += sum / mass.iter().sum::<f64>();
            count += 1.0;
        }
    }
    let laplace = 2.0 * scene.liquid.surface_tension / 2.5e-6;
    let late = mean_speed(&simulation) / scene.capillary_velocity();
    let error = pressure / count / laplace - 1.0;
    println!("{resolution}: pressure {:+.3} %, speed {early:.2e}, then {late:.2e}", 100.0 * error);
    (error, early, late)
}

#[test]
fn a_resting_drop_holds_laplaces_pressure() {
    // Packings scatter by less than .1 %.
    let (coarse, early, late) = rest(12, 5.0);
    assert!(coarse.abs() < 0.003, "{coarse}");
    // A start whose outermost layer undulates leaves 1e-3 in undamped modes; one that doesn't 2.4e-6, then 1e-6.
    assert!(late < 4e-6 && early < 4e-6, "{early:e} {late:e}");
    let (fine, ..) = rest(18, 5.0);
    assert!(fine.abs() < 0.003, "{fine}");
}

/// Forces without a potential drive vortices on and on: with a balance of tension that acted along the mean normal instead
/// of each particle's own `cases/laplace-drop` had 1.7 times the early speed by then. It is .6 times now.
/// Its pressure at the start was taken for that of a cold liquid.
#[test]
fn a_warm_drop_begins_at_laplaces_pressure() {
    let warm = [
        "liquid.equation_of_state=mie-grueneisen",
        "liquid.adiabat_slope=2",
        "liquid.grueneisen=2",
        "liquid.sound_speed=\"1483 m/s\"",
        "body.0.internal_energy=\"1000 J/kg\"",
        "amplitude=0",
    ];
    let simulation = drops::start(&drops::drop(&warm));
    let water = MieGrueneisen { reference_density: 1000.0, sound_speed: 1483.0, slope: 2.0, grueneisen: 2.0 };
    let [density, energy] = ["density", "total_energy"].map(|name| drops::column(&simulation, name));
    let pressures = density.iter().zip(&energy).map(|(&density, &energy)| water.pressure(density, energy));
    let mean = pressures.sum::<f64>() / density.len() as f64;
    let laplace = 2.0 * 0.074 / 2.5e-6;
    println!("{mean} {laplace}");
    // A hundredth of the 2 MPa that the warmth makes.
    assert!((mean - laplace).abs() < 0.02e6, "{mean} Pa");
}

/// A drop that breathes has the internal energy that its density says, whatever is subtracted from its pressures: in its
/// first compression it had .6 times as much where the reference pressure did no work.
#[test]
fn the_reference_pressure_does_its_work() {
    let internal = |reference: &str| {
        let scene = drops::drop(&[
            "liquid.equation_of_state=mie-grueneisen",
            "liquid.adiabat_slope=2",
            "liquid.grueneisen=2",
            "liquid.sound_speed=60 m/s",
            "amplitude=0.46",
            "body.0.velocity.r=-amplitude*capillary_velocity*r/radius",
            "body.0.velocity.z=-amplitude*capillary_velocity*z/radius",
            &format!("method.reference_pressure={reference}"),
        ]);
        let mut simulation = drops::start(&scene);
        drops::advance(&mut simulation, 20);
        let [mass, energy, u, w] =
            ["mass", "total_energy", "velocity_r", "velocity_z"].map(|name| drops::column(&simulation, name));
        let of = |i: usize| mass[i] * (energy[i] - 0.5 * (u[i] * u[i] + w[i] * w[i]));
        (0..mass.len()).map(of).sum::<f64>()
    };
    let [with, without] = ["drop", "none"].map(internal);
    println!("{with:e} J with a reference, {without:e} J without");
    assert!((with - without).abs() < 0.05 * without, "{with:e} J, not {without:e}");
}

#[test]
fn what_moves_in_a_resting_drop_dies_out() {
    let (_, early, late) = rest(35, 12.0);
    assert!(late < early, "{early:e} {late:e}");
}

/// Steps a drop; it must stay finite and bound.
fn survives(settings: &[&str]) {
    let scene = drops::drop(settings);
    let mut simulation = drops::start(&scene);
    drops::advance(&mut simulation, 200);
    assert!(is_finite(&simulation), "{settings:?}");
    let speed = mean_speed(&simulation) / scene.capillary_velocity();
    println!("{settings:?}: mean speed {speed:.3}");
    // Twenty times the start's speed: nothing that a drop does by itself.
    assert!(speed < 0.2, "{settings:?}: {speed}");
}

#[test]
fn the_papers_own_method_runs() {
    survives(&["paper=true"]);
}

#[test]
fn parshikovs_scheme_runs() {
    survives(&["method.scheme=parshikov"]);
    survives(&["method.axis=parshikov"]);
}

#[test]
fn shifting_runs() {
    survives(&["method.shifting=0.5"]);
}

#[test]
fn wider_kernels_run() {
    survives(&["method.theta=0.6"]);
    survives(&["method.theta=0.75"]);
}

/// The flow of mode 2 is fastest at the poles, 1.8 times its root mean square. Shifts along a boundary whose direction was not
/// the surface's threw rings at the poles about: within their first third of a period they were forty times as fast as the mean with
/// 70 particles to the radius. With 160 Laplace pressures that were carried on for eight steps did so anywhere on the surface.
#[test]
fn surfaces_of_fine_drops_move_with_the_flow() {
    for (resolution, steps) in [("resolution=70", 3000), ("resolution=160", 1000)] {
        let scene = drops::drop(&[resolution]);
        let mut simulation = drops::start(&scene);
        while simulation.world.clock.step < steps {
            drops::advance(&mut simulation, 20);
            let [mass, u, w] =
                ["mass", "velocity_r", "velocity_z"].map(|name| drops::column(&simulation, name));
            let squares = || u.iter().zip(&w).map(|(u, w)| u * u + w * w);
            let sum: f64 = squares().zip(&mass).map(|(square, mass)| square * mass).sum();
            let mean = (sum / mass.iter().sum::<f64>()).sqrt();
            let largest = squares().fold(0.0, f64::max).sqrt() / mean.max(0.002 * scene.capillary_velocity());
            assert!(largest < 2.5, "{resolution}, step {}: {largest} times", simulation.world.clock.step);
        }
    }
}

/// The least and the largest distance of neighbours along the surface of a round drop, in their own sizes, where the
/// axis is farther than three of them.
fn distances_along_the_surface(simulation: &Simulation) -> [f64; 2] {
    let [r, z, mass, density] =
        ["radius", "axial", "mass", "density"].map(|name| drops::column(simulation, name));
    let surface = simulation.world.store.by_name::<u32>("surface").unwrap();
    let size = |i: usize| (mass[i] / (2.0 * std::f64::consts::PI * r[i] * density[i])).sqrt();
    let mut row: Vec<usize> =
        (0..r.len()).filter(|&i| surface[i] == BOUNDARY && r[i] > 3.0 * size(i)).collect();
    row.sort_by(|&a, &b| r[a].atan2(z[a]).total_cmp(&r[b].atan2(z[b])));
    let distances = row.windows(2).map(|pair| {
        let [a, b] = [pair[0], pair[1]];
        (r[b] - r[a]).hypot(z[b] - z[a]) / (0.5 * (size(a) + size(b)))
    });
    distances.fold([f64::INFINITY, 0.0], |[least, most], distance| [least.min(distance), most.max(distance)])
}

/// What many swings leave of drift draws the boundary's particles together here and apart there.
#[test]
fn the_boundarys_particles_give_way_to_a_crowd() {
    let scene = drops::drop(&["resolution=12", "amplitude=0"]);
    let mut simulation = drops::start(&scene);
    drops::advance(&mut simulation, 1);
    let [mut r, mut z] = ["radius", "axial"].map(|name| drops::column(&simulation, name));
    let surface = simulation.world.store.by_name::<u32>("surface").unwrap().to_vec();
    for i in (0..r.len()).filter(|&i| surface[i] == BOUNDARY) {
        let (distance, angle) = (r[i].hypot(z[i]), r[i].atan2(z[i]));
        let turned = angle + 0.045 * (8.0 * angle).sin();
        (r[i], z[i]) = (distance * turned.sin(), distance * turned.cos());
    }
    simulation.world.store.set("radius", &r);
    simulation.world.store.set("axial", &z);
    let before = distances_along_the_surface(&simulation);
    drops::advance(&mut simulation, 32000);
    let after = distances_along_the_surface(&simulation);
    println!("{before:?} become {after:?} sizes");
    assert!(before[0] < 0.66 && before[1] > 1.36, "{before:?}");
    // If nobody gave way it would be .72 and 1.27.
    assert!(after[0] > 0.78 && after[1] < 1.23, "{after:?}");
}
