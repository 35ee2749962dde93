//! Settings that take several values.

use crate::failure::Failure;

/// A key of a scene and the values that it takes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Variation {
    /// A parameter, or a dotted key.
    pub(crate) key: String,
    /// Its values as they are written, at least one.
    pub(crate) values: Vec<String>,
}

impl Variation {
    /// Reads `key=a,b,c`. A comma in brackets parts no values.
    pub(crate) fn parse(text: &str) -> Result<Self, Failure> {
        let refuse = || {
            let help = "write it like --vary particle_size='50 nm','25 nm'";
            Failure::input(format!("`--vary {text}` is no list of values: {help}"))
        };
        let (key, list) = text.split_once('=').ok_or_else(refuse)?;
        let mut depth = 0i32;
        let values = list.split(|letter| {
            depth += match letter {
                '(' | '[' | '{' => 1,
                ')' | ']' | '}' => -1,
                _ => 0,
            };
            letter == ',' && depth == 0
        });
        let values: Vec<String> = values.map(|value| value.trim().to_owned()).collect();
        if key.trim().is_empty() || values.iter().any(String::is_empty) {
            return Err(refuse());
        }
        Ok(Variation { key: key.trim().to_owned(), values })
    }
}

/// Refuses keys that are varied twice, or varied and set.
pub(crate) fn check_keys(variations: &[Variation], set: &[String]) -> Result<(), Failure> {
    let set = set.iter().filter_map(|setting| setting.split_once('=')).map(|(key, _)| key.trim());
    let mut seen: Vec<&str> = set.collect();
    for Variation { key, .. } in variations {
        if seen.contains(&key.as_str()) {
            return Err(Failure::input(format!("`{key}` is given more than once; name it in one --vary")));
        }
        seen.push(key);
    }
    Ok(())
}

/// Every combination of values, the last key's varying fastest.
pub(crate) fn combinations(variations: &[Variation]) -> Vec<Vec<String>> {
    variations.iter().fold(vec![Vec::new()], |before, variation| {
        let extended = before.iter().flat_map(|values| {
            let longer = |value: &String| [&values[..], std::slice::from_ref(value)].concat();
            variation.values.iter().map(longer).collect::<Vec<_>>()
        });
        extended.collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_parted_at_commas_outside_brackets() {
        let variation = Variation::parse("size=max(1, 2) um, 50 nm").unwrap();
        assert_eq!(variation.key, "size");
        assert_eq!(variation.values, ["max(1, 2) um", "50 nm"]);
        for bad in ["size", "size=", "=1", "size=1,,2"] {
            assert!(Variation::parse(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn the_product_has_every_combination_once() {
        let variations = ["a=1,2", "b=3,4,5"].map(|text| Variation::parse(text).unwrap());
        let all = combinations(&variations);
        assert_eq!(all.len(), 6);
        assert_eq!(all[1], ["1", "4"]);
        assert!(check_keys(&variations, &["c=1".to_owned()]).is_ok());
        assert!(check_keys(&variations, &["a=1".to_owned()]).is_err());
    }
}
