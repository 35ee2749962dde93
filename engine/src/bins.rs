//! A uniform grid of cells over points of the plane; the points of neighbouring cells in one row of
//! the grid lie next to each other.

use crate::lanes::WIDTH;
use crate::store::bytes_of;
use std::ops::Range;

/// Points sorted into the cells of a uniform grid.
#[derive(Clone, Debug, Default)]
pub struct Bins {
    r_least: f64,
    z_least: f64,
    inverse_cell: f64,
    rows: usize,
    columns: usize,
    start: Vec<u32>,
    /// And then zeros to fill the last lanes.
    members: Vec<u32>,
}

impl Bins {
    /// Sorts points into cells of at least the given size in metres. Cells grow where the points lie
    /// so far apart that an ordinary grid would have many more cells than points.
    pub fn build(&mut self, r: &[f64], z: &[f64], cell: f64) {
        self.build_of(r.len(), |point| (r[point], z[point]), cell);
    }

    /// The same for `count` points of which `place` tells (r, z), always the same.
    pub fn build_of(&mut self, count: usize, place: impl Fn(usize) -> (f64, f64), cell: f64) {
        self.lay_out(count, &place, cell);
        self.sort(count, place, |_| true);
    }

    /// The first half of [`Bins::build_of`]: the cells, without members.
    pub fn lay_out(&mut self, count: usize, place: impl Fn(usize) -> (f64, f64), cell: f64) {
        let mut least = [f64::INFINITY; 2];
        let mut most = [f64::NEG_INFINITY; 2];
        for (r, z) in (0..count).map(&place) {
            least = [least[0].min(r), least[1].min(z)];
            most = [most[0].max(r), most[1].max(z)];
        }
        if count == 0 {
            (least, most) = ([0.0; 2], [0.0; 2]);
        }
        let [r_least, z_least] = least;
        let (height, width) = (most[0] - r_least, most[1] - z_least);
        let mut cell = cell;
        let most_cells = 16.0 * count as f64 + 1024.0;
        while (height / cell + 1.0) * (width / cell + 1.0) > most_cells {
            cell *= 1.5;
        }
        (self.r_least, self.z_least, self.inverse_cell) = (r_least, z_least, 1.0 / cell);
        self.rows = (height / cell) as usize + 1;
        self.columns = (width / cell) as usize + 1;
    }

    /// The second half: takes up the points whose cell is kept. A cell's members come in their order, whatever others
    /// are kept.
    pub fn sort(&mut self, count: usize, place: impl Fn(usize) -> (f64, f64), keep: impl Fn(usize) -> bool) {
        let cells = self.cells();
        let (mut start, mut members) = (std::mem::take(&mut self.start), std::mem::take(&mut self.members));
        start.clear();
        start.resize(cells + 1, 0);
        let kept = |point: usize| {
            let (r, z) = place(point);
            Some(self.cell_of(r, z)).filter(|&cell| keep(cell))
        };
        for cell in (0..count).filter_map(kept) {
            start[cell + 1] += 1;
        }
        for cell in 0..cells {
            start[cell + 1] += start[cell];
        }
        let total = start[cells];
        members.clear();
        members.resize(total as usize + WIDTH, 0);
        // Filling from the back with the ends of the cells leaves `start` as the starts.
        for point in (0..count).rev() {
            if let Some(cell) = kept(point) {
                let slot = &mut start[cell + 1];
                *slot -= 1;
                members[*slot as usize] = point as u32;
            }
        }
        // `start[c + 1]` now holds the start of cell c: move it down by one.
        start.rotate_left(1);
        start[cells] = total;
        (self.start, self.members) = (start, members);
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.rows * self.columns
    }

    /// Number of the cell at (r, z).
    #[inline]
    pub fn cell_of(&self, r: f64, z: f64) -> usize {
        let [row, column] = self.place(r, z);
        cell(row, self.rows) * self.columns + cell(column, self.columns)
    }

    /// Calls `visit` with ranges of cells that together hold every place within `reach` metres of any place of a cell.
    pub fn cells_around(&self, of: usize, reach: f64, mut visit: impl FnMut(Range<usize>)) {
        let steps = (reach * self.inverse_cell) as usize + 1;
        let (row, column) = (of / self.columns, of % self.columns);
        let (first, last) = (column.saturating_sub(steps), (column + steps).min(self.columns - 1));
        for row in row.saturating_sub(steps)..=(row + steps).min(self.rows - 1) {
            visit(row * self.columns + first..row * self.columns + last + 1);
        }
    }

    /// Bytes that cells and members take.
    pub fn bytes(&self) -> usize {
        bytes_of(&self.start) + bytes_of(&self.members)
    }

    /// The points in the order of the cells.
    pub fn members(&self) -> &[u32] {
        &self.members[..self.members.len().saturating_sub(WIDTH)]
    }

    /// The same, and then zeros: as many lanes as there are can be loaded from any place of a point.
    pub fn padded_members(&self) -> &[u32] {
        &self.members
    }

    /// Calls `visit` with ranges of [`Bins::members`] that together hold every point within `reach`
    /// metres of (r, z), and some more: what lies in a square of cells.
    #[inline]
    pub fn near(&self, r: f64, z: f64, reach: f64, mut visit: impl FnMut(Range<usize>)) {
        let [row, column] = self.place(r, z);
        let reach = reach * self.inverse_cell;
        let (first, last) = (cell(column - reach, self.columns), cell(column + reach, self.columns));
        for number in cell(row - reach, self.rows)..=cell(row + reach, self.rows) {
            self.visit(number, first, last, &mut visit);
        }
    }

    /// The same of a disc of cells: fewer points where `reach` is that of many cells.
    #[inline]
    pub fn within(&self, r: f64, z: f64, reach: f64, mut visit: impl FnMut(Range<usize>)) {
        let [row, column] = self.place(r, z);
        // A little wider than by the circle, for all of this is rounded.
        let reach = reach * self.inverse_cell + 1e-6;
        for number in cell(row - reach, self.rows)..=cell(row + reach, self.rows) {
            let away = (number as f64 - row).max(row - (number + 1) as f64).max(0.0);
            let half = (reach * reach - away * away).max(0.0).sqrt();
            let (first, last) = (cell(column - half, self.columns), cell(column + half, self.columns));
            self.visit(number, first, last, &mut visit);
        }
    }

    /// A place in cells from the first one on.
    #[inline]
    fn place(&self, r: f64, z: f64) -> [f64; 2] {
        [r - self.r_least, z - self.z_least].map(|length| length * self.inverse_cell)
    }

    #[inline]
    fn visit(&self, row: usize, first: usize, last: usize, visit: &mut impl FnMut(Range<usize>)) {
        let base = row * self.columns;
        let range = self.start[base + first] as usize..self.start[base + last + 1] as usize;
        if !range.is_empty() {
            visit(range);
        }
    }
}

/// The cell at a place, of so many.
#[inline]
fn cell(place: f64, count: usize) -> usize {
    (place.max(0.0) as usize).min(count - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_point_within_reach_is_visited_once() {
        let points: Vec<(f64, f64)> =
            (0..500).map(|i| ((i as f64 * 0.618).fract() * 3.0, (i as f64 * 0.414).fract() * 5.0)).collect();
        let (r, z): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
        let mut bins = Bins::default();
        bins.build(&r, &z, 0.3);
        let mut visited = [0; 2];
        for &(pr, pz) in &points {
            let mut found = [Vec::new(), Vec::new()];
            bins.near(pr, pz, 0.7, |range| found[0].extend_from_slice(&bins.members()[range]));
            bins.within(pr, pz, 0.7, |range| found[1].extend_from_slice(&bins.members()[range]));
            (0..2).for_each(|way| visited[way] += found[way].len());
            for found in found {
                let mut unique = found.clone();
                unique.sort_unstable();
                unique.dedup();
                assert_eq!(unique.len(), found.len());
                for (k, &(qr, qz)) in points.iter().enumerate() {
                    let near = (qr - pr).hypot(qz - pz) <= 0.7;
                    assert!(!near || unique.binary_search(&(k as u32)).is_ok());
                }
            }
        }
        assert!(visited[1] < visited[0]);
    }
}
