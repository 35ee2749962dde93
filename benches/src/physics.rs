//! Scenes that differ in one thing that they model.

use crate::read;
use meniscus_cases::scene::Scene;

/// A liquid that flows and nothing more: no surface, no corrections, no axis unless it lies there. Sound and
/// so the time step are the same for all.
const LIQUID: &str = r#"format = 1
title = "A liquid in motion"
[parameters]
radius = "2.5 um"
resolution = 35
speed = "0.1 m/s"
[liquid]
density = "1000 kg/m3"
surface_tension = "0 N/m"
sound_speed = "150 m/s"
[[body]]
shape = { sphere = { radius = "radius" } }
velocity = { r = "-0.5*speed*r/radius", z = "speed*z/radius" }
[particles]
size = "radius/resolution"
[run]
until = "1 us"
[method]
flux = "first-order"
kernel_correction = false
tangential_pressure = false
strain_correction = false
reference_pressure = "none"
shifting = 0
"#;

/// A scene that models one thing more than the one before it.
#[derive(Clone, Copy, Debug)]
pub struct Variant {
    /// What it adds, in words.
    pub name: &'static str,
    /// Whether it starts anew, so that there is nothing to compare it with.
    pub first: bool,
    settings: &'static [&'static str],
}

/// The drop with its physics added one by one, then a rod away from the axis and on it.
pub const VARIANTS: [Variant; 10] = [
    added("drop, first-order flux", &[]).anew(),
    added("+ kernel correction", &["method.kernel_correction=true"]),
    added("+ low-dissipation flux", &["method.flux=reconstructed"]),
    added("+ surface tension", &["liquid.surface_tension=0.074 N/m"]),
    added(
        "+ corrections at the surface",
        &[
            "method.tangential_pressure=true",
            "method.strain_correction=true",
            "method.reference_pressure=drop",
        ],
    ),
    added("+ shifting", &["method.shifting=3"]),
    added(
        "+ energy equation",
        &[
            "liquid.equation_of_state=mie-grueneisen",
            "liquid.adiabat_slope=2",
            "liquid.grueneisen=2",
        ],
    ),
    added("+ viscosity", &["liquid.viscosity=1 mPa s"]),
    added(
        "ring 1 m from the axis",
        &[
            "method.kernel_correction=true",
            "method.flux=reconstructed",
            "body.0.shape={ annulus = { inner = \"0 um\", outer = \"radius/2\", bottom = \"0 um\", top = \"3.1416*radius\" } }",
            "body.0.velocity.r=-speed*r/radius",
            "domain.origin=1 m",
        ],
    )
    .anew(),
    added("+ the axis (a rod)", &["body.0.velocity.r=-0.5*speed*r/radius", "domain.origin=0 m"]),
];

const fn added(name: &'static str, settings: &'static [&'static str]) -> Variant {
    Variant { name, first: false, settings }
}

impl Variant {
    const fn anew(self) -> Self {
        Variant { first: true, ..self }
    }
}

/// The scenes of [`VARIANTS`] with settings (`key=value`) that hold for all of them.
///
/// # Panics
/// If one of them has a mistake.
pub fn scenes(common: &[&str]) -> Vec<(Variant, Scene)> {
    let mut settings: Vec<&str> = Vec::new();
    let scene = |variant: Variant| {
        if variant.first {
            settings = common.to_vec();
        }
        settings.extend(variant.settings);
        (variant, read(LIQUID, &settings))
    };
    VARIANTS.map(scene).into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{advance, drop_scene, start};
    use meniscus_cases::simulation::Simulation;

    fn stages(simulation: &Simulation) -> Vec<&'static str> {
        simulation.costs().iter().map(|cost| cost.stage).collect()
    }

    fn has_field(simulation: &Simulation, name: &str) -> bool {
        simulation.world.store.fields().any(|field| field.name == name)
    }

    #[test]
    fn a_scene_has_the_stages_and_fields_of_what_it_models_and_no_others() {
        // What each variant adds to the one before it: stages, and one of its fields.
        let bare =
            ["sort-bin", "state-anew", "flux", "time-step", "integrate", "list-check", "equation-of-state"];
        let added: [(&[&str], &str); 8] = [
            (&bare, "strain_rate"),
            (&["kernel-correction"], "moment_rr"),
            (&["velocity-gradient"], "velocity_sum_rr"),
            (
                &[
                    "incomplete-support",
                    "drops",
                    "boundary-detect",
                    "curvature",
                    "ghost-coupling",
                    "correction",
                ],
                "laplace_pressure",
            ),
            (
                &[
                    "tension-balance",
                    "tangential-pressure",
                    "void-closing",
                    "reference-pressure",
                    "wanted-size",
                    "size-evening",
                    "split-and-merge",
                ],
                "laplace_slope",
            ),
            (&["shifting", "boundary-evening"], "concentration_gradient_r"),
            (&["reference-work"], "power"),
            (&["viscosity"], "viscous_power"),
        ];
        let variants = scenes(&["resolution=24"]);
        let simulations: Vec<Simulation> = variants[..8].iter().map(|(_, scene)| start(scene)).collect();
        let mut expected = Vec::new();
        for (k, (new, field)) in added.iter().enumerate() {
            let name = variants[k].0.name;
            expected.extend(new.iter().copied());
            let mut found = stages(&simulations[k]);
            found.sort_unstable();
            expected.sort_unstable();
            assert_eq!(found, expected, "{name}");
            for (j, simulation) in simulations.iter().enumerate() {
                assert_eq!(has_field(simulation, field), j >= k, "`{field}` in {}", variants[j].0.name);
            }
        }
    }

    /// The strain's correction needs the gradient of the step alone; to predict the next one somebody must reconstruct, or
    /// be viscous.
    #[test]
    fn rates_of_deformation_are_kept_where_somebody_predicts() {
        let kept = |settings: &[&str]| {
            let scene = drop_scene(&[settings, &["particle_size=radius/24"]].concat());
            let simulation = start(&scene);
            assert!(stages(&simulation).contains(&"velocity-gradient"));
            has_field(&simulation, "deformation_rr")
        };
        assert!(kept(&[]) && kept(&["method.flux=first-order", "liquid.viscosity=1 mPa s"]));
        assert!(!kept(&["method.flux=first-order"]));
    }

    #[test]
    fn far_from_the_axis_nothing_is_mirrored() {
        let variants = scenes(&["resolution=24"]);
        let [.., (_, ring), (_, rod)] = variants.as_slice() else { panic!("two scenes") };
        let [ring, rod] = [ring, rod].map(|scene| {
            let mut simulation = start(scene);
            advance(&mut simulation, 2);
            simulation
        });
        assert_eq!(stages(&ring), stages(&rod));
        let near = |simulation: &Simulation| simulation.world.neighbours.images().len();
        assert_eq!(near(&ring), 0);
        assert!(near(&rod) > 0);
    }
}
