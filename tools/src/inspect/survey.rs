//! Everything that is told about one checkpoint.

use std::collections::BTreeMap;
use std::path::Path;

use meniscus_engine::checkpoint::{CheckpointError, ColumnView, Mapped, Role};
use serde::Serialize;

use super::failure::{Failure, known};
use super::nearest::{Nearest, Place, nearest};
use super::statistics::{Histogram, Statistics};
use super::totals::{Total, column, totals};

/// What stands in a checkpoint. The names of the entries are those of the JSON output.
#[derive(Debug, Serialize)]
pub struct Survey {
    pub file: String,
    /// The scene's own title, if it has one.
    pub title: Option<String>,
    pub scene_hash: String,
    pub revision: String,
    pub format: u32,
    pub step: u64,
    /// Time reached, s.
    pub time: f64,
    /// The last step taken, s.
    pub step_size: f64,
    /// Further numbers of the clock.
    pub scalars: BTreeMap<String, f64>,
    /// Length of the file, bytes.
    pub file_length: u64,
    /// Length of the columns in it, bytes.
    pub columns_length: u64,
    /// Whether every byte is as it was written.
    pub whole: bool,
    /// None where the columns are damaged.
    pub particles: Option<usize>,
    pub fields: Vec<Field>,
    pub totals: Vec<Total>,
    pub nearest: Option<Nearest>,
}

/// What is told about one field.
#[derive(Debug, Serialize)]
pub struct Field {
    pub name: String,
    pub symbol: String,
    pub unit: String,
    pub about: String,
    pub role: &'static str,
    #[serde(flatten)]
    pub statistics: Statistics,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub histogram: Option<Histogram>,
}

/// Reads a checkpoint. Where only its columns are damaged, what the header and clock tell comes
/// back together with the damage.
pub fn take(
    path: &Path,
    names: &[String],
    at: Option<Place>,
) -> Result<(Survey, Option<CheckpointError>), Failure> {
    let mapped = Mapped::open(path)?;
    let clock = mapped.clock();
    let mut survey = Survey {
        file: path.display().to_string(),
        title: title(mapped.scene()),
        scene_hash: format!("{:016x}", mapped.scene_hash()),
        revision: mapped.revision().to_owned(),
        format: mapped.format_version(),
        step: clock.step,
        time: clock.time,
        step_size: clock.step_size,
        scalars: clock.scalars.iter().cloned().collect(),
        file_length: mapped.file_length(),
        columns_length: mapped.columns_length(),
        whole: false,
        particles: None,
        fields: Vec::new(),
        totals: Vec::new(),
        nearest: None,
    };
    if let Err(error) = mapped.verify() {
        return Ok((survey, Some(error)));
    }
    survey.whole = true;
    let columns = mapped.columns()?;
    let chosen = choose(&columns, names)?;
    survey.particles = Some(columns.first().map_or(0, ColumnView::len));
    survey.fields = chosen.iter().map(|column| field(column, !names.is_empty())).collect();
    if names.is_empty() {
        survey.totals = totals(&columns);
    }
    if let Some(place) = at {
        survey.nearest = Some(nearest(place, &columns, &chosen)?);
    }
    Ok((survey, None))
}

/// The columns of these names, or all where no name is given.
fn choose<'a>(columns: &[ColumnView<'a>], names: &[String]) -> Result<Vec<ColumnView<'a>>, Failure> {
    if names.is_empty() {
        return Ok(columns.to_vec());
    }
    let chosen = names.iter().map(|name| {
        column(columns, name)
            .ok_or_else(|| Failure::UnknownField { name: name.clone(), known: known(columns) })
    });
    chosen.collect()
}

fn field(column: &ColumnView<'_>, with_histogram: bool) -> Field {
    let statistics = Statistics::of(column.values());
    Field {
        name: column.name().to_owned(),
        symbol: column.symbol().to_owned(),
        unit: column.unit().to_owned(),
        about: column.about().to_owned(),
        role: match column.role() {
            Role::State => "state",
            Role::Derived => "derived",
        },
        statistics,
        histogram: with_histogram.then(|| Histogram::of(column.values(), &statistics)),
    }
}

fn title(scene: &str) -> Option<String> {
    let table: toml::Table = scene.parse().ok()?;
    table.get("title")?.as_str().map(str::to_owned)
}
