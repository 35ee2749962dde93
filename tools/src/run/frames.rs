//! Frames: particles for ParaView and pictures, at equal distances in time.

use std::io::Write;
use std::path::{Path, PathBuf};

use meniscus_cases::scene::Scene;
use meniscus_cases::simulation::Simulation;
use meniscus_stages::fields;
use serde::{Deserialize, Serialize};

use super::columns::{Shown, column, pressure, shown, size};
use crate::failure::Failure;
use crate::output::atomic::{read_text, write_atomic};
use crate::output::colour::ColourMap;
use crate::output::folder::RunFolder;
use crate::output::picture::{Particles, Picture, Shade, Window, draw_picture, write_picture};
use crate::output::vtk::{Field, FieldData, write_pvd, write_vtp};
use crate::output::{OutputError, OutputResult};

/// What is remembered of the frames of a run, in `frames/index.json`.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Index {
    frames: Vec<Frame>,
}

/// One window and one range of colours for all pictures of a run, wider from one to the next where the
/// liquid leaves it.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct View {
    r: (f64, f64),
    z: (f64, f64),
    colours: (f64, f64),
}

#[derive(Debug, Serialize, Deserialize)]
struct Frame {
    step: u64,
    time: f64,
    /// Its particles, if they were written.
    file: Option<String>,
    /// What the pictures show from this one on, if any was drawn: a resumed run goes on with that of the last frame it
    /// keeps. Indices that were written before frames had views lack it: the view begins anew.
    view: Option<View>,
}

/// Writes the frames of a run.
pub(super) struct Frames {
    folder: RunFolder,
    index: Index,
    /// How many frames were due at the last look.
    due: u64,
}

impl Frames {
    /// The frames of a new run.
    pub(super) fn new(folder: &RunFolder) -> Self {
        Frames { folder: folder.clone(), index: Index::default(), due: 0 }
    }

    /// The frames of an earlier run up to a step and its time; later ones will be made again.
    ///
    /// # Errors
    /// When the index is damaged: the list for ParaView would lose them.
    pub(super) fn resume(
        folder: &RunFolder,
        scene: &Scene,
        (step, time): (u64, f64),
    ) -> Result<Self, Failure> {
        let mut frames = Self::new(folder);
        let path = frames.index_path();
        if path.exists() {
            frames.index = read_index(&path).map_err(|error| {
                let way_out = "bring it back from a copy, or remove it: particles.pvd then begins anew";
                Failure::input(format!("{error}; {way_out}"))
            })?;
        } else if folder.particles().exists() {
            eprintln!("`{}` is missing: particles.pvd begins anew at step {step}", path.display());
        }
        frames.index.frames.retain(|frame| frame.step <= step);
        frames.due = due(scene, time);
        Ok(frames)
    }

    fn index_path(&self) -> PathBuf {
        self.folder.frames().join("index.json")
    }

    /// Writes a frame if one is due: at the start, and at the first step at or past each due time.
    pub(super) fn look(&mut self, scene: &Scene, simulation: &Simulation) -> OutputResult<()> {
        let due = due(scene, simulation.world.clock.time);
        let first = self.index.frames.is_empty() && simulation.world.clock.step == 0;
        if scene.output.frames == 0 || !(first || due > self.due) {
            return Ok(());
        }
        self.due = due;
        let clock = &simulation.world.clock;
        let name = format!("step-{:09}", clock.step);
        let mut view = self.index.frames.last().and_then(|frame| frame.view);
        if scene.output.picture {
            let path = self.folder.file(&format!("frames/{name}.png"));
            let write = |picture: &Picture| write_picture(&path, picture);
            with_picture(&mut view, scene, simulation, write).unwrap_or(Ok(()))?;
        }
        let file = scene.output.paraview.then(|| format!("frames/{name}.vtp"));
        if let Some(file) = &file {
            write_particles(&self.folder.file(file), scene, simulation)?;
        }
        self.index.frames.push(Frame { step: clock.step, time: clock.time, file, view });
        if scene.output.paraview {
            let frames = self.index.frames.iter();
            let list: Vec<(f64, String)> =
                frames.filter_map(|frame| Some((frame.time, frame.file.clone()?))).collect();
            write_pvd(&self.folder.particles(), &list)?;
        }
        self.keep_index()
    }

    fn keep_index(&self) -> OutputResult<()> {
        let path = self.index_path();
        let text = serde_json::to_string_pretty(&self.index)
            .map_err(|error| OutputError::data(&path, error.to_string()))?;
        write_atomic(&path, |file| file.write_all(text.as_bytes()))
    }
}

fn read_index(path: &Path) -> OutputResult<Index> {
    let wrong = |error| OutputError::content(path, format!("no index of frames: {error}"));
    serde_json::from_str(&read_text(path)?).map_err(wrong)
}

/// How many frames an index holds.
///
/// # Errors
/// When it cannot be read or is damaged.
pub(crate) fn count_frames(index: &Path) -> OutputResult<usize> {
    Ok(read_index(index)?.frames.len())
}

/// Draws a picture and lets it go: what one costs.
///
/// # Errors
/// In words, where there is nothing to see.
pub(crate) fn rehearse_picture(scene: &Scene, simulation: &Simulation) -> Result<(), String> {
    let drawn = with_picture(&mut None, scene, simulation, draw_picture);
    drawn.transpose().map(|_| ())
}

/// Does something with the picture of the present state; `None` where there is nothing to colour it by. It
/// widens the view where the liquid has left it.
fn with_picture<T>(
    view: &mut Option<View>,
    scene: &Scene,
    simulation: &Simulation,
    use_it: impl FnOnce(&Picture) -> T,
) -> Option<T> {
    let name = scene.output.colour_by.as_str();
    let Shown { unit, values } = shown(simulation, name)?;
    let origin = scene.domain.origin;
    let r = column(simulation, fields::RADIUS.description.name);
    let r: Vec<f64> = r.iter().map(|r| r + origin).collect();
    let z = column(simulation, fields::AXIAL.description.name);
    let diameter = size(simulation);
    let particles = Particles { r: &r, z: &z, diameter: &diameter };
    let now = view_of(scene, &particles, &values);
    let view = *view.insert(view.map_or(now, |before| before.widened_to(&now)));
    Some(use_it(&Picture {
        title: &scene.title,
        time: simulation.world.clock.time,
        particles,
        shade: Shade {
            name,
            unit: if unit == "1" { "" } else { unit },
            values: &values,
            map: if view.colours.0 == -view.colours.1 { ColourMap::BlueRed } else { ColourMap::Viridis },
            range: Some(view.colours),
        },
        window: Some(Window { r: view.r, z: view.z, mirrored: None }),
    }))
}

/// How many of the scene's frames are due at a time.
fn due(scene: &Scene, time: f64) -> u64 {
    (time * scene.output.frames as f64 / scene.until).floor() as u64
}

/// Share of the particles beyond either side of the view, and of the colours: a few strays must not make
/// all the others small, or take all colours.
const STRAYS: f64 = 0.002;
const COLOUR_STRAYS: f64 = 0.02;

/// A view of what is there, with a margin.
fn view_of(scene: &Scene, particles: &Particles, values: &[f64]) -> View {
    let [r, z] = [particles.r, particles.z].map(|places| between(places, STRAYS));
    let largest = particles.diameter.iter().copied().fold(0.0, f64::max);
    let margin = largest + 0.1 * (r.1 - r.0).max(z.1 - z.0);
    View {
        r: ((r.0 - margin).max(0.0), r.1 + margin),
        z: (z.0 - margin, z.1 + margin),
        colours: colours(scene, values),
    }
}

impl View {
    fn widened_to(&self, other: &View) -> View {
        let both = |one: (f64, f64), other: (f64, f64)| (one.0.min(other.0), one.1.max(other.1));
        View {
            r: both(self.r, other.r),
            z: both(self.z, other.z),
            colours: both(self.colours, other.colours),
        }
    }
}

/// The finite values without a share at either end; zeros where there are none.
fn between(values: &[f64], share: f64) -> (f64, f64) {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    sorted.sort_unstable_by(f64::total_cmp);
    let last = sorted.len().saturating_sub(1);
    let at = |place: usize| sorted.get(place).copied().unwrap_or(0.0);
    let strays = (share * last as f64) as usize;
    (at(strays), at(last - strays))
}

fn colours(scene: &Scene, values: &[f64]) -> (f64, f64) {
    let (low, high) = between(values, COLOUR_STRAYS);
    let (motion, waves) = (scene.fastest_initial_speed(), scene.capillary_velocity());
    match scene.output.colour_by.as_str() {
        "velocity_r" | "velocity_z" => {
            let most = motion.max(0.02 * waves).max(high.abs()).max(low.abs());
            (-most, most)
        }
        "speed" => (0.0, motion.max(0.02 * waves).max(high)),
        "pressure" => {
            // What the motion adds: rho U (U + 2 c), and never less than 3 % of what is there.
            let added = scene.liquid.density * motion * (motion + 2.0 * waves);
            let margin = added.max(0.03 * high.abs());
            (low - margin, high + margin)
        }
        _ if high > low => (low, high),
        _ => (low - 0.1 * low.abs() - 1e-300, high + 0.1 * high.abs() + 1e-300),
    }
}

fn write_particles(path: &Path, scene: &Scene, simulation: &Simulation) -> OutputResult<()> {
    let of = |name: &str| column(simulation, name);
    let r = of(fields::RADIUS.description.name);
    let z = of(fields::AXIAL.description.name);
    let velocity = (of(fields::VELOCITY_R.description.name), of(fields::VELOCITY_Z.description.name));
    let (pressure, size) = (pressure(simulation), size(simulation));
    let (density, mass) = (of(fields::DENSITY.description.name), of(fields::MASS.description.name));
    let index = |name: &str| {
        let column = simulation.world.store.by_name::<u32>(name);
        column.map_or_else(Vec::new, |column| column.to_vec())
    };
    let identity = index(fields::IDENTITY.description.name);
    let surface = index(fields::SURFACE.description.name);
    let field = |name, unit, data| Field { name, unit, data };
    let mut fields = vec![
        field("velocity", "m/s", FieldData::Vector(&velocity.0, &velocity.1)),
        field("pressure", "Pa", FieldData::Scalar(&pressure)),
        field("density", "kg/m3", FieldData::Scalar(&density)),
        field("size", "m", FieldData::Scalar(&size)),
        field("mass", "kg", FieldData::Scalar(&mass)),
        field("identity", "", FieldData::Index(&identity)),
    ];
    // Only what acts at the surface knows where it is.
    if !surface.is_empty() {
        fields.push(field("surface", "", FieldData::Index(&surface)));
    }
    let asked = scene.output.colour_by.as_str();
    let coloured = shown(simulation, asked);
    if let Some(Shown { unit, values }) = &coloured
        && !fields.iter().any(|field| field.name == asked)
    {
        fields.push(field(asked, unit, FieldData::Scalar(values)));
    }
    write_vtp(path, (&r, &z), &fields)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_index_comes_back_bit_for_bit() {
        let frame = |step: u64| Frame { step, time: step as f64 * 1.7e-10 / 3.0, file: None, view: None };
        let index = Index { frames: (0..1000).map(frame).collect() };
        let text = serde_json::to_string(&index).unwrap();
        let back: Index = serde_json::from_str(&text).unwrap();
        let times = |index: &Index| index.frames.iter().map(|frame| frame.time).collect::<Vec<_>>();
        assert_eq!(times(&back), times(&index));
    }

    #[test]
    fn an_index_without_the_views_of_frames_keeps_its_frames() {
        let text =
            r#"{"view": null, "frames": [{"step": 3, "time": 1e-9, "file": "frames/step-000000003.vtp"}]}"#;
        let index: Index = serde_json::from_str(text).unwrap();
        let [frame] = &index.frames[..] else { panic!("{index:?}") };
        assert!(frame.step == 3 && frame.file.is_some() && frame.view.is_none());
    }
}
