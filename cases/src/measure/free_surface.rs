//! The area of any free surface, from where its particles have found it.

use crate::assemble::Physics;
use meniscus_engine::bins::Bins;
use meniscus_engine::domain::Domain;
use meniscus_engine::store::Store;
use meniscus_stages::fields;
use meniscus_stages::surface::{BOUNDARY, length};
use std::f64::consts::PI;

/// How far apart, in particle sizes, neighbouring points of a surface can lie: in creases gaps are wide.
const REACH: f64 = 8.0;
/// Part of that within which points tell the surface's direction.
const CLOSE: f64 = 0.5;
/// How much farther across the surface than along it, in particle sizes, the next point may lie: of points so close to each
/// other chance decides where they lie.
const ACROSS: f64 = 0.2;
/// Points that are no farther apart, in particle sizes, are one. Which of them lies on which side is chance: where both
/// lay on the same, a piece of the surface was counted twice, some per cent of a small drop's. (With a tenth some still were:
/// .9 % of the area for two outputs of a splash.)
const MERGED: f64 = 0.3;
/// How many times farther away the next point may lie than the farther of that one's own two next points does: else it is no end of a gap, and
/// the other point lies beside the surface. (One between the sides of a crease was two per cent of a splash's area, for one output.)
const LONELY: f64 = 2.0;
/// Slope towards the axis from which on a surface that ends does not go on across it.
const STEEP: f64 = 2.0;

/// Area of the free surface in m2; `None` where the pipeline doesn't look for the surface's place.
///
/// Every boundary particle knows the way to the surface: where it ends lies a point of the surface. What lies
/// halfway to the next such point on either side, turned about the axis, is its share. A pole that its ring has just left is
/// closed by a disc.
pub(super) fn area(store: &Store, physics: &Physics) -> Option<f64> {
    let (size, origin) = (physics.particle_size, physics.domain.origin);
    let (r, z) = feet(store)?;
    let spots = merged([&r, &z, &sizes(store, origin)?], MERGED * size, &physics.domain);
    Some(Points::new(spots, REACH * size, &physics.domain).area(origin))
}

/// Sizes of the boundary particles, m: those of rings that were drawn in to the axis are several times the others'.
fn sizes(store: &Store, origin: f64) -> Option<Vec<f64>> {
    let column = |name: &str| store.by_name::<f64>(name);
    let r = column(fields::RADIUS.description.name)?;
    let mass = column(fields::MASS.description.name)?;
    let density = column(fields::DENSITY.description.name)?;
    let size = |i: usize| (mass[i] / (2.0 * PI * (r[i] + origin) * density[i])).sqrt();
    Some(with_surface(store)?.into_iter().map(size).collect())
}

/// The points of the surface, r and z in m; `None` where the pipeline doesn't look for them.
pub(super) fn feet(store: &Store) -> Option<(Vec<f64>, Vec<f64>)> {
    let column = |name: &str| store.by_name::<f64>(name);
    let (r, z) = (column(fields::RADIUS.description.name)?, column(fields::AXIAL.description.name)?);
    let offset_r = column(fields::SURFACE_OFFSET_R.description.name)?;
    let offset_z = column(fields::SURFACE_OFFSET_Z.description.name)?;
    Some(with_surface(store)?.into_iter().map(|i| (r[i] + offset_r[i], z[i] + offset_z[i])).unzip())
}

/// The boundary particles that have found a surface: around a hole in the liquid there are others.
fn with_surface(store: &Store) -> Option<Vec<usize>> {
    let surface = store.by_name::<u32>(fields::SURFACE.description.name)?;
    let offset_r = store.by_name::<f64>(fields::SURFACE_OFFSET_R.description.name)?;
    let offset_z = store.by_name::<f64>(fields::SURFACE_OFFSET_Z.description.name)?;
    let has_found = |&i: &usize| surface[i] == BOUNDARY && (offset_r[i], offset_z[i]) != (0.0, 0.0);
    Some((0..surface.len()).filter(has_found).collect())
}

/// Points of the surface, m: r, z and the sizes of their particles.
type Spots = [Vec<f64>; 3];

/// The points, without those that lie within `distance` m of one before, or of an image of it.
fn merged([r, z, sizes]: [&[f64]; 3], distance: f64, domain: &Domain) -> Spots {
    let (count, mut bins) = (r.len(), Bins::default());
    let (r, z, sources) = with_images(r.to_vec(), z.to_vec(), distance, domain);
    bins.build(&r, &z, distance);
    let mut is_kept = vec![true; count];
    for point in 0..count {
        let is_one = |other: usize| {
            let source = other.checked_sub(count).map_or(other, |image| sources[image] as usize);
            source < point && is_kept[source] && length([r[other] - r[point], z[other] - z[point]]) < distance
        };
        let mut has_one = false;
        bins.near(r[point], z[point], distance, |range| {
            has_one |= bins.members()[range].iter().any(|&other| is_one(other as usize));
        });
        is_kept[point] = !has_one;
    }
    let kept =
        |column: &[f64]| (0..count).filter(|&point| is_kept[point]).map(|point| column[point]).collect();
    [kept(&r), kept(&z), kept(sizes)]
}

/// Points in the plane and then their images within `reach` m of any, all in m, and whose images these are.
fn with_images(
    mut r: Vec<f64>,
    mut z: Vec<f64>,
    reach: f64,
    domain: &Domain,
) -> (Vec<f64>, Vec<f64>, Vec<u32>) {
    let mut images = Vec::new();
    domain.images(&r, &z, reach, &mut images);
    for image in &images {
        let source = image.source as usize;
        let (image_r, image_z) = domain.place(image, r[source], z[source]);
        r.push(image_r);
        z.push(image_z);
    }
    (r, z, images.iter().map(|image| image.source).collect())
}

/// Points of the surface in the plane and then their images, m.
struct Points {
    r: Vec<f64>,
    z: Vec<f64>,
    /// Sizes of the points' particles, m.
    sizes: Vec<f64>,
    /// Whose images the others are.
    sources: Vec<u32>,
    reach: f64,
    bins: Bins,
}

impl Points {
    fn new([r, z, sizes]: Spots, reach: f64, domain: &Domain) -> Self {
        let (r, z, sources) = with_images(r, z, reach, domain);
        let mut bins = Bins::default();
        bins.build(&r, &z, 0.5 * CLOSE * reach);
        Points { r, z, sizes, sources, reach, bins }
    }

    /// Calls `visit` with the points within `reach` m of one, the ways to them, and their lengths.
    fn near(&self, point: usize, reach: f64, mut visit: impl FnMut(usize, [f64; 2], f64)) {
        let (r, z) = (self.r[point], self.z[point]);
        self.bins.near(r, z, reach, |range| {
            for &other in &self.bins.members()[range] {
                let way = [self.r[other as usize] - r, self.z[other as usize] - z];
                let distance = length(way);
                if distance < reach && other as usize != point {
                    visit(other as usize, way, distance);
                }
            }
        });
    }

    /// The direction in which the points about one spread most. (The way from a particle that lies close to
    /// the surface may point anywhere, so it doesn't tell.)
    fn tangent(&self, point: usize) -> [f64; 2] {
        let (mut difference, mut product) = (0.0, 0.0);
        let close = CLOSE * self.reach;
        self.near(point, close, |_, [dr, dz], distance| {
            // The next points count most: at a narrow rim those farther away lie on its other side.
            let weight = (1.0 - distance / close).powi(6);
            difference += weight * (dr * dr - dz * dz);
            product += weight * dr * dz;
        });
        let (sine, cosine) = (0.5 * f64::atan2(2.0 * product, difference)).sin_cos();
        [cosine, sine]
    }

    /// The nearest point on either side, towards the tangent the second.
    fn next(&self, point: usize, tangent: [f64; 2]) -> [Option<Next>; 2] {
        let mut next: [Option<Next>; 2] = [None; 2];
        self.near(point, self.reach, |other, [dr, dz], distance| {
            let along = dr * tangent[0] + dz * tangent[1];
            let across = dr * tangent[1] - dz * tangent[0];
            let side = &mut next[usize::from(along > 0.0)];
            // What lies steeply above or below belongs to another part of the surface.
            if across.abs() <= along.abs() + ACROSS * self.sizes[point]
                && side.is_none_or(|nearest| distance < nearest.distance)
            {
                let count = self.sizes.len();
                let source = if other < count { other } else { self.sources[other - count] as usize };
                *side = Some(Next { source, distance, rise: dr });
            }
        });
        next
    }

    /// Area in m2 with the axis at r = -origin.
    fn area(&self, origin: f64) -> f64 {
        let tangents: Vec<[f64; 2]> = (0..self.sizes.len()).map(|point| self.tangent(point)).collect();
        let next: Vec<[Option<Next>; 2]> =
            tangents.iter().enumerate().map(|(point, &tangent)| self.next(point, tangent)).collect();
        let widest = |point: usize| {
            next[point]
                .iter()
                .map(|side| side.map_or(f64::INFINITY, |next| next.distance))
                .fold(0.0, f64::max)
        };
        let share = |(point, tangent): (usize, &[f64; 2])| {
            let radius = self.r[point] + origin;
            let is_end = |side: &Next| side.distance <= LONELY * widest(side.source);
            let mut slices =
                next[point].map(|side| side.filter(is_end).map(|next| (next.distance, next.rise)));
            // Rings that were drawn in to the axis are several times as large as the others, and leave gaps in proportion:
            // across the axis lies the point's own image.
            let inward = usize::from(tangent[0] < 0.0);
            let is_steep = tangent[1].abs() > STEEP * tangent[0].abs();
            if next[point][inward].is_none() && !is_steep && 2.0 * radius < REACH * self.sizes[point] {
                slices[inward] = Some((2.0 * radius, -2.0 * radius));
            }
            // Half the way is a slice of a cone; its mean radius is that at a quarter of the way.
            let slice = |(distance, rise): (f64, f64)| PI * distance * (radius + 0.25 * rise);
            slices.into_iter().flatten().map(slice).sum::<f64>()
        };
        tangents.iter().enumerate().map(share).sum()
    }
}

/// The next point of the surface, seen from one.
#[derive(Clone, Copy)]
struct Next {
    /// Which one it is, or whose image.
    source: usize,
    /// m.
    distance: f64,
    /// How much farther from the axis it lies, m.
    rise: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::{History, Observer};
    use crate::scene::{Scene, parse};
    use crate::simulation::{Simulation, to_the_end};
    use meniscus_stages::surface::INSIDE;

    /// A scene of particles of 50 nm, at its start.
    fn started(bodies: &str) -> (Scene, Simulation) {
        let scene = format!(
            "format = 1\n[liquid]\ndensity = \"1000 kg/m3\"\nsurface_tension = \"0.074 N/m\"\n{bodies}\n\
             [particles]\nsize = \"50 nm\"\n[run]\nuntil = \"1 us\"\n"
        );
        let scene = parse("surface.toml", &scene, &[]).unwrap();
        let simulation = Simulation::new(&scene, &mut to_the_end).unwrap();
        (scene, simulation)
    }

    fn measured(bodies: &str) -> f64 {
        let (_, mut simulation) = started(bodies);
        (0..12).for_each(|_| simulation.step().unwrap());
        area(&simulation.world.store, &simulation.physics).unwrap()
    }

    fn assert_near(bodies: &str, exact: f64) {
        let measured = measured(bodies);
        assert!((measured / exact - 1.0).abs() < 0.004, "{bodies}: {measured} instead of {exact}");
    }

    /// Of semi-axes a across the axis of symmetry and c > a along it.
    fn prolate(a: f64, c: f64) -> f64 {
        let eccentricity = (1.0 - a * a / (c * c)).sqrt();
        2.0 * PI * a * a * (1.0 + c / (a * eccentricity) * eccentricity.asin())
    }

    #[test]
    fn areas_of_known_surfaces() {
        let sphere = |radius: f64| 4.0 * PI * radius * radius;
        assert_near("[[body]]\nshape = { sphere = { radius = \"1 um\" } }", sphere(1e-6));
        assert_near(
            "[[body]]\nshape = { spheroid = { radial = \"0.7 um\", axial = \"2.1 um\" } }",
            prolate(0.7e-6, 2.1e-6),
        );
        assert_near(
            "[[body]]\nshape = { torus = { major = \"2 um\", minor = \"1 um\" } }",
            4.0 * PI * PI * 2e-12,
        );
        assert_near(
            "[[body]]\nshape = { sphere = { radius = \"1 um\" } }\n\
             [[body]]\nshape = { sphere = { radius = \"0.6 um\", centre = \"2.5 um\" } }",
            sphere(1e-6) + sphere(0.6e-6),
        );
    }

    /// Area over the exact one of a sphere by points on it: so many angles from the pole, the radius that each point has,
    /// and the size of its particle.
    fn of_sphere(points: impl Iterator<Item = [f64; 3]>, distance: f64) -> f64 {
        let mut columns = [Vec::new(), Vec::new(), Vec::new()];
        for [angle, radius, size] in points {
            for (column, value) in columns.iter_mut().zip([radius * angle.sin(), radius * angle.cos(), size])
            {
                column.push(value);
            }
        }
        let spots = merged(columns.each_ref().map(|column| &column[..]), distance, &Domain::default());
        let points = Points::new(spots, REACH * SPACING, &Domain::default());
        points.area(0.0) / (4.0 * PI)
    }

    const SPACING: f64 = PI / 60.0;

    fn circle() -> impl Iterator<Item = [f64; 3]> {
        (0..60).map(|k| [(f64::from(k) + 0.5) * SPACING, 1.0, SPACING])
    }

    /// One above the other, mostly: each alone would have the next ones on either side.
    #[test]
    fn points_at_the_same_place_count_once() {
        for (aside, above) in [(0.02, 0.0), (0.02, 0.2)] {
            let others = circle().step_by(7);
            let others =
                others.map(|[angle, _, size]| [angle + aside * SPACING, 1.0 + above * SPACING, size]);
            let area = of_sphere(circle().chain(others), MERGED * SPACING);
            assert!((area - 1.0).abs() < 0.001, "{area}");
        }
    }

    /// So do those that a period's ends part.
    #[test]
    fn points_at_the_same_place_across_the_ends_of_a_period_count_once() {
        let domain = Domain { origin: 0.0, period: Some((0.0, 60.0 * SPACING)) };
        // One above the other, mostly: each alone would have the next ones on either side.
        let of = |more: &[[f64; 2]]| {
            let row = (0..60).map(|k| [1.0, (f64::from(k) + 0.01) * SPACING]);
            let (r, z): (Vec<f64>, Vec<f64>) = row.chain(more.iter().copied()).map(|[r, z]| (r, z)).unzip();
            let sizes = vec![SPACING; z.len()];
            let spots = merged([&r, &z, &sizes], MERGED * SPACING, &domain);
            Points::new(spots, REACH * SPACING, &domain).area(0.0)
        };
        let whole = of(&[]);
        assert!((whole / (2.0 * PI * 60.0 * SPACING) - 1.0).abs() < 1e-12, "{whole}");
        let area = of(&[[1.0 + 0.2 * SPACING, 59.99 * SPACING]]);
        assert!((area / whole - 1.0).abs() < 1e-4, "{area} instead of {whole}");
    }

    /// They are one after the other, not two pieces of surface.
    #[test]
    fn points_beside_and_above_each_other_are_next() {
        let others = circle().step_by(7);
        let others = others.map(|[angle, _, size]| [angle + 0.34 * SPACING, 1.0 + 0.35 * SPACING, size]);
        let area = of_sphere(circle().chain(others), MERGED * SPACING);
        assert!((area - 1.0).abs() < 0.05, "{area}");
    }

    /// A lone particle between the sides of a crease sees the surface on either side, which is whole without it.
    #[test]
    fn who_lies_beside_a_whole_surface_is_no_part_of_it() {
        for below in [2.5, 3.0, 4.5] {
            let lone = [[1.0, 1.0 - below * SPACING, SPACING]];
            let [alone, both] = [&lone[..0], &lone[..]]
                .map(|more| of_sphere(circle().chain(more.iter().copied()), MERGED * SPACING));
            assert_eq!(alone, both, "{below}");
        }
    }

    /// Both ends of a gap have each other, wherever the points before and after lie.
    #[test]
    fn gaps_in_a_surface_belong_to_it() {
        for missing in [1, 2, 4] {
            let points = circle().enumerate().filter(|(k, _)| !(20..20 + missing).contains(k));
            let doubled = [[(20.0 - 0.1) * SPACING, 1.0, SPACING]];
            let area = of_sphere(points.map(|(_, point)| point).chain(doubled), MERGED * SPACING);
            assert!((area - 1.0).abs() < 0.002, "{missing}: {area}");
        }
    }

    /// Around a hole in the liquid there are boundary particles that find no surface.
    #[test]
    fn who_has_found_no_surface_is_no_point_of_it() {
        let (_, mut simulation) = started("[[body]]\nshape = { sphere = { radius = \"1 um\" } }");
        (0..12).for_each(|_| simulation.step().unwrap());
        let area_before = area(&simulation.world.store, &simulation.physics);
        let surface = simulation.world.store.by_name_mut::<u32>("surface").unwrap();
        let deep = surface.iter().position(|code| *code == INSIDE).unwrap();
        surface[deep] = BOUNDARY;
        assert_eq!(area(&simulation.world.store, &simulation.physics), area_before);
    }

    /// A ring that has just left the axis leaves a gap there, in proportion to its size.
    #[test]
    fn the_surface_goes_on_across_the_axis() {
        let pole = 6.0 * SPACING;
        let size = |angle: f64| if angle < 2.0 * pole { 3.0 * SPACING } else { SPACING };
        let points = circle().filter(|[angle, ..]| *angle > pole);
        let area = of_sphere(points.map(|[angle, radius, _]| [angle, radius, size(angle)]), MERGED * SPACING);
        assert!((area - 1.0).abs() < 0.002, "{area}");
        // The more so at the tip of a small drop; a disc is 3 % smaller than what lies there of a sphere.
        let points = circle().filter(|[angle, ..]| *angle > 0.9);
        let area = of_sphere(points.map(|[angle, radius, _]| [angle, radius, 0.2]), MERGED * SPACING);
        assert!((area - 1.0).abs() < 0.05, "{area}");
    }

    /// A sphere stretches until its motion has become surface: the sum stays.
    #[test]
    fn motion_becomes_surface() {
        let (scene, mut simulation) = started(
            "[[body]]\nshape = { sphere = { radius = \"1 um\" } }\n\
             velocity = { r = \"-5 m/s * r/(1 um)\", z = \"10 m/s * z/(1 um)\" }",
        );
        let observer = Observer::new(&scene, &simulation);
        let mut history = History::new(observer.quantities());
        for _ in 0..90 {
            history.push(observer.observe(&simulation));
            (0..10).for_each(|_| simulation.step().unwrap());
        }
        let [kinetic, internal, surface] =
            ["kinetic energy", "internal energy", "surface energy"].map(|name| history.of(name));
        let sum = |row: usize| kinetic[row] + internal[row] + surface[row];
        assert!(kinetic[89] < 0.02 * kinetic[0] && kinetic[0] > 0.06 * surface[0]);
        let worst = (0..90).map(|row| (sum(row) / sum(0) - 1.0).abs()).fold(0.0, f64::max);
        assert!(worst < 0.005, "the energy changes by {worst}");
    }
}
