use super::{Endless, LevelSet, Polygon, Shape};
use crate::region::Region;
use std::f64::consts::PI;
use std::sync::Arc;

fn sphere(radius: f64, centre: f64) -> Shape {
    Shape::Sphere { radius, centre }
}

fn level_set(inside: impl Fn(f64, f64) -> f64 + Send + Sync + 'static, bounds: [f64; 4]) -> Shape {
    Shape::Expression(LevelSet::new(Arc::new(inside), bounds, true))
}

fn assert_close(value: f64, exact: f64, tolerance: f64) {
    let error = (value - exact).abs();
    assert!(
        error <= tolerance * exact.abs(),
        "{value} is not {exact}: relative error {:e}",
        error / exact.abs()
    );
}

#[test]
fn primitives_have_their_textbook_volumes() {
    let annulus = Shape::Annulus { inner: 1.0, outer: 3.0, bottom: -1.0, top: 1.0 };
    let torus = Shape::Torus { major: 3.0, minor: 1.0, centre: 2.0 };
    let cone = Shape::Polygon(Polygon::cut_at_axis(&[[0.0, 0.0], [2.0, 0.0], [0.0, 3.0]]));
    let cases = [
        (sphere(2.0, 5.0), 4.0 / 3.0 * PI * 8.0),
        (Shape::Spheroid { radial: 2.0, axial: 3.0, centre: 0.0 }, 4.0 / 3.0 * PI * 12.0),
        (Shape::Cylinder { radius: 2.0, bottom: 1.0, top: 4.0 }, 12.0 * PI),
        (annulus, 16.0 * PI),
        (torus, 6.0 * PI * PI),
        (cone, 4.0 * PI),
    ];
    for (shape, exact) in cases {
        assert_close(shape.volume(), exact, 1e-14);
        // The quadrature knows nothing of the closed form.
        assert_close(Shape::Union(vec![shape]).volume(), exact, 1e-10);
    }
}

#[test]
fn booleans_integrate_to_ten_digits() {
    // Two unit spheres one radius apart share a lens of volume 5 pi / 12.
    let pair = || vec![sphere(1.0, 0.0), sphere(1.0, 1.0)];
    let (whole, lens) = (4.0 / 3.0 * PI, 5.0 / 12.0 * PI);
    assert_close(Shape::Intersection(pair()).volume(), lens, 1e-10);
    assert_close(Shape::Union(pair()).volume(), 2.0 * whole - lens, 1e-10);
    assert_close(Shape::Difference(pair()).volume(), whole - lens, 1e-10);
    // A drilled sphere keeps the volume of a sphere as wide as the hole is long.
    let drill = Shape::Cylinder { radius: 0.6, bottom: -2.0, top: 2.0 };
    let ring = Shape::Difference(vec![sphere(1.0, 0.0), drill]);
    assert_close(ring.volume(), whole * 0.8_f64.powi(3), 1e-10);
    assert!(!ring.encloses_axis() && ring.smallest_extent() == 1.0);
}

#[test]
fn expressions_integrate_to_ten_digits_even_with_jumps() {
    let ball = level_set(|r, z| r * r + z * z - 1.0, [0.0, 2.0, -2.0, 2.0]);
    assert_close(ball.volume(), 4.0 / 3.0 * PI, 1e-10);
    let step = level_set(|r, z| if z < 0.3 { r - 1.0 } else { r - 0.5 }, [0.0, 2.0, 0.0, 1.0]);
    assert_close(step.volume(), PI * (0.3 + 0.25 * 0.7), 1e-10);
    let [_, r_max, z_min, z_max] = ball.bounds();
    assert!((1.0..1.02).contains(&r_max) && (-1.02..=-1.0).contains(&z_min) && (1.0..1.02).contains(&z_max));
}

#[test]
fn an_origin_off_the_axis_weighs_the_section() {
    let film = Shape::Annulus { inner: -1e-8, outer: 1e-8, bottom: 0.0, top: 1e-5 };
    assert_close(film.volume_about(1.0), 2.0 * PI * 2e-13, 1e-14);
    let disc = Shape::Torus { major: 0.0, minor: 1.0, centre: 0.0 };
    assert_close(disc.volume_about(5.0), 10.0 * PI * PI, 1e-14);
    let square = Shape::Polygon(Polygon::new(vec![[-1.0, 0.0], [1.0, 0.0], [1.0, 2.0], [-1.0, 2.0]]));
    assert_close(square.volume_about(3.0), 2.0 * PI * 3.0 * 4.0, 1e-14);
}

#[test]
fn a_spheroid_knows_its_exact_distance() {
    for (radial, axial) in [(2.0, 0.7), (0.7, 2.0), (1.0, 1.0), (50.0, 1.0)] {
        let shape = Shape::Spheroid { radial, axial, centre: 0.5 };
        for step in 0..=64 {
            let angle = PI * (f64::from(step) / 64.0 - 0.5);
            let (across, along) = (angle.cos().max(0.0), angle.sin());
            let normal = [across / radial, along / axial];
            let length = normal[0].hypot(normal[1]);
            // Along the normal the distance is the way gone, inwards up to the smallest curvature radius.
            for way in [1e-3, 0.5, 3.0, -1e-3, -0.5 * radial.min(axial).powi(2) / radial.max(axial)] {
                let r = radial * across + way * normal[0] / length;
                let z = axial * along + way * normal[1] / length + 0.5;
                let distance = shape.signed_distance(r, z);
                assert!((distance - way).abs() < 1e-12 * radial.max(axial), "{distance} is not {way}");
            }
        }
        assert_close(shape.signed_distance(0.0, 0.5), -radial.min(axial), 1e-14);
    }
}

#[test]
fn an_expression_finds_the_distance_of_the_surface() {
    let (radial, axial) = (2.0, 1.0);
    let exact = Shape::Spheroid { radial, axial, centre: 0.0 };
    let expression =
        level_set(move |r, z| (r / radial).powi(2) + (z / axial).powi(2) - 1.0, [0.0, 2.5, -1.5, 1.5]);
    for [r, z] in exact.interior_points(16).chain([[2.01, 0.0], [0.0, 1.01], [1.5, 0.8], [0.7, -1.0]]) {
        let (distance, wanted) = (expression.signed_distance(r, z), exact.signed_distance(r, z));
        assert_eq!(distance < 0.0, wanted < 0.0);
        // Deep inside, where several points of the surface compete, any of them will do.
        if wanted > -0.3 {
            assert!((distance - wanted).abs() < 1e-6, "{distance} is not {wanted} at {r}, {z}");
        }
    }
}

#[test]
fn the_axis_is_no_boundary() {
    let half = Shape::Polygon(Polygon::cut_at_axis(&[[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]));
    assert_close(half.volume(), 2.0 * PI, 1e-14);
    assert_eq!(half.bounds(), [0.0, 1.0, -1.0, 1.0]);
    for shape in [half, Shape::Cylinder { radius: 1.0, bottom: -1.0, top: 1.0 }] {
        assert_close(shape.signed_distance(0.0, 0.25), -0.75, 1e-14);
        assert_close(shape.signed_distance(0.01, 0.0), -0.99, 1e-14);
        assert_close(shape.signed_distance(1.0 + 3.0, 1.0 + 4.0), 5.0, 1e-14);
    }
    let ball = level_set(|r, z| r * r + z * z - 1.0, [0.0, 2.0, -2.0, 2.0]);
    assert_close(ball.signed_distance(0.0, 0.5), -0.5, 1e-8);
}

#[test]
fn booleans_combine_distances() {
    let shell = Shape::Difference(vec![sphere(2.0, 0.0), sphere(1.0, 0.0)]);
    for (r, distance) in [(0.5, 0.5), (1.25, -0.25), (1.75, -0.25), (3.0, 1.0)] {
        assert_close(shell.signed_distance(r, 0.0), distance, 1e-14);
    }
    let dumbbell = Shape::Union(vec![sphere(1.0, -2.0), sphere(1.0, 2.0)]);
    assert_close(dumbbell.signed_distance(0.0, 0.0), 1.0, 1e-14);
    assert_eq!(dumbbell.bounds(), [0.0, 1.0, -3.0, 3.0]);
}

#[test]
fn a_crossing_outline_is_found() {
    let bow = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
    assert_eq!(Polygon::crossing(&bow), Some([0, 2]));
    assert_eq!(Polygon::crossing(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]), None);
    assert_eq!(Polygon::crossing(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), None);
}

#[test]
fn interior_points_lie_inside() {
    let shell = Shape::Difference(vec![sphere(2.0, 0.0), sphere(1.9, 0.0)]);
    let mut count = 0;
    for [r, z] in shell.interior_points(32) {
        assert!(shell.signed_distance(r, z) < 0.0);
        count += 1;
    }
    assert!(count >= 1024);
}

/// A jet in a periodic scene goes on: the distance from its middle line is its radius, also at the ends of the period.
#[test]
fn what_spans_a_period_has_no_ends() {
    let jet = Shape::Cylinder { radius: 1.0, bottom: -3.0, top: 3.0 };
    let outside = Shape::Annulus { inner: 0.5, outer: 4.0, bottom: -5.0, top: 5.0 };
    let expression = LevelSet::new(Arc::new(|r, _| r - 1.0), [0.0, 2.0, -3.0, 3.0], true);
    let hollow = Shape::Difference(vec![jet.clone(), outside]);
    for (shape, radius) in [(jet.clone(), 1.0), (Shape::Expression(expression), 1.0), (hollow, 0.5)] {
        let endless = Endless::new(&shape, 6.0);
        for z in [-3.0, -2.9, 0.0, 3.0] {
            let distance = endless.signed_distance(0.2, z);
            assert!((distance - (0.2 - radius)).abs() < 1e-9, "{shape:?} at {z}: {distance}");
        }
        assert_eq!((endless.bounds(), endless.volume()), (shape.bounds(), shape.volume()));
    }
    let drop = Endless::new(&jet, 7.0);
    assert_eq!(drop.signed_distance(0.2, 2.9), jet.signed_distance(0.2, 2.9), "a short one has ends");
}
