//! What holds for all texts: none makes a reader panic, and what is written is what is computed.

use super::super::compiler::{Compiler, Meaning};
use super::super::{Condition, expression::Node};
use super::{EXAMPLE, parse};
use proptest::prelude::*;

/// A sum of products with its text and its value.
#[derive(Clone, Debug)]
struct Written {
    text: String,
    value: f64,
}

fn expression() -> impl Strategy<Value = Written> {
    let number = (0.001_f64..1000.0).prop_map(|value| Written { text: format!("{value:?}"), value }).boxed();
    number.prop_recursive(6, 40, 2, |inner| {
        (inner.clone(), inner, 0_usize..5).prop_map(|(left, right, operator)| {
            let (a, b) = (left.value, right.value);
            let (sign, value) = [("+", a + b), ("-", a - b), ("*", a * b), ("/", a / b), ("-", -a)][operator];
            let text = match operator {
                4 => format!("-({})", left.text),
                _ => format!("({} {sign} {})", left.text, right.text),
            };
            Written { text, value }
        })
    })
}

fn value_of(text: &str) -> f64 {
    let compiler = Compiler { meaning: &|_| Meaning::Unknown, known: &[], spatial: true };
    compiler.formula(&Node::parse(text).unwrap()).unwrap().at(1.0, 1.0)
}

/// Pieces of which texts are made that come near to the grammar.
fn pieces() -> impl Strategy<Value = String> {
    let words = [
        "r", "z", "density", "sqrt(", "(", ")", " ", "+", "-", "*", "/", "^", "<", ">=", "==", " and ",
        " or ", "not ", "1", "2.5e-6", " um", " kg/m3", "1e999", ",", "\u{b5}m", "=", "\"",
    ];
    proptest::collection::vec(proptest::sample::select(words.to_vec()), 0..40)
        .prop_map(|words| words.concat())
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(500) })]

    #[test]
    fn expressions_are_computed_as_they_are_written(written in expression()) {
        prop_assert_eq!(value_of(&written.text).to_bits(), written.value.to_bits(), "{}", written.text);
    }

    #[test]
    fn any_text_is_a_condition_or_a_mistake_in_it(text in prop_oneof![pieces(), "\\PC{0,60}"]) {
        match Condition::parse(&text, &[("density", "kg/m3")]) {
            Ok(condition) => drop(condition.holds(1.0, 2.0, &[3.0])),
            Err(mistake) => prop_assert!(text.contains(mistake.blamed().unwrap())),
        }
    }

    #[test]
    fn any_text_is_a_scene_or_a_mistake_in_it(text in "\\PC{0,200}") {
        prop_assert!(parse("scene.toml", &text, &[]).is_err());
    }

    /// A line that is lost, doubled or spoiled gives another scene or one mistake with a place.
    #[test]
    fn spoiled_scenes_are_explained(line in 0_usize..200, kind in 0_usize..3, spoilt in pieces()) {
        let mut lines: Vec<String> = EXAMPLE.lines().map(str::to_owned).collect();
        let line = line % lines.len();
        match kind {
            0 => drop(lines.remove(line)),
            1 => lines.insert(line, lines[line].clone()),
            _ => {
                let key = lines[line].split('=').next().unwrap_or_default().to_owned();
                lines[line] = format!("{key}= '{}'", spoilt.replace('\'', ""));
            }
        }
        let text = lines.join("\n");
        match parse("scene.toml", &text, &[]) {
            Ok(scene) => prop_assert!(parse("scene.toml", &scene.text, &[]).is_ok()),
            Err(diagnosis) => {
                prop_assert!(diagnosis.is_error() && !diagnosis.to_string().is_empty());
                prop_assert!(diagnosis.line().is_none_or(|line| line <= lines.len() + 1));
            }
        }
    }

    #[test]
    fn settings_never_panic(key in "[a-z_.0-9]{0,20}", value in pieces()) {
        let _ = parse("scene.toml", EXAMPLE, &[format!("{key}={value}")]);
    }
}
