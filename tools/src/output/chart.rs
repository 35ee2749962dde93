//! Error against cost on logarithmic axes, as an SVG picture for a page.

use std::fmt::Write;

use super::axis::Axis;
use super::report::escape;

/// A point of a series.
#[derive(Clone, Debug)]
pub struct Point {
    /// Cost in core-seconds.
    pub x: f64,
    /// Magnitude of the error.
    pub y: f64,
    /// What is written beside it.
    pub label: String,
    /// Size of the particles or cells in any common unit.
    pub size: f64,
}

/// Points of one program with one set of settings.
#[derive(Clone, Debug)]
pub struct Series {
    /// Name in the legend.
    pub name: String,
    /// The points, in the order of the line through them.
    pub points: Vec<Point>,
    /// Whether it is this program's: drawn strongly, with labels at its points.
    pub ours: bool,
}

/// Errors against costs.
pub struct Chart<'a> {
    /// Label of the ordinate.
    pub y_label: String,
    /// What is drawn.
    pub series: &'a [Series],
    /// An error that is aimed at: a line across.
    pub target: Option<f64>,
}

impl Series {
    /// A series of this program with its first point: cost, error, label, size.
    pub fn ours(name: String, first: (f64, f64, String, f64)) -> Self {
        let mut series = Series { name, points: Vec::new(), ours: true };
        series.push(first);
        series
    }

    /// Adds a point: cost, error, label, size. One that logarithmic axes cannot show is left out.
    pub fn push(&mut self, (x, y, label, size): (f64, f64, String, f64)) {
        if x.is_finite() && y.is_finite() && x > 0.0 && y > 0.0 {
            self.points.push(Point { x, y, label, size });
        }
    }
}

const WIDTH: f64 = 580.0;
const AXES: f64 = 280.0;
const LEFT: f64 = 64.0;
const RIGHT: f64 = WIDTH - 24.0;
const LEGEND_LINE: f64 = 20.0;
const OURS: [&str; 4] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7"];
const OTHERS: [&str; 4] = ["#b45309", "#6b7280", "#7c3aed", "#0f766e"];

/// Draws the chart.
pub fn chart(chart: &Chart<'_>) -> String {
    let points = || chart.series.iter().flat_map(|series| &series.points);
    let x_axis = Axis::around(points().map(|point| point.x), true);
    let y_axis = Axis::around(points().map(|point| point.y).chain(chart.target), true);
    let mut svg = String::new();
    let top = draw_legend(&mut svg, chart) + 14.0;
    let bottom = top + AXES;
    let x_at = |x| LEFT + x_axis.fraction(x) * (RIGHT - LEFT);
    let y_at = |y| bottom - y_axis.fraction(y) * AXES;
    for (value, label) in x_axis.ticks(7) {
        let x = x_at(value);
        let _ = write!(
            svg,
            r#"<path class="grid" d="M{x:.1} {top:.1}V{bottom:.1}"/><text class="tick" text-anchor="middle" x="{x:.1}" y="{:.1}">{label}</text>"#,
            bottom + 18.0
        );
    }
    for (value, label) in y_axis.ticks(6) {
        let y = y_at(value);
        let label = if value >= 1e-5 { percent_label(value) } else { label };
        let _ = write!(
            svg,
            r#"<path class="grid" d="M{LEFT} {y:.1}H{RIGHT}"/><text class="tick" text-anchor="end" x="{:.1}" y="{:.1}">{label}</text>"#,
            LEFT - 8.0,
            y + 4.0
        );
    }
    let _ = write!(svg, r#"<path class="axis" d="M{LEFT} {top:.1}V{bottom:.1}H{RIGHT}"/>"#);
    let _ = write!(
        svg,
        r#"<text class="tick" text-anchor="end" x="{RIGHT}" y="{:.1}">core-seconds</text>"#,
        bottom + 38.0
    );
    if let Some(target) = chart.target {
        let y = y_at(target);
        let _ = write!(
            svg,
            r#"<path class="target" d="M{LEFT} {y:.1}H{RIGHT}"/><text class="target-name" text-anchor="end" x="{:.1}" y="{:.1}">target</text>"#,
            RIGHT - 4.0,
            y - 5.0
        );
    }
    for (series, colour) in coloured(chart.series) {
        let places: Vec<(f64, f64)> = series.points.iter().map(|p| (x_at(p.x), y_at(p.y))).collect();
        draw_series(&mut svg, series, colour, &places);
    }
    let height = bottom + 46.0;
    let title = escape(&format!("{} against core-seconds", chart.y_label));
    format!(
        r#"<svg viewBox="0 0 {WIDTH} {height:.0}" role="img" aria-label="{title}"><text class="label" x="12" y="18">{}</text>{svg}</svg>"#,
        escape(&chart.y_label)
    )
}

fn coloured(series: &[Series]) -> Vec<(&Series, &'static str)> {
    let (mut ours, mut others) = (OURS.iter().cycle(), OTHERS.iter().cycle());
    let mut coloured = Vec::new();
    for series in series {
        let next = if series.ours { ours.next() } else { others.next() };
        coloured.push((series, next.copied().unwrap_or(OURS[0])));
    }
    coloured
}

/// Draws the legend and returns its lower edge.
fn draw_legend(svg: &mut String, chart: &Chart<'_>) -> f64 {
    let (mut x, mut y) = (12.0, 42.0);
    for (series, colour) in coloured(chart.series) {
        let width = 40.0 + 7.0 * series.name.chars().count() as f64;
        if x > 12.0 && x + width > RIGHT {
            (x, y) = (12.0, y + LEGEND_LINE);
        }
        let _ = write!(
            svg,
            r#"<text class="legend" x="{:.1}" y="{y}">{}</text>"#,
            x + 18.0,
            escape(&series.name)
        );
        mark(svg, series.ours, colour, (x + 6.0, y - 4.0));
        x += width;
    }
    y
}

fn draw_series(svg: &mut String, series: &Series, colour: &str, places: &[(f64, f64)]) {
    let path: Vec<String> = places.iter().map(|(x, y)| format!("{x:.1} {y:.1}")).collect();
    let (width, dashes) = if series.ours { (2.2, "none") } else { (1.2, "4 4") };
    if places.len() > 1 {
        let _ = write!(
            svg,
            r#"<path d="M{}" fill="none" stroke="{colour}" stroke-width="{width}" stroke-dasharray="{dashes}"/>"#,
            path.join("L")
        );
    }
    for (place, point) in places.iter().zip(&series.points) {
        mark(svg, series.ours, colour, *place);
        let class = if series.ours { "ours" } else { "theirs" };
        // At the right edge a label stands to the left of its point.
        let (anchor, shift) = if place.0 > RIGHT - 60.0 { ("end", -9.0) } else { ("start", 9.0) };
        let _ = write!(
            svg,
            r#"<text class="{class}" fill="{colour}" text-anchor="{anchor}" x="{:.1}" y="{:.1}">{}</text>"#,
            place.0 + shift,
            place.1 - 7.0,
            escape(&point.label)
        );
    }
}

fn mark(svg: &mut String, ours: bool, colour: &str, (x, y): (f64, f64)) {
    let _ = if ours {
        write!(svg, r#"<circle cx="{x:.1}" cy="{y:.1}" r="5" fill="{colour}"/>"#)
    } else {
        let (x, y) = (x - 4.0, y - 4.0);
        write!(
            svg,
            r#"<rect x="{x:.1}" y="{y:.1}" width="8" height="8" fill="none" stroke="{colour}" stroke-width="1.8"/>"#
        )
    };
}

fn percent_label(value: f64) -> String {
    let percent = 100.0 * value;
    let decimals = (-percent.log10() + 1e-9).ceil().max(0.0) as usize;
    format!("{percent:.decimals$} %")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_that_cannot_be_drawn_are_left_out_and_names_are_escaped() {
        let mut series = Series::ours("a < b".to_owned(), (1.0, 0.01, "12".to_owned(), 1.0));
        series.push((0.0, 0.1, "no".to_owned(), 1.0));
        series.push((10.0, f64::NAN, "no".to_owned(), 1.0));
        series.push((10.0, 0.001, "25".to_owned(), 0.5));
        let svg = chart(&Chart { y_label: "error".to_owned(), series: &[series], target: Some(0.005) });
        assert!(svg.contains("a &lt; b") && !svg.contains("NaN") && !svg.contains(">no<"), "{svg}");
        assert_eq!(svg.matches("<circle").count(), 3);
        assert!(svg.contains("target") && svg.contains("0.5 %"), "{svg}");
    }
}
