//! `meniscus inspect CHECKPOINT`: what a checkpoint holds, at a glance.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::Path;

use meniscus_cases::assemble::{Physics, assemble};
use meniscus_cases::scene::Scene;
use meniscus_engine::checkpoint::Mapped;
use serde::Serialize;

use super::around;
use super::columns::choose;
use super::failure::{Failure, Verdict};
use super::fields::gathered;
use super::open::{self, newest};
use super::print::{self, number};
use super::statistics::Statistics;
use super::totals::{Total, totals};

/// Files up to this length are read as a whole: checked, and their fields summed up; bytes.
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
    /// Sums over all particles, where the columns were read.
    totals: Vec<Total>,
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
    /// None where the column was not read.
    #[serde(flatten)]
    statistics: Option<Statistics>,
}

/// Sums up a checkpoint: the fields of these names, or all where no name is given. Where only its columns are damaged, what the header and clock tell is printed
/// all the same, and then the damage.
pub fn run(path: &Path, names: &[String], as_json: bool, output: &mut dyn Write) -> Result<Verdict, Failure> {
    let mapped = Mapped::open(&newest(path)?)?;
    let mut summary = head(&mapped);
    let damage = match columns(&mapped, names, &mut summary) {
        Err(Failure::Checkpoint(damage)) => Some(damage),
        other => other.map(|()| None)?,
    };
    if damage.is_some() {
        summary.whole = Some(false);
    }
    if as_json {
        print::json(&summary, output)?;
    } else {
        text(&summary, output)?;
    }
    damage.map_or(Ok(Verdict::Good), |error| Err(error.into()))
}

/// What header, clock and scene tell.
fn head(mapped: &Mapped) -> Summary {
    let clock = mapped.clock();
    let scene = open::scene(mapped);
    Summary {
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
        totals: Vec::new(),
        stages: scene.as_ref().map(stages).unwrap_or_default(),
        crash: None,
    }
}

/// What the columns tell. Those of a long file are read only where they are asked for by name.
fn columns(mapped: &Mapped, names: &[String], summary: &mut Summary) -> Result<(), Failure> {
    let short = mapped.file_length() <= CHECKED_AT_ONCE;
    if short || !names.is_empty() {
        mapped.verify()?;
        summary.whole = Some(true);
    }
    let columns = mapped.columns()?;
    summary.particles = Some(open::particles(&columns));
    for field in choose(mapped, &columns, names)? {
        let statistics = match summary.whole {
            Some(true) => Some(gathered(mapped, &field)?.statistics()),
            _ => None,
        };
        summary.fields.push(Field {
            name: field.name().to_owned(),
            unit: field.unit().to_owned(),
            role: field.role(),
            about: field.about().to_owned(),
            statistics,
        });
    }
    if short {
        summary.totals = totals(&columns);
    }
    summary.crash = around::explain(mapped.clock(), &columns, open::scene(mapped).as_ref());
    Ok(())
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
    if let Some(crash) = &summary.crash {
        writeln!(output, "BROKE DOWN  {crash}\n")?;
    }
    writeln!(output, "checkpoint  {}", summary.file)?;
    writeln!(output, "scene       {title} (hash {})", summary.scene_hash)?;
    writeln!(output, "step        {}", summary.step)?;
    writeln!(output, "time        {time} s (last step {step_size} s)")?;
    // What a crash is told by is told as a whole above.
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
    for total in &summary.totals {
        writeln!(output, "{:<11} {} {}", total.name, number(total.value), total.unit)?;
    }
    if summary.fields.is_empty() {
        return Ok(());
    }
    let optional = |value: Option<f64>| value.map_or("-".to_owned(), number);
    let rows = summary.fields.iter().map(|field| {
        let of = field.statistics.unwrap_or_default();
        let numbers = [of.minimum, of.maximum, of.mean].map(optional);
        let non_finite = field.statistics.map_or("-".to_owned(), |of| of.non_finite.to_string());
        let mut row = vec![field.name.clone(), field.unit.clone()];
        row.extend(numbers);
        row.extend([non_finite, field.role.to_owned()]);
        row
    });
    let head = ["field", "unit", "minimum", "maximum", "mean", "non-finite", "role"];
    writeln!(output, "\n{}", print::table(&head, rows))?;
    if summary.whole.is_none() {
        writeln!(output, "\n`inspect fields` reads the columns of a file as long as this one")?;
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
