//! What callgrind counted, stage by stage.

use std::collections::BTreeMap;

/// The caller whose calls are the stages of a step, but for those that work on chunks.
const STEP: &str = "pipeline::Pipeline::step";
/// What it calls in between.
const WORK: &str = "pipeline::Work::run";
/// How the names of the stages' functions end.
const RUN: &str = "pipeline::Stage>::run";
/// The same for stages that work on chunks, which are called from many places.
const CHUNKS: [&str; 3] =
    ["group::ChunkStage>::prepare", "group::ChunkStage>::chunk", "group::ChunkStage>::finish"];

/// Instructions of each stage with all that it calls, by the name of its type, from the profile of steps that was written
/// with `--compress-strings=no --compress-pos=no`.
///
/// ```text
/// fn=<caller>
/// <line> <instructions of its own>
/// cfn=<callee>
/// calls=<count> <line of the callee>
/// <line> <instructions of these calls>
/// ```
pub fn stages(profile: &str) -> BTreeMap<String, u64> {
    let mut stages = BTreeMap::new();
    let (mut in_step, mut callee) = (false, None);
    let mut lines = profile.lines();
    while let Some(line) = lines.next() {
        if let Some(caller) = line.strip_prefix("fn=") {
            in_step = caller.contains(STEP) || caller.contains(WORK);
        } else if let Some(name) = line.strip_prefix("cfn=") {
            callee = stage(name).map(|stage| (stage, CHUNKS.iter().any(|work| name.contains(work))));
        } else if line.starts_with("calls=") {
            let cost =
                lines.next().and_then(|line| line.split(' ').nth(1)).and_then(|cost| cost.parse().ok());
            if let (Some((stage, of_chunks)), Some(cost)) = (callee, cost)
                && (in_step || of_chunks)
            {
                *stages.entry(stage.to_owned()).or_insert(0) += u64::max(cost, 0);
            }
        }
    }
    stages
}

/// The type in `<path::Type<parameters> as path::Stage>::run`, if the function is one.
fn stage(function: &str) -> Option<&str> {
    let is_stage = function.contains(RUN) || CHUNKS.iter().any(|work| function.contains(work));
    let (path, _) = function.strip_prefix('<')?.split_once(" as ").filter(|_| is_stage)?;
    path.split('<').next()?.rsplit("::").next()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn calls_of_stages_from_a_step_count() {
        let profile = "\
fn=meniscus_engine::pipeline::Pipeline::begin
5 10
cfn=<meniscus_stages::sort_bin::SortBin as meniscus_engine::pipeline::Stage>::run
calls=1 0
5 1000

fn=meniscus_engine::pipeline::Pipeline::step
7 20
cfn=<meniscus_stages::sort_bin::SortBin as meniscus_engine::pipeline::Stage>::run
calls=2 0
7 300
cfn=std::time::Instant::now
calls=4 0
7 44

fn=meniscus_engine::group::Group::chunks::{{closure}}
9 30
cfn=<meniscus_engine::pairs::PairPass<R,I,T> as meniscus_engine::group::ChunkStage>::chunk
calls=2 0
9 5000
";
        let expected = [("PairPass", 5000), ("SortBin", 300)].map(|(name, cost)| (name.to_owned(), cost));
        assert_eq!(stages(profile), BTreeMap::from(expected));
    }
}
