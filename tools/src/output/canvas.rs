//! A drawing surface that becomes a PNG or an SVG file, with text in a font
//! that travels with the program.
//!
//! Lengths are in units of which the PNG has a chosen number of pixels each;
//! y grows downwards.

use kuva::RasterBackend;
use kuva::backend::svg::SvgBackend;
use kuva::render::color::Color;
use kuva::render::render::{Primitive, Scene, TextAnchor};

use super::colour::Colour;

/// Text and marks.
pub(super) const INK: Colour = [34, 34, 34];
/// Secondary text, ticks and frames.
pub(super) const GREY: Colour = [105, 105, 105];
/// Grid lines.
pub(super) const PALE: Colour = [228, 228, 228];

/// Mean advance of a letter of the font, in parts of its size. An estimate, to
/// make room for a text; its place is exact through its [`Anchor`].
const ADVANCE: f64 = 0.6;
/// Lengths of a dash and of the gap after it.
const DASH: (f64, f64) = (6.0, 4.0);

/// Which point of a text its position means.
#[derive(Clone, Copy)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// How a line is drawn.
#[derive(Clone, Copy)]
pub(super) struct Pen {
    pub colour: Colour,
    pub width: f64,
    pub dashed: bool,
}

impl Pen {
    pub(super) fn solid(colour: Colour, width: f64) -> Self {
        Self { colour, width, dashed: false }
    }
}

/// The surface: white to begin with.
pub(super) struct Canvas {
    scene: Scene,
}

impl Canvas {
    pub(super) fn new(width: f64, height: f64) -> Self {
        Self { scene: Scene::new(width, height) }
    }

    /// About how wide a text will be.
    pub(super) fn text_width(text: &str, size: u32) -> f64 {
        text.chars().count() as f64 * ADVANCE * f64::from(size)
    }

    /// A line of text with its baseline at `place`.
    pub(super) fn text(&mut self, place: (f64, f64), size: u32, colour: Colour, anchor: Anchor, text: &str) {
        self.scene.add(Primitive::Text {
            x: place.0,
            y: place.1,
            // A dollar sign would begin a formula.
            content: text.replace('$', "\\$"),
            size,
            anchor: match anchor {
                Anchor::Start => TextAnchor::Start,
                Anchor::Middle => TextAnchor::Middle,
                Anchor::End => TextAnchor::End,
            },
            rotate: None,
            bold: false,
            color: Some(paint(colour)),
        });
    }

    /// A filled rectangle from its upper left corner.
    pub(super) fn rectangle(&mut self, corner: (f64, f64), size: (f64, f64), fill: Colour) {
        self.scene.add(Primitive::Rect {
            x: corner.0,
            y: corner.1,
            width: size.0,
            height: size.1,
            fill: paint(fill),
            stroke: None,
            stroke_width: None,
            opacity: None,
        });
    }

    /// A filled disc at each centre.
    pub(super) fn discs(&mut self, centres: &[(f64, f64)], radius: f64, fill: Colour) {
        self.scene.add(Primitive::CircleBatch {
            cx: centres.iter().map(|centre| centre.0).collect(),
            cy: centres.iter().map(|centre| centre.1).collect(),
            r: radius,
            fill: paint(fill),
            fill_opacity: None,
            stroke: None,
            stroke_width: None,
        });
    }

    /// A line through all points.
    pub(super) fn line(&mut self, points: &[(f64, f64)], pen: Pen) {
        if !pen.dashed {
            return self.stroke(points.to_vec(), pen);
        }
        // Dashes are cut here: the raster backend would begin them anew at
        // every point of the line.
        for dash in dashes(points) {
            self.stroke(dash, pen);
        }
    }

    fn stroke(&mut self, points: Vec<(f64, f64)>, pen: Pen) {
        self.scene.add(Primitive::PolyLine {
            points,
            stroke: paint(pen.colour),
            stroke_width: pen.width,
            stroke_dasharray: None,
        });
    }

    /// The surface as a PNG file.
    pub(super) fn png(&self, pixels_per_unit: f32) -> Result<Vec<u8>, String> {
        RasterBackend::new().with_scale(pixels_per_unit).render_scene(&self.scene)
    }

    /// The surface as an SVG file.
    pub(super) fn svg(&self) -> String {
        SvgBackend.render_scene(&self.scene)
    }
}

fn paint([red, green, blue]: Colour) -> Color {
    Color::Rgb(red, green, blue)
}

/// Cuts a line into its dashes.
fn dashes(points: &[(f64, f64)]) -> Vec<Vec<(f64, f64)>> {
    let mut dashes = Vec::new();
    let (mut drawing, mut left) = (true, DASH.0);
    let mut dash: Vec<(f64, f64)> = points.iter().take(1).copied().collect();
    for pair in points.windows(2) {
        let ((x, y), (to_x, to_y)) = (pair[0], pair[1]);
        let length = (to_x - x).hypot(to_y - y);
        let mut done = 0.0;
        while length - done > left {
            done += left;
            let place = (x + (to_x - x) * done / length, y + (to_y - y) * done / length);
            if drawing {
                dash.push(place);
                dashes.push(std::mem::take(&mut dash));
            } else {
                dash = vec![place];
            }
            drawing = !drawing;
            left = if drawing { DASH.0 } else { DASH.1 };
        }
        left -= length - done;
        if drawing {
            dash.push((to_x, to_y));
        }
    }
    if dash.len() > 1 {
        dashes.push(dash);
    }
    dashes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_do_not_depend_on_the_points_of_a_line() {
        let straight = |count: usize| -> Vec<(f64, f64)> {
            (0..=count).map(|index| (25.0 * index as f64 / count as f64, 0.0)).collect()
        };
        for count in [1, 7, 100] {
            let ends: Vec<(f64, f64)> =
                dashes(&straight(count)).iter().map(|dash| (dash[0].0, dash[dash.len() - 1].0)).collect();
            for (end, expected) in ends.iter().zip([(0.0, 6.0), (10.0, 16.0), (20.0, 25.0)]) {
                assert!((end.0 - expected.0).abs() + (end.1 - expected.1).abs() < 1e-9);
            }
            assert_eq!(ends.len(), 3);
        }
        assert!(dashes(&[(1.0, 1.0)]).is_empty());
    }
}
