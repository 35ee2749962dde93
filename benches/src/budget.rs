//! Counted instructions beside those that were accepted.

use std::collections::BTreeMap;

/// By how much a stage may grow over what was accepted.
pub const BUDGET: f64 = 0.03;

/// Instructions by scene and stage.
pub type Counts = BTreeMap<String, BTreeMap<String, u64>>;

/// What is wrong, a sentence each; none where every stage of every scene is within the budget.
pub fn excesses(accepted: &Counts, found: &Counts) -> Vec<String> {
    let compare = |(scene, stage): (&str, &str)| {
        let place = format!("stage {stage} of the scene `{scene}`");
        match (of(accepted, scene, stage), of(found, scene, stage)) {
            (None, _) => Some(format!("{place} has no accepted count")),
            (_, None) => Some(format!("{place} has an accepted count, but did not run")),
            (Some(accepted), Some(found)) => {
                let change = found as f64 / accepted as f64 - 1.0;
                let percent = 100.0 * change;
                (change > BUDGET).then(|| {
                    format!("{place} takes {percent:.2} % more: {found} instructions instead of {accepted}")
                })
            }
        }
    };
    places(accepted, found).into_iter().filter_map(compare).collect()
}

/// The stages that became so much cheaper that the accepted counts should follow, a sentence each.
pub fn gains(accepted: &Counts, found: &Counts) -> Vec<String> {
    let compare = |(scene, stage): (&str, &str)| {
        let change = of(found, scene, stage)? as f64 / of(accepted, scene, stage)? as f64 - 1.0;
        let percent = -100.0 * change;
        (change < -BUDGET).then(|| format!("stage {stage} of the scene `{scene}` takes {percent:.2} % less"))
    };
    places(accepted, found).into_iter().filter_map(compare).collect()
}

fn of(counts: &Counts, scene: &str, stage: &str) -> Option<u64> {
    counts.get(scene)?.get(stage).copied()
}

/// Scene and stage of every count in either table.
fn places<'a>(one: &'a Counts, other: &'a Counts) -> Vec<(&'a str, &'a str)> {
    let mut places = Vec::new();
    for (scene, stages) in one.iter().chain(other) {
        places.extend(stages.keys().map(|stage| (scene.as_str(), stage.as_str())));
    }
    places.sort_unstable();
    places.dedup();
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(stages: &[(&str, u64)]) -> Counts {
        let stages = stages.iter().map(|(stage, count)| ((*stage).to_owned(), *count)).collect();
        Counts::from([("drop".to_owned(), stages)])
    }

    #[test]
    fn three_percent_more_are_too_much() {
        let accepted = counts(&[("flux", 1000), ("list", 1000)]);
        assert!(excesses(&accepted, &counts(&[("flux", 1029), ("list", 500)])).is_empty());
        let problems = excesses(&accepted, &counts(&[("flux", 1031), ("list", 1000)]));
        assert_eq!(
            problems,
            ["stage flux of the scene `drop` takes 3.10 % more: 1031 instructions instead of 1000"]
        );
    }

    #[test]
    fn stages_that_come_or_go_must_be_accepted() {
        let (one, two) = (counts(&[("flux", 1000)]), counts(&[("flux", 1000), ("list", 1000)]));
        assert_eq!(excesses(&one, &two), ["stage list of the scene `drop` has no accepted count"]);
        assert_eq!(
            excesses(&two, &one),
            ["stage list of the scene `drop` has an accepted count, but did not run"]
        );
    }

    #[test]
    fn gains_are_told() {
        let found = counts(&[("flux", 900), ("list", 980)]);
        let gains = gains(&counts(&[("flux", 1000), ("list", 1000)]), &found);
        assert_eq!(gains, ["stage flux of the scene `drop` takes 10.00 % less"]);
    }
}
