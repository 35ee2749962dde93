use super::{EXAMPLE, changed, mistake, settings};
use crate::scene::{Method, Scene, Scheme, parse};

fn set(list: &[&str]) -> Scene {
    match parse("drop.toml", EXAMPLE, &settings(list)) {
        Ok(scene) => scene,
        Err(diagnosis) => panic!("{:?}", miette::Report::new(diagnosis)),
    }
}

#[test]
fn settings_replace_values_and_keep_comments() {
    let scene = set(&[
        "radius=15 um",
        "particle_size=\"0.5 um\"",
        "method.scheme=parshikov",
        "output.frames=3",
        "run.steps = 20",
        "sound_speed=150 m/s",
        "domain.period=40 um",
        "body.0.shape.sphere.centre=1 um",
        "title=Other",
    ]);
    assert_eq!(
        (scene.parameters[0].value.map(|radius| radius.value), scene.particle_size),
        (Some(1.5e-5), 5e-7)
    );
    assert_eq!((scene.method.scheme, scene.output.frames, scene.steps), (Scheme::Parshikov, 3, Some(20)));
    assert_eq!((scene.liquid.sound_speed, scene.domain.period), (Some(150.0), Some(4e-5)));
    assert_eq!(scene.title, "Other");
    assert!(scene.text.contains("sound_speed = \"150 m/s\"     # derived from the scene"));
    assert!(scene.text.contains("[domain]\nperiod = \"40 um\""));
    let again = super::read(&scene.text);
    assert_eq!(again.text, scene.text);
    assert_eq!((again.until, again.parameters, again.method), (scene.until, scene.parameters, scene.method));
}

#[test]
fn paper_and_repeated_settings() {
    let scene = set(&["paper=true", "amplitude=1", "amplitude=0.5"]);
    assert_eq!(scene.method, Method { theta: 0.5, ..Method::paper() });
    assert_eq!(scene.parameters[6].value.map(|amplitude| amplitude.value), Some(0.5));
    assert_eq!(set(&[]).text, EXAMPLE);
}

fn blamed(list: &[&str], wanted: &str, fragments: &[&str]) {
    let diagnosis = mistake(EXAMPLE, list, fragments);
    assert_eq!(
        (diagnosis.source_name(), diagnosis.line(), diagnosis.blamed()),
        (Some("--set"), Some(1), Some(wanted)),
        "{diagnosis}"
    );
}

#[test]
fn a_bad_setting_is_shown_itself() {
    blamed(&["radus=15 um"], "radus", &["no parameter `radus`", "did you mean `radius`?", "`density`"]);
    blamed(&["radius"], "radius", &["sets nothing"]);
    blamed(&["radius.=1"], "radius.", &["is no key"]);
    blamed(&["radius=15 kg"], "15 kg", &["`15 kg` is a mass; `radius` expects a length"]);
    blamed(&["radius=\"-1 um\""], "\"-1 um\"", &["`radius` is -1e-6 m", "must be positive"]);
    blamed(&["radius=2 * raduis"], "raduis", &["unknown name `raduis`"]);
    blamed(&["radius=\"2 * raduis\""], "raduis", &["unknown name `raduis`"]);
    blamed(&["method.schem=parshikov"], "method.schem", &["unknown key `schem` in `method`"]);
    blamed(&["metod.scheme=parshikov"], "metod.scheme", &["unknown key `metod`"]);
    blamed(&["method.scheme=nonsense"], "nonsense", &["knows no `nonsense`", "`parshikov`"]);
    blamed(&["method.theta=3"], "3", &["must lie between 0.4 and 1.5"]);
    blamed(&["output.picture=3"], "3", &["expects true or false"]);
    blamed(&["title.x=3"], "title.x", &["`title` holds no key `x`"]);
    blamed(&["body.7.shape=3"], "body.7.shape", &["`body` holds no key `7`"]);
    blamed(&["body.0=1 um"], "body.0", &["`body.0` is a table", "--set body.0.KEY=VALUE"]);
    blamed(&["particles.size={}"], "{}", &["`size` expects a length", "not a table"]);
    blamed(&["body.0.shape={ sphere = { radius = \"-1 um\" } }"], "\"-1 um\"", &["`radius` is -1e-6 m"]);
    blamed(&["body=3"], "body", &["no parameter `body`"]);
    blamed(&["method.theta=0.6", "method.theta=9"], "9", &["`theta` is 9"]);
    blamed(&["particle_size=1 um"], "1 um", &["fewer than 10 (5) fit"]);
}

#[test]
fn a_table_within_tables_is_none_to_set() {
    let text = changed("velocity = {", "[body.velocity]\n#");
    mistake(&text, &["body.0.velocity=3"], &["`body.0.velocity` is a table"]);
}

#[test]
fn a_mistake_of_the_file_keeps_its_line() {
    let text = changed("frames = 10", "frames = -1");
    let diagnosis = mistake(&text, &["paper=true", "amplitude=0.1"], &["`frames` is -1"]);
    assert_eq!(
        (diagnosis.source_name(), diagnosis.line(), diagnosis.blamed()),
        (Some("drop.toml"), Some(37), Some("-1"))
    );
}
