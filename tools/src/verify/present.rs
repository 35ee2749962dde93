//! A verification as a table for the terminal and as a page.

use comfy_table::{CellAlignment, Table, presets};

use super::catalogue::{Case, Expectation};
use super::judge::Row;
use crate::output::chart::{Chart, Point, Series, chart};
use crate::output::report::{Cell, Grid, Page, Section, Tone};
use crate::output::units::{quantity, significant};
use crate::study::error::{order, order_in_words, percent};

const HEAD: [&str; 12] = [
    "case",
    "per length",
    "measure",
    "measured",
    "exact",
    "error",
    "target",
    "met?",
    "paper",
    "best mesh code",
    "core-s",
    "particle-step",
];
/// The column that tells whether a target was met.
const MET: usize = 7;

fn cells(row: &Row) -> Vec<String> {
    let measured = &row.measured;
    let optional = |error: Option<f64>| error.map_or("-".to_owned(), percent);
    let magnitude = |error: Option<f64>| optional(error).trim_start_matches('+').to_owned();
    let met = match (&row.failure, row.met) {
        (Some(_), _) => "BROKE DOWN",
        (None, Some(true)) => "yes",
        (None, Some(false)) => "MISSED",
        (None, None) => "-",
    };
    let code = match (row.code_error, row.code_seconds) {
        (Some(error), Some(seconds)) => format!("{} ({seconds} s)", percent(error)),
        _ => "-".to_owned(),
    };
    vec![
        row.case.clone(),
        row.resolution.to_string(),
        measured.name.clone(),
        measured.shown(),
        measured.exact.map_or("-".to_owned(), |exact| quantity(exact, &measured.unit, 4)),
        optional(measured.error),
        magnitude(row.target),
        met.to_owned(),
        magnitude(row.paper_error),
        code,
        significant(row.core_seconds, 3),
        quantity(row.core_ns_per_particle_step * 1e-9, "s", 3),
    ]
}

/// The table for the terminal.
pub(super) fn table(rows: &[Row]) -> Table {
    let mut table = Table::new();
    table.load_style(presets::UTF8_HORIZONTAL_ONLY).set_header(HEAD);
    for row in rows {
        table.add_row(cells(row));
    }
    for (index, column) in table.column_iter_mut().enumerate() {
        if index != 0 && index != 2 {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    table
}

/// How many targets were met, in a sentence.
pub(super) fn verdict(rows: &[Row]) -> String {
    let judged = rows.iter().filter(|row| row.met.is_some()).count();
    match rows.iter().filter(|row| row.met == Some(false)).count() {
        0 => format!("all {judged} targets met"),
        missed => format!("{missed} of {judged} targets MISSED"),
    }
}

/// The page.
pub(super) fn page(cases: &[Case], rows: &[Row]) -> Page {
    let sections = cases.iter().map(|case| {
        let own: Vec<&Row> = rows.iter().filter(|row| row.case == case.name).collect();
        section(case, &own)
    });
    let lead = format!(
        "{}. Errors are relative to the exact value, or absolute where zero is exact. Costs are seconds of \
         one core, packing included. The best mesh code's error is the smallest that any of \
         them reached, with its cost; those were timed apart from ours, so compare costs as orders of magnitude.",
        sentence(&verdict(rows))
    );
    Page { title: "Meniscus: measured against exact".to_owned(), lead, sections: sections.collect() }
}

fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().chain(letters).collect())
}

fn section(case: &Case, rows: &[&Row]) -> Section {
    let mut notes = vec![case.about.clone()];
    let mut charts = Vec::new();
    for expectation in &case.measure {
        let of: Vec<&&Row> = rows.iter().filter(|row| row.measured.name == expectation.name).collect();
        let points = of.iter().filter_map(|row| Some((1.0 / row.resolution, row.measured.error?)));
        let points: Vec<(f64, f64)> = points.collect();
        if let Some(order) = order(&points) {
            notes.push(order_in_words(&expectation.name, order));
        }
        if let Some(drawn) = draw(case, expectation, &of) {
            charts.push(drawn);
        }
    }
    // The case and its length stand in the heading.
    let body = rows.iter().map(|row| {
        cells(row).into_iter().enumerate().skip(1).map(|(k, text)| match (k, row.met) {
            (MET, Some(true)) => Cell::toned(text, Tone::Good),
            (MET, Some(false)) => Cell::toned(text, Tone::Bad),
            _ => Cell::plain(text),
        })
    });
    let rows = body.map(Iterator::collect).collect();
    let mut head: Vec<String> = HEAD.iter().skip(1).map(|name| (*name).to_owned()).collect();
    head[0] = format!("{}/D", case.per);
    Section { heading: case.title.clone(), notes, charts, grid: Some(Grid { head, rows, texts: 2 }) }
}

fn draw(case: &Case, expectation: &Expectation, rows: &[&&Row]) -> Option<String> {
    let mut series = Vec::new();
    for row in rows {
        let Some(error) = row.measured.error else { continue };
        let label = format!("{}", row.resolution);
        let point = (row.core_seconds, error.abs(), label, 1.0 / row.resolution);
        match series.first_mut() {
            None => series.push(Series::ours(format!("Meniscus, {}/D", case.per), point)),
            Some(ours) => ours.push(point),
        }
    }
    if series.iter().all(|series| series.points.is_empty()) {
        return None;
    }
    for code in &expectation.code {
        let point = |[cells, error, seconds]: &[f64; 3]| Point {
            x: *seconds,
            y: error.abs(),
            label: cells.to_string(),
            size: 1.0 / cells,
        };
        let points = code.points.iter().map(point).collect();
        series.push(Series { name: code.name.clone(), points, ours: false });
    }
    let target = rows.last().and_then(|row| row.target);
    let y_label = format!("error of {}", expectation.name);
    Some(chart(&Chart { y_label, series: &series, target }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::error::tests::fake;
    use crate::verify::catalogue::tests::example;
    use crate::verify::judge::judge;

    #[test]
    fn a_missed_target_stands_out() {
        let case = example();
        let rows: Vec<Row> = [(12.0, 10.5), (25.0, 10.2)]
            .into_iter()
            .flat_map(|(resolution, value)| judge(&case, resolution, &fake("frequency", value, 10.0)))
            .collect();
        let text = table(&rows).to_string();
        assert!(text.contains("MISSED") && text.contains("yes") && text.contains("+2.0 %"), "{text}");
        assert_eq!(verdict(&rows), "1 of 2 targets MISSED");
        let page = page(&[case], &rows);
        assert_eq!(page.sections[0].charts.len(), 1);
        assert!(page.sections[0].charts[0].contains("mesh"));
        assert!(page.sections[0].notes[1].contains("order 1.2"), "{:?}", page.sections[0].notes);
    }
}
