//! `meniscus inspect CHECKPOINT`: what a checkpoint holds, at a glance.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::Path;

use meniscus_cases::assemble::{Physics, assemble};
use meniscus_cases::scene::Scene;
use meniscus_engine::checkpoint::{CheckpointError, Mapped};
use serde::Serialize;

use super::around;
use super::failure::{Failure, Verdict};
use super::fields::role;
use super::open::{self, newest};
use super::print::{self, number};

/// Files up to this length are checked as a whole before they are summed up, bytes.
const CHECKED_AT_ONCE: u64 = 64 << 20;

/// What stands in a checkpoint. The names of the entries are those of the JSON output.
#[derive(Debug, Serialize)]
struct Summary {
    file: String,
    /// The scene's own title, if it has one.
    title: Option<String>,
    scene_hash: String,
    revision: String,
    format: u32,
    step: u64,
    /// Time reached, s.
    time: f64,
    /// The last step taken, s.
    step_size: f64,
    /// Further numbers of the clock.
    scalars: BTreeMap<String, f64>,
    /// Length of the file, bytes.
    file_length: u64,
    /// Length of the columns in it, bytes.
    columns_length: u64,
    /// Checksum of the columns (xxh3), as the header tells it.
    columns_checksum: String,
    /// Whether every byte is as it was written; none where only header and clock were checked.
    whole: Option<bool>,
    /// None where the columns are damaged.
    particles: Option<usize>,
    fields: Vec<Field>,
    /// The stages of a step, in their order; empty where this release cannot read the scene.
    stages: Vec<&'static str>,
    /// Why the run broke down, if it did.
    crash: Option<String>,
}

#[derive(Debug, Serialize)]
struct Field {
    name: String,
    unit: String,
    role: &'static str,
    about: String,
}

/// Sums up a checkpoint. Where only its columns are damaged, what the header and clock tell is printed
/// all the same, and then the damage.
pub fn run(path: &Path, as_json: bool, output: &mut dyn Write) -> Result<Verdict, Failure> {
    let mapped = Mapped::open(&newest(path)?)?;
    let (summary, damage) = take(&mapped);
    if as_json {
        print::json(&summary, output)?;
    } else {
        text(&summary, output)?;
    }
    damage.map_or(Ok(Verdict::Good), |error| Err(error.into()))
}

fn take(mapped: &Mapped) -> (Summary, Option<CheckpointError>) {
    let clock = mapped.clock();
    let scene = open::scene(mapped);
    let mut summary = Summary {
        file: mapped.path().display().to_string(),
        title: scene.as_ref().map(|scene| scene.title.clone()).or_else(|| title(mapped.scene())),
        scene_hash: format!("{:016x}", mapped.scene_hash()),
        revision: mapped.revision().to_owned(),
        format: mapped.format_version(),
        step: clock.step,
        time: clock.time,
        step_size: clock.step_size,
        scalars: clock.scalars.iter().cloned().collect(),
        file_length: mapped.file_length(),
        columns_length: mapped.columns_length(),
        columns_checksum: format!("{:016x}", mapped.columns_checksum()),
        whole: None,
        particles: None,
        fields: Vec::new(),
        stages: scene.as_ref().map(stages).unwrap_or_default(),
        crash: None,
    };
    let checked = match mapped.file_length() > CHECKED_AT_ONCE {
        true => Ok(None),
        false => mapped.verify().map(|()| Some(true)),
    };
    match checked.and_then(|whole| Ok((whole, mapped.columns()?))) {
        Ok((whole, columns)) => {
            summary.whole = whole;
            summary.particles = Some(open::particles(&columns));
            let field = |column: &meniscus_engine::checkpoint::ColumnView<'_>| Field {
                name: column.name().to_owned(),
                unit: column.unit().to_owned(),
                role: role(column.role()),
                about: column.about().to_owned(),
            };
            summary.fields = columns.iter().map(field).collect();
            summary.crash = around::explain(clock, &columns, scene.as_ref());
            (summary, None)
        }
        Err(error) => {
            summary.whole = Some(false);
            (summary, Some(error))
        }
    }
}

/// The title of a scene that this release may not understand.
fn title(scene: &str) -> Option<String> {
    let table: toml::Table = scene.parse().ok()?;
    table.get("title")?.as_str().map(str::to_owned)
}

fn stages(scene: &Scene) -> Vec<&'static str> {
    let plan = assemble(&Physics::of(scene)).map(|assembly| assembly.plan).unwrap_or_default();
    plan.iter().filter(|line| line.present).map(|line| line.stage).collect()
}

fn text(summary: &Summary, output: &mut dyn Write) -> io::Result<()> {
    let title = summary.title.as_deref().filter(|title| !title.is_empty()).unwrap_or("without title");
    let particles = summary.particles.map_or("unknown".to_owned(), |particles| particles.to_string());
    let checksums = match summary.whole {
        Some(true) => "good",
        Some(false) => "DAMAGED",
        None => "good in header, clock and scene; `inspect verify` checks the columns",
    };
    let (time, step_size) = (number(summary.time), number(summary.step_size));
    writeln!(output, "checkpoint  {}", summary.file)?;
    writeln!(output, "scene       {title} (hash {})", summary.scene_hash)?;
    writeln!(output, "step        {}", summary.step)?;
    writeln!(output, "time        {time} s (last step {step_size} s)")?;
    // What a crash is told by is told as a whole below.
    let told = |name: &str| summary.crash.is_some() && name.starts_with("fault ");
    for (name, value) in summary.scalars.iter().filter(|(name, _)| !told(name)) {
        writeln!(output, "            {name} = {}", number(*value))?;
    }
    writeln!(output, "particles   {particles}")?;
    writeln!(output, "revision    {}, format {}", summary.revision, summary.format)?;
    let (file, columns) = (size(summary.file_length), size(summary.columns_length));
    writeln!(output, "size        {file} (columns {columns})")?;
    writeln!(output, "checksums   {checksums} (columns {})", summary.columns_checksum)?;
    if !summary.stages.is_empty() {
        writeln!(output, "stages      {}", summary.stages.join(", "))?;
    }
    if let Some(crash) = &summary.crash {
        writeln!(output, "BROKE DOWN  {crash}")?;
    }
    if !summary.fields.is_empty() {
        let rows = summary.fields.iter().map(|field| {
            vec![field.name.clone(), field.unit.clone(), field.role.to_owned(), field.about.clone()]
        });
        writeln!(output, "\n{}", print::left_table(&["field", "unit", "role", "about"], rows))?;
    }
    Ok(())
}

fn size(bytes: u64) -> String {
    let mut amount = bytes as f64;
    for unit in ["B", "KiB", "MiB"] {
        if amount < 1024.0 {
            return format!("{} {unit}", (amount * 10.0).round() / 10.0);
        }
        amount /= 1024.0;
    }
    format!("{amount:.1} GiB")
}
