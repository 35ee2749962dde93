//! What lies near some particles: cells of a coarse grid.

use meniscus_engine::store::bytes_of;

/// Cells of a uniform grid over the plane, marked where some particles are near.
#[derive(Debug, Default)]
pub(crate) struct SurfaceLayer {
    r_least: f64,
    z_least: f64,
    inverse_cell: f64,
    columns: usize,
    marked: Vec<bool>,
}

impl SurfaceLayer {
    /// Marks what lies within `reach` metres of the chosen among particles at (r, z), and some more; the grid goes
    /// so far beyond all particles.
    pub fn mark(&mut self, [r, z]: [&[f64]; 2], chosen: &[u32], reach: f64) {
        let (mut least, mut most) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for (&r, &z) in r.iter().zip(z) {
            least = [least[0].min(r), least[1].min(z)];
            most = [most[0].max(r), most[1].max(z)];
        }
        let mut cell = reach;
        let most_cells = 4.0 * r.len() as f64 + 1024.0;
        let count = |cell: f64, axis: usize| ((most[axis] - least[axis]).max(0.0) / cell).floor() + 3.0;
        while count(cell, 0) * count(cell, 1) > most_cells {
            cell *= 1.5;
        }
        (self.r_least, self.z_least, self.inverse_cell) = (least[0] - cell, least[1] - cell, 1.0 / cell);
        self.columns = count(cell, 1) as usize;
        self.marked.clear();
        self.marked.resize(count(cell, 0) as usize * self.columns, false);
        for &i in chosen {
            // The grid's rim of one cell makes room for all neighbours.
            let centre = self.cell(r[i as usize], z[i as usize]).unwrap_or(0);
            for row in [centre.saturating_sub(self.columns), centre, centre + self.columns] {
                let last = (row + 2).min(self.marked.len());
                self.marked[row.saturating_sub(1).min(last)..last].fill(true);
            }
        }
    }

    /// Whether a place in m lies in a marked cell.
    pub fn contains(&self, r: f64, z: f64) -> bool {
        self.cell(r, z).is_some_and(|cell| self.marked[cell])
    }

    fn cell(&self, r: f64, z: f64) -> Option<usize> {
        let (row, column) = ((r - self.r_least) * self.inverse_cell, (z - self.z_least) * self.inverse_cell);
        let inside = row >= 0.0 && column >= 0.0 && column < self.columns as f64;
        let cell = row as usize * self.columns + column as usize;
        (inside && cell < self.marked.len()).then_some(cell)
    }

    /// Bytes that the cells take.
    pub fn bytes(&self) -> usize {
        bytes_of(&self.marked)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whatever_is_within_reach_is_contained() {
        let r: Vec<f64> = (0..500).map(|i| (f64::from(i) * 0.618).fract() * 3.0).collect();
        let z: Vec<f64> = (0..500).map(|i| (f64::from(i) * 0.414).fract() * 5.0).collect();
        let chosen = [3, 77, 450];
        let mut layer = SurfaceLayer::default();
        layer.mark([&r, &z], &chosen, 0.4);
        let near =
            |i: usize| chosen.iter().any(|&c| (r[i] - r[c as usize]).hypot(z[i] - z[c as usize]) < 0.4);
        assert!((0..500).all(|i| !near(i) || layer.contains(r[i], z[i])));
        let contained = (0..500).filter(|&i| layer.contains(r[i], z[i])).count();
        assert!(contained < 250, "{contained} of 500");
        for &c in &chosen {
            let (r, z) = (r[c as usize], z[c as usize]);
            assert!(layer.contains(r - 0.39, z) && layer.contains(r, z + 0.39));
        }
        assert!(
            !layer.contains(100.0, 0.0) && !layer.contains(0.0, -100.0) && !layer.contains(f64::NAN, 0.0)
        );
    }
}
