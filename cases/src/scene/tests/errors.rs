use super::{EXAMPLE, changed, mistake, mistake_at, shaped};
use crate::scene::read;
use std::path::Path;

#[test]
fn the_text_must_be_toml_of_format_1() {
    mistake_at(&changed("theta = 0.5", "theta = 0.5 0.6"), 34, "0.5 0.6", &["no TOML", "must be quoted"]);
    mistake_at(
        &changed("theta = 0.5", "theta = 0.5\ntheta = 0.6"),
        35,
        "theta",
        &["no TOML", "duplicate key"],
    );
    mistake_at(&changed("format = 1", "format = 2"), 1, "2", &["format is 2, not 1", "write `format = 1`"]);
    mistake_at(&changed("format = 1\n", ""), 1, "", &["missing key `format`"]);
    let missing = read(Path::new("no/such.toml"), &[]).expect_err("no such file");
    assert!(missing.to_string().contains("no/such.toml") && missing.line().is_none());
}

#[test]
fn a_drop_too_long_for_its_exact_motion_is_refused() {
    let measure = "[[measure]]\nlarge-oscillation = { radial = \"1 um\", axial = \"2 um\" }\n";
    mistake(&format!("{EXAMPLE}\n{measure}"), &[], &["0.6 to 1.6 times `radial`", "6e-7 to 1.6e-6 m"]);
}

#[test]
fn the_advice_keeps_to_the_rule() {
    let lengths = "such as \"2.5 um\" is expected";
    mistake(EXAMPLE, &["method.axis_factor=0.5"], &["must be at least 1", "such as 2 is expected"]);
    let narrow = ["must be at least 6", "such as 11 is expected"];
    mistake(EXAMPLE, &["method.colour_support=5"], &narrow);
    let gas = ["surface_tension=0", "sound_speed=auto", "liquid.equation_of_state=ideal-gas"];
    let ratio = "liquid.heat_ratio=0.4";
    mistake(EXAMPLE, &[&gas[..], &[ratio]].concat(), &["must be above 1", "such as \"5/3\" is expected"]);
    let inverted = "{ annulus = { inner = \"9 um\", outer = \"3 um\", bottom = 0, top = \"1 um\" } }";
    let mistake = mistake(&shaped(inverted), &[], &["above `inner`", "`inner` is 9e-6 m: choose more"]);
    assert!(!format!("{:?}", miette::Report::new(mistake)).contains(lengths));
}

#[test]
fn a_measure_that_cannot_apply_is_refused() {
    let still = ["surface_tension=0", "sound_speed=15 m/s", "capillary_velocity=1 m/s", "run.until=1 us"];
    mistake(EXAMPLE, &still, &["surface tension drives, and there is none", "leave the measure out"]);
    let late = changed("mode = \"mode\",", "mode = \"mode\", from = \"1 s\",");
    mistake_at(&late, 41, "[[measure]]", &["fitted from 1 s on, but the run ends at", "an earlier `from`"]);
    let periodic = "[domain]\nperiod = \"12.566 um\"\n[[measure]]\n";
    let [still_r, still_z] = ["body.0.velocity.r=0 m/s", "body.0.velocity.z=0 m/s"];
    for (table, measure, settings, reason) in [
        (periodic, "growth-rate = { wavenumber = 1.5, radius = \"1 um\" }", &[][..], "does not grow"),
        (
            periodic,
            "growth-rate = { wavenumber = 0.7, radius = \"1 um\" }",
            &[],
            "1.4 waves fit into the period",
        ),
        ("[[measure]]\n", "energy-drift = {}", &[still_r, still_z], "nothing moves then"),
        (
            "[[measure]]\n",
            "pinch-off = { radius = \"1 um\", wavenumber = 0.5, speed = \"1 m/s\" }",
            &[],
            "no period",
        ),
        (periodic, "plateau-density = { dimensions = 2, speed = \"1 m/s\" }", &[], "the shock in a gas"),
    ] {
        mistake(&format!("{EXAMPLE}{table}{measure}\n"), settings, &[reason]);
    }
    super::read(&format!("{EXAMPLE}{periodic}growth-rate = {{ wavenumber = 0.5, radius = \"1 um\" }}\n"));
}

#[test]
fn a_title_is_one_short_line() {
    let title = "A water drop oscillates in mode 2";
    let long = "x".repeat(201);
    mistake_at(&changed(title, &long), 2, &format!("\"{long}\""), &["201 characters long", "200 characters"]);
    mistake_at(&changed(title, " "), 2, "\" \"", &["`title` is empty", "the file's name"]);
    let coloured = changed(title, "\\u001b[31mred");
    mistake_at(&coloured, 2, "\"\\u001b[31mred\"", &["control character U+001B", "plain text"]);
    assert_eq!(super::read(&changed(title, &long[1..])).title.len(), 200);
}

#[test]
fn of_a_long_line_only_a_part_is_shown() {
    let padding = "x".repeat(10_000);
    for text in [
        changed("A water drop", &padding),
        changed("theta = 0.5", &format!("theta = 3 # {padding}")),
        changed("amplitude = 0.02", &format!("amplitude = \"0.02{}+ raduis\"", "+ 1".repeat(3000))),
        changed("theta = 0.5", &format!("theta = 3\n# {padding}")),
    ] {
        let diagnosis = mistake(&text, &[], &[]);
        let line = diagnosis.line().unwrap();
        let shown = format!("{:?}", miette::Report::new(diagnosis));
        assert!(shown.lines().all(|line| line.chars().count() < 600), "{shown}");
        assert!(shown.contains(&format!("drop.toml:{line}:")), "{shown}");
    }
}

#[test]
fn nothing_is_faster_than_light() {
    mistake_at(
        &changed("-amplitude*capillary_velocity*(r/radius)/2", "1e300 m/s"),
        23,
        "\"1e300 m/s\"",
        &["`body.0.velocity.r` is up to 1e300 m/s: faster than light", "check its numbers"],
    );
    mistake(EXAMPLE, &["sound_speed=1e9 m/s"], &["the sound speed is 1e9 m/s"]);
    let strong = ["surface_tension=1e30 N/m", "capillary_velocity=1 m/s"];
    mistake(EXAMPLE, &strong, &["faster than light", "the surface tension"]);
}

#[test]
fn keys_are_known_and_there() {
    mistake_at(
        &changed("theta =", "thetta ="),
        34,
        "thetta",
        &["unknown key `thetta` in `method`", "did you mean `theta`?"],
    );
    mistake_at(
        &changed("[run]", "[rum]"),
        29,
        "rum",
        &["unknown key `rum` in the scene", "did you mean `run`?"],
    );
    mistake_at(
        &shaped("{ sphre = { radius = \"radius\" } }"),
        22,
        "sphre",
        &["unknown key `sphre`", "did you mean `sphere`?"],
    );
    mistake_at(
        &shaped("{ sphere = { centre = \"0 m\" } }"),
        22,
        "{ centre = \"0 m\" }",
        &["missing key `radius` in `body.0.shape.sphere`", "add: radius ="],
    );
    mistake_at(&changed("until = ", "steps = 3 # "), 29, "[run]", &["missing key `until` in `run`"]);
    mistake_at(&changed("laplace-pressure", "laplace"), 40, "laplace", &["known keys: `laplace-pressure`"]);
    let two = "{ sphere = { radius = \"1 um\" }, torus = { major = \"2 um\", minor = \"1 um\" } }";
    mistake_at(&shaped(two), 22, two, &["more than one kind"]);
    mistake_at(&shaped("{}"), 22, "{}", &["no kind", "`sphere`"]);
}

#[test]
fn values_have_their_type() {
    mistake_at(
        &changed("frames = 10", "frames = true"),
        37,
        "true",
        &["`frames` expects a number without unit, not true or false"],
    );
    mistake_at(&changed("frames = 10", "frames = 2.5"), 37, "2.5", &["whole number from 0"]);
    let most = i64::MAX.to_string();
    let mistake = changed("frames = 10", &format!("frames = {most}"));
    mistake_at(&mistake, 37, &most, &["`frames` is 9.2234e18", "from 0 to 2^53"]);
    mistake_at(
        &changed("frames = 10", "picture = \"yes\""),
        37,
        "\"yes\"",
        &["`picture` expects true or false, not a text"],
    );
    mistake_at(&shaped("\"sphere\""), 22, "\"sphere\"", &["expects a table with one key, not a text"]);
    mistake_at(&changed("mode = 2", "mode = true"), 11, "true", &["the parameter `mode` is neither"]);
    mistake_at(&changed("[output]\nframes = 10", "[output]\nframes = [1]"), 37, "[1]", &["not a list"]);
    mistake_at(
        &changed("scheme = \"harmonic-mean\"", "scheme = \"harmonic\""),
        33,
        "\"harmonic\"",
        &["`scheme` knows no `harmonic`", "`parshikov`"],
    );
}

#[test]
fn quantities_have_their_unit() {
    let text = changed("\"2.5 um\"", "\"2.5 kg\"");
    mistake_at(&text, 6, "\"2.5 kg\"", &["`2.5 kg` is a mass; `radius` expects a length such as \"2.5 um\""]);
    let text = changed("size = \"particle_size\"", "size = \"2.5 kg\"");
    mistake_at(&text, 26, "\"2.5 kg\"", &["`2.5 kg` is a mass; `size` expects a length such as \"2.5 um\""]);
    let text = changed("particle_size = \"71.4 nm\"", "particle_size = \"71.4 nN\"");
    mistake_at(&text, 7, "\"71.4 nN\"", &["`71.4 nN` is a quantity in kg m s^-2; `size` expects a length"]);
    let text = changed("size = \"particle_size\"", "size = 2.5");
    mistake_at(&text, 26, "2.5", &["`2.5` is a number without unit", "add a unit: \"2.5 m\" in SI units"]);
    let text = changed("size = \"particle_size\"", "size = 1e-7");
    mistake_at(&text, 26, "1e-7", &["add a unit: \"1e-7 m\""]);
    let text = changed("size = \"particle_size\"", "size = nan");
    mistake_at(&text, 26, "nan", &["a length such as \"2.5 um\" is expected"]);
    let text = changed("z = \"amplitude*capillary_velocity*z/radius\"", "z = \"amplitude*z/radius\"");
    mistake_at(&text, 23, "\"amplitude*z/radius\"", &["is a number without unit; `z` expects a velocity"]);
    mistake_at(
        &changed("theta = 0.5", "theta = \"0.5 m\""),
        34,
        "\"0.5 m\"",
        &["is a length; `theta` expects a number"],
    );
}

#[test]
fn values_stay_in_their_limits() {
    let method = [
        ("theta", "0.3"),
        ("theta", "1.6"),
        ("axis_factor", "0.9"),
        ("cfl", "0"),
        ("cfl", "1.1"),
        ("cfl", "inf"),
    ];
    for (key, value) in method {
        mistake_at(
            &changed("theta = 0.5", &format!("{key} = {value}")),
            34,
            value,
            &[&format!("`{key}` is {value}")],
        );
    }
    mistake_at(
        &changed("\"71.4 nm\"", "\"-71.4 nm\""),
        7,
        "\"-71.4 nm\"",
        &["`size` is -7.14e-8 m: it must be positive"],
    );
    mistake_at(
        &changed("density = \"density\"", "density = \"0 kg/m3\""),
        16,
        "\"0 kg/m3\"",
        &["`density` is 0 kg m^-3: it must be positive"],
    );
    mistake_at(
        &changed("\"71.4 nm\"", "\"1 um\""),
        7,
        "\"1 um\"",
        &["fewer than 10 (5) fit across", "4.9995e-7 m or less"],
    );
    mistake_at(&changed("\"71.4 nm\"", "\"1e-30 m\""), 7, "\"1e-30 m\"", &["more than 1e8", "or more"]);
    let far = shaped("{ sphere = { radius = \"radius\", centre = \"1e300 m\" } }");
    mistake(&far, &["capillary_velocity=1e-300 m/s"], &["too far from z = 0"]);
    mistake_at(&changed("mode = 2", "mode = 1"), 11, "1", &["`mode` is 1", "whole number from 2"]);
    mistake_at(&changed("mode = 2", "s = 1"), 11, "s", &["`s` is a unit"]);
    mistake_at(&changed("mode = 2", "drop-mode = 1"), 11, "drop-mode", &["cannot name a parameter"]);
}

#[test]
fn pictures_are_coloured_by_what_the_scene_has() {
    let colour = |name: &str| changed("frames = 10", &format!("colour_by = \"{name}\""));
    let expected = ["`output.colour_by` knows no `speeds`", "did you mean `speed`?", "`velocity_r`"];
    mistake_at(&colour("speeds"), 37, "\"speeds\"", &expected);
    for known in ["speed", "density", "surface"] {
        super::read(&colour(known));
    }
    // Without surface tension there is no such pressure.
    super::read(&colour("laplace_pressure"));
    let dry = colour("laplace_pressure").replace("surface_tension = \"surface_tension\"", "");
    mistake(&dry, &["sound_speed=100 m/s"], &["knows no `laplace_pressure`"]);
}

#[test]
fn mixed_precision_knows_the_default_weights_alone() {
    for other in ["method.axis=parshikov", "method.scheme=parshikov"] {
        let settings = ["method.precision=mixed", other];
        mistake(EXAMPLE, &settings, &["mixed precision", "method.axis = \"conservative\""]);
    }
}
