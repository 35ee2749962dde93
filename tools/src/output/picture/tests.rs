use super::*;

struct Liquid {
    r: Vec<f64>,
    z: Vec<f64>,
    diameter: Vec<f64>,
    values: Vec<f64>,
}

/// Particles on a square lattice where `inside` says so.
fn liquid(spacing: f64, reach: (f64, f64), inside: impl Fn(f64, f64) -> bool) -> Liquid {
    let (columns, rows) = ((reach.0 / spacing) as i64, (reach.1 / spacing) as i64);
    let places = (0..columns).flat_map(|column| (-rows..rows).map(move |row| (column, row)));
    let places: Vec<(f64, f64)> = places
        .map(|(column, row)| ((column as f64 + 0.5) * spacing, (row as f64 + 0.5) * spacing))
        .filter(|(r, z)| inside(*r, *z))
        .collect();
    Liquid {
        r: places.iter().map(|place| place.0).collect(),
        z: places.iter().map(|place| place.1).collect(),
        diameter: vec![spacing; places.len()],
        values: places.iter().map(|(r, z)| 1e6 * z * (1.0 - r / reach.0)).collect(),
    }
}

fn draw(name: &str, liquid: &Liquid, map: ColourMap) -> (Pixmap, std::time::Duration) {
    let folder = tempfile::tempdir().unwrap();
    let path = match std::env::var_os("MENISCUS_SHOW") {
        Some(_) => std::env::temp_dir().join(name),
        None => folder.path().join(name),
    };
    let picture = Picture {
        title: "Droplet oscillation",
        time: 1.25e-5,
        particles: Particles { r: &liquid.r, z: &liquid.z, diameter: &liquid.diameter },
        shade: Shade { name: "axial velocity", unit: "m/s", values: &liquid.values, map, range: None },
        window: None,
    };
    let started = std::time::Instant::now();
    write_picture(&path, &picture).unwrap();
    let elapsed = started.elapsed();
    println!("{} particles in {elapsed:?}", liquid.r.len());
    (Pixmap::load_png(&path).unwrap(), elapsed)
}

fn ellipsoid(r: f64, z: f64) -> bool {
    (r / 5e-6).powi(2) + (z / 4e-6).powi(2) < 1.0
}

#[test]
fn a_drop_is_whole_symmetric_and_on_white() {
    let drop = liquid(0.2e-6, (5e-6, 5e-6), ellipsoid);
    let (picture, _) = draw("drop.png", &drop, ColourMap::BlueRed);
    assert!((850..=910).contains(&picture.width().max(picture.height())));
    let colour = |x, y| {
        let pixel = picture.pixel(x, y).unwrap();
        assert_eq!(pixel.alpha(), 255);
        [pixel.red(), pixel.green(), pixel.blue()]
    };
    assert_eq!(colour(2, 2), [255; 3]);
    // Red above, blue below the equator, on both sides of the axis.
    let (axis, equator) = (348, 348);
    let (mut above, mut below) = ([0, 0], [0, 0]);
    for x in 0..2 * axis {
        let side = usize::from(x > axis);
        let (upper, lower) = (colour(x, equator - 150), colour(x, equator + 150));
        above[side] += i32::from(upper[0] > upper[2]);
        below[side] += i32::from(lower[2] > lower[0]);
    }
    assert!(above.iter().chain(&below).all(|count| *count > 100), "{above:?} {below:?}");
}

#[test]
fn a_fine_drop_is_drawn_in_no_time() {
    let drop = liquid(0.0178e-6, (5e-6, 5e-6), ellipsoid);
    let (_, elapsed) = draw("fine.png", &drop, ColourMap::Viridis);
    assert!(drop.r.len() > 99_000);
    // Ten times what it takes on an idle core, for busy ones.
    assert!(elapsed.as_secs_f64() < 2.0, "{elapsed:?}");
}

#[test]
fn jets_films_and_odd_values_are_shown() {
    let jet = liquid(0.2e-6, (2e-6, 2e-5), |r, z| r < 1.5e-6 + 4e-7 * (z * 8e5).sin());
    draw("jet.png", &jet, ColourMap::Viridis);
    let mut film = liquid(2e-8, (2e-6, 1e-6), |_, z| z.abs() < 4e-7);
    film.r.iter_mut().for_each(|r| *r += 1.0);
    film.values[0] = f64::NAN;
    film.r[1] = f64::INFINITY;
    draw("film.png", &film, ColourMap::Viridis);
    let single = Liquid { r: vec![0.0], z: vec![0.0], diameter: vec![1e-6], values: vec![3.0] };
    draw("single.png", &single, ColourMap::Viridis);
}

#[test]
fn nothing_to_show_is_said() {
    let picture = |values| Picture {
        title: "",
        time: 0.0,
        particles: Particles { r: &[], z: &[], diameter: &[] },
        shade: Shade { name: "", unit: "", values, map: ColourMap::Viridis, range: None },
        window: None,
    };
    let error = |values| {
        let path = Path::new("none.png");
        write_picture(path, &picture(values)).unwrap_err().to_string()
    };
    assert!(error(&[]).contains("no particles to show"));
    assert!(error(&[1.0]).contains("differ in length"));
}
