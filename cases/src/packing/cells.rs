//! Sources sorted into square cells, so that a particle meets only those in its reach.

use super::domain::{Point, Source};
use meniscus_engine::lanes::{Lanes, WIDTH};
use std::ops::Range;

/// Sources row by row of unit cells; a stretch of cells in a row is one contiguous range.
#[derive(Default)]
pub(super) struct Cells {
    origin: Point,
    columns: usize,
    rows: usize,
    starts: Vec<u32>,
    /// The cell of every source, in their order.
    cell_of: Vec<u32>,
    /// r, z and area of the sources in the order of their cells, and then what fills the last lanes.
    pub sorted: [Vec<f64>; 3],
}

impl Cells {
    /// Sorts `sources`; within a cell they keep their order, so that sums are reproducible.
    pub fn fill(&mut self, sources: &[Source]) {
        let none = [f64::INFINITY, f64::NEG_INFINITY];
        let [r, z] = sources.iter().fold([none; 2], |bounds, source| {
            std::array::from_fn(|axis| {
                let [least, most] = bounds[axis];
                [least.min(source.point[axis]), most.max(source.point[axis])]
            })
        });
        self.origin = [r[0], z[0]];
        self.columns = (r[1] - r[0]) as usize + 1;
        self.rows = (z[1] - z[0]) as usize + 1;

        // Counting sort, from the back: each cell's end moves down to its start.
        self.starts.clear();
        self.starts.resize(self.columns * self.rows + 1, 0);
        self.cell_of.clear();
        for source in sources {
            let column = (source.point[0] - self.origin[0]) as usize;
            let row = (source.point[1] - self.origin[1]) as usize;
            let cell = row * self.columns + column;
            self.cell_of.push(cell as u32);
            self.starts[cell] += 1;
        }
        let mut end = 0;
        for start in &mut self.starts {
            end += *start;
            *start = end;
        }
        let [r, z, area] = &mut self.sorted;
        for column in [&mut *r, &mut *z, &mut *area] {
            column.resize(sources.len() + WIDTH, 0.0);
        }
        for (source, &cell) in sources.iter().zip(&self.cell_of).rev() {
            let place = &mut self.starts[cell as usize];
            *place -= 1;
            let place = *place as usize;
            (r[place], z[place], area[place]) = (source.point[0], source.point[1], source.area);
        }
    }

    /// Calls `visit` with the ways r and z from `point` to eight sources at a time, their distances and areas: every source
    /// in a box of half side `reach`, and some more. What fills the last lanes has no area.
    #[inline(always)]
    pub fn around(&self, point: Point, reach: f64, mut visit: impl FnMut([Lanes; 2], Lanes, Lanes)) {
        let [r, z, area] = &self.sorted;
        let [point_r, point_z] = point.map(Lanes::splat);
        for range in self.near(point, reach) {
            for start in range.clone().step_by(WIDTH) {
                let load = |column: &[f64]| Lanes::load(&column[start..]);
                let (dr, dz) = (load(r) - point_r, load(z) - point_z);
                let area = load(area).keep_first((range.end - start).min(WIDTH));
                visit([dr, dz], dr.mul_add(dr, dz * dz).sqrt(), area);
            }
        }
    }

    /// Ranges of `sorted` that together hold every source in a box of half side `reach` around `point`, and
    /// some more, in a fixed order.
    pub fn near(&self, point: Point, reach: f64) -> impl Iterator<Item = Range<usize>> {
        let span = |axis: usize, cells: usize| {
            let place = point[axis] - self.origin[axis];
            // Casting clips negative numbers at zero.
            ((place - reach) as usize, ((place + reach) as usize).min(cells - 1))
        };
        let ((left, right), (bottom, top)) = (span(0, self.columns), span(1, self.rows));
        (bottom..=top).map(move |row| {
            let row = row * self.columns;
            self.starts[row + left.min(right)] as usize..self.starts[row + right + 1] as usize
        })
    }
}
