//! From the effective text to a scene.

use super::checks;
use super::diagnosis::Fault;
use super::entry::Entry;
use super::measures::Measure;
use super::method::Method;
use super::output::Output;
use super::parameters::Context;
use super::quantity::{LENGTH, SQUARED_RATE, TIME};
use super::section::Section;
use super::source::syntax;
use super::{Domain, Scene, body, liquid};
use std::path::Path;
use toml_edit::{Document, Item};

const KEYS: [&str; 13] = [
    "format",
    "title",
    "paper",
    "parameters",
    "liquid",
    "body",
    "particles",
    "run",
    "domain",
    "forces",
    "method",
    "output",
    "measure",
];

/// Reads a whole scene, the doubts about it, and for each body what is wrong with it if particles cannot fill it.
pub(super) fn scene(name: &str, text: &str) -> Result<(Scene, Vec<Fault>, Vec<Fault>), Fault> {
    let document = Document::parse(text).map_err(|error| syntax(&error))?;
    let root = document.as_table();
    // A scene of another format is told so before anything else in it is doubted.
    check_format(root)?;
    let context = Context::new(text, root.get("parameters").and_then(Item::as_table_like))?;
    let table = Section::new(Entry::root(&context, root), &KEYS)?;
    if let Some(entry) = table.optional("parameters").filter(|_| !root["parameters"].is_table_like()) {
        return Err(entry.wrong_type("a table", "[parameters]"));
    }

    let stem =
        Path::new(name).file_stem().map_or(name.to_owned(), |stem| stem.to_string_lossy().into_owned());
    let title = table.read_or("title", stem, title)?;
    let paper = table.read_or("paper", false, |entry| entry.flag())?;
    let (liquid, [sound_speed, viscosity]) =
        liquid::read(table.required("liquid", "[liquid] with density = \"1000 kg/m3\"")?)?;
    let domain = table.read_or("domain", Domain { origin: 0.0, period: None }, domain)?;
    let bodies = table
        .required("body", "[[body]] with shape = { sphere = { radius = \"2.5 um\" } }")?
        .elements("[[body]]")?
        .into_iter()
        .map(|entry| body::read(entry, domain.origin, &liquid))
        .collect::<Result<Vec<_>, _>>()?;
    context.check_finite()?;
    let (bodies, shapes): (Vec<_>, Vec<_>) = bodies.into_iter().unzip();
    let particles =
        Section::new(table.required("particles", "[particles] with size = \"50 nm\"")?, &["size"])?;
    let size = particles.required("size", "size = \"50 nm\"")?;
    let run = Section::new(table.required("run", "[run] with until = \"3 us\"")?, &["until", "steps"])?;
    let base = if paper { Method::paper() } else { Method::defaults() };

    let measures = table.read_or("measure", Vec::new(), |entry| entry.elements("[[measure]]"))?;

    let scene = Scene {
        title,
        paper,
        text: text.to_owned(),
        source_name: name.to_owned(),
        parameters: context.parameters(),
        liquid,
        particle_size: size.positive(LENGTH)?,
        until: run.required("until", "until = \"3 us\"")?.positive(TIME)?,
        steps: run.read_or("steps", None, |entry| entry.count(1).map(Some))?,
        central_force: table.read_or("forces", 0.0, forces)?,
        method: table.read_or("method", base.clone(), |entry| Method::read(entry, base))?,
        output: table.read_or("output", Output::defaults(), Output::read)?,
        measures: measures.iter().cloned().map(Measure::read).collect::<Result<_, _>>()?,
        bodies,
        domain,
        warnings: Vec::new(),
        unfilled: Vec::new(),
    };
    let chosen = |key: &str| table.inner("method", key);
    let places = checks::Places {
        shapes: &shapes,
        size: &size,
        sound_speed,
        viscosity,
        colour: table.inner("output", "colour_by"),
        period: table.inner("domain", "period"),
        measures: &measures,
        integration: chosen("time_integration").or_else(|| chosen("flux")),
    };
    let doubts = checks::check(&scene, &places)?;
    let unfilled = shapes.iter().map(|shape| {
        let body = shape.path.trim_end_matches(".shape");
        let help = "choose smaller particles or a simpler shape, and check its places and lengths";
        shape.fault(format!("`{body}` cannot be filled with particles"), help)
    });
    Ok((scene, doubts, unfilled.collect()))
}

/// Longest title, in characters: it heads pictures, plots and tables.
const LONGEST_TITLE: usize = 200;

/// One line, which a terminal can show as it stands.
fn title(entry: Entry<'_>) -> Result<String, Fault> {
    let title = entry.text()?;
    let help = format!("a title is one line of plain text, of {LONGEST_TITLE} characters at most");
    if title.trim().is_empty() {
        return Err(entry.fault("`title` is empty", format!("{help}; without one it is the file's name")));
    }
    if let Some(control) = title.chars().find(|letter| letter.is_control()) {
        let message = format!("`title` holds the control character U+{:04X}", u32::from(control));
        return Err(entry.fault(message, help));
    }
    match title.chars().count() {
        length if length > LONGEST_TITLE => {
            Err(entry.fault(format!("`title` is {length} characters long"), help))
        }
        _ => Ok(title.to_owned()),
    }
}

fn check_format(root: &toml_edit::Table) -> Result<(), Fault> {
    let help = "this version reads scenes of format 1: write `format = 1` at the top";
    match root.get("format") {
        None => {
            Err(Fault::new(0..0, "missing key `format` in the scene", help)
                .labelled("`format` is missing here"))
        }
        Some(item) if item.as_integer() == Some(1) => Ok(()),
        Some(item) => {
            let found =
                item.as_value().map_or("a table".to_owned(), |value| value.to_string().trim().to_owned());
            Err(Fault::new(
                item.span().unwrap_or_default(),
                format!("the scene's format is {found}, not 1"),
                help,
            ))
        }
    }
}

/// B^2 of the central force.
fn forces(entry: Entry<'_>) -> Result<f64, Fault> {
    let table = Section::new(entry, &["central"])?;
    table.read_or("central", 0.0, |entry| entry.not_negative(SQUARED_RATE))
}

fn domain(entry: Entry<'_>) -> Result<Domain, Fault> {
    let table = Section::new(entry, &["origin", "period"])?;
    Ok(Domain {
        origin: table.read_or("origin", 0.0, |entry| entry.not_negative(LENGTH))?,
        period: table.read_or("period", None, |entry| entry.positive(LENGTH).map(Some))?,
    })
}
