//! What becomes of the energy.

use super::evaluate::{Outcome, largest_change};
use super::history::History;
use crate::scene::Scene;

/// Largest change of the energy over the kinetic energy at the start.
pub(super) fn drift(scene: &Scene, history: &History) -> Outcome {
    let (name, scale) = ("energy-drift".to_owned(), history.of("kinetic energy").first().copied());
    let Some(energy) = energies(scene, history) else { return unknown(name) };
    let drift = largest_change(&energy).zip(scale);
    Outcome::of(name, drift.map(|(change, scale)| change / scale), "1").against(0.0)
}

/// Largest rise of the energy above the least that it had before, over that at the start. Of three outputs in a row the middle
/// energy counts: where a surface is crumpled its measured area is wrong by a per cent now and then, in single outputs.
pub(super) fn gain(scene: &Scene, history: &History) -> Outcome {
    let name = "energy-gain".to_owned();
    let Some(energy) = energies(scene, history) else { return unknown(name) };
    let gain = largest_rise(&medians(&energy)).zip(energy.first()).map(|(rise, start)| rise / start);
    Outcome::of(name, gain, "1").against(0.0)
}

/// Each value's median with the one before and the one after it; the first and the last value stay.
fn medians(values: &[f64]) -> Vec<f64> {
    let median = |three: &[f64]| three[0].max(three[1]).min(three[0].min(three[1]).max(three[2]));
    let inner = values.windows(3).map(median);
    let (first, last) = (values.first(), values.last().filter(|_| values.len() > 1));
    first.copied().into_iter().chain(inner).chain(last.copied()).collect()
}

/// Largest difference of a value to the least one before it; `None` for fewer than two values.
pub(super) fn largest_rise(values: &[f64]) -> Option<f64> {
    let first = *values.first()?;
    values.get(1)?;
    let rise = |(least, most): (f64, f64), value: &f64| (least.min(*value), most.max(value - least));
    Some(values.iter().fold((first, 0.0), rise).1)
}

fn unknown(name: String) -> Outcome {
    Outcome::of(name, None, "1").against(0.0).lacking("the energy of the surface is not known")
}

/// Kinetic, internal, surface and potential energy; `None` where surface tension acts on a liquid whose surface is not
/// known.
pub(super) fn energies(scene: &Scene, history: &History) -> Option<Vec<f64>> {
    let mut energy = history.of("kinetic energy");
    let mut parts = vec![history.of("internal energy")];
    if scene.liquid.surface_tension > 0.0 {
        parts.push(history.of("surface energy"));
    }
    if scene.central_force > 0.0 {
        parts.push(history.of("potential energy"));
    }
    for part in &parts {
        energy.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
    }
    parts.iter().all(|part| part.len() == energy.len()).then_some(energy)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_rise_counts() {
        assert_eq!(largest_rise(&[5.0, 4.0, 3.5, 1.0]), Some(0.0));
        assert_eq!(largest_rise(&[5.0, 4.0, 4.5, 2.0, 3.25, 3.0]), Some(1.25));
        assert_eq!(largest_rise(&[5.0]), None);
    }

    #[test]
    fn single_outputs_do_not_count() {
        assert_eq!(medians(&[5.0, 4.0, 3.0, 4.0, 4.5, 3.5, 3.0]), [5.0, 4.0, 4.0, 4.0, 4.0, 3.5, 3.0]);
        // What lasts does.
        assert_eq!(medians(&[5.0, 4.0, 4.0, 4.5, 4.5, 3.0]), [5.0, 4.0, 4.0, 4.5, 4.5, 3.0]);
        for few in [&[][..], &[2.0], &[3.0, 4.0]] {
            assert_eq!(medians(few), few);
        }
    }
}
