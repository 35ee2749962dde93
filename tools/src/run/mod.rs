//! `meniscus run` and `meniscus resume`: from a scene to its results.

mod checkpoints;
mod columns;
mod frames;
mod plots;
mod profile;
mod recorder;
mod report;
mod resume;
mod signals;
mod stopwatch;

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use meniscus_cases::scene::{self, Scene};
use meniscus_cases::simulation::{Simulation, StartError};
use meniscus_engine::checkpoint::Checkpoint;
use meniscus_engine::pipeline::Fault;

use crate::command::{RunArguments, pool, print};
use crate::failure::{Failure, INTERRUPTED};
use crate::memory;
use crate::output::folder::RunFolder;
use crate::output::progress::Progress;
use crate::output::summary::{Status, Summary, print_table};
use crate::output::units::{grouped, quantity};
use crate::plan::sound_speed_sentence;
pub(crate) use frames::{count_frames, rehearse_picture};
use profile::Profiler;
use recorder::Recorder;
pub(crate) use recorder::observed_every;
pub(crate) use resume::{resume, same_scene};
pub(crate) use signals::Signals;
use stopwatch::{Moment, Stopwatch};

/// A number of the clock, which checkpoints carry on: that of the particles at the start.
const FIRST_PARTICLES: &str = "particles at the start";

/// How a run ended.
enum End {
    Done,
    Interrupted,
    Failed(Fault),
}

/// From where a run goes on.
enum Start {
    /// Nothing has been computed yet.
    Scene,
    /// The clock has started.
    Running(Box<Checkpoint>),
}

/// What a run costs, and since when.
struct Costs {
    started: Moment,
    filling: Stopwatch,
    steps: Stopwatch,
    first_step: u64,
    profiler: Option<Arc<Profiler>>,
}

/// A scene on its way into a folder.
struct Run {
    scene: Scene,
    folder: RunFolder,
    signals: Signals,
    display: Display,
    profiler: Option<Arc<Profiler>>,
    started: Moment,
}

/// What a run shows of its progress.
#[derive(Clone)]
pub(crate) enum Display {
    /// Nothing.
    Quiet,
    /// All about the one run there is.
    Alone,
    /// A run among others.
    Among {
        /// What it is called there.
        name: String,
        /// The work of the runs after this one over this one's work.
        later: f64,
        /// Whether its progress is shown, too.
        quiet: bool,
    },
}

impl Display {
    fn alone(quiet: bool) -> Self {
        if quiet { Display::Quiet } else { Display::Alone }
    }

    /// What a message begins with: which run it is about, where there are several.
    fn prefix(&self) -> String {
        match self {
            Display::Quiet | Display::Alone => String::new(),
            Display::Among { name, .. } => format!("{name}: "),
        }
    }
}

/// Runs a scene.
pub(crate) fn run(arguments: &RunArguments) -> Result<ExitCode, Failure> {
    let started = Moment::now();
    let signals = listen()?;
    let settings = [arguments.set.clone(), arguments.extent.settings()].concat();
    let scene = scene::read(&arguments.scene, &settings);
    let scene = scene.map_err(|diagnosis| arguments.extent.blamed(diagnosis))?;
    let pool = pool(arguments.extent.threads)?;
    let out = arguments.out.clone();
    let out = out.unwrap_or_else(|| default_folder(&arguments.scene));
    let folder =
        RunFolder::take(out, arguments.overwrite).map_err(|error| Failure::input(error.to_string()))?;
    if folder.replaces(&arguments.scene) {
        return Err(Failure::input(format!(
            "the scene `{}` would be replaced by the results; choose another folder with `--out DIR`",
            arguments.scene.display()
        )));
    }
    let display = Display::alone(arguments.extent.quiet);
    let profiler = Profiler::asked(&arguments.extent, &pool)?;
    let run = Run { scene, folder, signals, display, profiler, started };
    run.introduce();
    tell(&pool.install(|| run.begin())?)
}

/// Runs a scene into a folder that was taken for it, on the threads of the caller's pool.
pub(crate) fn run_into(
    folder: RunFolder,
    scene: Scene,
    signals: &Signals,
    display: Display,
) -> Result<Summary, Failure> {
    let started = Moment::now();
    Run { scene, folder, signals: signals.clone(), display, profiler: None, started }.begin()
}

/// Prints what a run has given, and turns it into an exit code.
fn tell(summary: &Summary) -> Result<ExitCode, Failure> {
    let mut text = Vec::new();
    // Memory takes whatever is written.
    let _ = print_table(summary, &mut text);
    print(&String::from_utf8_lossy(&text))?;
    Ok(match summary.status {
        Some(Status::Interrupted) => ExitCode::from(INTERRUPTED),
        Some(Status::Failed) => ExitCode::from(1),
        Some(Status::Done) | None => ExitCode::SUCCESS,
    })
}

/// Signals from now on.
pub(crate) fn listen() -> Result<Signals, Failure> {
    let signals = Signals::listen();
    signals.map_err(|error| Failure::on_the_way(format!("cannot listen to signals: {error}")))
}

/// runs/ and the scene's name: that of its file, or of its folder if the file is a mere `scene.toml`.
fn default_folder(scene: &Path) -> PathBuf {
    let stem = scene.file_stem().unwrap_or_default();
    let folder = scene.canonicalize().ok();
    let folder = folder.as_deref().and_then(Path::parent).and_then(Path::file_name);
    let name = match folder {
        Some(folder) if stem == "scene" => folder,
        _ => stem,
    };
    Path::new("runs").join(name)
}

impl Run {
    fn introduce(&self) {
        for warning in &self.scene.warnings {
            eprintln!("{:?}", miette::Report::new(warning.clone()));
        }
        eprintln!("{}", self.scene.title);
        eprintln!("{}", sound_speed_sentence(&self.scene));
        eprintln!("results in {}", self.folder.path().display());
    }

    /// Progress of the time loop.
    fn progress(&self) -> Progress {
        match &self.display {
            Display::Quiet | Display::Among { quiet: true, .. } => Progress::quiet(),
            Display::Alone => Progress::new(self.scene.until, "running").within(self.scene.steps),
            Display::Among { name, later, .. } => {
                let progress = Progress::new(self.scene.until, &format!("{name}: running"));
                progress.within(self.scene.steps).followed_by(*later)
            }
        }
    }

    /// Fills the bodies with particles. An interruption leaves what stands in the folder: the scene, or an earlier run that
    /// this one `replaces`.
    fn fill(&self, replaces: bool) -> Result<Simulation, Failure> {
        let folder = self.folder.path().display();
        memory::check(&self.scene)?;
        let mut progress = match &self.display {
            Display::Quiet | Display::Among { quiet: true, .. } => Progress::quiet(),
            Display::Alone => Progress::of_part("placing particles"),
            Display::Among { name, .. } => Progress::of_part(&format!("{name}: placing particles")),
        };
        let simulation = Simulation::new(&self.scene, &mut |part| {
            progress.update_part(part);
            if self.signals.stop() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        simulation.map_err(|error| match error {
            StartError::Stopped => Failure::interrupted(format!(
                "interrupted while the particles were placed; {}",
                if replaces {
                    format!("the earlier run in `{folder}` stays as it was")
                } else {
                    format!("`meniscus resume {folder}` places them anew")
                }
            )),
            error => error.into(),
        })
    }

    /// Begins the run, and goes to its end. An earlier run in the folder stays until the particles are placed:
    /// not before is it known that the scene can run. Where there is none the scene comes first: a run that is stopped
    /// while it places them can be resumed.
    fn begin(&self) -> Result<Summary, Failure> {
        let mut filling = Stopwatch::default();
        let simulation = if self.folder.is_begun() {
            let simulation = filling.time(|| self.fill(true))?;
            self.folder.clear()?;
            simulation
        } else {
            self.folder.clear()?;
            self.folder.write_scene(&self.scene.text)?;
            let simulation = filling.time(|| self.fill(false));
            simulation.inspect_err(|failure| {
                if !failure.is_interruption() {
                    self.folder.give_up();
                }
            })?
        };
        self.go(simulation, filling)
    }

    /// Takes the run up where it stands, and goes to its end.
    fn take_up(&self, start: Start) -> Result<Summary, Failure> {
        let mut filling = Stopwatch::default();
        let simulation = match start {
            Start::Scene => filling.time(|| self.fill(false))?,
            Start::Running(checkpoint) => Simulation::resume(&self.scene, &checkpoint)?,
        };
        self.go(simulation, filling)
    }

    fn go(&self, mut simulation: Simulation, filling: Stopwatch) -> Result<Summary, Failure> {
        if matches!(self.display, Display::Alone) {
            eprintln!("{} particles", grouped(simulation.world.store.len() as u64));
        }
        let begins = simulation.world.clock.step == 0;
        let open = if begins { Recorder::start } else { Recorder::resume };
        let mut recorder = open(&self.scene, &self.folder, &simulation)?;
        // Not before: a resumed run that cannot take up its files leaves the scene's end as it was.
        self.folder.write_scene(&self.scene.text)?;
        if begins {
            let particles = simulation.world.store.len() as f64;
            simulation.world.clock.set_number(FIRST_PARTICLES, particles);
            recorder.record(&simulation)?;
            // What has been placed need not be placed again.
            recorder.checkpoint(&simulation)?;
        }
        self.go_on(&mut simulation, &mut recorder, filling)
    }

    /// Steps to the end, and says how it went.
    fn go_on(
        &self,
        simulation: &mut Simulation,
        recorder: &mut Recorder,
        filling: Stopwatch,
    ) -> Result<Summary, Failure> {
        let mut costs = Costs {
            started: self.started,
            filling,
            steps: Stopwatch::default(),
            first_step: simulation.world.clock.step,
            profiler: self.profiler.clone(),
        };
        if let Some(profiler) = &self.profiler {
            profiler.start(costs.first_step);
        }
        let end = self.drive(simulation, recorder, &mut costs.steps)?;
        let failure = match &end {
            End::Done | End::Interrupted => {
                recorder.checkpoint(simulation)?;
                recorder.finish()?;
                None
            }
            End::Failed(fault) => {
                recorder.finish()?;
                let kept = recorder.crash_checkpoint(simulation, fault)?;
                eprintln!(
                    "{}the run broke down: {fault}\nits last state lies in {kept}; `meniscus inspect` tells more",
                    self.display.prefix()
                );
                Some(fault.to_string())
            }
        };
        let status = match end {
            End::Done => Status::Done,
            End::Interrupted => Status::Interrupted,
            End::Failed(_) => Status::Failed,
        };
        let ending = report::Ending { status, failure, prefix: self.display.prefix() };
        report::report(&self.scene, &self.folder, simulation, (recorder, &costs), ending)
    }

    /// The time loop.
    fn drive(
        &self,
        simulation: &mut Simulation,
        recorder: &mut Recorder,
        cost: &mut Stopwatch,
    ) -> Result<End, Failure> {
        let mut progress = self.progress();
        while !is_over(&self.scene, simulation.world.clock.step, simulation.world.clock.time) {
            if self.signals.stop() {
                return Ok(End::Interrupted);
            }
            if let Err(fault) = cost.time(|| simulation.step()) {
                return Ok(End::Failed(fault));
            }
            recorder.record(simulation)?;
            let clock = &simulation.world.clock;
            if self.signals.take_checkpoint() {
                recorder.checkpoint(simulation)?;
                recorder.finish()?;
                let time = quantity(clock.time, "s", 4);
                progress.message(&format!("checkpoint written at t = {time}"));
            }
            progress.update(clock.step, clock.time, clock.previous_step_size);
        }
        Ok(End::Done)
    }
}

/// Whether the scene's end is reached, after a number of steps and at a time in s. The last step isn't
/// cut: outputs never change the motion.
pub(crate) fn is_over(scene: &Scene, step: u64, time: f64) -> bool {
    time >= scene.until || scene.steps.is_some_and(|steps| step >= steps)
}
