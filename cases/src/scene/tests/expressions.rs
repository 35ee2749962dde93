use super::{EXAMPLE, changed, mistake_at, read};

/// The value in SI units of a parameter written like this.
fn value(written: &str) -> f64 {
    let scene = read(&changed("mode = 2", &format!("mode = 2\nprobe = {written}")));
    let probe = scene.parameters.iter().find(|parameter| parameter.name == "probe");
    probe.and_then(|probe| probe.value).map_or(f64::NAN, |quantity| quantity.value)
}

fn shown(written: &str) -> String {
    let scene = read(&changed("mode = 2", &format!("mode = 2\nprobe = \"{written}\"")));
    let probe = scene.parameters.iter().find(|parameter| parameter.name == "probe");
    probe.and_then(|probe| probe.value).map_or(String::new(), |quantity| quantity.to_string())
}

#[test]
fn units_become_si() {
    let cases = [
        ("2.5 um", "2.5e-6 m"),
        ("2.5um", "2.5e-6 m"),
        ("2.5 µm", "2.5e-6 m"),
        ("2.5 μm", "2.5e-6 m"),
        ("50 mN/m", "0.05 kg s^-2"),
        ("1 kPa", "1000 kg m^-1 s^-2"),
        ("1 g/cm3", "1000 kg m^-3"),
        ("1 kg m^-3", "1 kg m^-3"),
        ("1 kg*m^2/s^2/m", "1 kg m s^-2"),
        ("-3 us", "-3e-6 s"),
        ("7", "7"),
        ("sqrt(2 m)", "1.4142 m^(1/2)"),
        ("1 m / radius", "4e5"),
        ("180 deg", "3.1416"),
    ];
    for (written, wanted) in cases {
        assert_eq!(shown(written), wanted, "{written}");
    }
    assert_eq!((value("\"71.4 nm\""), value("\"2.5 um\""), value("1.5e-6")), (7.14e-8, 2.5e-6, 1.5e-6));
}

#[test]
fn operators_bind_as_usual() {
    let cases = [
        ("2 + 3 * 4", 14.0),
        ("-2^2", -4.0),
        ("2^3^2", 512.0),
        ("2^-1", 0.5),
        ("(2 + 3) * 4", 20.0),
        ("8 / 2 / 2", 2.0),
        ("1 - 2 - 3", -4.0),
        ("--3", 3.0),
        ("max(2, min(5, 3)) + abs(-1)", 4.0),
        ("log(exp(2)) + sin(pi/2) + cos(0) + tan(0)", 4.0),
        ("legendre(2, 0.5)", -0.125),
        ("legendre(mode, 1)", 1.0),
        ("legendre_derivative(3, 0.5)", 0.375),
        ("legendre(0, 0.3) + legendre_derivative(0, 0.3)", 1.0),
        ("amplitude * mode", 0.04),
    ];
    for (written, wanted) in cases {
        let found = value(&format!("\"{written}\""));
        assert!((found - wanted).abs() < 1e-14, "{written} is {found}, not {wanted}");
    }
}

#[test]
fn mistakes_in_expressions_have_a_place() {
    let cases = [
        ("radius + ", "\"radius + \"", "expected a number, a name or `(`, but it ends"),
        ("radius + * 2", "*", "found `*`"),
        ("(radius", "\"(radius\"", "expected `)`"),
        ("2 radius", "radius", "`radius` is no unit"),
        ("2.5 umm", "umm", "`umm` is no unit"),
        ("2.5.1", "2.5.1", "is no number"),
        ("2 * raduis", "raduis", "did you mean `radius`?"),
        ("2 * r", "r", "`r` has no value here"),
        ("1/s^2", "s", "a unit follows a number: `2 s`, and `1 s^-1` for one over it"),
        ("2*mm", "mm", "`mm` is a unit without a number"),
        ("sqr(2)", "sqr(2)", "did you mean `sqrt`?"),
        ("max(2)", "max(2)", "takes 2 argument(s)"),
        ("radius + density", "radius + density", "cannot add a length and a density"),
        ("exp(radius)", "exp(radius)", "expects a number without unit, not a length"),
        ("radius^0.3", "radius^0.3", "a length to the power 0.3"),
        ("2^radius", "2^radius", "the exponent is a length"),
        ("legendre(1.5, 0.1)", "legendre(1.5, 0.1)", "expects a whole number"),
        ("1/0", "\"1/0\"", "`probe` is inf"),
        ("3 * sound_speed", "sound_speed", "`sound_speed` is \"auto\""),
        ("probe + 1", "\"probe + 1\"", "circle"),
        ("", "\"\"", "it ends"),
    ];
    for (written, blamed, fragment) in cases {
        let text = changed("mode = 2", &format!("mode = 2\nprobe = \"{written}\""));
        mistake_at(&text, 12, blamed, &[fragment]);
    }
    let deep = format!("probe = \"{}1{}\"", "(".repeat(500), ")".repeat(500));
    let diagnosis = super::mistake(&changed("mode = 2", &deep), &[], &["nested too deeply"]);
    assert_eq!(diagnosis.line(), Some(11));
}

#[test]
fn only_names_that_share_letters_are_suggested() {
    let help = |written: &str| {
        let text = changed("mode = 2", &format!("mode = 2\nR = 1\nprobe = \"{written}\""));
        miette::Diagnostic::help(&super::mistake(&text, &[], &["known names"])).unwrap().to_string()
    };
    assert!(!help("1 km/h").contains("did you mean"), "{}", help("1 km/h"));
    assert!(help("1 km/Pi").contains("did you mean `pi`?"), "{}", help("1 km/Pi"));
}

#[test]
fn places_have_no_value_outside_of_fields_and_the_advice_names_all_of_them() {
    let text = changed("mode = 2", "mode = 2\nprobe = \"2 * r\"");
    super::mistake(&text, &[], &["`velocity`", "`internal_energy`", "`expression`"]);
}

#[test]
fn a_field_is_fast() {
    let scene = read(EXAMPLE);
    let start = std::time::Instant::now();
    let sum: f64 = (0..1_000_000).map(|index| scene.bodies[0].velocity.at(f64::from(index), 1.0)[0]).sum();
    assert!(sum < 0.0);
    // Some 0.05 s; the bound is for busy machines.
    assert!(start.elapsed().as_secs() < 5, "{:?}", start.elapsed());
}
