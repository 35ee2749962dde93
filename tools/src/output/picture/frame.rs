//! What stands around the particles: title, time, colour bar, scale bar, axis.

use super::discs::Section;
use super::{Picture, Shade, Window};
use crate::output::axis::Axis;
use crate::output::canvas::{Anchor, Canvas, GREY, INK, Pen};
use crate::output::colour::Colour;
use crate::output::units::{Scale, grouped, labelled, quantity, round_below, scale};

/// Longer side of the picture in pixels.
const LONG_SIDE: f64 = 900.0;
/// Free space at the edges.
const MARGIN: f64 = 28.0;
/// Size of the title's letters, at most and at least, in pixels.
const TITLE: u32 = 20;
const SMALLEST_TITLE: u32 = 11;
/// Space above the section, for title and time, and below it, for the scale.
const HEAD: f64 = 92.0;
const FOOT: f64 = 78.0;
/// The section is no smaller than that, however thin the liquid is.
const LEAST_SECTION: (f64, f64) = (240.0, 220.0);
/// Distance of the colour bar from the section, its width and greatest height.
const GAP: f64 = 36.0;
const BAR_WIDTH: f64 = 18.0;
const BAR_HEIGHT: f64 = 380.0;
const TEXT: u32 = 14;
const AXIS: Colour = [170, 170, 170];

/// The layout of a picture, in pixels from its upper left corner.
pub(super) struct Frame {
    window: Window,
    section: Section,
    size: (f64, f64),
    pixels_per_metre: f64,
    bar: Bar,
}

struct Bar {
    label: String,
    axis: Axis,
}

/// Size of the title's letters: smaller where it is too long for the picture.
fn title_size(title: &str) -> u32 {
    let room = LONG_SIDE - 2.0 * MARGIN;
    let fits = |size: &u32| Canvas::text_width(title, *size) <= room;
    (SMALLEST_TITLE..=TITLE).rev().find(fits).unwrap_or(SMALLEST_TITLE)
}

impl Frame {
    /// The layout in which the window fills the picture.
    pub(super) fn fit(window: Window, shade: &Shade<'_>, range: (f64, f64), title: &str) -> Self {
        let Scale { factor, unit } = scale(range.0.abs().max(range.1.abs()), shade.unit);
        let bar = Bar {
            label: labelled(shade.name, &unit),
            axis: Axis::linear(range.0 * factor, range.1 * factor),
        };
        let labels = bar.axis.ticks(6);
        let ticks = labels.iter().map(|(_, label)| Canvas::text_width(label, TEXT));
        let ticks = BAR_WIDTH + 10.0 + ticks.fold(0.0, f64::max);
        let beside = GAP + ticks.max(Canvas::text_width(&bar.label, TEXT)) + MARGIN;

        let (left, right) = window.across();
        let (across, along) = (right - left, window.z.1 - window.z.0);
        let room = (LONG_SIDE - MARGIN - beside, LONG_SIDE - HEAD - FOOT);
        let pixels_per_metre = (room.0 / across).min(room.1 / along);
        let width = (across * pixels_per_metre).max(LEAST_SECTION.0).round();
        let height = (along * pixels_per_metre).max(LEAST_SECTION.1).round();
        let title_width = 2.0 * MARGIN + Canvas::text_width(title, title_size(title));
        Self {
            window,
            section: (MARGIN, HEAD, width, height),
            size: ((MARGIN + width + beside).max(title_width).ceil(), HEAD + height + FOOT),
            pixels_per_metre,
            bar,
        }
    }

    /// What is shown.
    pub(super) fn window(&self) -> &Window {
        &self.window
    }

    /// Where it is shown.
    pub(super) fn section(&self) -> Section {
        self.section
    }

    /// The pixel of a place (metres; on the other side of the axis, r is negative).
    pub(super) fn place(&self, r: f64, z: f64) -> (f64, f64) {
        let (left, top, width, height) = self.section;
        let (least, greatest) = self.window.across();
        let (r, z) = (r - 0.5 * (least + greatest), z - 0.5 * (self.window.z.0 + self.window.z.1));
        (left + 0.5 * width + self.length(r), top + 0.5 * height - self.length(z))
    }

    /// A length (metres) in pixels.
    pub(super) fn length(&self, length: f64) -> f64 {
        length * self.pixels_per_metre
    }

    /// The picture without its particles.
    pub(super) fn furnish(&self, picture: &Picture<'_>) -> Canvas {
        let mut canvas = Canvas::new(self.size.0, self.size.1);
        canvas.text((MARGIN, 38.0), title_size(picture.title), INK, Anchor::Start, picture.title);
        let count = picture.particles.r.len() as u64;
        let state = format!(
            "t = {}    {} particle{}",
            quantity(picture.time, "s", 4),
            grouped(count),
            if count == 1 { "" } else { "s" },
        );
        canvas.text((MARGIN, 62.0), TEXT, GREY, Anchor::Start, &state);
        self.draw_axis(&mut canvas);
        self.draw_colours(&mut canvas, picture);
        self.draw_scale(&mut canvas);
        canvas
    }

    /// The axis of symmetry, or how far away it is.
    fn draw_axis(&self, canvas: &mut Canvas) {
        let (_, top, _, height) = self.section;
        if self.window.is_mirrored() {
            let (x, _) = self.place(0.0, 0.0);
            let pen = Pen { dashed: true, ..Pen::solid(AXIS, 1.0) };
            canvas.line(&[(x, top - 10.0), (x, top + height + 10.0)], pen);
        } else {
            let text = format!("axis {} to the left", quantity(self.window.r.0, "m", 4));
            let place = (MARGIN, top + height + 62.0);
            canvas.text(place, TEXT, GREY, Anchor::Start, &text);
        }
    }

    fn draw_colours(&self, canvas: &mut Canvas, picture: &Picture<'_>) {
        let (section_left, section_top, width, height) = self.section;
        let length = (height - 30.0).min(BAR_HEIGHT).round();
        let left = section_left + width + GAP;
        let top = (section_top + 0.5 * (height - length) + 12.0).round();
        for line in 0..length as u32 {
            let from_top = f64::from(line);
            let colour = picture.shade.map.at(1.0 - (from_top + 0.5) / length);
            canvas.rectangle((left, top + from_top), (BAR_WIDTH, 1.0), colour);
        }
        let Bar { label, axis } = &self.bar;
        canvas.text((left, top - 16.0), TEXT, INK, Anchor::Start, label);
        for (value, label) in axis.ticks(6) {
            let y = top + (1.0 - axis.fraction(value)) * length;
            let right = left + BAR_WIDTH;
            canvas.line(&[(right, y), (right + 5.0, y)], Pen::solid(GREY, 1.0));
            canvas.text((right + 10.0, y + 5.0), TEXT, GREY, Anchor::Start, &label);
        }
    }

    /// A round length below the section, with its value.
    fn draw_scale(&self, canvas: &mut Canvas) {
        let (left, top, width, height) = self.section;
        let length = round_below(0.3 * width / self.pixels_per_metre);
        let (y, right) = (top + height + 36.0, left + self.length(length));
        canvas.line(&[(left, y), (right, y)], Pen::solid(INK, 3.0));
        let text = quantity(length, "m", 1);
        canvas.text((right + 12.0, y + 5.0), TEXT, INK, Anchor::Start, &text);
    }
}
