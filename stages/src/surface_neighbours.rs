//! Boundary particles near a place: the surface as a set of points.

use meniscus_engine::bins::Bins;
use meniscus_engine::domain::{Domain, Image};
use meniscus_engine::store::bytes_of;

/// Boundary particles and their images, to be searched.
#[derive(Default)]
pub(crate) struct SurfaceNeighbours {
    count: usize,
    images: Vec<Image>,
    points: [Vec<f64>; 2],
    bins: Bins,
}

impl SurfaceNeighbours {
    /// Takes up the particles of the given numbers, from their places (m), to be searched within `reach` m.
    pub fn gather(&mut self, numbers: &[u32], places: [&[f64]; 2], reach: f64, domain: &Domain) {
        self.count = numbers.len();
        for (points, from) in self.points.iter_mut().zip(places) {
            points.clear();
            points.extend(numbers.iter().map(|&i| from[i as usize]));
        }
        domain.images(&self.points[0], &self.points[1], reach, &mut self.images);
        for image in &self.images {
            let source = image.source as usize;
            let (r, z) = domain.place(image, self.points[0][source], self.points[1][source]);
            self.points[0].push(r);
            self.points[1].push(z);
        }
        self.bins.build(&self.points[0], &self.points[1], reach);
    }

    /// Bytes that it holds.
    pub fn bytes(&self) -> usize {
        self.points.iter().map(bytes_of).sum::<usize>() + bytes_of(&self.images) + self.bins.bytes()
    }

    /// Whether a member is an image across the axis.
    pub fn is_mirrored(&self, member: usize) -> bool {
        member.checked_sub(self.count).is_some_and(|image| self.images[image].mirrored)
    }

    /// The place in the list of boundary particles behind a member that may be an image.
    pub fn source(&self, member: usize) -> usize {
        match member.checked_sub(self.count) {
            Some(image) => self.images[image].source as usize,
            None => member,
        }
    }

    /// The nearest member within reach that is `wanted`, and the way to it.
    pub fn nearest(
        &self,
        [r, z]: [f64; 2],
        reach: f64,
        wanted: impl Fn(usize) -> bool,
    ) -> Option<(usize, [f64; 2])> {
        let (mut best, mut least) = (None, reach * reach);
        self.bins.near(r, z, reach, |range| {
            for &member in &self.bins.members()[range] {
                let member = member as usize;
                let way = [self.points[0][member] - r, self.points[1][member] - z];
                let square = way[0] * way[0] + way[1] * way[1];
                if square < least && wanted(member) {
                    (best, least) = (Some((member, way)), square);
                }
            }
        });
        best
    }

    /// Slope of the pressure along the tangent at a member of known pressure, by weighted least squares over
    /// the members within reach (method.md, section 10, "The surface error, later", T); `there` gives a
    /// neighbour's area and pressure, if they are known. Where the members lie across the surface rather than along it, in
    /// spray, the slope over a particle's `size` stays below the largest difference of pressure.
    pub fn slope(
        &self,
        member: usize,
        pressure: f64,
        [reach, size]: [f64; 2],
        tangent: [f64; 2],
        there: impl Fn(u32) -> Option<(f64, f64)>,
    ) -> f64 {
        let [r, z] = [self.points[0][member], self.points[1][member]];
        let (mut upper, mut lower, mut largest) = (0.0, 0.0, 0.0_f64);
        let inverse = 1.0 / reach;
        self.bins.near(r, z, reach, |range| {
            for &member in &self.bins.members()[range] {
                let (dr, dz) = (self.points[0][member as usize] - r, self.points[1][member as usize] - z);
                let inside = 1.0 - (dr * dr + dz * dz).sqrt() * inverse;
                if inside > 0.0
                    && let Some((area, other)) = there(member)
                {
                    let along = dr * tangent[0] + dz * tangent[1];
                    let weight = area * inside * inside * inside;
                    upper += weight * (other - pressure) * along;
                    lower += weight * along * along;
                    largest = largest.max((other - pressure).abs());
                }
            }
        });
        let most = largest / size;
        if lower > 0.0 { (upper / lower).clamp(-most, most) } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where the search found no surface no pressure is known: it is not zero.
    #[test]
    fn what_is_not_known_does_not_count() {
        let (r, z) = ([5.0; 5], [0.0, 1.0, 2.0, 3.0, 4.0]);
        let mut near = SurfaceNeighbours::default();
        near.gather(&[0, 1, 2, 3, 4], [&r, &z], 3.0, &Domain::default());
        let pressure = |member: u32| 10.0 + 2.0 * f64::from(member);
        let there = |member: u32| (member != 3).then(|| (1.0, pressure(member)));
        let slope = near.slope(2, pressure(2), [3.0, 1.0], [0.0, 1.0], there);
        assert!((slope - 2.0).abs() < 1e-12, "{slope}");
        let (member, way) = near.nearest([5.0, 2.8], 3.0, |member| member != 3).expect("a member");
        assert_eq!(member, 2);
        assert!((way[1] + 0.8).abs() < 1e-12);
    }
}
