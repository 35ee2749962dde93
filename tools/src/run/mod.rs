//! `meniscus run` and `meniscus resume`: from a scene to its results.

mod columns;
mod frames;
mod plots;
mod recorder;
mod report;
mod signals;
mod stopwatch;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use meniscus_cases::scene::{self, Scene};
use meniscus_cases::simulation::Simulation;
use meniscus_engine::checkpoint;
use meniscus_engine::clock::Clock;
use meniscus_engine::pipeline::Fault;

use crate::command::{ResumeArguments, RunArguments, pool};
use crate::failure::Failure;
use crate::output::folder::RunFolder;
use crate::output::progress::Progress;
use crate::output::units::{grouped, quantity};
use crate::plan::sound_speed_sentence;
use recorder::Recorder;
use signals::{INTERRUPTED, Signals};
use stopwatch::Stopwatch;

/// How a run ended.
enum End {
    Done,
    Interrupted,
    Failed(Fault),
}

/// What a run costs, and since when.
struct Costs {
    started: Instant,
    settling: Stopwatch,
    steps: Stopwatch,
    first_step: u64,
}

/// A scene on its way into a folder.
struct Run {
    scene: Scene,
    folder: RunFolder,
    signals: Signals,
    quiet: bool,
    started: Instant,
}

/// Runs a scene.
pub(crate) fn run(arguments: &RunArguments) -> Result<ExitCode, Failure> {
    let started = Instant::now();
    let settings = [arguments.set.clone(), arguments.extent.settings()].concat();
    let scene = scene::read(&arguments.scene, &settings)?;
    columns::check_colour(&scene)?;
    let pool = pool(arguments.extent.threads)?;
    let out = arguments.out.clone();
    let out = out.unwrap_or_else(|| default_folder(&arguments.scene));
    let folder =
        RunFolder::create(out, arguments.overwrite).map_err(|error| Failure::input(error.to_string()))?;
    std::fs::write(folder.scene(), &scene.text).map_err(|error| not_written(&folder.scene(), &error))?;
    let run = Run { scene, folder, signals: listen()?, quiet: arguments.extent.quiet, started };
    run.introduce();
    pool.install(|| run.begin())
}

/// Continues a run.
pub(crate) fn resume(arguments: &ResumeArguments) -> Result<ExitCode, Failure> {
    let started = Instant::now();
    let folder = RunFolder::open(&arguments.folder);
    let folder = folder.map_err(|error| Failure::input(error.to_string()))?;
    let newest = checkpoint::newest_valid(&folder.checkpoints());
    let (path, checkpoint, skipped) = newest.map_err(|error| Failure::input(error.to_string()))?;
    for (_, error) in skipped {
        eprintln!("passed over: {error}");
    }
    let name = path.display().to_string();
    let scene = scene::parse(&name, &checkpoint.scene, &arguments.extent.settings())?;
    columns::check_colour(&scene)?;
    let pool = pool(arguments.extent.threads)?;
    std::fs::write(folder.scene(), &scene.text).map_err(|error| not_written(&folder.scene(), &error))?;
    let run = Run { scene, folder, signals: listen()?, quiet: arguments.extent.quiet, started };
    eprintln!("continues from {name}");
    pool.install(|| run.pick_up(&checkpoint))
}

fn listen() -> Result<Signals, Failure> {
    let signals = Signals::listen();
    signals.map_err(|error| Failure::on_the_way(format!("cannot listen to signals: {error}")))
}

fn not_written(path: &Path, error: &std::io::Error) -> Failure {
    Failure::on_the_way(format!("cannot write `{}`: {error}", path.display()))
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

    fn progress(&self, total: f64, what: &str) -> Progress {
        if self.quiet { Progress::quiet() } else { Progress::new(total, what) }
    }

    fn begin(&self) -> Result<ExitCode, Failure> {
        let mut settling = Stopwatch::default();
        let mut simulation = settling.time(|| self.settle())?;
        eprintln!("{} particles", grouped(simulation.world.store.len() as u64));
        let mut recorder = Recorder::start(&self.scene, &self.folder, &simulation)?;
        recorder.record(&simulation)?;
        self.go_on(&mut simulation, &mut recorder, settling)
    }

    fn pick_up(&self, checkpoint: &checkpoint::Checkpoint) -> Result<ExitCode, Failure> {
        let mut simulation = Simulation::resume(&self.scene, checkpoint)?;
        let mut recorder = Recorder::resume(&self.scene, &self.folder, &simulation)?;
        if simulation.world.clock.step == 0 {
            recorder.record(&simulation)?;
        }
        self.go_on(&mut simulation, &mut recorder, Stopwatch::default())
    }

    fn settle(&self) -> Result<Simulation, Failure> {
        let unit = Simulation::capillary_time(&self.scene);
        let total = self.scene.settle.unwrap_or(meniscus_cases::simulation::SETTLE);
        let mut progress = self.progress(total * unit, "settling");
        let (mut step, mut before) = (0, 0.0);
        let simulation = Simulation::new(&self.scene, &mut |done, _| {
            if self.signals.stop() {
                // Nothing has been computed yet that a checkpoint could keep.
                eprintln!("interrupted while the particles settled");
                std::process::exit(i32::from(INTERRUPTED));
            }
            step += 1;
            progress.update(step, done * unit, (done - before) * unit);
            before = done;
        });
        Ok(simulation?)
    }

    /// Steps to the end, and says how it went.
    fn go_on(
        &self,
        simulation: &mut Simulation,
        recorder: &mut Recorder,
        settling: Stopwatch,
    ) -> Result<ExitCode, Failure> {
        let mut costs = Costs {
            started: self.started,
            settling,
            steps: Stopwatch::default(),
            first_step: simulation.world.clock.step,
        };
        let end = self.drive(simulation, recorder, &mut costs.steps)?;
        let failure = match &end {
            End::Done | End::Interrupted => {
                recorder.checkpoint(simulation)?;
                None
            }
            End::Failed(fault) => {
                let kept = recorder.crash_checkpoint(simulation)?;
                eprintln!("the run broke down: {fault}\nits last state lies in {kept}");
                Some(fault.to_string())
            }
        };
        let (status, code) = match end {
            End::Done => (crate::output::summary::Status::Done, ExitCode::SUCCESS),
            End::Interrupted => (crate::output::summary::Status::Interrupted, ExitCode::from(INTERRUPTED)),
            End::Failed(_) => (crate::output::summary::Status::Failed, ExitCode::from(1)),
        };
        let ending = report::Ending { status, failure };
        report::report(&self.scene, &self.folder, simulation, (recorder, &costs), ending)?;
        Ok(code)
    }

    /// The time loop.
    fn drive(
        &self,
        simulation: &mut Simulation,
        recorder: &mut Recorder,
        cost: &mut Stopwatch,
    ) -> Result<End, Failure> {
        let mut progress = self.progress(self.scene.until, "running");
        while !is_over(&self.scene, &simulation.world.clock) {
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
                let time = quantity(clock.time, "s", 4);
                progress.message(&format!("checkpoint written at t = {time}"));
            }
            progress.update(clock.step, clock.time, clock.previous_step_size);
        }
        Ok(End::Done)
    }
}

/// Whether the scene's end is reached. The last step isn't cut: outputs never change the motion.
fn is_over(scene: &Scene, clock: &Clock) -> bool {
    clock.time >= scene.until || scene.steps.is_some_and(|steps| clock.step >= steps)
}
