//! The observations of a run, row by row.

use super::observe::Quantity;

/// So many rows are kept at most, so that a run of any length takes the same memory. Odd: when every second
/// row goes, the first and the last stay.
const MOST_ROWS: usize = (1 << 14) + 1;

/// Observed quantities and their values at ever later times. Of more than some ten thousand rows every second
/// one is left out, again and again; the newest is always there.
#[derive(Clone, Debug, Default)]
pub struct History {
    quantities: Vec<Quantity>,
    rows: Vec<Vec<f64>>,
    /// Rows that were added so far.
    added: u64,
    /// log2 of how many added rows there are to one that is kept.
    thinned: u32,
}

impl History {
    /// A history without rows of the given quantities.
    pub fn new(quantities: Vec<Quantity>) -> Self {
        History { quantities, ..History::default() }
    }

    /// Adds one row.
    ///
    /// # Panics
    /// If it has not one value for each quantity.
    pub fn push(&mut self, row: Vec<f64>) {
        assert_eq!(row.len(), self.quantities.len(), "one value a quantity");
        // The newest row stays at least until the next one comes.
        if self.added > 0 && !self.is_kept(self.added - 1) {
            self.rows.pop();
        }
        self.rows.push(row);
        if self.rows.len() == MOST_ROWS && self.is_kept(self.added) {
            let mut index = 0;
            self.rows.retain(|_| {
                index += 1;
                index % 2 == 1
            });
            self.thinned += 1;
        }
        self.added += 1;
    }

    fn is_kept(&self, number: u64) -> bool {
        number.is_multiple_of(1 << self.thinned)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_history_is_thinned_evenly() {
        let mut history = History::new(vec![Quantity { name: "time".to_owned(), unit: "s" }]);
        let mut longest = 0;
        for number in 0..300_000 {
            history.push(vec![f64::from(number)]);
            longest = longest.max(history.rows.len());
            assert_eq!(history.rows.last().unwrap()[0], f64::from(number));
        }
        assert_eq!(longest, MOST_ROWS);
        let times = history.of("time");
        let (newest, kept) = times.split_last().unwrap();
        assert_eq!(*newest, 299_999.0);
        assert!(kept.len() > MOST_ROWS / 2);
        assert!(kept.iter().enumerate().all(|(k, time)| *time == 32.0 * k as f64), "{kept:?}");
    }
}
