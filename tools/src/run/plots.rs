//! Plots of what was measured, against what is exact.

use meniscus_cases::measure::bridge::Bridge;
use meniscus_cases::measure::exact::Drop;
use meniscus_cases::measure::fit::Oscillation;
use meniscus_cases::measure::large::Start;
use meniscus_cases::measure::spheroid::Spheroid;
use meniscus_cases::measure::thread::{Jet, limits};
use meniscus_cases::measure::viscous::Mode;
use meniscus_cases::measure::{History, columns_of, numbered, oscillation_fit, with_index};
use meniscus_cases::scene::{Measure, Scene};

use crate::failure::Failure;
use crate::output::folder::{PlotKind, RunFolder};
use crate::output::plot::{Curve, Plot, Style, plot};

/// Points at most of a measured curve that is shown as points.
const POINTS: usize = 120;

/// Draws one plot a measure, unless there is nothing to see yet.
pub(super) fn draw(scene: &Scene, folder: &RunFolder, history: &History) -> Result<(), Failure> {
    let times = history.of("time");
    if times.len() < 3 {
        return Ok(());
    }
    for (measure, index) in with_index(&scene.measures) {
        let (kind, curves, label) = match *measure {
            Measure::Oscillation { mode, radius, from, .. } => {
                let column = numbered("mode amplitude", index);
                let exact = Drop::of(&scene.liquid, radius).mode(mode);
                let curves = oscillation(history, &column, exact, from);
                (PlotKind::Oscillation, curves, format!("amplitude of mode {mode}"))
            }
            Measure::LaplacePressure { radius, .. } => {
                let exact = Drop::of(&scene.liquid, radius).laplace_pressure();
                let ends = vec![times[0], times[times.len() - 1]];
                let values = history.of(&numbered("core pressure", index));
                let curves = vec![
                    curve("measured", times.clone(), values, Style::Line),
                    curve("2 sigma/R", ends, vec![exact; 2], Style::Dashed),
                ];
                (PlotKind::LaplacePressure, curves, "pressure [Pa]".to_owned())
            }
            Measure::SpuriousVelocity { .. } => {
                let values = history.of(&numbered("spurious velocity", index));
                let curves = vec![curve("measured; exact is 0", times.clone(), values, Style::Line)];
                let label = "rms velocity over the capillary velocity".to_owned();
                (PlotKind::SpuriousVelocity, curves, label)
            }
            Measure::SemiAxis { radial, axial, shear, stiffness } => {
                let exact = Spheroid { radial, axial, shear, stiffness }.at_times(&times);
                let exact = |axis: usize| exact.iter().map(|axes| axes[axis]).collect();
                let mut curves = vec![
                    curve("exact, radial", times.clone(), exact(0), Style::Dashed),
                    curve("exact, axial", times.clone(), exact(1), Style::Dashed),
                ];
                curves.extend(measured(history, measure, index));
                (PlotKind::SemiAxis, curves, "semi-axis [m]".to_owned())
            }
            Measure::GrowthRate { .. } => {
                let mut curves = measured(history, measure, index);
                curves.truncate(2);
                (PlotKind::Growth, curves, "amplitude of the wave over the radius".to_owned())
            }
            Measure::FilmRetraction { .. } => {
                let mut curves = measured(history, measure, index);
                curves.remove(0);
                (PlotKind::Film, curves, "distance from the start of the edge, and constant [m]".to_owned())
            }
            Measure::PlateauDensity { .. } => {
                let curves = measured(history, measure, index);
                (PlotKind::PlateauDensity, curves, "density behind the shock [kg/m3]".to_owned())
            }
            Measure::ShockSpeed { .. } => {
                let mut curves = measured(history, measure, index);
                curves.truncate(1);
                (PlotKind::Shock, curves, "thickness stopped by the shock [m]".to_owned())
            }
            Measure::LargeOscillation { radial, axial, speed } => {
                let start = Start { radial, axial, speed };
                let exact = start.elongations(&scene.liquid, &times);
                let mut curves = vec![curve("potential flow", times.clone(), exact, Style::Dashed)];
                curves.extend(measured(history, measure, index));
                (PlotKind::LargeOscillation, curves, "mean of s^2 P_2 over R^2".to_owned())
            }
            Measure::Spread { .. } => {
                (PlotKind::Spread, measured(history, measure, index), "radius of the disc [m]".to_owned())
            }
            Measure::Coalescence { radius, other } => {
                let drops = Bridge { radius, other };
                let [mut x, y] = drops.exact(&scene.liquid);
                // The exact bridge starts narrower: both have the fitted range's smallest radius at once.
                let column = &columns_of(measure, index)[0].name;
                if let Some(later) = drops.delay([&times, &history.of(column)], [&x, &y]) {
                    x.iter_mut().for_each(|time| *time += later);
                }
                let mut curves = vec![curve("potential flow", x, y, Style::Dashed)];
                curves.extend(measured(history, measure, index));
                (PlotKind::Coalescence, curves, "radius of the bridge [m]".to_owned())
            }
            Measure::PinchOff { radius, wavenumber, speed } => {
                let [_, reach] = limits(scene.particle_size);
                let [x, y] = Jet { radius, wavenumber, speed }.exact(&scene.liquid, reach);
                let mut curves = vec![curve("potential flow", x, y, Style::Dashed)];
                curves.extend(measured(history, measure, index));
                (PlotKind::PinchOff, curves, "radius of the thread [m]".to_owned())
            }
            Measure::MomentumDrift | Measure::EnergyDrift | Measure::EnergyGain => continue,
        };
        let path = folder.plot(kind, index);
        let picture = Plot {
            title: scene.title.clone(),
            x_label: "time [s]".to_owned(),
            y_label: label,
            log_x: false,
            log_y: false,
            curves,
        };
        if picture.curves.iter().any(|curve| curve.y.iter().any(|y| y.is_finite())) {
            plot(&path, &picture)?;
        }
    }
    Ok(())
}

/// The columns of a measure as they were observed.
fn measured(history: &History, measure: &Measure, index: usize) -> Vec<Curve> {
    let columns = columns_of(measure, index).into_iter();
    columns.map(|c| curve(&c.name, history.of("time"), history.of(&c.name), Style::Line)).collect()
}

fn curve(label: &str, x: Vec<f64>, y: Vec<f64>, style: Style) -> Curve {
    Curve { label: label.to_owned(), x, y, style }
}

/// The measured amplitude on the exact oscillation of the same start, if the drop oscillates at all.
fn oscillation(history: &History, column: &str, exact: Option<Mode>, from: f64) -> Vec<Curve> {
    let (times, values) = (history.of("time"), history.of(column));
    let mut curves = Vec::new();
    let fit = exact.and_then(|exact| Some((exact, oscillation_fit(history, column, exact, from)?)));
    if let Some((exact, fit)) = fit {
        let Mode { angular_frequency, decay } = exact;
        let exact = Oscillation { angular_frequency, damping: decay, ..fit };
        let (first, last) = (times[0], times[times.len() - 1]);
        let x: Vec<f64> = (0..=600).map(|k| first + (last - first) * f64::from(k) / 600.0).collect();
        let y = x.iter().map(|time| exact.at(*time)).collect();
        curves.push(curve("exact frequency and damping", x, y, Style::Dashed));
    }
    let every = times.len().div_ceil(POINTS);
    let thinned = |values: Vec<f64>| values.into_iter().step_by(every).collect();
    curves.push(curve("measured", thinned(times), thinned(values), Style::Points));
    curves
}
