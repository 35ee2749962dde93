//! A picture of the particles in their section, coloured by a field.
//!
//! The section is mirrored at the axis, so that a drop looks like a drop; a
//! liquid far from the axis (a film on a large radius) is shown on one side.

use std::io::Write;
use std::path::Path;

use tiny_skia::Pixmap;

use super::atomic::write_atomic;
use super::colour::ColourMap;
use super::{OutputError, OutputResult};
use discs::Discs;
use frame::Frame;

mod discs;
mod frame;

/// Where the particles are: one entry each, in metres.
#[derive(Debug, Clone, Copy)]
pub struct Particles<'a> {
    /// Distance from the axis.
    pub r: &'a [f64],
    /// Position along the axis.
    pub z: &'a [f64],
    /// Diameter of the disc to draw, about the distance of neighbours.
    pub diameter: &'a [f64],
}

/// What colours the particles.
#[derive(Debug, Clone, Copy)]
pub struct Shade<'a> {
    /// Name of the field.
    pub name: &'a str,
    /// Its SI unit; empty for a plain number.
    pub unit: &'a str,
    /// Its values, one for each particle.
    pub values: &'a [f64],
    /// The colours.
    pub map: ColourMap,
    /// Values at the ends of the map; by default the least and the greatest,
    /// on a map with a middle the greatest magnitude on both sides.
    pub range: Option<(f64, f64)>,
}

/// The part of the section to show, in metres. One window for all pictures of
/// a run keeps them comparable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Least and greatest distance from the axis.
    pub r: (f64, f64),
    /// Least and greatest position along it.
    pub z: (f64, f64),
    /// Whether both sides of the axis are shown; by default unless the liquid
    /// is further from the axis than it is wide.
    pub mirrored: Option<bool>,
}

/// A picture to be drawn.
#[derive(Debug, Clone, Copy)]
pub struct Picture<'a> {
    /// Title, such as the name of the scene.
    pub title: &'a str,
    /// Simulated time in seconds.
    pub time: f64,
    /// The particles.
    pub particles: Particles<'a>,
    /// What colours them.
    pub shade: Shade<'a>,
    /// What to show; by default all particles.
    pub window: Option<Window>,
}

impl Window {
    /// The smallest window that shows all particles whose place is a number;
    /// `None` if there are none.
    pub fn around(particles: &Particles<'_>) -> Option<Self> {
        let range = |places: &[f64]| {
            let discs = places.iter().zip(particles.diameter);
            let discs = discs.filter(|(place, size)| place.is_finite() && size.is_finite());
            discs.fold(None, |range: Option<(f64, f64)>, (place, size)| {
                let (low, high) = (place - 0.5 * size, place + 0.5 * size);
                let (least, greatest) = range.unwrap_or((low, high));
                Some((least.min(low), greatest.max(high)))
            })
        };
        let (r, z) = (range(particles.r)?, range(particles.z)?);
        Some(Self { r: (r.0.max(0.0), r.1), z, mirrored: None })
    }

    fn is_mirrored(&self) -> bool {
        self.mirrored.unwrap_or(self.r.0 <= self.r.1 - self.r.0)
    }

    /// Least and greatest abscissa shown, in metres.
    fn across(&self) -> (f64, f64) {
        if self.is_mirrored() { (-self.r.1, self.r.1) } else { self.r }
    }
}

/// Draws the particles to a PNG file, all of it or nothing.
///
/// # Errors
/// When the particles' columns differ in length, there is nothing to see, or
/// the file cannot be written.
pub fn write_picture(path: &Path, picture: &Picture<'_>) -> OutputResult<()> {
    let png = draw_picture(picture).map_err(|problem| OutputError::data(path, problem))?;
    write_atomic(path, |file| file.write_all(&png))
}

/// Draws the particles, as a PNG file holds them.
///
/// # Errors
/// In words, when the particles' columns differ in length, or there is nothing to see.
pub fn draw_picture(picture: &Picture<'_>) -> Result<Vec<u8>, String> {
    let Picture { particles, shade, .. } = picture;
    let lengths = [particles.z, particles.diameter, shade.values].map(<[f64]>::len);
    if lengths.iter().any(|length| *length != particles.r.len()) {
        return Err("the columns of the particles differ in length".to_owned());
    }
    let window = picture.window.or_else(|| Window::around(particles));
    let window = window.filter(|window| {
        let (across, along) = (window.r.1 - window.r.0, window.z.1 - window.z.0);
        across.is_finite() && along.is_finite() && across > 0.0 && along > 0.0
    });
    let window = window.ok_or("there are no particles to show")?;

    let range = shade_range(shade);
    let frame = Frame::fit(window, shade, range, picture.title);
    let png = frame.furnish(picture).png(1.0)?;
    let mut pixels = Pixmap::decode_png(&png).map_err(|reason| reason.to_string())?;
    draw_particles(&mut pixels, &frame, picture, range);
    pixels.encode_png().map_err(|reason| reason.to_string())
}

fn draw_particles(pixels: &mut Pixmap, frame: &Frame, picture: &Picture<'_>, range: (f64, f64)) {
    let Picture { particles, shade, .. } = picture;
    let mut discs = Discs::new(pixels, frame.section());
    let span = range.1 - range.0;
    for (index, value) in shade.values.iter().enumerate() {
        let fraction = if span > 0.0 || value.is_nan() { (value - range.0) / span } else { 0.5 };
        let colour = shade.map.at(fraction);
        let (r, z) = (particles.r[index], particles.z[index]);
        let diameter = frame.length(particles.diameter[index]);
        discs.draw(frame.place(r, z), diameter, colour);
        if frame.window().is_mirrored() {
            discs.draw(frame.place(-r, z), diameter, colour);
        }
    }
}

fn shade_range(shade: &Shade<'_>) -> (f64, f64) {
    let finite = shade.values.iter().copied().filter(|value| value.is_finite());
    let ends = finite.fold(None, |ends: Option<(f64, f64)>, value| {
        let (least, greatest) = ends.unwrap_or((value, value));
        Some((least.min(value), greatest.max(value)))
    });
    let (least, greatest) = shade.range.or(ends).unwrap_or((0.0, 1.0));
    match (shade.map, shade.range) {
        (ColourMap::BlueRed, None) => {
            let magnitude = least.abs().max(greatest.abs());
            (-magnitude, magnitude)
        }
        _ => (least, greatest),
    }
}

#[cfg(test)]
mod tests;
