use super::{EXAMPLE, changed, mistake, read, shaped};
use crate::region::Region;
use crate::scene::{AxisTreatment, Choice, Flux, Measure, Method, Scheme};
use crate::shape::Shape;
use miette::Diagnostic;

fn close(value: f64, exact: f64) -> bool {
    (value - exact).abs() <= 1e-12 * exact.abs()
}

#[test]
fn the_example_is_read_in_full() {
    let scene = read(EXAMPLE);
    assert_eq!(scene.title, "A water drop oscillates in mode 2");
    assert_eq!(scene.source_name, "drop.toml");
    let names: Vec<&str> = scene.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
    assert_eq!(names[..3], ["radius", "particle_size", "surface_tension"]);
    assert_eq!(scene.parameters[4].value, None);
    assert_eq!(scene.parameters[0].value.map(|radius| radius.value), Some(2.5e-6));
    assert_eq!((scene.liquid.density, scene.liquid.surface_tension), (1000.0, 0.074));
    assert_eq!((scene.liquid.sound_speed, scene.particle_size), (None, 7.14e-8));
    assert!(close(scene.until, 8.0 * (1000.0 * 2.5e-6_f64.powi(3) / 0.074).sqrt()));
    assert!(matches!(scene.bodies[0].shape, Shape::Sphere { radius: 2.5e-6, centre: 0.0 }));
    let speed = 0.02 * (0.074 / 2.5e-3_f64).sqrt();
    let [radial, axial] = scene.bodies[0].velocity.at(1e-6, 2e-6);
    assert!(close(radial, -speed * 0.2) && close(axial, speed * 0.8));
    assert_eq!(scene.measures[1], Measure::Oscillation { mode: 2, radius: 2.5e-6, centre: 0.0, from: 0.0 });
    assert_eq!(scene.measures.len(), 3);
    assert_eq!(scene.method, Method::defaults());
    assert!(scene.warnings.is_empty());
}

#[test]
fn the_sound_speed_follows_from_the_motion() {
    let scene = read(EXAMPLE);
    let capillary = (0.074 / 2.5e-3_f64).sqrt();
    assert!(close(scene.capillary_velocity(), capillary));
    assert!(close(scene.derived_sound_speed(), 10.0 * 8.0_f64.sqrt() * capillary));
    let fastest = scene.fastest_initial_speed();
    assert!(fastest < 0.02 * capillary && fastest > 0.0196 * capillary);
    let fast = read(&changed("amplitude = 0.02", "amplitude = 5"));
    assert!(close(fast.derived_sound_speed(), 10.0 * fast.fastest_initial_speed()));
    let given = read(&changed("\"auto\"", "\"150 m/s\""));
    assert_eq!(given.derived_sound_speed(), 150.0);
    let still = EXAMPLE
        .replace("0.02", "0")
        .replace("0.074 N/m", "0 N/m")
        .replace("density*radius^3/surface_tension", "1 s^2");
    mistake(&still, &[], &["sound speed cannot be derived"]);
}

#[test]
fn a_slow_sound_speed_is_doubted() {
    let scene = read(&changed("\"auto\"", "\"20 m/s\""));
    let [warning] = scene.warnings.as_slice() else { panic!("one warning") };
    assert!(
        !warning.is_error()
            && warning.to_string().contains("below ten times the capillary velocity, 5.4406 m/s")
    );
    assert_eq!((warning.line(), warning.blamed()), (Some(10), Some("\"20 m/s\"")));
    let help = warning.help().map(|help| help.to_string()).unwrap_or_default();
    assert!(help.contains("\"auto\", which is 153.88 m/s here"), "{help}");
}

#[test]
fn an_undamped_euler_method_is_doubted() {
    let warnings = |choices: &str| read(&changed("theta = 0.5", choices)).warnings;
    let alone = warnings("time_integration = \"euler\"");
    assert_eq!(alone.len(), 1);
    assert!(alone[0].to_string().contains("damping of the first-order flux"), "{}", alone[0]);
    assert_eq!(alone[0].line(), Some(34));
    assert!(warnings("time_integration = \"euler\"\nflux = \"first-order\"").is_empty());
}

#[test]
fn a_viscosity_below_that_of_the_flux_is_doubted() {
    let viscous = changed(
        "surface_tension = \"surface_tension\"",
        "surface_tension = \"surface_tension\"\nviscosity = \"1 mPa s\"",
    );
    let scene = read(&viscous);
    assert!(scene.liquid.viscosity == 1e-3 && scene.warnings.is_empty());
    let scene = read(&viscous.replace("theta = 0.5", "flux = \"first-order\""));
    let [warning] = scene.warnings.as_slice() else { panic!("one warning") };
    assert!(!warning.is_error() && warning.to_string().contains("to the liquid's 0.001 Pa s"), "{warning}");
    assert_eq!(warning.blamed(), Some("\"1 mPa s\""));
    let wrong = viscous.replace("1 mPa s", "1 mPa");
    mistake(&wrong, &[], &["is a pressure; `viscosity` expects a viscosity"]);
}

#[test]
fn paper_changes_what_is_unset() {
    let text = changed("# paper = true", "paper = true").replace("theta = 0.5", "flux = \"reconstructed\"");
    let method = read(&text).method;
    assert_eq!(method, Method { flux: Flux::Reconstructed, ..Method::paper() });
    assert_eq!((method.axis, method.axis.name()), (AxisTreatment::Parshikov, "parshikov"));
    assert_eq!((method.scheme, method.cfl, method.colour_guard), (Scheme::HarmonicMean, 0.3, 0.0));
}

#[test]
fn a_small_scene_takes_the_defaults() {
    let text = r#"
format = 1
[liquid]
density = "1 g/L"
sound_speed = "10 m/s"
[[body]]
shape.cylinder = { radius = "1 um", bottom = "-2 um", top = "2 um" }
[particles]
size = "50 nm"
[run]
until = "1 us"
steps = 12
[domain]
period = "4 um"
"#;
    let scene = read(text);
    assert_eq!((scene.title.as_str(), scene.paper, scene.steps), ("drop", false, Some(12)));
    assert_eq!((scene.liquid.density, scene.liquid.surface_tension), (1.0, 0.0));
    assert_eq!((scene.domain.origin, scene.domain.period), (0.0, Some(4e-6)));
    assert_eq!(scene.bodies[0].velocity.at(1.0, 1.0), [0.0, 0.0]);
    assert!(scene.parameters.is_empty() && scene.measures.is_empty());
}

#[test]
fn every_shape_can_be_written() {
    let cases = [
        ("{ spheroid = { radial = \"2 um\", axial = \"3 um\" } }", [0.0, 2.0, -3.0, 3.0]),
        ("{ cylinder = { radius = \"2 um\", bottom = 0, top = \"3 um\" } }", [0.0, 2.0, 0.0, 3.0]),
        (
            "{ annulus = { inner = \"1 um\", outer = \"2 um\", bottom = \"0 m\", top = \"3 um\" } }",
            [1.0, 2.0, 0.0, 3.0],
        ),
        (
            "{ annulus = { inner = 0, outer = \"2 um\", bottom = \"0 m\", top = \"3 um\" } }",
            [0.0, 2.0, 0.0, 3.0],
        ),
        ("{ torus = { major = \"2 um\", minor = \"1 um\" } }", [1.0, 3.0, -1.0, 1.0]),
        ("{ torus = { major = \"0.5 um\", minor = \"1 um\" } }", [0.0, 1.5, -1.0, 1.0]),
        (
            "{ polygon = { points = [[\"-1 um\", \"0 m\"], [\"2 um\", \"0 m\"], [\"2 um\", \"2 um\"]] } }",
            [0.0, 2.0, 0.0, 2.0],
        ),
        (
            "{ union = [{ sphere = { radius = \"1 um\" } }, { sphere = { radius = \"1 um\", centre = \"1 um\" } }] }",
            [0.0, 1.0, -1.0, 2.0],
        ),
        (
            "{ intersection = [{ sphere = { radius = \"1 um\" } }, { sphere = { radius = \"1 um\", centre = \"1 um\" } }] }",
            [0.0, 1.0, 0.0, 1.0],
        ),
        (
            "{ difference = [{ sphere = { radius = \"2 um\" } }, { sphere = { radius = \"1 um\" } }] }",
            [0.0, 2.0, -2.0, 2.0],
        ),
    ];
    for (shape, bounds) in cases {
        let scene = read(&shaped(shape));
        for (found, wanted) in scene.bodies[0].shape.bounds().into_iter().zip(bounds) {
            assert!((found - wanted * 1e-6).abs() < 1e-18, "{shape}: {found} is not {wanted} um");
        }
    }
    let level = "{ expression = { inside = \"r^2 + z^2 - radius^2\", bounds = [\"0 m\", \"3 um\", \"-3 um\", \"3 um\"] } }";
    let volume = read(&shaped(level)).bodies[0].shape.volume();
    assert!((volume / (4.0 / 3.0 * std::f64::consts::PI * 2.5e-6_f64.powi(3)) - 1.0).abs() < 1e-10);
}

#[test]
fn a_film_lies_far_from_the_axis() {
    let film = "{ annulus = { inner = \"-1 um\", outer = \"1 um\", bottom = \"0 m\", top = \"10 um\" } }";
    let text = shaped(film).replace("[method]", "[domain]\norigin = \"1 m\"\nperiod = \"10 um\"\n[method]");
    let scene = read(&text);
    assert_eq!(scene.bodies[0].shape.bounds(), [-1e-6, 1e-6, 0.0, 1e-5]);
    assert_eq!(scene.domain.origin, 1.0);
    let sphere = changed("[method]", "[domain]\norigin = \"1 m\"\n[method]");
    mistake(&sphere, &[], &["a sphere sits on the axis", "use annulus"]);
}
