//! The same drop in other units: no length, density or tension is built in.

use meniscus_tests::drops;

/// Velocities over the capillary velocity after 50 steps, by identity.
fn velocities(settings: &[&str]) -> Vec<[f64; 2]> {
    let settings: Vec<&str> = settings.iter().copied().chain(["amplitude=0.3"]).collect();
    let scene = drops::drop(&settings);
    let mut simulation = drops::start(&scene);
    drops::advance(&mut simulation, 50);
    let unit = scene.capillary_velocity();
    let identity = simulation.world.store.by_name::<u32>("identity").expect("a column");
    let [u, w] = ["velocity_r", "velocity_z"].map(|name| drops::column(&simulation, name));
    let mut velocities = vec![[0.0; 2]; u.len()];
    for (k, &i) in identity.iter().enumerate() {
        velocities[i as usize] = [u[k] / unit, w[k] / unit];
    }
    velocities
}

#[test]
fn micrometres_millimetres_and_a_metal() {
    let micrometres = velocities(&[]);
    // Rows keep three digits of a rate of deformation and six of an impedance: the same ones where both are powers of
    // two of the others.
    let millimetres = velocities(&["radius=\"2.56 mm\""]);
    let [radius, tension] = [2.5 * 32.0 / 7.0, 0.074 * 128.0 / 49.0];
    let metal = velocities(&[
        &format!("radius=\"{radius:e} um\""),
        "density=\"7000 kg/m3\"",
        &format!("surface_tension=\"{tension:e} N/m\""),
    ]);
    for (name, other) in [("millimetres", millimetres), ("a metal", metal)] {
        assert_eq!(other.len(), micrometres.len());
        let scale = micrometres.iter().flatten().fold(0.0f64, |most, v| most.max(v.abs()));
        let pairs = micrometres.iter().flatten().zip(other.iter().flatten());
        let worst = pairs.fold(0.0f64, |worst, (a, b)| worst.max((a - b).abs())) / scale;
        println!("{name}: {worst:e}");
        // Rounding, multiplied over the steps; nothing but rounding differs.
        assert!(worst < 1e-9, "{name}: {worst:e}");
    }
}
