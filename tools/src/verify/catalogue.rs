//! `verify.toml`: which scenes run at which level, and what they are compared with.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::failure::Failure;

/// How thorough a verification is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Level {
    /// Coarse: under three minutes on two cores
    Quick,
    /// At the paper's resolutions
    Paper,
    /// Finer than the paper
    Fine,
}

/// All cases.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Catalogue {
    case: Vec<Case>,
}

/// A scene that is verified.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Case {
    pub(super) name: String,
    pub(super) title: String,
    pub(super) about: String,
    /// The scene, from the folder of the catalogue.
    scene: PathBuf,
    /// Parameter of the scene over which the numbers of particles are counted.
    pub(super) per: String,
    #[serde(default)]
    pub(super) set: Vec<String>,
    quick: Vec<f64>,
    paper: Vec<f64>,
    fine: Vec<f64>,
    pub(super) measure: Vec<Expectation>,
}

/// A measure and what it is compared with.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Expectation {
    pub(super) name: String,
    #[serde(default)]
    pub(super) target: Vec<Bound>,
    #[serde(default)]
    pub(super) paper: Vec<Bound>,
    #[serde(default)]
    pub(super) code: Vec<Code>,
}

/// An error that belongs to a resolution and all finer ones.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Bound {
    from: f64,
    error: f64,
}

/// What another program measured.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Code {
    pub(super) name: String,
    /// Cells per radius, error, core-seconds.
    pub(super) points: Vec<[f64; 3]>,
}

impl Case {
    /// Particles per length at a level, coarsest first.
    pub(super) fn resolutions(&self, level: Level) -> &[f64] {
        match level {
            Level::Quick => &self.quick,
            Level::Paper => &self.paper,
            Level::Fine => &self.fine,
        }
    }

    /// The scene's file.
    pub(super) fn scene(&self, folder: &Path) -> PathBuf {
        folder.join(&self.scene)
    }

    /// The settings of a run at a resolution.
    pub(super) fn settings(&self, resolution: f64) -> Vec<String> {
        let size = format!("particle_size={}/{resolution}", self.per);
        self.set.iter().cloned().chain([size]).collect()
    }
}

impl Expectation {
    /// The strictest target at a resolution.
    pub(super) fn target_at(&self, resolution: f64) -> Option<f64> {
        let bounds = self.target.iter().filter(|bound| bound.from <= resolution);
        bounds.map(|bound| bound.error).min_by(f64::total_cmp)
    }

    /// The paper's error at the finest of its resolutions up to this one.
    pub(super) fn paper_at(&self, resolution: f64) -> Option<f64> {
        let bounds = self.paper.iter().filter(|bound| bound.from <= resolution);
        bounds.max_by(|a, b| a.from.total_cmp(&b.from)).map(|bound| bound.error)
    }

    /// Another program's smallest error, whatever it cost, with that cost in core-seconds.
    pub(super) fn best_code(&self) -> Option<(f64, f64)> {
        let points = self.code.iter().flat_map(|code| &code.points);
        let best = points.min_by(|a, b| a[1].abs().total_cmp(&b[1].abs()));
        best.map(|[_, error, seconds]| (*error, *seconds))
    }
}

/// Reads the catalogue of a folder, and chooses the named cases of it; all if none is named.
pub(super) fn read(folder: &Path, names: &[String]) -> Result<Vec<Case>, Failure> {
    let path = folder.join("verify.toml");
    let text = std::fs::read_to_string(&path).map_err(|error| {
        let help = "run this in the folder that holds `cases`, or name that with --cases DIR";
        Failure::input(format!("cannot read `{}`: {error}; {help}", path.display()))
    })?;
    let wrong = |error: &dyn std::fmt::Display| Failure::input(format!("`{}`: {error}", path.display()));
    let catalogue: Catalogue = toml::from_str(&text).map_err(|error| wrong(&error))?;
    choose(catalogue.case, names)
}

fn choose(cases: Vec<Case>, names: &[String]) -> Result<Vec<Case>, Failure> {
    if let Some(name) = names.iter().find(|name| cases.iter().all(|case| case.name != **name)) {
        let known: Vec<&str> = cases.iter().map(|case| case.name.as_str()).collect();
        return Err(Failure::input(format!("there is no case `{name}`; there are {}", known.join(", "))));
    }
    Ok(cases.into_iter().filter(|case| names.is_empty() || names.contains(&case.name)).collect())
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(crate) const TEXT: &str = r#"
[[case]]
name = "drop"
title = "A drop"
about = "About it."
scene = "drop/scene.toml"
per = "radius"
set = ["periods=2"]
quick = [12, 25]
paper = [35]
fine = [70]
[[case.measure]]
name = "frequency"
target = [{ from = 12, error = 0.1 }, { from = 25, error = 0.01 }]
paper = [{ from = 35, error = 0.02 }]
[[case.measure.code]]
name = "mesh"
points = [[8, -0.001, 1], [16, 0.01, 5]]
"#;

    pub(crate) fn example() -> Case {
        toml::from_str::<Catalogue>(TEXT).unwrap().case.remove(0)
    }

    #[test]
    fn the_strictest_target_and_the_nearest_figure_apply() {
        let case = example();
        let frequency = &case.measure[0];
        assert_eq!([5.0, 12.0, 30.0].map(|n| frequency.target_at(n)), [None, Some(0.1), Some(0.01)]);
        assert_eq!([30.0, 70.0].map(|n| frequency.paper_at(n)), [None, Some(0.02)]);
        assert_eq!(frequency.best_code(), Some((-0.001, 1.0)));
        assert_eq!(case.settings(17.5), ["periods=2", "particle_size=radius/17.5"]);
    }

    #[test]
    fn an_unknown_case_is_refused() {
        assert!(choose(vec![example()], &["film".to_owned()]).is_err());
        assert_eq!(choose(vec![example()], &["drop".to_owned()]).unwrap().len(), 1);
    }

    #[test]
    fn the_catalogue_of_the_project_is_sound() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../cases");
        for case in read(&folder, &[]).unwrap() {
            for resolution in
                [Level::Quick, Level::Paper, Level::Fine].map(|level| case.resolutions(level)[0])
            {
                let scene = meniscus_cases::scene::read(&case.scene(&folder), &case.settings(resolution));
                assert!(scene.is_ok(), "{} at {resolution}", case.name);
            }
        }
    }
}
