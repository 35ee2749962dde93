//! The command line: its arguments, and what each subcommand calls.

use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};
use clap_complete::Shell;
use meniscus_cases::scene::Diagnosis;
use meniscus_engine::lanes::INSTRUCTION_SET;

use crate::failure::Failure;
use crate::output::units::counted;
use crate::study::StudyArguments;
use crate::verify::VerifyArguments;
use crate::{inspect, plan, run, study, verify};

const EXIT_CODES: &str = "\
Exit codes: 0 done; 1 ran but failed; 2 bad input; 130 interrupted after a clean checkpoint,
or at once by a second Ctrl-C.";

const RUN_EXAMPLES: &str = "\
Examples:
  meniscus run cases/oscillating-drop/scene.toml             results in runs/oscillating-drop
  meniscus run drop.toml --set radius='15 um' --out runs/large
  meniscus run drop.toml --set method.scheme=parshikov --threads 4
  meniscus run drop.toml --steps 100 --overwrite
  meniscus run drop.toml --profile                           speeds of all stages, and a trace

Ctrl-C stops after a checkpoint, a second Ctrl-C at once: `meniscus resume` then goes on from the checkpoint
before. (While particles are placed the first one stops, and `resume` places them anew.) SIGUSR1 writes a
checkpoint and goes on.
Exit codes: 0 done; 1 blew up; 2 bad input; 130 interrupted.";

const RESUME_EXAMPLES: &str = "\
Examples:
  meniscus resume runs/oscillating-drop                      to the end that was asked for last
  meniscus resume runs/oscillating-drop --until '10 us'      or to another one
  meniscus resume runs/oscillating-drop --profile            speeds and trace of what is left of it

--until and --steps, here and of `run`, take the place of those in the folder's scene.toml and stay
there; the end that comes first counts. One that the run has passed already is bad input.";

const PLAN_EXAMPLES: &str = "\
Examples:
  meniscus plan cases/laplace-drop/scene.toml                the stages, and how long a run takes
  meniscus plan drop.toml --set particle_size='20 nm' --fields

The time is that of filling, steps and pictures, each measured as the machine is now: all particles are
placed, which takes as long as in the run, and a few seconds of steps and pictures; what disks take is not
in it.";

const COMPLETIONS_EXAMPLES: &str = "\
Example:
  meniscus completions bash > ~/.local/share/bash-completion/completions/meniscus";

/// Axisymmetric capillary flow by smoothed particle hydrodynamics
#[derive(Parser)]
#[command(name = "meniscus", version = version(), after_help = EXIT_CODES)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Run a scene; results go into a folder
    #[command(after_help = RUN_EXAMPLES)]
    Run(RunArguments),
    /// Continue a run from its newest valid checkpoint
    #[command(after_help = RESUME_EXAMPLES)]
    Resume(ResumeArguments),
    /// Tell what a run would do, and what it would cost by a piece of it, without writing anything
    #[command(after_help = PLAN_EXAMPLES)]
    Plan(PlanArguments),
    /// Run the project's cases and compare them with what is exact
    Verify(VerifyArguments),
    /// Run a scene at every combination of some settings: error against cost
    Study(StudyArguments),
    /// Look into checkpoints, verify or compare them
    Inspect(inspect::Arguments),
    /// Print completions for a shell
    #[command(after_help = COMPLETIONS_EXAMPLES)]
    Completions {
        /// The shell
        shell: Shell,
    },
}

/// Arguments of `run`.
#[derive(clap::Args)]
pub(crate) struct RunArguments {
    /// The scene
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    /// Folder for the results [default: runs/ and the scene's name]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Replace a value of the scene: a parameter, or a dotted key; may be given several times
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
    /// Replace an earlier run in the folder
    #[arg(long)]
    pub(crate) overwrite: bool,
    #[command(flatten)]
    pub(crate) extent: Extent,
}

/// Arguments of `resume`.
#[derive(clap::Args)]
pub(crate) struct ResumeArguments {
    /// Folder of the run
    #[arg(value_name = "DIR")]
    pub(crate) folder: PathBuf,
    #[command(flatten)]
    pub(crate) extent: Extent,
}

/// How far a run goes, on how many threads, and what it tells of itself.
#[derive(clap::Args)]
pub(crate) struct Extent {
    /// Threads [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..), allow_negative_numbers = true)]
    pub(crate) threads: Option<u16>,
    /// Simulated time at which to stop, with its unit: "3 us"
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    until: Option<String>,
    /// Steps at most, counted from the start of the run
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    steps: Option<String>,
    /// Tell how fast each stage is and how evenly its threads are busy; trace the first 200 steps and every
    /// 1000th into profile.json (15 MB at most), which https://ui.perfetto.dev opens
    #[arg(long)]
    pub(crate) profile: bool,
    /// Show no progress
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

impl Extent {
    /// The settings of the scene that say how far it runs.
    pub(crate) fn settings(&self) -> Vec<String> {
        self.given().map(|(_, key, value)| format!("{key}{value}")).collect()
    }

    /// Names the option where a mistake is about one of these.
    pub(crate) fn blamed(&self, diagnosis: Diagnosis) -> Diagnosis {
        self.given().fold(diagnosis, |diagnosis, (option, key, value)| {
            diagnosis.given_by(option, &format!("{key}{value}"), key.len())
        })
    }

    /// Options, the keys that they set, and the values.
    fn given(&self) -> impl Iterator<Item = (&'static str, &'static str, &String)> {
        let until = self.until.iter().map(|time| ("--until", "run.until=", time));
        until.chain(self.steps.iter().map(|steps| ("--steps", "run.steps=", steps)))
    }
}

/// Arguments of `plan`.
#[derive(clap::Args)]
pub(crate) struct PlanArguments {
    /// The scene
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    /// Replace a value of the scene: a parameter, or a dotted key; may be given several times
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
    /// List every field with the stages that read and write it
    #[arg(long)]
    pub(crate) fields: bool,
    /// Threads that the cost is told for [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..), allow_negative_numbers = true)]
    pub(crate) threads: Option<u16>,
}

/// Version of the program, and the instruction set that it was built for: a portable build has several.
pub(crate) fn version() -> String {
    format!("{} ({INSTRUCTION_SET})", env!("CARGO_PKG_VERSION"))
}

/// Reads the arguments of the process and does what they ask for.
pub fn main() -> ExitCode {
    let done = match Arguments::parse().command {
        Command::Run(arguments) => run::run(&arguments),
        Command::Resume(arguments) => run::resume(&arguments),
        Command::Plan(arguments) => plan::plan(&arguments),
        Command::Verify(arguments) => verify::verify(&arguments),
        Command::Study(arguments) => study::study(&arguments),
        Command::Inspect(arguments) => Ok(inspect::run(&arguments)),
        Command::Completions { shell } => {
            let (mut command, mut text) = (Arguments::command(), Vec::new());
            clap_complete::generate(shell, &mut command, "meniscus", &mut text);
            print(&String::from_utf8_lossy(&text)).map(|()| ExitCode::SUCCESS)
        }
    };
    done.unwrap_or_else(|failure| failure.tell())
}

/// Prints to standard output. A reader that has gone is no failure.
pub(crate) fn print(text: &str) -> Result<(), Failure> {
    let mut output = io::stdout().lock();
    match output.write_all(text.as_bytes()).and_then(|()| output.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Failure::on_the_way(format!(
            "cannot write the output: {error}; check what the output is connected to"
        ))),
        _ => Ok(()),
    }
}

/// Threads for each core that still run: more of them wait for each other most of the time.
const THREADS_PER_CORE: usize = 4;
/// So many are started on any machine.
const MOST_THREADS: usize = 64;

/// Threads for the whole work of a command.
pub(crate) fn pool(threads: Option<u16>) -> Result<rayon::ThreadPool, Failure> {
    let threads = threads.map_or(0, usize::from);
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let most = (THREADS_PER_CORE * cores).max(MOST_THREADS);
    if threads > most {
        return Err(Failure::input(format!(
            "--threads {threads}: so many would hardly run on {}; choose {most} or fewer, or leave it out for one for \
             each core",
            counted(cores as u64, "core")
        )));
    }
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.map_err(|error| Failure::on_the_way(format!("cannot start the threads: {error}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arguments_are_consistent() {
        Arguments::command().debug_assert();
    }
}
