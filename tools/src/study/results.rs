//! What a study has found: its table, its plot and its files.

use std::path::Path;

use comfy_table::{CellAlignment, Table, presets};
use serde::Serialize;

use super::batch::Job;
use super::error::{Measured, measured, order, order_in_words, percent};
use super::variation::Variation;
use crate::failure::Failure;
use crate::output::chart::{Chart, Series, chart};
use crate::output::plot::{Curve, Plot, Style, plot};
use crate::output::report::{Cell, Grid, Page, Section, write_page};
use crate::output::summary::{Status, Summary};
use crate::output::units::{counted, grouped, quantity, significant};
use crate::output::{OutputError, OutputResult};

/// One run of a study.
#[derive(Serialize)]
struct Row {
    settings: Vec<String>,
    particle_size: f64,
    particles: u64,
    steps: u64,
    status: Option<Status>,
    failure: Option<String>,
    measures: Vec<Measured>,
    core_seconds: f64,
    core_ns_per_particle_step: f64,
}

impl Row {
    fn measured(&self, name: &str) -> Option<&Measured> {
        self.measures.iter().find(|measure| measure.name == name)
    }
}

/// All runs of a study.
#[derive(Serialize)]
pub(super) struct Results {
    scene: String,
    keys: Vec<String>,
    rows: Vec<Row>,
    /// Runs that were asked for.
    #[serde(skip)]
    wanted: usize,
}

/// Keys that change nothing but the resolution: a line connects such runs.
const RESOLUTION: [&str; 2] = ["particle_size", "particles.size"];

impl Results {
    /// Collects what the runs have given; there may be fewer summaries than jobs.
    pub(super) fn new(
        variations: &[Variation],
        combinations: Vec<Vec<String>>,
        jobs: &[Job],
        summaries: Vec<Summary>,
    ) -> Self {
        let scene = jobs.first().map_or(String::new(), |job| job.scene.title.clone());
        let rows = combinations.into_iter().zip(jobs).zip(summaries);
        let rows = rows.map(|((settings, job), summary)| Row {
            settings,
            particle_size: job.scene.particle_size,
            particles: summary.particles,
            steps: summary.steps,
            status: summary.status,
            measures: summary.measures.iter().filter_map(|m| measured(&summary, &m.name)).collect(),
            core_seconds: summary.cpu_seconds,
            core_ns_per_particle_step: summary.core_ns_per_particle_step,
            failure: summary.failure,
        });
        let keys = variations.iter().map(|variation| variation.key.clone()).collect();
        Results { scene, keys, rows: rows.collect(), wanted: jobs.len() }
    }

    /// How far the study came, if not to its end.
    pub(super) fn interruption(&self) -> Option<String> {
        let done = self.rows.iter().filter(|row| row.status != Some(Status::Interrupted)).count();
        (done < self.wanted).then(|| format!("interrupted after {done} of {} runs", self.wanted))
    }

    /// The names of all that any run has measured, and whether any has an exact value of it: a run that a measure
    /// does not apply to has the same columns.
    fn columns(&self) -> Vec<(&str, bool)> {
        let mut columns: Vec<(&str, bool)> = Vec::new();
        for measure in self.rows.iter().flat_map(|row| &row.measures) {
            match columns.iter_mut().find(|(name, _)| *name == measure.name) {
                Some((_, exact)) => *exact |= measure.exact.is_some(),
                None => columns.push((&measure.name, measure.exact.is_some())),
            }
        }
        columns
    }

    fn head(&self) -> Vec<String> {
        let mut head = self.keys.clone();
        for (name, exact) in self.columns() {
            head.push(name.to_owned());
            head.extend(exact.then(|| "error".to_owned()));
        }
        head.extend(["particles", "core-seconds", "per particle and step"].map(str::to_owned));
        head
    }

    fn cells(&self, row: &Row) -> Vec<String> {
        let none = || "-".to_owned();
        let mut cells = row.settings.clone();
        for (name, exact) in self.columns() {
            let measure = row.measured(name);
            cells.push(measure.map_or_else(none, Measured::shown));
            let error = measure.and_then(|measure| measure.error);
            cells.extend(exact.then(|| error.map_or_else(none, percent)));
        }
        cells.extend([grouped(row.particles), significant(row.core_seconds, 3)]);
        cells.push(match row.status {
            Some(Status::Failed) => "broke down".to_owned(),
            Some(Status::Interrupted) => "interrupted".to_owned(),
            _ => quantity(row.core_ns_per_particle_step * 1e-9, "s", 3),
        });
        cells
    }

    /// The table for the terminal.
    pub(super) fn table(&self) -> Table {
        let mut table = Table::new();
        table.load_style(presets::UTF8_HORIZONTAL_ONLY).set_header(self.head());
        for row in &self.rows {
            table.add_row(self.cells(row));
        }
        for column in table.column_iter_mut().skip(self.keys.len()) {
            column.set_cell_alignment(CellAlignment::Right);
        }
        table
    }

    /// Writes study.csv, study.json, study.html and, if there are errors to show, study.png and study.svg.
    pub(super) fn write(&self, out: &Path) -> Result<(), Failure> {
        self.write_csv(&out.join("study.csv"))?;
        let path = out.join("study.json");
        let json = serde_json::to_string_pretty(self).unwrap_or_default();
        std::fs::write(&path, json + "\n").map_err(OutputError::file("write", &path))?;
        let series = self.series();
        let name = self.rows.iter().flat_map(|row| &row.measures).find(|m| m.error.is_some());
        let label = format!("error of {}", name.map_or("", |measure| &measure.name));
        let mut charts = Vec::new();
        if series.iter().any(|series| !series.points.is_empty()) {
            plot(&out.join("study.png"), &self.plot(&series, &label))?;
            charts.push(chart(&Chart { y_label: label, series: &series, target: None }));
        }
        let rows = self.rows.iter().map(|row| self.cells(row).into_iter().map(Cell::plain).collect());
        let section = Section {
            heading: "All runs".to_owned(),
            notes: self.orders(&series),
            charts,
            grid: Some(Grid { head: self.head(), rows: rows.collect(), texts: self.keys.len() }),
        };
        let mut lead = counted(self.rows.len() as u64, "run");
        lead += "; errors are relative, or absolute where zero is exact.";
        if let Some(interruption) = self.interruption() {
            lead += &format!(" The study was {interruption}.");
        }
        let page = Page { title: format!("Study: {}", self.scene), lead, sections: vec![section] };
        Ok(write_page(&out.join("study.html"), &page)?)
    }

    fn write_csv(&self, path: &Path) -> OutputResult<()> {
        let wrong = |error: csv::Error| OutputError::data(path, error.to_string());
        let mut file = csv::Writer::from_path(path).map_err(wrong)?;
        let mut head = self.keys.clone();
        for (name, _) in self.columns() {
            head.extend([name.to_owned(), format!("{name} error")]);
        }
        head.extend(["particle size in m", "particles", "steps", "core_seconds"].map(str::to_owned));
        head.extend(["core_ns_per_particle_step", "status"].map(str::to_owned));
        file.write_record(&head).map_err(wrong)?;
        for row in &self.rows {
            let mut record = row.settings.clone();
            for (name, _) in self.columns() {
                let measure = row.measured(name);
                let error = measure.and_then(|measure| measure.error);
                let numbers = [measure.map(|measure| measure.value), error];
                record
                    .extend(numbers.map(|number| number.map_or(String::new(), |number| number.to_string())));
            }
            record.extend([row.particle_size.to_string(), row.particles.to_string(), row.steps.to_string()]);
            record.extend([row.core_seconds.to_string(), row.core_ns_per_particle_step.to_string()]);
            record.push(row.status.map_or("", Status::word).to_owned());
            file.write_record(&record).map_err(wrong)?;
        }
        file.flush().map_err(OutputError::file("write", path))
    }

    /// Error of the first measure that has one, against cost: a line for all runs that differ in
    /// their resolution only.
    fn series(&self) -> Vec<Series> {
        let mut all: Vec<Series> = Vec::new();
        for row in &self.rows {
            let error = row.measures.iter().find_map(|measure| measure.error);
            // What an interrupted run has measured is not what the whole one would have.
            let Some(error) = error.filter(|_| row.status != Some(Status::Interrupted)) else {
                continue;
            };
            let pairs = self.keys.iter().zip(&row.settings);
            let (sizes, others): (Vec<_>, Vec<_>) =
                pairs.partition(|(key, _)| RESOLUTION.contains(&key.as_str()));
            let join = |pairs: &[(&String, &String)]| {
                pairs.iter().map(|(key, value)| format!("{key} {value}")).collect::<Vec<_>>().join(", ")
            };
            let name = if others.is_empty() { "measured".to_owned() } else { join(&others) };
            let label = sizes.first().map_or(String::new(), |(_, value)| (*value).clone());
            let point = (row.core_seconds, error.abs(), label, row.particle_size);
            match all.iter_mut().find(|series| series.name == name) {
                Some(series) => series.push(point),
                None => all.push(Series::ours(name, point)),
            }
        }
        all
    }

    fn plot(&self, series: &[Series], label: &str) -> Plot {
        let curves = series.iter().flat_map(|series| {
            let x: Vec<f64> = series.points.iter().map(|point| point.x).collect();
            let y: Vec<f64> = series.points.iter().map(|point| point.y).collect();
            let curve = |style| Curve { label: series.name.clone(), x: x.clone(), y: y.clone(), style };
            [curve(if x.len() > 1 { Style::Line } else { Style::Points })]
        });
        let curves = curves.collect();
        let x_label = "core-seconds".to_owned();
        let y_label = label.to_owned();
        Plot { title: self.scene.clone(), x_label, y_label, curves, log_x: true, log_y: true }
    }

    fn orders(&self, series: &[Series]) -> Vec<String> {
        let order = |series: &Series| {
            let points: Vec<(f64, f64)> = series.points.iter().map(|point| (point.size, point.y)).collect();
            order(&points).map(|order| order_in_words(&series.name, order))
        };
        series.iter().filter_map(order).collect()
    }
}
