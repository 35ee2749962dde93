//! The observations of a run, row by row.

use super::observe::Quantity;

/// Observed quantities and their values at ever later times.
#[derive(Clone, Debug, Default)]
pub struct History {
    quantities: Vec<Quantity>,
    rows: Vec<Vec<f64>>,
}

impl History {
    /// A history without rows of the given quantities.
    pub fn new(quantities: Vec<Quantity>) -> Self {
        History { quantities, rows: Vec::new() }
    }

    /// Adds one row.
    ///
    /// # Panics
    /// If it has not one value for each quantity.
    pub fn push(&mut self, row: Vec<f64>) {
        assert_eq!(row.len(), self.quantities.len(), "one value a quantity");
        self.rows.push(row);
    }

    /// The quantities, in the order of the values of a row.
    pub fn quantities(&self) -> &[Quantity] {
        &self.quantities
    }

    /// All values of the quantity of this name, oldest first; empty if there is none.
    pub fn of(&self, name: &str) -> Vec<f64> {
        let column = self.quantities.iter().position(|q| q.name == name);
        column.map_or_else(Vec::new, |column| self.rows.iter().map(|row| row[column]).collect())
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Mean of a quantity over the rows whose time, relative to the last one's, lies between two
    /// fractions; `None` if there is no such row.
    pub fn mean(&self, name: &str, from: f64, to: f64) -> Option<f64> {
        let (times, values) = (self.of("time"), self.of(name));
        let end = *times.last()?;
        let chosen = times.iter().zip(&values);
        let chosen = chosen.filter(|(time, _)| **time >= from * end && **time <= to * end);
        let (sum, count) = chosen.fold((0.0, 0.0), |(sum, count), (_, value)| (sum + value, count + 1.0));
        (count > 0.0).then(|| sum / count)
    }
}
