//! Help for names that are not known: the nearest one, then all.

/// A help text that lists what is known and names the nearest.
pub(super) fn help(what: &str, given: &str, known: &[&str]) -> String {
    if known.is_empty() {
        return format!("there are no {what} here");
    }
    let list = known.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    match nearest(given, known) {
        Some(name) => format!("did you mean `{name}`? known {what}: {list}"),
        None => format!("known {what}: {list}"),
    }
}

fn nearest<'a>(given: &str, known: &[&'a str]) -> Option<&'a str> {
    let best = known.iter().map(|name| (distance(given, name), *name)).min()?;
    let letters = given.chars().count();
    // Where every letter is another one, nothing tells that this name was meant.
    (best.0 <= 1.max(letters / 3) && best.0 < letters).then_some(best.1)
}

/// Edits (insert, delete, replace) that turn one word into the other.
fn distance(first: &str, second: &str) -> usize {
    let second: Vec<char> = second.to_lowercase().chars().collect();
    let mut row: Vec<usize> = (0..=second.len()).collect();
    for (index, left) in first.to_lowercase().chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = index + 1;
        for (column, right) in second.iter().enumerate() {
            let replaced = diagonal + usize::from(left != *right);
            diagonal = row[column + 1];
            row[column + 1] = replaced.min(diagonal + 1).min(row[column] + 1);
        }
    }
    row[second.len()]
}
