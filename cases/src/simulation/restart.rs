//! From a simulation to a checkpoint, and back.

use super::crash::{self, Crash};
use super::{Simulation, StartError};
use crate::assemble::{Assembly, Physics, assemble};
use crate::scene::Scene;
use meniscus_engine::checkpoint::{self, Checkpoint, Column, Data};
use meniscus_engine::clock::Clock;
use meniscus_engine::field::{Description, Role, Values};
use meniscus_engine::pipeline::{Fault, World};
use meniscus_engine::store::Store;
use meniscus_stages::fields;
use std::borrow::Cow;

/// Start of the names of numbers that count the steps which a bound has set.
const BOUND: &str = "steps bound by ";

impl Simulation {
    /// The whole state: every State column in memory order, the clock with its marks, and the scene's
    /// effective text.
    pub fn checkpoint(&self, scene: &Scene) -> Checkpoint {
        self.with_checkpoint(scene, Checkpoint::clone)
    }

    /// Shows the whole state, whose columns need no second memory for that.
    pub fn with_checkpoint<R>(&self, scene: &Scene, look: impl FnOnce(&Checkpoint) -> R) -> R {
        self.lend(scene, Vec::new(), false, look)
    }

    /// Shows the state in which a run broke down, with all that was computed up to there, and why it did.
    pub fn with_crash_checkpoint<R>(
        &self,
        scene: &Scene,
        fault: &Fault,
        look: impl FnOnce(&Checkpoint) -> R,
    ) -> R {
        self.lend(scene, crash::written(fault).into(), true, look)
    }

    /// Shows the state with more numbers on its clock.
    fn lend<R>(
        &self,
        scene: &Scene,
        scalars: Vec<(String, f64)>,
        with_derived: bool,
        look: impl FnOnce(&Checkpoint) -> R,
    ) -> R {
        let mut clock = written_clock(&self.world.clock);
        clock.scalars.extend(scalars);
        self.world.store.lend(with_derived, |columns| {
            let checkpoint = Checkpoint {
                clock,
                scene: scene.text.clone(),
                revision: env!("CARGO_PKG_VERSION").to_owned(),
                columns: columns.into_iter().map(column).collect(),
            };
            let result = look(&checkpoint);
            (result, checkpoint.columns.into_iter().map(|column| values(column.data)).collect())
        })
    }

    /// Continues from a checkpoint of the scene, bit for bit as if there had been no interruption.
    ///
    /// # Errors
    /// Columns that are missing, of another type or length, or hold values that no state can have.
    pub fn resume(scene: &Scene, checkpoint: &Checkpoint) -> Result<Self, StartError> {
        let physics = Physics::of(scene);
        let Assembly { wiring, pipeline, plan } = assemble(&physics)?;
        let mut store = wiring.allocate(checkpoint.particles());
        let clock = read_clock(&checkpoint.clock).map_err(StartError::Checkpoint)?;
        take_columns(&mut store, checkpoint).map_err(StartError::Checkpoint)?;
        check_state(&store, scene.domain.origin).map_err(StartError::Checkpoint)?;
        Ok(Simulation { physics, world: World::new(store, clock), plan, pipeline })
    }
}

fn column((description, values): (Description, Values)) -> Column {
    Column {
        name: description.name.to_owned(),
        symbol: description.symbol.to_owned(),
        unit: description.unit.to_owned(),
        about: description.about.to_owned(),
        role: match description.role {
            Role::State => checkpoint::Role::State,
            Role::Derived | Role::Transient => checkpoint::Role::Derived,
        },
        data: match values {
            Values::F64(values) => Data::F64(values),
            Values::U32(values) => Data::U32(values),
        },
    }
}

fn values(data: Data) -> Values {
    match data {
        Data::F64(values) => Values::F64(values),
        Data::U32(values) => Values::U32(values),
    }
}

fn written_clock(clock: &Clock) -> checkpoint::Clock {
    let numbers = clock.numbers().iter().map(|(name, value)| (name.to_string(), *value));
    let bounds = clock.bounds_met().iter().map(|(reason, steps)| (format!("{BOUND}{reason}"), *steps as f64));
    checkpoint::Clock {
        step: clock.step,
        time: clock.time,
        step_size: clock.previous_step_size,
        scalars: numbers.chain(bounds).collect(),
    }
}

fn read_clock(written: &checkpoint::Clock) -> Result<Clock, String> {
    if let Some(crash) = Crash::told_by(written) {
        return Err(format!("in it `{}` broke down: resume from an earlier one", crash.stage));
    }
    let [time, step_size] = [written.time, written.step_size];
    if !(time >= 0.0 && time.is_finite() && step_size >= 0.0 && step_size.is_finite()) {
        return Err(format!("its time is {time:e} s and its step size {step_size:e} s"));
    }
    let mut clock = Clock::at(written.step, time, step_size);
    for (name, value) in &written.scalars {
        let reason = name.strip_prefix(BOUND);
        let steps = 0.0..=written.step as f64;
        if !value.is_finite() || reason.is_some() && !steps.contains(value) {
            return Err(format!("the number `{name}` of its clock is {value}"));
        }
        match reason {
            Some(reason) => clock.restore_bound(reason, *value as u64),
            None => clock.restore_number(Cow::Owned(name.clone()), *value),
        }
    }
    Ok(clock)
}

fn take_columns(store: &mut Store, checkpoint: &Checkpoint) -> Result<(), String> {
    let columns = store.columns().filter(|(d, _)| d.role == Role::State);
    let names: Vec<&str> = columns.map(|(description, _)| description.name).collect();
    let missing: Vec<String> = names
        .iter()
        .filter(|name| checkpoint.column(name).is_none())
        .map(|name| format!("`{name}`"))
        .collect();
    if !missing.is_empty() {
        return Err(format!(
            "it lacks {}; an earlier or later version of Meniscus wrote it: resume with that one, or run the scene anew",
            missing.join(", ")
        ));
    }
    if checkpoint.particles() == 0 {
        return Err("it holds no particles".to_owned());
    }
    for column in &checkpoint.columns {
        let name = column.name.as_str();
        if !names.contains(&name) {
            continue;
        }
        let taken = match &column.data {
            Data::F64(values) => {
                if let Some(place) = values.iter().position(|value| !value.is_finite()) {
                    return Err(format!("`{name}` of particle {place} in memory order is {}", values[place]));
                }
                store.set(name, values)
            }
            Data::U32(values) => store.set(name, values),
        };
        if !taken {
            return Err(format!("`{name}` is of another type or length"));
        }
    }
    Ok(())
}

fn check_state(store: &Store, origin: f64) -> Result<(), String> {
    for (field, above) in [(&fields::RADIUS, -origin), (&fields::DENSITY, 0.0), (&fields::MASS, 0.0)] {
        let name = field.description.name;
        let values = store.by_name::<f64>(name);
        let bad = values.as_deref().and_then(|values| values.iter().find(|value| **value <= above));
        if let Some(value) = bad {
            return Err(format!("a {name} is {value:e}: it must be above {above:e}"));
        }
    }
    let refinement = store.by_name::<f64>(fields::REFINEMENT.description.name);
    let mut refinement = refinement.iter().flat_map(|column| column.iter());
    if let Some(value) = refinement.find(|value| !(0.0..1.0).contains(*value)) {
        return Err(format!("a refinement is {value:e}: it must be at least 0 and below 1"));
    }
    // Those that are split off later get the numbers after the largest.
    let identities = store.by_name::<u32>(fields::IDENTITY.description.name);
    if identities.is_some_and(|identities| identities.contains(&u32::MAX)) {
        return Err(format!("a particle has the identity {}, the largest there is", u32::MAX));
    }
    // Sums over drops have one place for every number up to the largest.
    let drops = store.by_name::<u32>(fields::DROP.description.name);
    let most = drops.as_deref().and_then(|drops| drops.iter().max()).copied().unwrap_or(0);
    if most as usize >= store.len() {
        return Err(format!(
            "a drop has the number {most}: it must be below that of particles, {}",
            store.len()
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
