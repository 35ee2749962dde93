//! Sources sorted into square cells, so that a particle meets only those in its reach.

use super::domain::{Point, Source};

/// Sources row by row of unit cells; a stretch of cells in a row is one contiguous range.
#[derive(Default)]
pub(super) struct Cells {
    origin: Point,
    columns: usize,
    rows: usize,
    starts: Vec<usize>,
    sorted: Vec<Source>,
}

impl Cells {
    /// Sorts `sources`; within a cell they keep their order, so that sums are reproducible.
    pub fn fill(&mut self, sources: &[Source]) {
        let bound = |axis: usize, pick: fn(f64, f64) -> f64, from: f64| {
            sources.iter().fold(from, |bound, source| pick(bound, source.point[axis]))
        };
        self.origin = [bound(0, f64::min, f64::INFINITY), bound(1, f64::min, f64::INFINITY)];
        let top = [bound(0, f64::max, f64::NEG_INFINITY), bound(1, f64::max, f64::NEG_INFINITY)];
        self.columns = (top[0] - self.origin[0]) as usize + 1;
        self.rows = (top[1] - self.origin[1]) as usize + 1;

        let cell = |source: &Source| {
            let column = (source.point[0] - self.origin[0]) as usize;
            let row = (source.point[1] - self.origin[1]) as usize;
            row * self.columns + column
        };
        // Counting sort: after the placing loop each entry has moved up to the next cell's start.
        let mut ends = vec![0; self.columns * self.rows + 1];
        for source in sources {
            ends[cell(source) + 1] += 1;
        }
        for index in 1..ends.len() {
            ends[index] += ends[index - 1];
        }
        self.starts.clone_from(&ends);
        self.sorted.clear();
        self.sorted.resize(sources.len(), Source { point: [0.0; 2], area: 0.0 });
        for source in sources {
            let place = &mut ends[cell(source)];
            self.sorted[*place] = *source;
            *place += 1;
        }
    }

    /// Every source in a box of half side `reach` around `point`, and some more, in a fixed order.
    pub fn near(&self, point: Point, reach: f64) -> impl Iterator<Item = &Source> {
        let span = |axis: usize, cells: usize| {
            let place = point[axis] - self.origin[axis];
            // Casting clips negative numbers at zero.
            ((place - reach) as usize, ((place + reach) as usize).min(cells - 1))
        };
        let ((left, right), (bottom, top)) = (span(0, self.columns), span(1, self.rows));
        (bottom..=top).flat_map(move |row| {
            let row = row * self.columns;
            self.sorted[self.starts[row + left.min(right)]..self.starts[row + right + 1]].iter()
        })
    }
}
