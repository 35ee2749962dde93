//! The reference of scenes, `cases/SCENES.md`, against the code that reads them.

use super::{EXAMPLE, changed, read, shaped};
use crate::scene::{Method, parse};
use miette::Diagnostic;

const PAGE: &str = include_str!("../../../SCENES.md");

/// The keys that the message about an unknown one lists.
fn known(text: &str) -> Vec<String> {
    let diagnosis = parse("drop.toml", text, &[]).expect_err("an unknown key");
    let help = diagnosis.help().expect("a help").to_string();
    let (_, keys) = help.split_once("known keys: ").unwrap_or_else(|| panic!("no keys in: {help}"));
    keys.split(", ").map(|key| key.trim_matches('`').to_owned()).collect()
}

#[test]
fn every_key_stands_in_it() {
    let measure = |kind: &str| format!("{EXAMPLE}\n[[measure]]\n{kind} = {{ zzzz = 1 }}\n");
    let shape = |kind: &str| shaped(&format!("{{ {kind} = {{ zzzz = 1 }} }}"));
    let mut texts = vec![
        changed("format = 1", "format = 1\nzzzz = 1"),
        changed("density = \"density\"", "density = \"density\"\nzzzz = 1"),
        changed("[[body]]", "[[body]]\nzzzz = 1"),
        changed("size = \"particle_size\"", "size = \"particle_size\"\nzzzz = 1"),
        changed("[run]", "[run]\nzzzz = 1"),
        changed("theta = 0.5", "zzzz = 0.5"),
        changed("frames = 10", "zzzz = 10"),
        format!("{EXAMPLE}\n[domain]\nzzzz = 1\n"),
        format!("{EXAMPLE}\n[forces]\nzzzz = 1\n"),
        shaped("{ zzzz = 1 }"),
        measure("oscillation").replace("oscillation = { zzzz", "zzzz = { mode"),
    ];
    texts.extend(["sphere", "spheroid", "cylinder", "annulus", "torus", "polygon", "expression"].map(shape));
    let measures = ["laplace-pressure", "oscillation", "growth-rate", "film-retraction", "large-oscillation"];
    let others = ["spread", "coalescence", "pinch-off", "semi-axis", "plateau-density", "shock-speed"];
    texts.extend(measures.into_iter().chain(others).map(measure));
    for text in texts {
        for key in known(&text) {
            // In a sentence, in a heading, or behind the name of its table.
            let forms = [format!("`{key}`"), format!("[{key}]"), format!(".{key}`"), format!("`{key}.")];
            assert!(forms.iter().any(|form| PAGE.contains(form)), "`{key}` is not told");
        }
    }
}

/// A table of method with what a column of the page says; what depends on the scene is left out.
fn method(column: usize) -> String {
    let (_, section) = PAGE.split_once("## `[method]`").expect("a section");
    let (section, _) = section.split_once("\n## ").expect("another one");
    let mut told = Vec::new();
    for row in section.lines().filter(|line| line.starts_with("| `")) {
        let cells: Vec<&str> = row.trim_matches('|').split(" | ").map(str::trim).collect();
        let [key, _, default, paper] = cells[..] else { panic!("{row}") };
        let value = if column == 1 && paper != "the same" { paper } else { default };
        if !value.contains(' ') {
            told.push(format!("{} = {}", key.trim_matches('`'), value.trim_matches('`')));
        }
    }
    assert!(told.len() > 15, "{told:?}");
    changed("scheme = \"harmonic-mean\"\ntheta = 0.5", &told.join("\n"))
}

#[test]
fn its_defaults_of_the_method_are_the_defaults() {
    assert_eq!(read(&method(0)).method, Method::defaults());
    assert_eq!(read(&method(1)).method, Method::paper());
}
