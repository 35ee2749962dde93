//! The summary of a run as people read it.

use std::io::{self, Write};

use comfy_table::{CellAlignment, ColumnConstraint, ContentArrangement, Table, Width, presets};

use super::{Measure, PairSpeed, Profile, StageCost, StageProfile, Status, Summary};
use crate::output::units::{counted, duration, grouped, quantity, significant};

/// Widest line of the printed tables.
const TABLE_WIDTH: u16 = 100;

/// Prints a summary for people: what was measured against what is exact, what
/// the run cost, and which stage took how much of it.
///
/// # Errors
/// When `out` cannot be written.
pub fn print_table(summary: &Summary, out: &mut impl Write) -> io::Result<()> {
    let status = match summary.status {
        None | Some(Status::Done) => "",
        Some(Status::Failed) => "  FAILED",
        Some(Status::Interrupted) => "  interrupted",
    };
    writeln!(out, "{}{status}", summary.scene)?;
    if let Some(failure) = &summary.failure {
        writeln!(out, "{failure}")?;
    }
    writeln!(
        out,
        "{} simulated, {}, {}{}, {}{}",
        quantity(summary.time, "s", 4),
        counted(summary.steps, "step"),
        counted(summary.particles, "particle"),
        match summary.first_particles {
            0 => String::new(),
            first if first == summary.particles => String::new(),
            first => format!(" ({} at first)", grouped(first)),
        },
        counted(summary.threads as u64, "thread"),
        if summary.mixed_precision { ", mixed precision" } else { "" },
    )?;
    if !summary.measures.is_empty() {
        writeln!(out, "{}", measures_table(&summary.measures))?;
    }
    if summary.ns_per_particle_step.is_finite() {
        writeln!(
            out,
            "cost per particle and step: {} elapsed, {} of processor time",
            quantity(summary.ns_per_particle_step * 1e-9, "s", 3),
            quantity(summary.core_ns_per_particle_step * 1e-9, "s", 3),
        )?;
    }
    // A run that was resumed took longer: each process knows its own time alone.
    writeln!(
        out,
        "whole process: {} elapsed, {} of processor time",
        duration(summary.wall_seconds),
        duration(summary.cpu_seconds),
    )?;
    if let Some(profile) = &summary.profile {
        writeln!(out, "{}", profile_table(profile))?;
    } else if !summary.stages.is_empty() {
        writeln!(out, "{}", stages_table(summary))?;
    }
    if !summary.step_bounds.is_empty() {
        let bounds = summary.step_bounds.iter();
        let bounds: Vec<String> =
            bounds.map(|(reason, steps)| format!("{reason} ({})", counted(*steps, "step"))).collect();
        writeln!(out, "time step set by: {}", bounds.join(", "))?;
    }
    let kept = &summary.conservation;
    writeln!(
        out,
        "change of energy {}, axial momentum {}, mass {}",
        relative(kept.energy),
        relative(kept.momentum_z),
        relative(kept.mass),
    )
}

fn measures_table(measures: &[Measure]) -> Table {
    let mut table = table(["measure", "measured", "exact", "error"]);
    for measure in measures {
        let reference = measure.reference.map(|value| quantity(value, &measure.unit, 4));
        let measured = match measure.value.is_nan() {
            true => "not reached".to_owned(),
            false => quantity(measure.value, &measure.unit, 4),
        };
        table.add_row([
            measure.name.clone(),
            measured,
            reference.unwrap_or_default(),
            measure.relative_error.map(relative).unwrap_or_default(),
        ]);
    }
    align(table)
}

fn stages_table(summary: &Summary) -> Table {
    let mut table = table(["stage", "calls", "elapsed", "per particle and step", "share"]);
    let mut stages: Vec<&StageCost> = summary.stages.iter().collect();
    stages.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
    for stage in stages {
        let bar = "█".repeat((stage.share.clamp(0.0, 1.0) * 20.0).round() as usize);
        table.add_row([
            stage.name.clone(),
            grouped(stage.calls),
            duration(stage.seconds),
            each(stage),
            format!("{:5.1} % {bar:<20}", stage.share * 100.0),
        ]);
    }
    align(table)
}

fn profile_table(profile: &Profile) -> Table {
    const EACH: usize = 3;
    let mut table = table([
        "stage",
        "elapsed",
        "share",
        "per particle and step",
        "imbalance",
        "pairs",
        "GB/s",
        "GFLOP/s",
    ]);
    let mut stages: Vec<&StageProfile> = profile.stages.iter().collect();
    stages.sort_by(|a, b| b.cost.seconds.total_cmp(&a.cost.seconds));
    for stage in stages {
        let number = |value: Option<f64>| value.map_or_else(String::new, |value| significant(value, 3));
        let pairs = |of: fn(&PairSpeed) -> f64| number(stage.pairs.as_ref().map(of));
        table.add_row([
            stage.cost.name.clone(),
            duration(stage.cost.seconds),
            format!("{:.1} %", stage.cost.share * 100.0),
            each(&stage.cost),
            number(stage.imbalance),
            pairs(|pairs| pairs.per_particle_step),
            pairs(|pairs| pairs.gigabytes_per_second),
            pairs(|pairs| pairs.gigaflops),
        ]);
    }
    // Names and numbers stay whole, a heading need not.
    for (number, column) in table.column_iter_mut().enumerate() {
        column.set_constraint(match number {
            0 => ColumnConstraint::LowerBoundary(Width::Fixed(22)),
            EACH => ColumnConstraint::Absolute(Width::Fixed(14)),
            _ => ColumnConstraint::ContentWidth,
        });
    }
    align(table)
}

/// What a stage costs per particle and step; nothing where no step was taken.
fn each(stage: &StageCost) -> String {
    let nanoseconds = stage.ns_per_particle_step;
    if nanoseconds.is_finite() { quantity(nanoseconds * 1e-9, "s", 3) } else { String::new() }
}

fn table<const COLUMNS: usize>(header: [&str; COLUMNS]) -> Table {
    let mut table = Table::new();
    table
        .load_style(presets::UTF8_BORDERS_ONLY)
        .set_content_arrangement(ContentArrangement::Dynamic)
        .set_width(TABLE_WIDTH)
        .set_header(header);
    table
}

fn align(mut table: Table) -> Table {
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    table
}

/// A relative deviation: in percent, or with an exponent where it is tiny.
fn relative(error: f64) -> String {
    if error.is_nan() {
        "not known".to_owned()
    } else if error != 0.0 && error.abs() < 1e-5 {
        significant(error, 2)
    } else {
        format!("{} %", significant(error * 100.0, 3))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::summary::tests::example;

    #[test]
    fn the_table_says_it_all_within_a_hundred_columns() {
        let mut summary = example();
        summary.scene = "a film of a rather long name ".repeat(2);
        let never = Measure { value: f64::NAN, ..summary.measures[0].clone() };
        summary.measures.push(never);
        let mut out = Vec::new();
        print_table(&summary, &mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        for part in
            ["31.42 µs", "31.25 µs", "0.544 %", "46.3 ns", "70.0 %", "3.0e-17", "-0.120 %", "not reached"]
        {
            assert!(text.contains(part), "{part} is not in\n{text}");
        }
        assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
        assert!(!text.contains("imbalance"), "{text}");
        if std::env::var_os("MENISCUS_SHOW").is_some() {
            println!("{text}");
        }
    }

    #[test]
    fn without_a_step_nothing_costs_per_step() {
        let mut summary = example();
        (summary.steps, summary.threads, summary.step_bounds[0].1) = (0, 1, 1);
        (summary.ns_per_particle_step, summary.core_ns_per_particle_step) = (f64::NAN, f64::NAN);
        summary.stages.iter_mut().for_each(|stage| stage.ns_per_particle_step = f64::NAN);
        let mut out = Vec::new();
        print_table(&summary, &mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        assert!(!text.contains("NaN") && !text.contains("cost per particle"), "{text}");
        assert!(text.contains("1 thread,") && text.contains("acoustic (1 step)"), "{text}");
    }

    #[test]
    fn a_profile_fits_with_its_headings_whole() {
        let mut summary = example();
        let pairs = PairSpeed {
            per_particle_step: 13.2,
            per_nanosecond: 0.191,
            gigabytes_per_second: 22.4,
            gigaflops: 25.8,
        };
        let stage = |name: &str, pairs| StageProfile {
            cost: StageCost {
                name: name.to_owned(),
                calls: 12_000,
                seconds: 6.63,
                ns_per_particle_step: 68.9,
                share: 0.219,
            },
            busy: vec![0.9, 0.8],
            imbalance: Some(1.0588),
            pairs,
        };
        let stages = vec![stage("flux", Some(pairs)), stage("packing", None)];
        summary.profile = Some(Profile { stages });
        let mut out = Vec::new();
        print_table(&summary, &mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        for part in ["packing", "imbalance", "1.06", "GFLOP/s", "25.8"] {
            assert!(text.contains(part), "{part} is not in\n{text}");
        }
        assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    }
}
