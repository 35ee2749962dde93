//! The pipeline: stages in an explicit order, and the runner that owns spans, costs and checks.

use crate::clock::Clock;
use crate::lanes::RowTable;
use crate::neighbours::NeighbourList;
use crate::store::Store;
use bumpalo::Bump;
use std::ops::AddAssign;
use std::time::{Duration, Instant};

/// Everything that a step works on.
#[derive(Debug)]
pub struct World {
    /// The particles.
    pub store: Store,
    /// Time and step size.
    pub clock: Clock,
    /// Who is near whom.
    pub neighbours: NeighbourList,
    /// The particles' packed rows for the pair passes.
    pub rows: RowTable,
    /// Scratch memory of one step, reused by the next.
    pub arena: Bump,
}

impl World {
    /// A world of the given particles at the given time, without neighbours yet.
    pub fn new(store: Store, clock: Clock) -> Self {
        World {
            store,
            clock,
            neighbours: NeighbourList::default(),
            rows: RowTable::default(),
            arena: Bump::new(),
        }
    }

    /// Bytes that all of it takes.
    pub fn bytes(&self) -> usize {
        self.store.bytes() + self.neighbours.bytes() + self.rows.bytes() + self.arena.allocated_bytes()
    }
}

/// One stage of a step. It states its handles when it is constructed and touches nothing else.
pub trait Stage: Send {
    /// The name under which its cost is reported.
    fn name(&self) -> &'static str;

    /// Does the stage's work.
    ///
    /// # Errors
    /// A [`Fault`] that says which particle and quantity went bad.
    fn run(&mut self, world: &mut World) -> Result<(), Fault>;

    /// Bytes that the stage keeps for itself, where it keeps something of every particle.
    fn bytes(&self) -> usize {
        0
    }

    /// What one run evaluates and moves, where the stage is a pair pass; must cost nothing to tell.
    fn pair_work(&self, _world: &World) -> PairWork {
        PairWork::default()
    }
}

/// What a pair pass does: with its time, how fast it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PairWork {
    /// Evaluated pairs, each from both its sides; entries that fill a list up to its block count as well.
    pub pairs: u64,
    /// Bytes that are loaded and stored. Most loads find their rows in a cache.
    pub bytes: u64,
    /// Floating-point operations on pairs.
    pub operations: u64,
}

impl AddAssign for PairWork {
    fn add_assign(&mut self, other: Self) {
        self.pairs += other.pairs;
        self.bytes += other.bytes;
        self.operations += other.operations;
    }
}

/// A quantity that went bad: the run stops here.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "{quantity} of particle {particle} at (r, z) = ({r:.6e}, {z:.6e}) m became {value:e} in stage `{stage}` at step {step}"
)]
pub struct Fault {
    /// The stage that found it.
    pub stage: &'static str,
    /// The particle's identity.
    pub particle: u32,
    /// Name of the quantity.
    pub quantity: &'static str,
    /// Its value.
    pub value: f64,
    /// Radius in metres.
    pub r: f64,
    /// Axial position in metres.
    pub z: f64,
    /// The step.
    pub step: u64,
}

/// What one stage has cost so far.
#[derive(Clone, Debug)]
pub struct Cost {
    /// The stage.
    pub stage: &'static str,
    /// How often it ran.
    pub calls: u64,
    /// Wall time in it.
    pub time: Duration,
    /// What it evaluated and moved, where it is a pair pass.
    pub pair_work: PairWork,
}

/// The stages of a step, in their order.
pub struct Pipeline {
    start: Vec<Box<dyn Stage>>,
    stages: Vec<Box<dyn Stage>>,
    costs: Vec<Cost>,
}

impl Pipeline {
    /// A pipeline that runs `start` once before the first step of a new run, then `stages` every step.
    pub fn new(start: Vec<Box<dyn Stage>>, stages: Vec<Box<dyn Stage>>) -> Self {
        let cost = |stage: &dyn Stage| Cost {
            stage: stage.name(),
            calls: 0,
            time: Duration::ZERO,
            pair_work: PairWork::default(),
        };
        let costs = stages.iter().map(|stage| cost(stage.as_ref())).collect();
        Pipeline { start, stages, costs }
    }

    /// Bytes that the stages of a step keep for themselves.
    pub fn bytes(&self) -> usize {
        self.stages.iter().map(|stage| stage.bytes()).sum()
    }

    /// The cost of every stage, in their order.
    pub fn costs(&self) -> &[Cost] {
        &self.costs
    }

    /// Runs the start stages: once for a new run, not when a run is resumed. What they keep is given back.
    ///
    /// # Errors
    /// The first fault.
    pub fn begin(&mut self, world: &mut World) -> Result<(), Fault> {
        for mut stage in self.start.drain(..) {
            let _span = tracing::info_span!("start", stage = stage.name()).entered();
            stage.run(world)?;
        }
        Ok(())
    }

    /// Runs one stage of the step alone, for benchmarks and tests; false if there is none of that name.
    ///
    /// # Errors
    /// The stage's fault.
    pub fn run_stage(&mut self, name: &str, world: &mut World) -> Result<bool, Fault> {
        match self.stages.iter_mut().find(|stage| stage.name() == name) {
            Some(stage) => stage.run(world).map(|()| true),
            None => Ok(false),
        }
    }

    /// One time step.
    ///
    /// # Errors
    /// The first fault; time doesn't move on.
    pub fn step(&mut self, world: &mut World) -> Result<(), Fault> {
        if cfg!(debug_assertions) {
            world.store.poison_derived();
        }
        world.arena.reset();
        let _span = tracing::info_span!("step", number = world.clock.step).entered();
        for (stage, cost) in self.stages.iter_mut().zip(&mut self.costs) {
            let _span = tracing::info_span!("stage", name = stage.name()).entered();
            let start = Instant::now();
            stage.run(world)?;
            cost.time += start.elapsed();
            cost.calls += 1;
            cost.pair_work += stage.pair_work(world);
        }
        world.clock.advance();
        Ok(())
    }
}
