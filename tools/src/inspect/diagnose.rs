//! `meniscus inspect diagnose`: what physics says about a checkpoint.

use std::io::Write;
use std::path::PathBuf;

use meniscus_cases::measure::Observer;
use meniscus_cases::scene::Scene;
use meniscus_cases::simulation::Simulation;
use meniscus_engine::checkpoint::{Checkpoint, ColumnView, read};
use serde::Serialize;

use super::around::{AT_BOUNDARY, explain};
use super::columns::column;
use super::drops::{Neighbourhood, neighbourhood};
use super::failure::{Failure, Verdict};
use super::open::{open, scene};
use super::print::{self, number};
use super::totals::{Total, totals};

/// Which checkpoint, and how to show it.
#[derive(clap::Args, Debug)]
#[command(after_help = "\
Examples:
  meniscus inspect diagnose runs/drop
  meniscus inspect diagnose runs/drop --json | jq '.drops | length'

Drops are sets of particles that lie within each other's support. The bounds of the time step are
those of one more step from here.")]
pub struct Arguments {
    /// A checkpoint, or the folder of a run: then its newest checkpoint
    checkpoint: PathBuf,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Drops and counts of neighbours that are listed in text.
const LISTED: usize = 10;

/// The names of the entries are those of the JSON output.
#[derive(Debug, Serialize)]
struct Diagnosis {
    totals: Vec<Total>,
    #[serde(flatten)]
    around: Option<Neighbourhood>,
    surface_particles: Option<usize>,
    bounds: Vec<Bound>,
    crash: Option<String>,
    /// What could not be told, and why.
    missing: Vec<String>,
}

/// How long a step a stage allows.
#[derive(Debug, Serialize)]
struct Bound {
    reason: &'static str,
    /// s
    step_size: f64,
}

/// Prints mass, momentum, energies, drops, neighbours and bounds of the time step.
pub fn run(arguments: &Arguments, output: &mut dyn Write) -> Result<Verdict, Failure> {
    let mapped = open(&arguments.checkpoint)?;
    let columns = mapped.columns()?;
    let scene = scene(&mapped).ok_or(Failure::NoScene)?;
    let surface = column(&columns, "surface");
    let mut diagnosis = Diagnosis {
        totals: Vec::new(),
        around: None,
        surface_particles: surface
            .map(|surface| surface.values().filter(|value| *value == AT_BOUNDARY).count()),
        bounds: Vec::new(),
        crash: explain(mapped.clock(), &columns, Some(&scene)),
        missing: Vec::new(),
    };
    match neighbourhood(&columns, &scene) {
        Ok(around) => diagnosis.around = Some(around),
        Err(failure) => diagnosis.missing.push(format!("no drops and neighbours: {failure}")),
    }
    diagnosis.move_on(&scene, &read(mapped.path())?, &columns);
    if arguments.json {
        print::json(&diagnosis, output)?;
    } else {
        diagnosis.text(output)?;
    }
    Ok(Verdict::Good)
}

impl Diagnosis {
    /// Takes the totals as a run does, and one step to learn its bounds. Where the state is none that
    /// can move, sums over the columns must do.
    fn move_on(&mut self, scene: &Scene, checkpoint: &Checkpoint, columns: &[ColumnView<'_>]) {
        let resumed = match self.crash {
            Some(_) => Err("the run broke down here".to_owned()),
            None => Simulation::resume(scene, checkpoint).map_err(|error| error.to_string()),
        };
        let mut simulation = match resumed {
            Ok(simulation) => simulation,
            Err(reason) => {
                self.missing.push(format!("no energies and no bounds of the time step: {reason}"));
                self.totals = totals(columns);
                return;
            }
        };
        let observer = Observer::new(scene, &simulation);
        let row = observer.observe(&simulation);
        let observed = observer.quantities().into_iter().zip(row);
        let total = |(quantity, value): (meniscus_cases::measure::Quantity, f64)| Total {
            name: quantity.name,
            unit: quantity.unit.to_owned(),
            value,
        };
        self.totals = observed.map(total).collect();
        let told = self.totals.iter().any(|total| total.name == "surface energy");
        if scene.liquid.surface_tension > 0.0 && !told {
            let reason =
                "no surface energy: with this scene's curvature nothing tells where the surface lies";
            self.missing.push(reason.to_owned());
        }
        if let Err(fault) = simulation.step() {
            self.missing.push(format!("the next step breaks down: {fault}"));
        }
        let stated = simulation.world.clock.stated().iter();
        self.bounds =
            stated.map(|bound| Bound { reason: bound.reason, step_size: bound.step_size }).collect();
    }

    fn text(&self, output: &mut dyn Write) -> Result<(), Failure> {
        if let Some(crash) = &self.crash {
            writeln!(output, "BROKE DOWN  {crash}\n")?;
        }
        let unit = |unit: &str| if unit == "1" { String::new() } else { unit.to_owned() };
        let rows =
            self.totals.iter().map(|total| vec![total.name.clone(), number(total.value), unit(&total.unit)]);
        writeln!(output, "{}", print::table(&["total", "value", "unit"], rows))?;
        if let Some(around) = &self.around {
            self.surroundings(around, output)?;
        }
        for bound in &self.bounds {
            writeln!(output, "time step: at most {} s ({})", number(bound.step_size), bound.reason)?;
        }
        for missing in &self.missing {
            writeln!(output, "{missing}")?;
        }
        Ok(())
    }

    fn surroundings(&self, around: &Neighbourhood, output: &mut dyn Write) -> Result<(), Failure> {
        let drops = around.drops.len();
        writeln!(output, "\n{drops} drop{}", if drops == 1 { "" } else { "s, the largest first" })?;
        let rows = around.drops.iter().take(LISTED).map(|drop| {
            let numbers = [drop.mass, drop.volume, drop.radius, drop.centre_z, drop.velocity_z];
            let numbers = numbers.into_iter().map(number);
            std::iter::once(drop.particles.to_string()).chain(numbers).collect()
        });
        let head =
            ["particles", "mass [kg]", "volume [m3]", "radius [m]", "centre z [m]", "velocity z [m/s]"];
        writeln!(output, "{}", print::table(&head, rows))?;
        let rows = around
            .neighbours
            .iter()
            .map(|(neighbours, particles)| vec![neighbours.to_string(), particles.to_string()]);
        writeln!(output, "\n{}", print::table(&["neighbours", "particles"], rows))?;
        let of = &around.nearest_distance;
        if let (Some(mean), Some(deviation), Some(least)) = (of.mean, of.standard_deviation, of.minimum) {
            writeln!(
                output,
                "\npacking: nearest neighbour at {} +- {} of the particle size, the closest at {}",
                number(mean),
                number(deviation),
                number(least)
            )?;
        }
        if let Some(surface) = self.surface_particles {
            writeln!(output, "{surface} particles at the surface")?;
        }
        let Neighbourhood { near_axis, beyond_axis, left_out, .. } = around;
        writeln!(output, "{near_axis} particles within half a size of the axis, {beyond_axis} beyond it")?;
        if *left_out > 0 {
            writeln!(output, "{left_out} particles without a sound place or size")?;
        }
        Ok(())
    }
}
