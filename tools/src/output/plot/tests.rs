use std::fs;

use super::*;

fn curve(label: &str, style: Style, count: usize, y: impl Fn(f64) -> f64) -> Curve {
    let x: Vec<f64> = (0..count).map(|index| index as f64 * 1e-4 / (count - 1) as f64).collect();
    let y = x.iter().map(|&x| y(x)).collect();
    Curve { label: label.to_owned(), x, y, style }
}

fn folder() -> tempfile::TempDir {
    let mut folder = tempfile::tempdir().unwrap();
    // For a look at the pictures.
    folder.disable_cleanup(std::env::var_os("MENISCUS_SHOW").is_some());
    println!("{}", folder.path().display());
    folder
}

#[test]
fn both_files_are_written_with_fitting_units() {
    let folder = folder();
    let path = folder.path().join("radius.png");
    let shape = |time: f64| 5e-6 * (1.0 + 0.05 * (time * 2e5).cos() * (-time * 1e4).exp());
    let plot = Plot {
        title: "Droplet oscillation: radius at the pole".into(),
        x_label: "time [s]".into(),
        y_label: "radius [m]".into(),
        curves: vec![
            curve("linear theory", Style::Dashed, 400, shape),
            curve("measured", Style::Points, 60, |time| shape(time) * 1.002),
            curve("smoothed", Style::Line, 100, |time| shape(time) * 0.996),
        ],
        log_x: false,
        log_y: false,
    };
    super::plot(&path, &plot).unwrap();
    let svg = fs::read_to_string(path.with_extension("svg")).unwrap();
    for text in ["time [µs]", "radius [µm]", "linear theory", "measured"] {
        assert!(svg.contains(text), "{text}");
    }
    assert!(fs::read(&path).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn logarithmic_axes_leave_out_what_has_no_logarithm() {
    let folder = folder();
    let path = folder.path().join("cost.png");
    let cost = vec![0.0, 0.3, 2.5, 21.0, 170.0, 1500.0];
    let error = |order: f64| cost.iter().map(|cost| 0.02 * f64::powf(*cost, -order)).collect();
    let curve = |label: &str, order, style| Curve {
        label: label.to_owned(),
        x: cost.clone(),
        y: error(order),
        style,
    };
    let plot = Plot {
        title: "Error against cost".into(),
        x_label: "processor time [s]".into(),
        y_label: "relative error of the period".into(),
        curves: vec![curve("symplectic", 0.6, Style::Points), curve("second order", 0.66, Style::Dashed)],
        log_x: true,
        log_y: true,
    };
    super::plot(&path, &plot).unwrap();
    assert!(fs::read_to_string(path.with_extension("svg")).unwrap().contains("processor time [s]"));
}

#[test]
fn nothing_to_draw_is_said() {
    let empty = |x: Vec<f64>, y| Plot {
        title: "nothing".into(),
        x_label: String::new(),
        y_label: String::new(),
        curves: vec![Curve { label: "none".into(), x, y, style: Style::Line }],
        log_x: false,
        log_y: false,
    };
    let error = |plot| super::plot(Path::new("none.png"), &plot).unwrap_err().to_string();
    assert!(error(empty(vec![f64::NAN], vec![1.0])).contains("has no points"));
    assert!(error(empty(vec![1.0], vec![])).contains("differ in length"));
}
