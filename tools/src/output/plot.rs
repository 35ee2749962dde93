//! Curves against each other: measured points on an exact line, error against
//! cost.

use std::io::Write;
use std::path::Path;

use super::atomic::write_atomic;
use super::axis::Axis;
use super::canvas::{Anchor, Canvas, GREY, INK, PALE, Pen};
use super::colour::Colour;
use super::units::{Scale, labelled, scale, split_label};
use super::{OutputError, OutputResult};

/// How a curve is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// A solid line.
    Line,
    /// A dashed line, for what is exact or expected.
    Dashed,
    /// Separate points, for what was measured.
    Points,
}

/// One curve of a plot.
#[derive(Debug, Clone)]
pub struct Curve {
    /// Its name in the legend.
    pub label: String,
    /// Its abscissae.
    pub x: Vec<f64>,
    /// Its ordinates, as many.
    pub y: Vec<f64>,
    /// How it is drawn.
    pub style: Style,
}

/// A picture of curves over common axes.
#[derive(Debug, Clone)]
pub struct Plot {
    /// Title above the axes.
    pub title: String,
    /// Label of the abscissa with its SI unit, as in "time \[s\]"; a linear
    /// axis gets a fitting prefix by itself.
    pub x_label: String,
    /// Label of the ordinate, likewise.
    pub y_label: String,
    /// The curves, in the order of the legend.
    pub curves: Vec<Curve>,
    /// Whether the abscissa is logarithmic.
    pub log_x: bool,
    /// Whether the ordinate is logarithmic.
    pub log_y: bool,
}

/// Size of the picture in units of which each is two pixels.
const SIZE: (f64, f64) = (640.0, 440.0);
const PIXELS_PER_UNIT: f32 = 2.0;
/// Left edge of the texts above the axes, and the free right edge.
const LEFT: f64 = 18.0;
const RIGHT: f64 = SIZE.0 - 24.0;
/// Baseline of the title and distance of the lines of the legend below it.
const TITLE: f64 = 28.0;
const LINE: f64 = 20.0;
/// Lower edge of the axes.
const BOTTOM: f64 = SIZE.1 - 52.0;
const TEXT: u32 = 12;

/// Colours that people with any colour vision can tell apart (after Okabe and Ito).
const COLOURS: [Colour; 6] =
    [[0, 114, 178], [213, 94, 0], [0, 158, 115], [204, 121, 167], [230, 159, 0], [86, 180, 233]];

/// Draws the curves to `path_png` and to the SVG file of the same name.
///
/// Points that cannot be drawn (not finite, or not positive on a logarithmic
/// axis) are left out.
///
/// # Errors
/// When no point is left, a curve's x and y differ in length, or a file
/// cannot be written.
pub fn plot(path_png: &Path, plot: &Plot) -> OutputResult<()> {
    let uneven = |curve: &&Curve| curve.x.len() != curve.y.len();
    if let Some(curve) = plot.curves.iter().find(uneven) {
        let problem = format!("x and y of the curve `{}` differ in length", curve.label);
        return Err(OutputError::data(path_png, problem));
    }
    let lines: Vec<Line<'_>> = (plot.curves.iter().zip(COLOURS.iter().cycle()))
        .map(|(curve, colour)| Line { curve, colour: *colour, points: drawable(plot, curve) })
        .collect();
    if lines.iter().all(|line| line.points.is_empty()) {
        let problem = format!("the plot `{}` has no points", plot.title);
        return Err(OutputError::data(path_png, problem));
    }
    let canvas = compose(plot, &lines);
    let png = canvas.png(PIXELS_PER_UNIT).map_err(|problem| OutputError::data(path_png, problem))?;
    write_atomic(path_png, |file| file.write_all(&png))?;
    let path_svg = path_png.with_extension("svg");
    write_atomic(&path_svg, |file| file.write_all(canvas.svg().as_bytes()))
}

/// A curve, ready to be drawn.
struct Line<'a> {
    curve: &'a Curve,
    colour: Colour,
    points: Vec<(f64, f64)>,
}

fn drawable(plot: &Plot, curve: &Curve) -> Vec<(f64, f64)> {
    let fits = |value: f64, log: bool| value.is_finite() && (!log || value > 0.0);
    let points = curve.x.iter().copied().zip(curve.y.iter().copied());
    points.filter(|&(x, y)| fits(x, plot.log_x) && fits(y, plot.log_y)).collect()
}

fn compose(plot: &Plot, lines: &[Line<'_>]) -> Canvas {
    let x_all = || lines.iter().flat_map(|line| &line.points).map(|point| point.0);
    let y_all = || lines.iter().flat_map(|line| &line.points).map(|point| point.1);
    let (x_label, x_factor) = fit_unit(&plot.x_label, plot.log_x, x_all());
    let (y_label, y_factor) = fit_unit(&plot.y_label, plot.log_y, y_all());
    let x_axis = Axis::around(x_all().map(|x| x * x_factor), plot.log_x);
    let y_axis = Axis::around(y_all().map(|y| y * y_factor), plot.log_y);
    let y_ticks = y_axis.ticks(6);

    let mut canvas = Canvas::new(SIZE.0, SIZE.1);
    canvas.text((LEFT, TITLE), 17, INK, Anchor::Start, &plot.title);
    let legend = draw_legend(&mut canvas, lines);
    // The label of the ordinate stands upright above its axis.
    let label = legend + LINE + 4.0;
    canvas.text((LEFT, label), TEXT, GREY, Anchor::Start, &y_label);
    let top = label + 12.0;
    let widest = (y_ticks.iter()).map(|(_, label)| Canvas::text_width(label, TEXT));
    let left = LEFT + widest.fold(0.0, f64::max) + 8.0;
    let x_at = |value| left + x_axis.fraction(value) * (RIGHT - left);
    let y_at = |value| BOTTOM + y_axis.fraction(value) * (top - BOTTOM);

    for (value, label) in x_axis.ticks(8) {
        let x = x_at(value);
        canvas.line(&[(x, top), (x, BOTTOM)], Pen::solid(PALE, 0.5));
        canvas.text((x, BOTTOM + 18.0), TEXT, GREY, Anchor::Middle, &label);
    }
    for (value, label) in y_ticks {
        let y = y_at(value);
        canvas.line(&[(left, y), (RIGHT, y)], Pen::solid(PALE, 0.5));
        canvas.text((left - 8.0, y + 4.0), TEXT, GREY, Anchor::End, &label);
    }
    canvas.line(&[(left, top), (left, BOTTOM), (RIGHT, BOTTOM)], Pen::solid(GREY, 1.0));
    canvas.text((RIGHT, BOTTOM + 40.0), TEXT, GREY, Anchor::End, &x_label);
    for line in lines {
        let points = line.points.iter().map(|(x, y)| (x_at(x * x_factor), y_at(y * y_factor)));
        draw(&mut canvas, line, &points.collect::<Vec<_>>());
    }
    canvas
}

/// Draws the legend and returns its last baseline.
fn draw_legend(canvas: &mut Canvas, lines: &[Line<'_>]) -> f64 {
    let (mut x, mut y) = (LEFT, TITLE + LINE + 4.0);
    for line in lines {
        let width = 32.0 + Canvas::text_width(&line.curve.label, TEXT) + 18.0;
        if x > LEFT && x + width > RIGHT {
            (x, y) = (LEFT, y + LINE);
        }
        let middle = y - 4.0;
        match line.curve.style {
            Style::Points => draw(canvas, line, &[(x + 20.0, middle)]),
            _ => draw(canvas, line, &[(x, middle), (x + 26.0, middle)]),
        }
        canvas.text((x + 32.0, y), TEXT, INK, Anchor::Start, &line.curve.label);
        x += width;
    }
    y
}

fn draw(canvas: &mut Canvas, line: &Line<'_>, points: &[(f64, f64)]) {
    let pen = Pen::solid(line.colour, 1.6);
    match line.curve.style {
        Style::Points => canvas.discs(points, 3.0, line.colour),
        Style::Line => canvas.line(points, pen),
        Style::Dashed => canvas.line(points, Pen { dashed: true, ..pen }),
    }
}

/// The label of an axis with the unit that fits its values, and the factor
/// that brings them there. A logarithmic axis shows its decades in SI.
fn fit_unit(label: &str, logarithmic: bool, values: impl Iterator<Item = f64>) -> (String, f64) {
    let (name, unit) = split_label(label);
    let largest = values.fold(0.0, |largest: f64, value| largest.max(value.abs()));
    let Scale { factor, unit } = scale(if logarithmic { 1.0 } else { largest }, unit);
    (labelled(name, &unit), factor)
}

#[cfg(test)]
mod tests;
