//! Everything that a run writes on its way.

use std::path::Path;

use meniscus_cases::measure::{History, Observer, Quantity};
use meniscus_cases::scene::Scene;
use meniscus_cases::simulation::Simulation;
use meniscus_engine::checkpoint;
use meniscus_engine::pipeline::Fault;

use super::checkpoints::Checkpoints;
use super::frames::Frames;
use super::stopwatch::Stopwatch;
use crate::failure::Failure;
use crate::output::folder::RunFolder;
use crate::output::series::{self, SeriesWriter};

/// Writes series, frames and checkpoints as a run goes on.
pub(super) struct Recorder<'a> {
    scene: &'a Scene,
    folder: &'a RunFolder,
    observer: Observer,
    series: Option<SeriesWriter>,
    frames: Frames,
    checkpoints: Checkpoints,
    /// The observations so far.
    pub(super) history: History,
    /// What all this has cost.
    pub(super) cost: Stopwatch,
}

/// What the costs call all that a recorder does.
pub(super) const OUTPUTS: &str = "outputs";

/// Steps between two observations. Where the scene wants no series its measures still need them.
pub(crate) fn observed_every(scene: &Scene) -> u64 {
    match scene.output.series_every {
        0 => 10,
        every => every,
    }
}

impl<'a> Recorder<'a> {
    /// A recorder of a new run.
    pub(super) fn start(
        scene: &'a Scene,
        folder: &'a RunFolder,
        simulation: &Simulation,
    ) -> Result<Self, Failure> {
        let observer = Observer::new(scene, simulation);
        let quantities = observer.quantities();
        let columns: Vec<(&str, &str)> =
            quantities.iter().map(|quantity| (quantity.name.as_str(), quantity.unit)).collect();
        let wanted = scene.output.series_every > 0;
        let series = wanted.then(|| SeriesWriter::create(&folder.series(), &columns));
        Ok(Recorder {
            scene,
            folder,
            observer,
            series: series.transpose()?,
            frames: Frames::new(folder),
            checkpoints: Checkpoints::of(folder),
            history: History::new(quantities),
            cost: Stopwatch::default(),
        })
    }

    /// A recorder that goes on with an earlier run's files, cut to the present step.
    pub(super) fn resume(
        scene: &'a Scene,
        folder: &'a RunFolder,
        simulation: &Simulation,
    ) -> Result<Self, Failure> {
        let (path, clock) = (folder.series(), &simulation.world.clock);
        let mut history = History::new(Observer::new(scene, simulation).quantities());
        let goes_on = scene.output.series_every > 0 && path.exists();
        if scene.output.series_every == 0 {
            eprintln!("this scene keeps no series: what is measured begins at step {}", clock.step);
        }
        if scene.output.series_every > 0 && !goes_on {
            eprintln!("`{}` is missing: the series begins anew at step {}", path.display(), clock.step);
        }
        if goes_on {
            read_history(&path, (observed_every(scene), clock.step), &mut history)?;
            if history.is_empty() {
                let path = path.display();
                eprintln!("`{path}` has no row up to step {}: the series begins anew there", clock.step);
            }
        }
        let frames = Frames::resume(folder, scene, (clock.step, clock.time))?;
        let open = || SeriesWriter::open_for_resume(&path, clock.step);
        let continued = goes_on.then(open).transpose()?;
        let mut recorder = match continued {
            None => Self::start(scene, folder, simulation)?,
            series => Recorder {
                scene,
                folder,
                observer: Observer::new(scene, simulation),
                series,
                frames: Frames::new(folder),
                checkpoints: Checkpoints::of(folder),
                history,
                cost: Stopwatch::default(),
            },
        };
        recorder.frames = frames;
        Ok(recorder)
    }

    /// Writes what is due at the present step: the start or the end of one.
    pub(super) fn record(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        let _span = tracing::info_span!("stage", name = OUTPUTS).entered();
        let mut cost = self.cost;
        let done = cost.time(|| self.write_due(simulation));
        self.cost = cost;
        done
    }

    fn write_due(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        let step = simulation.world.clock.step;
        if step.is_multiple_of(observed_every(self.scene)) {
            let row = self.observer.observe(simulation);
            if let Some(series) = &mut self.series {
                series.append(step, &row)?;
            }
            self.history.push(row);
        }
        self.frames.look(self.scene, simulation)?;
        let every = self.scene.output.checkpoint_every;
        let due = every > 0 && step > 0 && step.is_multiple_of(every);
        if due || self.checkpoints.are_overdue() {
            self.checkpoint(simulation)?;
        }
        Ok(())
    }

    /// Begins to write a checkpoint, and then removes the oldest ones.
    pub(super) fn checkpoint(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        let series = self.series.as_ref().map(SeriesWriter::file).transpose()?;
        self.checkpoints.write((simulation, self.scene), series)
    }

    /// Waits until the last checkpoint lies on the disk.
    pub(super) fn finish(&mut self) -> Result<(), Failure> {
        self.checkpoints.finish()
    }

    /// Writes the state in which a run broke down, under a name that no resumed run takes up.
    pub(super) fn crash_checkpoint(&self, simulation: &Simulation, fault: &Fault) -> Result<String, Failure> {
        let name = checkpoint::crash_file_name(simulation.world.clock.step);
        let path = self.folder.checkpoints().join(name);
        simulation.with_crash_checkpoint(self.scene, fault, |state| checkpoint::write(&path, state))?;
        Ok(path.display().to_string())
    }
}

/// The rows up to a step, one every so many steps, which a run goes on with.
fn read_history(path: &Path, (every, last_step): (u64, u64), history: &mut History) -> Result<(), Failure> {
    let series = series::read(path).map_err(|error| {
        let way_out = "mend it, or remove it to go on without the earlier rows";
        Failure::input(format!("{error}; {way_out}"))
    })?;
    let same = |(column, quantity): (&series::Column, &Quantity)| column.name == quantity.name;
    let quantities = history.quantities();
    let matches = series.columns.len() == quantities.len() && series.columns.iter().zip(quantities).all(same);
    if !matches {
        return Err(Failure::input(format!(
            "`{}` has other columns than this run; remove it to go on without the earlier rows",
            path.display()
        )));
    }
    // What measures fit across a hole is wrong, and nobody would know.
    if let Some((before, after)) = series.hole(every, last_step) {
        return Err(Failure::input(format!(
            "`{}` lacks the rows between steps {before} and {after}, before the checkpoint of step {last_step}; \
             restore them from a copy, or remove the file to go on without the earlier rows",
            path.display()
        )));
    }
    let rows = series.rows.into_iter();
    for row in rows.filter(|row| row.step <= last_step) {
        history.push(row.values);
    }
    Ok(())
}
