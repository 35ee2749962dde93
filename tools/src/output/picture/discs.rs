//! Discs with soft edges, drawn straight into the pixels: a hundred thousand
//! of them take a few hundredths of a second.

use std::f64::consts::FRAC_1_SQRT_2;

use tiny_skia::Pixmap;

use crate::output::colour::Colour;

/// From this diameter (pixels) on, discs stand apart and have a darker rim.
const APART: f64 = 9.0;
/// Up to this diameter, discs are enlarged until they close the gaps between
/// neighbours of a square lattice, so that the field appears without holes.
const CLOSED: f64 = 6.0;
/// Brightness of a rim, and its width in parts of the diameter.
const RIM: f64 = 0.72;
const RIM_WIDTH: f64 = 0.07;

/// How far (pixels) enlarged discs at its edge may leave their section.
const OVERLAP: f64 = 8.0;

/// A rectangle of the picture: left, top, width and height in pixels.
pub(super) type Section = (f64, f64, f64, f64);

/// Draws discs into one section of an opaque picture.
pub(super) struct Discs<'a> {
    pixels: &'a mut Pixmap,
    /// First and last pixel column, and row.
    columns: (f64, f64),
    rows: (f64, f64),
}

impl<'a> Discs<'a> {
    pub(super) fn new(pixels: &'a mut Pixmap, section: Section) -> Self {
        let (left, top) = (section.0 - OVERLAP, section.1 - OVERLAP);
        let (width, height) = (section.2 + 2.0 * OVERLAP, section.3 + 2.0 * OVERLAP);
        let (most_columns, most_rows) = (pixels.width() as f64 - 1.0, pixels.height() as f64 - 1.0);
        Self {
            pixels,
            columns: (left.floor().max(0.0), (left + width).ceil().min(most_columns)),
            rows: (top.floor().max(0.0), (top + height).ceil().min(most_rows)),
        }
    }

    /// Draws one disc; a centre or diameter that is not finite draws nothing.
    pub(super) fn draw(&mut self, centre: (f64, f64), diameter: f64, colour: Colour) {
        if !(centre.0.is_finite() && centre.1.is_finite() && diameter.is_finite()) {
            return;
        }
        let apart = ((diameter - CLOSED) / (APART - CLOSED)).clamp(0.0, 1.0);
        // The soft edge, half a pixel wide, must not let the paper through either.
        let (own, closed) = (0.5 * diameter, FRAC_1_SQRT_2 * diameter + 0.5);
        let radius = closed + apart * (own - closed);
        if apart < 1.0 {
            return self.fill(centre, radius, colour);
        }
        let rim = colour.map(|channel| (f64::from(channel) * RIM) as u8);
        self.fill(centre, radius, rim);
        self.fill(centre, radius - (RIM_WIDTH * diameter).min(2.0), colour);
    }

    fn fill(&mut self, (x, y): (f64, f64), radius: f64, colour: Colour) {
        let width = self.pixels.width() as usize;
        let data = self.pixels.data_mut();
        let reach = radius + 0.5;
        for row in within(self.rows, y - 0.5, reach) {
            for column in within(self.columns, x - 0.5, reach) {
                let (across, down) = (column as f64 + 0.5 - x, row as f64 + 0.5 - y);
                let distance = (across * across + down * down).sqrt();
                let cover = (reach - distance).clamp(0.0, 1.0);
                let start = 4 * (row * width + column);
                for (channel, ink) in data[start..start + 3].iter_mut().zip(colour) {
                    let paper = f64::from(*channel);
                    *channel = (paper + cover * (f64::from(ink) - paper) + 0.5) as u8;
                }
            }
        }
    }
}

/// The pixels of a line (from first to last) within `reach` of `middle`.
fn within((first, last): (f64, f64), middle: f64, reach: f64) -> std::ops::Range<usize> {
    let start = (middle - reach).ceil().max(first);
    let end = (middle + reach).floor().min(last);
    if start > end {
        return 0..0;
    }
    start as usize..end as usize + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// How much of the paper the ink covers, in pixels.
    fn covered(centre: (f64, f64), diameter: f64) -> f64 {
        let mut pixels = Pixmap::new(64, 64).unwrap();
        pixels.fill(tiny_skia::Color::WHITE);
        Discs::new(&mut pixels, (0.0, 0.0, 64.0, 64.0)).draw(centre, diameter, [0; 3]);
        let shade = |pixel: &tiny_skia::PremultipliedColorU8| 1.0 - f64::from(pixel.red()) / 255.0;
        pixels.pixels().iter().map(shade).sum()
    }

    #[test]
    fn a_disc_has_its_area_wherever_it_lies() {
        let area = std::f64::consts::PI * 100.0;
        for centre in [(32.0, 32.0), (31.7, 32.4), (20.5, 41.25)] {
            assert!((covered(centre, 20.0) / area - 1.0).abs() < 0.01);
        }
        assert!((covered((0.0, 32.0), 20.0) / area - 0.5).abs() < 0.01);
    }

    #[test]
    fn what_lies_outside_or_nowhere_is_not_drawn() {
        for centre in [(-20.0, 0.0), (1e12, 3.0), (f64::NAN, 3.0), (3.0, f64::INFINITY)] {
            assert_eq!(covered(centre, 10.0), 0.0);
        }
    }
}
