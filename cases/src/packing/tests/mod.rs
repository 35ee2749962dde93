mod shapes;

use super::cells::Cells;
use super::domain::Domain as PackingDomain;
use super::{Packing, PackingError, PackingOptions, relax};
use crate::region::Region;
use meniscus_engine::domain::Domain;
use meniscus_stages::colour_field::ColourField;
use meniscus_stages::surface_points::Particles;
use shapes::{Cylinder, Disc};
use std::f64::consts::PI;
use std::ops::ControlFlow;

const SIZE: f64 = 1e-6;

const SPHERE: Disc = Disc { centre: 0.0, radius: 12.0 * SIZE };

fn pack(region: &dyn Region, options: &PackingOptions) -> Result<Packing, PackingError> {
    super::pack(region, options, &mut |_| ControlFlow::Continue(()))
}

fn depths(packing: &Packing, region: &dyn Region) -> Vec<f64> {
    let places = packing.r.iter().zip(&packing.z);
    places.map(|(&r, &z)| -region.signed_distance(r, z) / SIZE).collect()
}

fn volume(packing: &Packing, origin: f64) -> f64 {
    let rings = packing.r.iter().zip(&packing.area);
    rings.map(|(r, area)| 2.0 * PI * (origin + r) * area).sum()
}

fn shortest_distance(packing: &Packing) -> f64 {
    let places: Vec<_> = packing.r.iter().zip(&packing.z).collect();
    let mut shortest = f64::INFINITY;
    for (index, one) in places.iter().enumerate() {
        for other in &places[..index] {
            shortest = shortest.min((one.0 - other.0).hypot(one.1 - other.1));
        }
    }
    shortest / SIZE
}

#[test]
fn a_sphere_is_filled_evenly_up_to_a_layer_at_half_a_size() {
    let packing = pack(&SPHERE, &PackingOptions::new(SIZE)).unwrap();
    assert_eq!(packing.r.len(), 226, "pi 12^2 / 2 = 226.2");
    assert!((volume(&packing, 0.0) / SPHERE.volume() - 1.0).abs() < 1e-13);
    for (area, depth) in packing.area.iter().zip(depths(&packing, &SPHERE)) {
        // The outermost ones smooth the contour.
        let most = if depth < 0.75 { 0.05 } else { 0.01 };
        assert!((area / SIZE.powi(2) - 1.0).abs() < most, "{area} at depth {depth}");
    }
    assert!(packing.r.iter().all(|&r| r > 0.4 * SIZE), "no particle crowds the axis");
    assert!(shortest_distance(&packing) > 0.75);

    let depths = depths(&packing, &SPHERE);
    let layer = depths.iter().filter(|&&depth| depth < 0.75).count();
    // A layer of thickness D along the half circle of radius 11.5 D holds 36 particles.
    assert!((33..=39).contains(&layer), "{layer} particles in the outermost layer");
    let first = depths.iter().copied().find(|depth| *depth < 0.75).unwrap();
    assert!((first - 0.5).abs() < 0.03, "outermost layer at depth {first}");
    for depth in depths.iter().filter(|&&depth| depth < 0.75) {
        assert!((depth - first).abs() < 1e-6, "outermost layer at depths {first} and {depth}");
    }
    let shallow = depths.iter().filter(|&&depth| depth < 6.0).count() as f64;
    let exact = PI / 2.0 * (12.0f64.powi(2) - 6.0f64.powi(2));
    assert!((shallow / exact - 1.0).abs() < 0.03, "outer half holds {shallow} of {exact}");
}

/// What surface tension sees of a packing: where the colour field is one half. With equal areas it lies up to .01
/// sizes off.
#[test]
fn the_contour_of_the_particles_is_the_boundary() {
    for radius in [12.0, 18.0, 25.0, 36.0, 50.0] {
        let sphere = Disc { centre: 0.0, radius: radius * SIZE };
        let packing = pack(&sphere, &PackingOptions::new(SIZE)).unwrap();
        let size: Vec<f64> = packing.area.iter().map(|area| area.sqrt()).collect();
        let (r, z) = (&packing.r[..], &packing.z[..]);
        let support = 11.0 * SIZE;
        let source = Particles { r, z, list_r: r, list_z: z, support };
        let mut field = ColourField::default();
        let wanted = (0..r.len() as u32).map(|i| (i, support));
        field.refresh(
            &source,
            |i| size[i] * size[i],
            wanted,
            1,
            (0.0, &Domain { origin: 0.0, period: None }),
        );
        let gap_at = |k: u32| {
            let (sine, cosine) = (0.01 * PI * (f64::from(k) + 0.5)).sin_cos();
            let here = field.at(sphere.radius * sine, sphere.radius * cosine, support);
            let slope = -(here.gradient[0] * sine + here.gradient[1] * cosine);
            (0.5 - here.value) / slope / SIZE
        };
        let gaps: Vec<f64> = (0..100).map(gap_at).collect();
        let mean = gaps.iter().sum::<f64>() / 100.0;
        let waves = gaps.iter().map(|gap| (gap - mean).abs()).fold(0.0, f64::max);
        println!("{radius} sizes to the radius: {mean:.1e} sizes too deep, waves of {waves:.1e}");
        assert!(mean.abs() < 0.005, "{radius} sizes to the radius: the contour lies {mean} sizes too deep");
        assert!(waves < 3e-4, "{radius} sizes to the radius: the contour undulates by {waves} sizes");
    }
}

#[test]
fn a_settled_packing_pushes_nothing_but_the_outermost_layer() {
    let packing = pack(&SPHERE, &PackingOptions::new(SIZE)).unwrap();
    let (worst, _) = pushes(&packing, &SPHERE);
    assert!(worst < 0.02, "a particle feels {worst}");
}

#[test]
fn a_large_sphere_is_as_even_as_a_small_one() {
    let sphere = Disc { centre: 0.0, radius: 180.0 * SIZE };
    let options = PackingOptions::new(SIZE);
    let packing = pack(&sphere, &options).unwrap();
    assert_eq!(packing.r.len(), 50_894, "pi 180^2 / 2");
    let (worst, square) = pushes(&packing, &sphere);
    assert!(worst < 0.05, "a particle feels {worst}");
    assert!(square.sqrt() < 0.005, "root of the mean square {}", square.sqrt());
}

/// The largest push on a particle below the outermost layer, and the mean of their squares.
fn pushes(packing: &Packing, region: &dyn Region) -> (f64, f64) {
    let domain = PackingDomain::new(region, &PackingOptions::new(SIZE)).unwrap();
    let bottom = region.bounds()[2];
    let places = packing.r.iter().zip(&packing.z);
    let points: Vec<_> = places.map(|(r, z)| [r / SIZE, (z - bottom) / SIZE]).collect();
    let (mut cells, mut sources) = (Cells::default(), Vec::new());
    relax::gather(&domain, &points, &relax::dust(&domain, relax::REACH, relax::DUST), &mut sources);
    cells.fill(&sources);
    let below = points.iter().zip(depths(packing, region)).filter(|(_, depth)| *depth >= 0.75);
    let pushes = below.map(|(point, _)| relax::gradient(&cells, *point, 2.0));
    let pushes: Vec<f64> = pushes.map(|[r, z]| r.hypot(z)).collect();
    let sum: f64 = pushes.iter().map(|push| push * push).sum();
    (pushes.iter().copied().fold(0.0, f64::max), sum / pushes.len() as f64)
}

#[test]
fn a_section_far_from_the_axis_mirrors_nothing() {
    let region = Disc { centre: 6.0 * SIZE, radius: 6.0 * SIZE };
    let origin = 1.0;
    let volume_there = 2.0 * PI * (origin + region.centre) * PI * region.radius.powi(2);
    let mut options = PackingOptions { origin, ..PackingOptions::new(SIZE) };
    assert_eq!(pack(&region, &options), Err(PackingError::NoVolume { origin }));
    options.volume = Some(volume_there);
    let packing = pack(&region, &options).unwrap();
    assert_eq!(packing.r.len(), 113);
    assert!((volume(&packing, origin) / volume_there - 1.0).abs() < 1e-12);
    // Its layer goes round the whole circle of circumference 34.6 D, also where r is next to zero.
    let layer = depths(&packing, &region).into_iter().filter(|depth| (depth - 0.5).abs() < 0.03);
    assert!((31..=37).contains(&layer.count()));
}

#[test]
fn a_period_has_no_ends() {
    let region = Cylinder { radius: 6.0 * SIZE, height: 20.3 * SIZE, endless: true };
    let period = Some(region.height);
    let options = PackingOptions { period, ..PackingOptions::new(SIZE) };
    let packing = pack(&region, &options).unwrap();
    assert_eq!(packing.r.len(), 122);
    assert!(packing.z.iter().all(|z| (0.0..region.height).contains(z)));
    // Shifted by a period, the lower half continues the upper half at the usual distance.
    let mut joined = packing.clone();
    for (z, place) in packing.z.iter().zip(&mut joined.z) {
        *place = if *z < region.height / 2.0 { z + region.height } else { *z };
    }
    assert!(shortest_distance(&joined) > 0.75);
    let near_join = joined.z.iter().filter(|&z| (z - region.height).abs() < 2.0 * SIZE).count();
    assert!((21..=27).contains(&near_join), "{near_join} particles on an area of 24 D^2");
}

#[test]
fn corners_are_filled() {
    let region = Cylinder { radius: 6.0 * SIZE, height: 8.0 * SIZE, endless: false };
    let packing = pack(&region, &PackingOptions::new(SIZE)).unwrap();
    assert!(depths(&packing, &region).iter().all(|&depth| depth > 0.49));
    for corner in [0.5 * SIZE, 7.5 * SIZE] {
        let places = packing.r.iter().zip(&packing.z);
        let gaps = places.map(|(r, z)| (r - 5.5 * SIZE).hypot(z - corner) / SIZE);
        assert!(gaps.fold(f64::INFINITY, f64::min) < 0.6);
    }
}

#[test]
fn the_seed_alone_decides() {
    let on_threads = |threads: usize, seed: u64| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let options = PackingOptions { seed, iterations: 50, ..PackingOptions::new(SIZE) };
        pool.install(|| pack(&SPHERE, &options).unwrap())
    };
    assert_eq!(on_threads(1, 7), on_threads(3, 7));
    assert_ne!(on_threads(1, 7), on_threads(1, 8));
}

#[test]
fn impossible_requests_are_refused() {
    let options = |particle_size: f64| PackingOptions::new(particle_size);
    for size in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(pack(&SPHERE, &options(size)), Err(PackingError::Option { .. })));
    }
    assert!(matches!(pack(&SPHERE, &options(1e-3)), Err(PackingError::Empty { .. })));
    assert!(matches!(pack(&SPHERE, &options(1e-12)), Err(PackingError::TooMany { .. })));
    let short = PackingOptions { period: Some(SIZE), ..options(SIZE) };
    assert!(matches!(pack(&SPHERE, &short), Err(PackingError::Option { .. })));
    let wrong = PackingOptions { volume: Some(1.1 * SPHERE.volume()), ..options(SIZE) };
    assert!(matches!(pack(&SPHERE, &wrong), Err(PackingError::Volume { .. })));
    let endless = Disc { centre: 0.0, radius: f64::INFINITY };
    assert_eq!(pack(&endless, &options(SIZE)), Err(PackingError::Region));
}

#[test]
fn a_handful_of_particles_is_no_error() {
    for radius in [0.8, 1.5, 3.0] {
        let region = Disc { centre: 0.0, radius: radius * SIZE };
        let packing = pack(&region, &PackingOptions::new(SIZE));
        assert!(packing.is_ok(), "radius {radius} D: {packing:?}");
    }
}
