//! The differences between two checkpoints, as numbers.

use std::collections::{BTreeMap, HashMap};

use meniscus_engine::checkpoint::{CheckpointError, Clock, ColumnView, Mapped};
use serde::Serialize;

use super::columns::column;
use super::open::particles as length;
use super::print::number;

/// All differences between two checkpoints. The names of the entries are those of the JSON output.
#[derive(Debug, Serialize)]
pub struct Difference {
    /// Whether there is none that counts.
    pub same: bool,
    /// How particles were paired: by `identity` or by `order`.
    pub matched_by: &'static str,
    /// Differences of the clock, in sentences.
    pub clock: Vec<String>,
    /// Differences that do not count, in sentences.
    pub remarks: Vec<String>,
    pub particles_only_in_a: usize,
    pub particles_only_in_b: usize,
    pub fields_only_in_a: Vec<String>,
    pub fields_only_in_b: Vec<String>,
    pub fields: Vec<FieldDifference>,
}

/// How one field differs over the particles that both files have.
#[derive(Debug, Serialize)]
pub struct FieldDifference {
    pub name: String,
    pub unit: String,
    /// Infinite where only one of two values is finite.
    pub largest: f64,
    pub root_mean_square: f64,
    /// Number of particles beyond the tolerance.
    pub differing: usize,
    pub first: Option<First>,
}

/// The first particle, in the order of the first file, that differs in a field.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct First {
    /// Its identity, or its index where particles were matched by order.
    pub particle: u64,
    pub a: f64,
    pub b: f64,
}

/// Compares two checkpoints; `tolerance` is relative to the largest magnitude of each field.
pub fn compare(a: &Mapped, b: &Mapped, tolerance: f64) -> Result<Difference, CheckpointError> {
    let (columns_a, columns_b) = (a.columns()?, b.columns()?);
    let pairing = Pairing::of(&columns_a, &columns_b);
    let clock = clocks(a.clock(), b.clock(), tolerance);
    let mut remarks = Vec::new();
    if a.scene_hash() != b.scene_hash() {
        remarks.push("the scenes differ".to_owned());
    }
    if a.revision() != b.revision() {
        remarks.push(format!("revision {} against {}", a.revision(), b.revision()));
    }
    let mut fields = Vec::new();
    for one in &columns_a {
        if let Some(other) = column(&columns_b, one.name()) {
            fields.push(compare_field(*one, other, &pairing, tolerance));
        }
    }
    let mut difference = Difference {
        same: false,
        matched_by: if pairing.identities.is_some() { "identity" } else { "order" },
        clock,
        remarks,
        particles_only_in_a: length(&columns_a) - pairing.pairs.len(),
        particles_only_in_b: length(&columns_b) - pairing.pairs.len(),
        fields_only_in_a: missing(&columns_a, &columns_b),
        fields_only_in_b: missing(&columns_b, &columns_a),
        fields,
    };
    difference.same = difference.clock.is_empty()
        && difference.particles_only_in_a + difference.particles_only_in_b == 0
        && difference.fields_only_in_a.is_empty()
        && difference.fields_only_in_b.is_empty()
        && difference.fields.iter().all(|field| field.differing == 0);
    Ok(difference)
}

/// Which particle of one file is which of the other.
struct Pairing<'a> {
    pairs: Vec<(usize, usize)>,
    /// The first file's identities, where particles were matched by them.
    identities: Option<ColumnView<'a>>,
}

impl<'a> Pairing<'a> {
    fn of(a: &[ColumnView<'a>], b: &[ColumnView<'a>]) -> Self {
        Self::by_identity(a, b).unwrap_or_else(|| {
            let common = length(a).min(length(b));
            Self { pairs: (0..common).map(|index| (index, index)).collect(), identities: None }
        })
    }

    /// None where a file has no identities, or one of them twice.
    fn by_identity(a: &[ColumnView<'a>], b: &[ColumnView<'a>]) -> Option<Self> {
        let a = column(a, "identity")?;
        let (places_a, places_b) = (places(&a)?, places(&column(b, "identity")?)?);
        let mut pairs: Vec<(usize, usize)> = places_a
            .iter()
            .filter_map(|(identity, &index)| Some((index, *places_b.get(identity)?)))
            .collect();
        // A hash map's order is random; the first file's order makes "first" mean something.
        pairs.sort_unstable();
        Some(Self { pairs, identities: Some(a) })
    }

    /// What to call a particle of the first file.
    fn name(&self, index: usize) -> u64 {
        let identity = self.identities.and_then(|column| column.value(index));
        identity.map_or(index as u64, |identity| identity as u64)
    }
}

/// Where each identity stands; none where they are no whole numbers or one occurs twice.
fn places(identities: &ColumnView<'_>) -> Option<HashMap<u64, usize>> {
    let places: HashMap<u64, usize> =
        identities.values().enumerate().map(|(index, identity)| (identity as u64, index)).collect();
    (identities.is_integer() && places.len() == identities.len()).then_some(places)
}

fn compare_field(
    a: ColumnView<'_>,
    b: ColumnView<'_>,
    pairing: &Pairing<'_>,
    tolerance: f64,
) -> FieldDifference {
    let magnitudes = a.values().chain(b.values()).map(f64::abs);
    let scale = magnitudes.filter(|value| value.is_finite());
    let allowed = if a.is_integer() && b.is_integer() { 0.0 } else { tolerance * scale.fold(0.0, f64::max) };
    let mut result = FieldDifference {
        name: a.name().to_owned(),
        unit: a.unit().to_owned(),
        largest: 0.0,
        root_mean_square: 0.0,
        differing: 0,
        first: None,
    };
    let mut squares = 0.0;
    for &(index_a, index_b) in &pairing.pairs {
        let (Some(a), Some(b)) = (a.value(index_a), b.value(index_b)) else {
            continue;
        };
        let distance = distance(a, b);
        squares += distance * distance;
        result.largest = result.largest.max(distance);
        if distance > allowed {
            result.differing += 1;
            let particle = pairing.name(index_a);
            result.first.get_or_insert(First { particle, a, b });
        }
    }
    result.root_mean_square = (squares / pairing.pairs.len().max(1) as f64).sqrt();
    result
}

/// How far two values are apart; a value that is not a number equals itself here.
fn distance(a: f64, b: f64) -> f64 {
    if a == b || (a.is_nan() && b.is_nan()) {
        return 0.0;
    }
    let distance = (a - b).abs();
    if distance.is_nan() { f64::INFINITY } else { distance }
}

fn clocks(a: &Clock, b: &Clock, tolerance: f64) -> Vec<String> {
    let mut sentences = Vec::new();
    if a.step != b.step {
        sentences.push(format!("step {} against {}", a.step, b.step));
    }
    let (a, b) = (numbers(a), numbers(b));
    for (name, &one) in &a {
        match b.get(name) {
            Some(&other) => {
                let allowed = tolerance * one.abs().max(other.abs());
                let apart = distance(one, other);
                if apart > allowed || apart.is_infinite() {
                    sentences.push(format!("{name} {one:e} against {other:e}"));
                }
            }
            None => sentences.push(format!("{name} {} against none", number(one))),
        }
    }
    for (name, &other) in b.iter().filter(|(name, _)| !a.contains_key(*name)) {
        sentences.push(format!("{name} none against {}", number(other)));
    }
    sentences
}

fn numbers(clock: &Clock) -> BTreeMap<&str, f64> {
    let scalars = clock.scalars.iter();
    let mut numbers: BTreeMap<&str, f64> = scalars.map(|(name, value)| (name.as_str(), *value)).collect();
    numbers.extend([("time", clock.time), ("last step size", clock.step_size)]);
    numbers
}

fn missing(columns: &[ColumnView<'_>], others: &[ColumnView<'_>]) -> Vec<String> {
    let missing = columns.iter().filter(|one| column(others, one.name()).is_none());
    missing.map(|column| column.name().to_owned()).collect()
}
