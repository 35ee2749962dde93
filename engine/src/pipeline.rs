//! The pipeline: stages in an explicit order, and the runner that owns spans and costs.

use crate::clock::Clock;
use crate::group::{ChunkStage, Group};
use crate::lanes::RowTable;
use crate::neighbours::NeighbourList;
use crate::store::Store;
use crate::wiring::{Wiring, WiringError};
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
    /// Scratch memory of one stage, or of a group of them, reused by the next.
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

/// One stage of a step that looks at all particles at once. It states its handles when it is constructed and touches
/// nothing else.
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
    "{quantity} of particle {particle} at (r, z) = ({r:.6e}, {z:.6e}) m became {value:e}{note} in stage `{stage}` at step {step}"
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
    /// What is told after the value where this does not speak for itself.
    pub note: String,
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

/// A stage, by the way it works.
pub enum AnyStage {
    /// On all particles at once.
    Whole(Box<dyn Stage>),
    /// On chunks of particles.
    Chunks(Box<dyn ChunkStage>),
}

impl AnyStage {
    /// A stage that works on all particles at once.
    pub fn whole(stage: impl Stage + 'static) -> Self {
        AnyStage::Whole(Box::new(stage))
    }

    /// A stage that works on chunks of particles.
    pub fn chunks(stage: impl ChunkStage + 'static) -> Self {
        AnyStage::Chunks(Box::new(stage))
    }
}

/// What runs at a time: a stage, or all that take the same chunks in turn.
enum Work {
    Stage(Box<dyn Stage>),
    Group(Group),
}

impl Work {
    /// Stages that work on chunks and follow each other make one group.
    fn of(stages: Vec<AnyStage>, wiring: &Wiring) -> Vec<Work> {
        let mut works = Vec::new();
        let mut group: Vec<Box<dyn ChunkStage>> = Vec::new();
        for stage in stages {
            let ends = match &stage {
                AnyStage::Chunks(stage) => stage.ends_group(),
                AnyStage::Whole(_) => true,
            };
            let whole = match stage {
                AnyStage::Chunks(stage) => {
                    group.push(stage);
                    None
                }
                AnyStage::Whole(stage) => Some(stage),
            };
            if ends && !group.is_empty() {
                works.push(Work::Group(Group::new(std::mem::take(&mut group), wiring)));
            }
            works.extend(whole.map(Work::Stage));
        }
        if !group.is_empty() {
            works.push(Work::Group(Group::new(group, wiring)));
        }
        works
    }

    fn names(&self) -> Vec<&'static str> {
        match self {
            Work::Stage(stage) => vec![stage.name()],
            Work::Group(group) => group.stages().map(|stage| stage.name()).collect(),
        }
    }

    fn name(&self) -> &str {
        match self {
            Work::Stage(stage) => stage.name(),
            Work::Group(group) => &group.name,
        }
    }

    /// Runs it; `costs` are those of its stages.
    fn run(&mut self, world: &mut World, costs: &mut [Cost]) -> Result<(), Fault> {
        match self {
            Work::Group(group) => group.run(world, costs),
            Work::Stage(stage) => {
                let _span = tracing::info_span!("stage", name = stage.name()).entered();
                let start = Instant::now();
                stage.run(world)?;
                costs[0].time += start.elapsed();
                costs[0].calls += 1;
                Ok(())
            }
        }
    }
}

impl Cost {
    fn of(stage: &'static str) -> Self {
        Cost { stage, calls: 0, time: Duration::ZERO, pair_work: PairWork::default() }
    }
}

/// The stages of a step, in their order.
pub struct Pipeline {
    start: Vec<Work>,
    works: Vec<Work>,
    costs: Vec<Cost>,
    particle_steps: u64,
}

impl Pipeline {
    /// A pipeline that runs `start` once before the first step of a new run, then `stages` every step. The wiring has
    /// given the stages their handles.
    ///
    /// # Errors
    /// Stages that hand each other what is only held within a group, and are not of one.
    pub fn new(start: Vec<AnyStage>, stages: Vec<AnyStage>, wiring: &Wiring) -> Result<Self, WiringError> {
        let [start, works] = [start, stages].map(|stages| Work::of(stages, wiring));
        for works in [&start, &works] {
            wiring.check_transients(&works.iter().map(Work::names).collect::<Vec<_>>())?;
        }
        let costs = works.iter().flat_map(Work::names).map(Cost::of).collect();
        Ok(Pipeline { start, works, costs, particle_steps: 0 })
    }

    /// Bytes that the stages of a step keep for themselves.
    pub fn bytes(&self) -> usize {
        let bytes = |work: &Work| match work {
            Work::Stage(stage) => stage.bytes(),
            Work::Group(group) => group.bytes(),
        };
        self.works.iter().map(bytes).sum()
    }

    /// The cost of every stage, in their order.
    pub fn costs(&self) -> &[Cost] {
        &self.costs
    }

    /// The numbers of particles of all steps so far, added up: stages may add particles and take some out.
    pub fn particle_steps(&self) -> u64 {
        self.particle_steps
    }

    /// Runs the start stages: once for a new run, not when a run is resumed. What they keep is given back.
    ///
    /// # Errors
    /// The first fault.
    pub fn begin(&mut self, world: &mut World) -> Result<(), Fault> {
        for mut work in self.start.drain(..) {
            let _span = tracing::info_span!("start", stage = work.name()).entered();
            let mut costs: Vec<Cost> = work.names().into_iter().map(Cost::of).collect();
            work.run(world, &mut costs)?;
        }
        world.rows.are_current = false;
        // What the start has changed since its list was built is not known to that.
        world.neighbours.margin = 0.0;
        // Scratch memory keeps its largest piece; no step needs one as large.
        world.arena = Bump::new();
        Ok(())
    }

    /// Runs one stage of the step alone, for benchmarks and tests; false if there is none of that name.
    ///
    /// # Errors
    /// The stage's fault.
    pub fn run_stage(&mut self, name: &str, world: &mut World) -> Result<bool, Fault> {
        match self.works.iter_mut().find(|work| work.names().contains(&name)) {
            Some(Work::Stage(stage)) => stage.run(world).map(|()| true),
            Some(Work::Group(group)) => group.run_one(name, world).map(|()| true),
            None => Ok(false),
        }
    }

    /// One time step.
    ///
    /// # Errors
    /// The first fault; time doesn't move on.
    pub fn step(&mut self, world: &mut World) -> Result<(), Fault> {
        let _span = tracing::info_span!("step", number = world.clock.step).entered();
        let particles = world.store.len() as u64;
        let mut costs = &mut self.costs[..];
        for work in &mut self.works {
            let count = match work {
                Work::Stage(_) => 1,
                Work::Group(group) => group.stages().count(),
            };
            let (own, others) = costs.split_at_mut(count);
            world.arena.reset();
            work.run(world, own)?;
            costs = others;
        }
        world.clock.advance();
        self.particle_steps += particles;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Field;
    use crate::group::{Around, Chunk, Partial};
    use crate::store::{Read, Update, Write};

    static PLACE: Field<f64> = Field::state("place", "x", "m", "Where it is.");
    static WAY: Field<f64> = Field::transient("way", "dx", "m", "How far it goes.");

    struct Choose(Read<f64>, Write<f64>);
    struct Go(Read<f64>, Update<f64>);
    struct Rest;

    impl ChunkStage for Choose {
        fn name(&self) -> &'static str {
            "choose"
        }
        fn chunk(&self, _: &Around, chunk: &Chunk) -> Partial {
            let place = chunk.read(self.0);
            chunk.write(self.1).iter_mut().zip(&*place).for_each(|(way, place)| *way = 2.0 * place);
            [place.iter().sum(), 0.0]
        }
        fn finish(&mut self, world: &mut World, [sum, _]: Partial) -> Result<(), Fault> {
            world.clock.limit("sum", sum);
            Ok(())
        }
    }

    impl ChunkStage for Go {
        fn name(&self) -> &'static str {
            "go"
        }
        fn chunk(&self, _: &Around, chunk: &Chunk) -> Partial {
            let way = chunk.read(self.0);
            chunk.write(self.1).iter_mut().zip(&*way).for_each(|(place, way)| *place += way);
            Partial::default()
        }
    }

    impl Stage for Rest {
        fn name(&self) -> &'static str {
            "rest"
        }
        fn run(&mut self, _: &mut World) -> Result<(), Fault> {
            Ok(())
        }
    }

    fn wired() -> (Wiring, Choose, Go) {
        let mut wiring = Wiring::new();
        wiring.stage("choose");
        let choose = Choose(wiring.read(&PLACE), wiring.write(&WAY));
        wiring.stage("go");
        let go = Go(wiring.read(&WAY), wiring.update(&PLACE));
        (wiring, choose, go)
    }

    #[test]
    fn stages_of_a_group_hand_on_what_has_no_column() {
        let (wiring, choose, go) = wired();
        let stages = vec![AnyStage::chunks(choose), AnyStage::chunks(go), AnyStage::whole(Rest)];
        let mut pipeline = Pipeline::new(Vec::new(), stages, &wiring).unwrap();
        let mut world = World::new(wiring.allocate(3000), Clock::default());
        let places: Vec<f64> = (0..3000).map(f64::from).collect();
        assert!(world.store.set("place", &places) && world.store.by_name::<f64>("way").is_none());
        pipeline.step(&mut world).unwrap();
        assert_eq!(world.clock.time, 2999.0 * 3000.0 / 2.0, "what chunks found is combined");
        let expected: Vec<f64> = places.iter().map(|place| 3.0 * place).collect();
        assert_eq!(&*world.store.by_name::<f64>("place").unwrap(), &expected);
        assert!(pipeline.costs().iter().all(|cost| cost.calls == 1));
    }

    #[test]
    fn what_is_read_beyond_its_group_is_explained() {
        let (wiring, choose, go) = wired();
        let stages = vec![AnyStage::chunks(choose), AnyStage::whole(Rest), AnyStage::chunks(go)];
        let error = Pipeline::new(Vec::new(), stages, &wiring).err().expect("a mistake").to_string();
        assert_eq!(
            error,
            "stage `go` reads `way`, which is only held while `choose` and the stages after it take a chunk in \
             turn; move it there"
        );
    }
}
