//! A portable build: a folder with the command built for several levels of the instruction set, and a launcher
//! that becomes the best one that the processor knows.
//!
//! The lanes' width is fixed when they are compiled, and everything that a pair pass calls must be compiled
//! along with them: so the whole program is built once a level, each as fast as a build for that processor alone.

/// A level of the instruction set that the command is built for.
#[derive(Debug)]
pub struct Level {
    /// Its name as a target processor of the compiler.
    pub name: &'static str,
    /// Whether processor and system know what it has beyond the level before.
    pub known: fn() -> bool,
}

/// The levels, each with all that those before it have.
pub const LEVELS: [Level; 2] =
    [Level { name: "x86-64-v3", known: avx2 }, Level { name: "x86-64-v4", known: avx512 }];

impl Level {
    /// The name of the file of the command built for this level.
    pub fn program(&self) -> String {
        format!("meniscus-{}", self.name)
    }

    /// The highest of the levels up to the first that is not known.
    pub fn best(levels: &[Level]) -> Option<&Level> {
        levels.iter().take_while(|level| (level.known)()).last()
    }
}

#[cfg(target_arch = "x86_64")]
fn avx2() -> bool {
    is_x86_feature_detected!("avx2")
        && is_x86_feature_detected!("bmi1")
        && is_x86_feature_detected!("bmi2")
        && is_x86_feature_detected!("f16c")
        && is_x86_feature_detected!("fma")
        && is_x86_feature_detected!("lzcnt")
        && is_x86_feature_detected!("movbe")
}

#[cfg(target_arch = "x86_64")]
fn avx512() -> bool {
    is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512bw")
        && is_x86_feature_detected!("avx512cd")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
}

#[cfg(not(target_arch = "x86_64"))]
fn avx2() -> bool {
    false
}

#[cfg(not(target_arch = "x86_64"))]
fn avx512() -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_best_level_has_all_that_those_before_it_have() {
        let best = |known: [fn() -> bool; 2]| {
            let [first, second] = known;
            let levels = [Level { name: "first", known: first }, Level { name: "second", known: second }];
            Level::best(&levels).map(|level| level.name)
        };
        let (yes, no) = (|| true, || false);
        assert_eq!(best([yes, yes]), Some("second"));
        assert_eq!(best([yes, no]), Some("first"));
        assert_eq!(best([no, yes]), None);
        assert_eq!(best([no, no]), None);
    }

    /// This very test runs on a processor that knows what it was compiled with.
    #[test]
    fn a_level_that_this_was_compiled_for_is_known() {
        assert!(
            !cfg!(all(target_feature = "avx2", target_feature = "fma", target_feature = "bmi2")) || avx2()
        );
        assert!(!cfg!(all(target_feature = "avx512bw", target_feature = "avx512vl")) || avx512());
    }
}
