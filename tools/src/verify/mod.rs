//! `meniscus verify`: every case against what is exact, what the paper says and what mesh codes give.

mod catalogue;
mod judge;
mod present;

use std::path::PathBuf;
use std::process::ExitCode;

use crate::command::{pool, print};
use crate::failure::{Failure, INTERRUPTED};
use crate::output::OutputError;
use crate::output::report::{write_chart, write_page};
use crate::output::summary::Status;
use crate::study::batch::{Job, prepare, run_all};
use catalogue::Level;
use judge::judge;

const EXAMPLES: &str = "\
Examples:
  meniscus verify                                 all cases, coarse: under three minutes on two cores
  meniscus verify laplace-drop --level paper      one case at the paper's resolutions
  meniscus verify --level fine --out fine

DIR gets verify.html, verify.json, the plots as CASE-1.svg and so on, and each run's own results in runs/.
Exit codes: 0 all targets met; 1 a target missed; 2 bad input; 130 interrupted.";

/// Arguments of `verify`.
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct VerifyArguments {
    /// Cases to verify [default: all]
    #[arg(value_name = "CASE")]
    names: Vec<String>,
    /// How thoroughly
    #[arg(long, value_enum, default_value_t = Level::Quick)]
    level: Level,
    /// Folder for the results
    #[arg(long, value_name = "DIR", default_value = "runs/verify")]
    out: PathBuf,
    /// Replace an earlier verification in the folder
    #[arg(long)]
    overwrite: bool,
    /// Folder of the cases
    #[arg(long, value_name = "DIR", default_value = "cases")]
    cases: PathBuf,
    /// Threads [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..), allow_negative_numbers = true)]
    threads: Option<u16>,
    /// Show no progress
    #[arg(long, short)]
    quiet: bool,
}

/// Runs the cases and tells which targets they met.
pub(crate) fn verify(arguments: &VerifyArguments) -> Result<ExitCode, Failure> {
    let cases = catalogue::read(&arguments.cases, &arguments.names)?;
    let mut jobs = Vec::new();
    let mut plan = Vec::new();
    for case in &cases {
        for &resolution in case.resolutions(arguments.level) {
            let name = format!("{}-{resolution}", case.name);
            jobs.push(Job::read(name, &case.scene(&arguments.cases), &case.settings(resolution))?);
            plan.push((case, resolution));
        }
    }
    let known = catalogue::read(&arguments.cases, &[])?;
    let is_of_case = |name: &str| {
        let parts = name.rsplit_once('-');
        parts.is_some_and(|(case, number)| {
            number.parse::<f64>().is_ok() && known.iter().any(|known| known.name == case)
        })
    };
    let is_result = |name: &str| {
        let of_case = name.strip_prefix("runs/").or(name.strip_suffix(".svg"));
        ["verify.json", "verify.html"].contains(&name) || of_case.is_some_and(is_of_case)
    };
    let pool = pool(arguments.threads)?;
    prepare(&arguments.out, arguments.overwrite, &jobs, is_result)?;
    let (summaries, done) = run_all(&jobs, &arguments.out, (&pool, arguments.quiet));
    done?;
    if summaries.iter().any(|summary| summary.status == Some(Status::Interrupted)) {
        eprintln!("interrupted after {} of {} runs", summaries.len() - 1, jobs.len());
        return Ok(ExitCode::from(INTERRUPTED));
    }
    let judged = plan.iter().zip(&summaries);
    let rows: Vec<_> =
        judged.flat_map(|((case, resolution), summary)| judge(case, *resolution, summary)).collect();
    let path = arguments.out.join("verify.json");
    let json = serde_json::to_string_pretty(&rows).unwrap_or_default();
    std::fs::write(&path, json + "\n").map_err(OutputError::file("write", &path))?;
    let page = arguments.out.join("verify.html");
    let contents = present::page(&cases, &rows);
    write_page(&page, &contents)?;
    for (case, section) in cases.iter().zip(&contents.sections) {
        for (k, chart) in section.charts.iter().enumerate() {
            write_chart(&arguments.out.join(format!("{}-{}.svg", case.name, k + 1)), chart)?;
        }
    }
    let missed = rows.iter().filter(|row| row.met == Some(false)).count();
    let (table, verdict) = (present::table(&rows), present::verdict(&rows));
    print(&format!("{table}\n{verdict}\nresults in {}\n", page.display()))?;
    Ok(if missed > 0 { ExitCode::from(1) } else { ExitCode::SUCCESS })
}
