//! Particles near the surface, in rows of cells of the plane: what sums with wide kernels visit.

use meniscus_engine::bins::Bins;
use meniscus_engine::domain::{Domain, Image};
use meniscus_engine::lanes::WIDTH;
use meniscus_engine::store::bytes_of;

/// Size of a cell over the largest support radius, twice the usual one.
const FINENESS: f64 = 0.125;

/// Cells take up members for so many times the reach that is asked for, so that they need not soon be sorted again.
const SPARE: f64 = 1.1;

/// Particles as wide kernels sum them: in rows of cells, images at the axis and the period
/// included. The membership of cells is renewed with the neighbour list, positions every time. Only cells near places
/// that are asked for have members. What lies in a cell, and in which order, does not depend on which these
/// are: nor does any sum.
#[derive(Debug, Default)]
pub(crate) struct SurfacePoints {
    list_build: u64,
    images: Vec<Image>,
    bins: Bins,
    /// Number of particles, after which images are counted.
    particles: usize,
    /// Present positions of the members, m, in the order of the cells; and then zeros to fill the last lanes.
    pub r: Vec<f64>,
    pub z: Vec<f64>,
    /// Their areas, m2, likewise.
    pub area: Vec<f64>,
    slack: f64,
    /// Whether a cell has its members.
    has_members: Vec<bool>,
    /// How far from any place of a cell all cells have theirs, m.
    complete: Vec<f64>,
}

/// Columns and lengths from which points are taken up.
#[derive(Clone, Copy, Debug)]
pub struct Particles<'a> {
    /// Present positions, m.
    pub r: &'a [f64],
    /// Present positions, m.
    pub z: &'a [f64],
    /// Positions when the neighbour list was built, m.
    pub list_r: &'a [f64],
    /// Positions when the neighbour list was built, m.
    pub list_z: &'a [f64],
    /// Largest support radius that will be asked for, m.
    pub support: f64,
}

impl SurfacePoints {
    /// Takes up the particles' present positions (m) and areas (m2). `list_build` counts the builds of
    /// the neighbour list, between which no particle moves farther than `slack` metres. All that lies within a reach (m)
    /// of each of the `wanted` particles may then be visited.
    pub fn refresh(
        &mut self,
        source: &Particles,
        area: impl Fn(usize) -> f64,
        wanted: impl Iterator<Item = (u32, f64)> + Clone,
        list_build: u64,
        (slack, domain): (f64, &Domain),
    ) {
        let Particles { r, z, list_r, list_z, support } = *source;
        (self.slack, self.particles) = (slack, r.len());
        let is_new = self.list_build != list_build || self.complete.is_empty();
        if is_new {
            self.list_build = list_build;
            domain.images(list_r, list_z, support + 2.0 * slack, &mut self.images);
        }
        let images = &self.images;
        let place = |point: usize, r: &[f64], z: &[f64]| match point.checked_sub(r.len()) {
            None => (r[point], z[point]),
            Some(image) => {
                let source = images[image].source as usize;
                domain.place(&images[image], r[source], z[source])
            }
        };
        let count = r.len() + images.len();
        let listed = |point: usize| place(point, list_r, list_z);
        if is_new {
            self.bins.lay_out(count, listed, FINENESS * support);
        }
        // Both the particle and what it sees may have moved since the list was built; and all of this is rounded.
        let bins = &self.bins;
        let wanted = wanted.map(|(i, reach)| {
            let cell = bins.cell_of(list_r[i as usize], list_z[i as usize]);
            (cell, 1.001 * (reach + 2.0 * slack))
        });
        if is_new || wanted.clone().any(|(cell, reach)| self.complete[cell] < reach) {
            let (has_members, complete) = (&mut self.has_members, &mut self.complete);
            has_members.clear();
            has_members.resize(bins.cells(), false);
            complete.clear();
            complete.resize(bins.cells(), 0.0);
            for (cell, reach) in wanted {
                bins.cells_around(cell, 0.0, |cells| {
                    complete[cells].iter_mut().for_each(|complete| *complete = complete.max(SPARE * reach));
                });
            }
            for cell in (0..bins.cells()).filter(|&cell| complete[cell] > 0.0) {
                bins.cells_around(cell, complete[cell], |cells| has_members[cells].fill(true));
            }
            self.bins.sort(count, listed, |cell| self.has_members[cell]);
            let padded = self.bins.padded_members().len();
            for column in [&mut self.r, &mut self.z, &mut self.area] {
                column.clear();
                column.resize(padded, 0.0);
            }
        }
        let members = self.bins.members().iter();
        for (k, &member) in members.enumerate() {
            let member = member as usize;
            let source = member.checked_sub(r.len()).map_or(member, |image| images[image].source as usize);
            (self.r[k], self.z[k]) = place(member, r, z);
            self.area[k] = area(source);
        }
    }

    /// Of each member which particle it is, and whether it is mirrored.
    pub fn sources(&self) -> impl Iterator<Item = (usize, bool)> {
        self.bins.members().iter().map(|&member| match (member as usize).checked_sub(self.particles) {
            None => (member as usize, false),
            Some(image) => (self.images[image].source as usize, self.images[image].mirrored),
        })
    }

    /// Calls `visit` with the first of up to eight members, and how many there are from it on in its row of cells; they
    /// are all within `reach` metres of (r, z), and some more.
    #[inline(always)]
    pub fn within(&self, r: f64, z: f64, reach: f64, mut visit: impl FnMut(usize, usize)) {
        self.bins.within(r, z, reach + self.slack, |range| {
            for start in range.clone().step_by(WIDTH) {
                visit(start, range.end - start);
            }
        });
    }

    /// Bytes that the members take.
    pub fn bytes(&self) -> usize {
        let columns = [&self.r, &self.z, &self.area].into_iter().map(bytes_of).sum::<usize>();
        let cells = bytes_of(&self.has_members) + bytes_of(&self.complete);
        columns + cells + bytes_of(&self.images) + self.bins.bytes()
    }

    /// Number of members.
    #[cfg(test)]
    pub fn len(&self) -> usize {
        self.bins.members().len()
    }
}
