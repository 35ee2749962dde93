//! Conditions on the fields of particles, such as `density < 990 kg/m3 and r < 1 um`.

use super::compiler::{Compiler, Meaning};
use super::diagnosis::{Diagnosis, Place};
use super::expression::{Mistake, Node, Relation, Test};
use super::formula::{Formula, common_dimension};
use super::parser;
use super::quantity::Dimension;
use miette::{NamedSource, Severity};

/// A condition that every particle meets or does not: comparisons of expressions with units, joined by
/// `not`, `and`, `or` (`or` binds least). What is no number stands in no relation but `!=`.
#[derive(Debug)]
pub struct Condition(Checked);

#[derive(Debug)]
enum Checked {
    Any(Vec<Checked>),
    All(Vec<Checked>),
    Not(Box<Checked>),
    Compare(Vec<Formula>, Vec<Relation>),
}

impl Condition {
    /// Reads a condition on fields of the given names and SI units; `r` and `z` are the place.
    ///
    /// # Errors
    /// The first mistake: grammar, unknown names, dimensions that do not fit together.
    pub fn parse(text: &str, fields: &[(&str, &str)]) -> Result<Self, Diagnosis> {
        let names: Vec<&str> = fields.iter().map(|(name, _)| *name).collect();
        let meaning = |name: &str| match fields.iter().position(|(known, _)| *known == name) {
            Some(number) => Meaning::Field(number, dimension(fields[number].1)),
            None => Meaning::Unknown,
        };
        let compiler = Compiler { meaning: &meaning, known: &names, spatial: true };
        let checked = parser::parse_condition(text).and_then(|test| check(&compiler, &test));
        checked.map(Self).map_err(|mistake| {
            let source = NamedSource::new("condition", text.to_owned());
            let place = Place { source, span: mistake.span, label: String::new() };
            Diagnosis::new(Severity::Error, mistake.message, mistake.help, Some(place))
        })
    }

    /// Numbers of the fields that it asks for, in the order in which they were named.
    pub fn fields(&self) -> Vec<usize> {
        let mut found = Vec::new();
        self.0.fields(&mut found);
        found.sort_unstable();
        found.dedup();
        found
    }

    /// Whether it holds for a particle at r, z (m), whose fields have these values in the order in which
    /// they were named, in SI units.
    pub fn holds(&self, r: f64, z: f64, fields: &[f64]) -> bool {
        self.0.holds(&|formula| formula.of_particle(r, z, fields))
    }
}

impl Checked {
    fn fields(&self, found: &mut Vec<usize>) {
        match self {
            Self::Any(tests) | Self::All(tests) => tests.iter().for_each(|test| test.fields(found)),
            Self::Not(test) => test.fields(found),
            Self::Compare(formulas, _) => formulas.iter().for_each(|formula| formula.code.fields(found)),
        }
    }

    fn holds(&self, value: &dyn Fn(&Formula) -> f64) -> bool {
        match self {
            Self::Any(tests) => tests.iter().any(|test| test.holds(value)),
            Self::All(tests) => tests.iter().all(|test| test.holds(value)),
            Self::Not(test) => !test.holds(value),
            Self::Compare(formulas, relations) => {
                let pairs = formulas.windows(2).zip(relations);
                pairs.into_iter().all(|(pair, relation)| relation.holds(value(&pair[0]), value(&pair[1])))
            }
        }
    }
}

fn check(compiler: &Compiler<'_>, test: &Test) -> Result<Checked, Mistake> {
    let all = |tests: &[Test]| -> Result<Vec<Checked>, Mistake> {
        tests.iter().map(|test| check(compiler, test)).collect()
    };
    Ok(match test {
        Test::Any(tests) => Checked::Any(all(tests)?),
        Test::All(tests) => Checked::All(all(tests)?),
        Test::Not(test) => Checked::Not(Box::new(check(compiler, test)?)),
        Test::Compare(nodes, relations) => Checked::Compare(sides(compiler, nodes)?, relations.clone()),
    })
}

/// The compared values, of one dimension.
fn sides(compiler: &Compiler<'_>, nodes: &[Node]) -> Result<Vec<Formula>, Mistake> {
    let formulas = nodes.iter().map(|node| compiler.formula(node)).collect::<Result<Vec<_>, _>>()?;
    for (pair, nodes) in formulas.windows(2).zip(nodes.windows(2)) {
        if common_dimension(&pair[0], &pair[1]).is_none() {
            let [one, other] = [&pair[0], &pair[1]].map(|formula| formula.dimension().described());
            return Err(Mistake::new(
                nodes[0].span.start..nodes[1].span.end,
                format!("cannot compare {one} and {other}"),
                "both sides need the same dimension, as in `density < 990 kg/m3`",
            ));
        }
    }
    Ok(formulas)
}

/// The dimension of a field's unit, such as `kg/m3`, `1/s` or `1`.
fn dimension(unit: &str) -> Dimension {
    let text = match unit.strip_prefix("1/") {
        Some(below) => format!("1/(1 {below})"),
        None if unit.is_empty() || unit == "1" => return Dimension::NONE,
        None => format!("1 {unit}"),
    };
    let compiler = Compiler { meaning: &|_| Meaning::Unknown, known: &[], spatial: false };
    let formula = parser::parse(&text).and_then(|node| compiler.formula(&node));
    formula.map_or(Dimension::NONE, |formula| formula.dimension())
}

#[cfg(test)]
mod tests {
    use super::*;
    use miette::Diagnostic;

    const FIELDS: [(&str, &str); 4] =
        [("density", "kg/m3"), ("speed", "m/s"), ("strain_rate", "1/s"), ("identity", "1")];

    fn holds(text: &str, values: [f64; 4]) -> bool {
        Condition::parse(text, &FIELDS).unwrap().holds(1e-6, -2e-6, &values)
    }

    #[test]
    fn conditions_hold_or_not() {
        let values = [998.0, 3.0, -2.0, 7.0];
        for text in [
            "density < 999 kg/m3",
            "0.9 g/L < density/1000",
            "r == 1 um and z < -1 um",
            "0 < r <= 1 um",
            "speed > 3 m/s or identity == 7",
            "not speed > 3 m/s",
            "abs(strain_rate) >= 2 Hz and not identity != 7 or speed < 0",
            "sqrt(r^2 + z^2) < 3 um",
            "speed != 0",
            "(speed > 3 m/s or identity == 7) and (r^2 + z^2) < 9 um^2",
            "not (speed > 3 m/s or (identity == 8 and (not z > 0)))",
        ] {
            assert!(holds(text, values), "{text}");
            assert!(!holds(&format!("not {text}"), values) || text.contains("or") || text.contains("and"));
        }
        let deep = |depth| format!("{}r > 0{}", "(".repeat(depth), ")".repeat(depth));
        assert!(holds(&deep(90), values) && Condition::parse(&deep(400), &FIELDS).is_err());
        let nan = [f64::NAN; 4];
        assert!(!holds("density < 1 kg/m3 or density >= 1 kg/m3", nan));
        assert!(holds("density != density", nan));
    }

    #[test]
    fn mistakes_are_shown_at_their_place() {
        for (text, blamed, message) in [
            ("density < 999", "density < 999", "cannot compare"),
            ("densty < 1 kg/m3", "densty", "unknown name `densty`"),
            ("density", "", "comparison"),
            ("density < 1 kg/m3 and", "", "expected"),
            ("density < 1 kg/m3 density", "d", "expected"),
            ("1 um < r < 3", "r < 3", "cannot compare"),
            ("(density < 1 kg/m3 or speed) and r < 1 um", ")", "comparison"),
            ("(density < 1 kg/m3", "", "expected"),
            ("", "", "expected"),
        ] {
            let error = Condition::parse(text, &FIELDS).unwrap_err();
            assert!(error.to_string().contains(message), "{text}: {error}");
            assert_eq!(error.blamed().unwrap(), blamed, "{text}: {error}");
        }
        for text in ["speed", "speed = 1 m/s", "(speed) and z < 0"] {
            let help = Condition::parse(text, &FIELDS).unwrap_err().help().unwrap().to_string();
            assert!(help.contains("compare with < <= > >= == or !="), "{text}: {help}");
        }
        let deep = format!("{}z < 1 um", "-(".repeat(200));
        for long in ["z < 1 um or ".repeat(200), deep] {
            let help = Condition::parse(&long, &FIELDS).unwrap_err().help().unwrap().to_string();
            assert!(help.contains("ask for less"), "{help}");
        }
    }
}
