mod bodies;
mod errors;
mod expressions;
mod properties;
mod reading;
mod reference;
mod settings;

use super::{Diagnosis, Scene, parse};
use miette::Diagnostic;

/// A whole scene, with every table.
pub(super) const EXAMPLE: &str = r#"format = 1
title = "A water drop oscillates in mode 2"
# paper = true

[parameters]             # names to vary
radius = "2.5 um"
particle_size = "71.4 nm"
surface_tension = "0.074 N/m"
density = "1000 kg/m3"
sound_speed = "auto"     # derived from the scene
mode = 2
amplitude = 0.02
capillary_velocity = "sqrt(surface_tension/(density*radius))"

[liquid]
density = "density"
surface_tension = "surface_tension"
sound_speed = "sound_speed"
equation_of_state = "linear"

[[body]]
shape = { sphere = { radius = "radius", centre = "0 m" } }
velocity = { r = "-amplitude*capillary_velocity*(r/radius)/2", z = "amplitude*capillary_velocity*z/radius" }

[particles]
size = "particle_size"
# All are of one size at the start.

[run]
until = "8 * sqrt(density*radius^3/surface_tension)"

[method]
scheme = "harmonic-mean"
theta = 0.5

[output]
frames = 10

[[measure]]
laplace-pressure = { radius = "radius", centre = "0 m" }
[[measure]]
oscillation = { mode = "mode", radius = "radius", centre = "0 m" }
[[measure]]
spurious-velocity = { radius = "radius" }
"#;

/// The example with one text replaced, which must stand in it.
pub(super) fn changed(from: &str, to: &str) -> String {
    assert!(EXAMPLE.contains(from), "the example has no {from}");
    EXAMPLE.replacen(from, to, 1)
}

/// The example with its body's shape replaced; sizes fit a radius of 2.5 um.
pub(super) fn shaped(shape: &str) -> String {
    changed(r#"{ sphere = { radius = "radius", centre = "0 m" } }"#, shape)
}

pub(super) fn settings(settings: &[&str]) -> Vec<String> {
    settings.iter().map(|setting| (*setting).to_owned()).collect()
}

pub(super) fn read(text: &str) -> Scene {
    match parse("drop.toml", text, &[]) {
        Ok(scene) => scene,
        Err(diagnosis) => panic!("{:?}", miette::Report::new(diagnosis)),
    }
}

/// The one mistake of a scene, whose message and help must hold all the fragments.
pub(super) fn mistake(text: &str, set: &[&str], fragments: &[&str]) -> Diagnosis {
    let diagnosis = parse("drop.toml", text, &settings(set)).expect_err("a mistake");
    let help = diagnosis.help().map(|help| help.to_string()).unwrap_or_default();
    assert!(!help.is_empty(), "no help: {diagnosis}");
    let said = format!("{diagnosis}\n{help}");
    for fragment in fragments {
        assert!(said.contains(fragment), "`{fragment}` is missing in: {said}");
    }
    diagnosis
}

/// A mistake of a scene's file at a line, with the underlined text.
pub(super) fn mistake_at(text: &str, line: usize, blamed: &str, fragments: &[&str]) {
    let diagnosis = mistake(text, &[], fragments);
    assert_eq!(diagnosis.source_name(), Some("drop.toml"));
    assert_eq!((diagnosis.line(), diagnosis.blamed()), (Some(line), Some(blamed)), "{diagnosis}");
}
