//! The pair sums of one step against the method's equations, particle by particle.

use meniscus_cases::assemble::Physics;
use meniscus_cases::scene::{Flux, Method, Precision};
use meniscus_cases::simulation::Simulation;
use meniscus_stages::equation_of_state::Packing;
use meniscus_stages::surface::INSIDE;
use meniscus_tests::drops;
use meniscus_tests::liquid::{self, Block, DEFORMATION, DENSITY, FLUXES, Random, SIZE, SOUND_SPEED, WEIGHTS};
use meniscus_tests::reference::{Particle, Sums, rounded};

/// Sums of some fifty terms in another order, and inverses that are shared: an error of 1e-14 of the
/// largest term; the largest column is at least a thousandth of that.
const TOLERANCE: f64 = 1e-11;

/// Some twenty roundings of 6e-8 in each of some fifty terms, which add up like chance: 2e-6 of the largest term,
/// and the largest column is at least a tenth of that.
const MIXED_TOLERANCE: f64 = 2e-5;

/// The columns of the velocity sums, row by row.
const SUMS: [&str; 4] = ["velocity_sum_rr", "velocity_sum_rz", "velocity_sum_zr", "velocity_sum_zz"];

fn agree(name: &str, about: &str, found: &[f64], expected: &[f64]) {
    agree_within(TOLERANCE, name, about, found, expected);
}

fn agree_within(tolerance: f64, name: &str, about: &str, found: &[f64], expected: &[f64]) {
    let scale = expected.iter().fold(0.0f64, |most, value| most.max(value.abs()));
    assert!(scale > 0.0, "{name} is zero everywhere: nothing is compared ({about})");
    for (i, (found, expected)) in found.iter().zip(expected).enumerate() {
        let error = (found - expected).abs() / scale;
        assert!(
            error < tolerance,
            "{name} of particle {i} is {found:e}, not {expected:e}: {error:e} of the largest ({about})"
        );
    }
}

fn differ(left: &[f64], right: &[f64]) -> Vec<f64> {
    left.iter().zip(right).map(|(left, right)| left - right).collect()
}

/// 2 (U* - U_a . e)|bw| of equation (24) for flagged particles: the ghost holds minus the reference
/// pressure and a millionth of the impedance.
fn ghost_strain(physics: &Physics, particles: &[Particle], sums: &[Sums], surface: &[u32]) -> Vec<f64> {
    let medium = liquid::medium(physics);
    let strain = |((a, sums), &flag): ((&Particle, &Sums), &u32)| {
        let own = a.density * medium.sound_speed;
        let rise = (medium.pressure(a) + a.reference_pressure) / (own * (1.0 + 1e-6));
        let [r, z] = sums.ghost_weight;
        if flag == 0 { 0.0 } else { 2.0 * rise * r.hypot(z) }
    };
    particles.iter().zip(sums).zip(surface).map(strain).collect()
}

/// T L^{-1}; zero where a neighbourhood is too poor.
fn solved(sums: &Sums) -> [[f64; 2]; 2] {
    let [[rr, rz], [zr, zz]] = sums.moment;
    let determinant = rr * zz - rz * zr;
    let lesser = 0.5 * (rr + zz) - (0.25 * (rr - zz).powi(2) + rz * zr).sqrt();
    if lesser < 0.2 {
        return [[0.0; 2]; 2];
    }
    sums.velocity_sum.map(|[r, z]| [(r * zz - z * zr) / determinant, (z * rr - r * rz) / determinant])
}

fn compare(physics: &Physics, particles: &[Particle], about: &str) {
    let tolerance = match physics.method.precision {
        Precision::Double => TOLERANCE,
        Precision::Mixed => MIXED_TOLERANCE,
    };
    let agree = |name: &str, about: &str, found: &[f64], expected: &[f64]| {
        agree_within(tolerance, name, about, found, expected);
    };
    let mut block = Block::new(physics, particles);
    block.step();
    let sums = liquid::medium(physics).sums(particles);
    let pick = |value: &dyn Fn(&Sums) -> f64| sums.iter().map(value).collect::<Vec<f64>>();

    let ghosts = ghost_strain(physics, particles, &sums, &block.surface());
    let strain = differ(&block.column("strain_rate"), &ghosts);
    agree("strain_rate", about, &strain, &pick(&|s| s.strain_rate));
    for (k, axis) in ["r", "z"].into_iter().enumerate() {
        let column = |name: &str| block.column(&format!("{name}_{axis}"));
        let force = differ(&column("force"), &column("surface_force"));
        agree("force", about, &force, &pick(&|s| s.force[k]));
        agree("dissipation", about, &column("dissipation"), &pick(&|s| s.dissipation[k]));
        agree("ghost_weight", about, &column("ghost_weight_sum"), &pick(&|s| s.ghost_weight[k]));
        if physics.method.shifting.is_none_or(|coefficient| coefficient > 0.0) {
            agree(
                "concentration_gradient",
                about,
                &column("concentration_gradient"),
                &pick(&|s| s.concentration_gradient[k]),
            );
        }
    }
    for (name, [i, j]) in [("moment_rr", [0, 0]), ("moment_rz", [0, 1]), ("moment_zz", [1, 1])] {
        agree(name, about, &block.column(name), &pick(&|s| s.moment[i][j]));
    }
    if physics.method.flux == Flux::FirstOrder {
        return;
    }
    for (k, name) in SUMS.into_iter().enumerate() {
        agree(name, about, &block.column(name), &pick(&|s| s.velocity_sum[k / 2][k % 2]));
    }
    for (k, name) in DEFORMATION.into_iter().enumerate() {
        agree(name, about, &block.column(name), &pick(&|s| deformation(solved(s))[k]));
    }
}

/// The symmetric part of a velocity gradient as the columns hold it.
fn deformation([[rr, rz], [zr, zz]]: [[f64; 2]; 2]) -> [f64; 3] {
    [rr, rz + zr, zz]
}

fn with(change: impl Fn(&mut Method)) -> Physics {
    let mut method = liquid::bare_method();
    change(&mut method);
    liquid::physics(method)
}

#[test]
fn every_scheme_and_flux_at_the_axis() {
    for (scheme, axis) in WEIGHTS {
        for flux in FLUXES {
            for (theta, shifting) in [(0.5, 0.0), (0.6, 0.5), (0.75, 0.0), (1.0, 0.5)] {
                let physics = with(|m| {
                    (m.scheme, m.axis, m.flux) = (scheme, axis, flux);
                    (m.theta, m.shifting) = (theta, Some(shifting));
                });
                let mut random = Random::new(7);
                // From .1 D on: the nearest particles see their own image and are larger than the cap.
                let mut particles = liquid::block([13, 15], 0.1, 0.3, &mut random);
                liquid::stir(&mut particles, &mut random);
                particles[3].mass *= 40.0;
                compare(&physics, &particles, &format!("{scheme:?} {axis:?} {flux:?} {theta}"));
            }
        }
    }
}

#[test]
fn mixed_precision() {
    for flux in FLUXES {
        for (origin, start) in [(0.0, 0.1), (30.0 * SIZE, 0.4), (1.0, 0.4), (0.0, 1e5)] {
            let mut physics = with(|m| {
                (m.flux, m.precision, m.kernel_correction) = (flux, Precision::Mixed, true);
                (m.theta, m.shifting) = (0.6, Some(0.5));
            });
            physics.domain.origin = origin;
            physics.domain.period = Some((0.0, 15.0 * SIZE));
            let mut random = Random::new(31);
            // Two blocks of eight whose lists differ in length, and a part of one.
            let mut particles = liquid::block([13, 15], start, 0.25, &mut random);
            liquid::stir(&mut particles, &mut random);
            for particle in &mut particles {
                particle.mass *= (particle.position[0] + origin) / particle.position[0];
                particle.position[1] = particle.position[1].clamp(0.0, 14.99 * SIZE);
                particle.kernel_scale = rounded(1.0 + 0.05 * random.draw(), 21);
                particle.reference_pressure = 1e4 * random.draw();
            }
            compare(&physics, &particles, &format!("mixed, {flux:?}, origin {origin}, from {start} on"));
        }
    }
}

#[test]
fn kernel_scales_and_reference_pressures() {
    for flux in FLUXES {
        let physics = with(|m| (m.flux, m.kernel_correction) = (flux, true));
        let mut random = Random::new(11);
        let mut particles = liquid::block([10, 12], 0.4, 0.3, &mut random);
        liquid::stir(&mut particles, &mut random);
        for particle in &mut particles {
            particle.kernel_scale = rounded(1.0 + 0.05 * random.draw(), 21);
            particle.reference_pressure = 1e4 * random.draw();
        }
        compare(&physics, &particles, &format!("kernel scale, {flux:?}"));
    }
}

#[test]
fn the_concentration_gradient_is_summed_in_steps_that_shift() {
    let physics = with(|m| (m.shifting, m.shifting_interval) = (Some(0.5), Some(3)));
    let mut random = Random::new(37);
    let mut particles = liquid::block([10, 12], 0.4, 0.3, &mut random);
    liquid::stir(&mut particles, &mut random);
    let mut block = Block::new(&physics, &particles);
    let mut after_step = || {
        block.step();
        [block.column("concentration_gradient_z"), block.column("moment_zz")]
    };
    let steps: Vec<[Vec<f64>; 2]> = (0..4).map(|_| after_step()).collect();
    let differs = |column: usize, step: usize| steps[step][column] != steps[step - 1][column];
    assert_eq!([1, 2, 3].map(|step| differs(0, step)), [false, false, true]);
    assert!((1..4).all(|step| differs(1, step)));
}

#[test]
fn a_period_and_a_distant_axis() {
    for (scheme, axis) in WEIGHTS {
        for origin in [0.0, 30.0 * SIZE, 1.0] {
            let mut physics = with(|m| (m.scheme, m.axis) = (scheme, axis));
            physics.domain.origin = origin;
            physics.domain.period = Some((0.0, 14.0 * SIZE));
            let mut random = Random::new(13);
            let mut particles = liquid::block([10, 14], 0.4, 0.25, &mut random);
            liquid::stir(&mut particles, &mut random);
            for particle in &mut particles {
                particle.mass *= (particle.position[0] + origin) / particle.position[0];
                particle.position[1] = particle.position[1].clamp(0.0, 13.99 * SIZE);
            }
            compare(&physics, &particles, &format!("{scheme:?} {axis:?} origin {origin}"));
        }
    }
}

/// Sum and sum of magnitudes.
fn total(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((0.0, 0.0), |(sum, scale), value| (sum + value, scale + value.abs()))
}

#[test]
fn harmonic_mean_pairs_conserve_momentum_and_energy() {
    for flux in FLUXES {
        let mut found = Vec::new();
        for (scheme, axis) in WEIGHTS {
            let physics = with(|m| (m.scheme, m.axis, m.flux) = (scheme, axis, flux));
            let mut random = Random::new(17);
            let mut particles = liquid::block([14, 16], 0.1, 0.3, &mut random);
            liquid::stir(&mut particles, &mut random);
            let mut block = Block::new(&physics, &particles);
            block.step();
            let volume = |i: usize| particles[i].mass / particles[i].density;
            let force = differ(&block.column("force_z"), &block.column("surface_force_z"));
            let dissipation = block.column("dissipation_z");
            let (sum, scale) = total((0..force.len()).map(|i| volume(i) * (force[i] + dissipation[i])));
            // The engine evolves no energy: the same pairs' power comes from the equations.
            let sums = liquid::medium(&physics).sums(&particles);
            let (power, power_scale) = total((0..force.len()).map(|i| volume(i) * sums[i].power));
            found.push([sum.abs() / scale, power.abs() / power_scale]);
        }
        // Every term has its opposite but for the rounding of the weights.
        assert!(found[0].iter().all(|&error| error < 1e-13), "{flux:?}: {found:?}");
        // Parshikov's weights have none: the test can fail.
        for scheme in &found[1..] {
            assert!(scheme.iter().all(|&error| error > 1e-6), "{flux:?}: {found:?}");
        }
    }
}

#[test]
fn velocity_gradients_are_exact_on_linear_fields() {
    // The image of U_r = a r, U_z = c z is the field itself; at a distance from the axis any is.
    let fields = [(0.2, [[0.7, 0.0], [0.0, -1.3]]), (20.0, [[0.7, -0.4], [1.9, -1.3]])];
    for (start, gradient) in fields {
        let physics = with(|_| ());
        let mut random = Random::new(19);
        let mut particles = liquid::block([12, 12], start, 0.35, &mut random);
        for p in &mut particles {
            let [r, z] = p.position;
            p.velocity = gradient.map(|[by_r, by_z]: [f64; 2]| (by_r * r + by_z * z) / SIZE);
            p.density *= 1.0 + 0.02 * random.draw();
        }
        let mut block = Block::new(&physics, &particles);
        block.step();
        let [rr, rz, zz] = ["moment_rr", "moment_rz", "moment_zz"].map(|name| block.column(name));
        let sum = SUMS.map(|name| block.column(name));
        let kept = DEFORMATION.map(|name| block.column(name));
        let mut solvable = 0;
        for (i, sums) in liquid::medium(&physics).sums(&particles).iter().enumerate() {
            if solved(sums) == [[0.0; 2]; 2] {
                continue;
            }
            solvable += 1;
            // The inverse magnifies rounding by at most 1/.2; 1e-10 is wide.
            let own = Sums {
                moment: [[rr[i], rz[i]], [rz[i], zz[i]]],
                velocity_sum: [[sum[0][i], sum[1][i]], [sum[2][i], sum[3][i]]],
                ..Sums::default()
            };
            let found = solved(&own);
            for (found, expected) in found.as_flattened().iter().zip(gradient.as_flattened()) {
                let error = (found * SIZE - expected).abs();
                assert!(error < 1e-10, "particle {i}: {error:e}");
            }
            for (kept, expected) in kept.iter().zip(deformation(gradient)) {
                let error = (kept[i] * SIZE - expected).abs();
                assert!(error < 1e-10, "particle {i}, kept deformation: {error:e}");
            }
        }
        assert!(solvable * 10 > particles.len() * 9, "{solvable} of {}", particles.len());
    }
}

#[test]
fn a_flow_that_is_linear_across_the_axis_is_not_dissipated() {
    let physics = with(|_| ());
    let mut particles = liquid::block([12, 12], 0.2, 0.3, &mut Random::new(43));
    let [by_r, by_z] = [0.75 / SIZE, -1.5 / SIZE];
    for p in &mut particles {
        p.velocity = [by_r * p.position[0], by_z * p.position[1]];
        p.gradient = [[by_r, 0.0], [0.0, by_z]];
    }
    let dissipation = |particles: &[Particle]| {
        let mut block = Block::new(&physics, particles);
        block.step();
        (block.column("dissipation_r"), block.column("deformation_rr"))
    };
    // Three digits of gradients are kept, and 4000 times what that leaves of a jump is felt; a first-order flux feels rho C U/D.
    let whole = DENSITY * SOUND_SPEED * by_r;
    let (smooth, gradient) = dissipation(&particles);
    let solvable = |i: usize| gradient[i] != 0.0;
    let nearest = |i: usize| particles[i].position[0] < 0.6 * SIZE && solvable(i);
    let most =
        (0..smooth.len()).filter(|&i| solvable(i)).map(|i| smooth[i].abs() / whole).fold(0.0, f64::max);
    assert!(most < 1e-3, "{most:e}");
    // A ring twice as fast as the flow is felt: the test can fail.
    let i = (0..smooth.len()).find(|&i| nearest(i)).expect("a ring at the axis");
    particles[i].velocity[0] *= 2.0;
    let (rough, _) = dissipation(&particles);
    assert!(rough[i] < -0.1 * whole, "{:e}", rough[i] / whole);
}

/// Strain rate, L_rr, L_zz and L_rz of a disordered block by Parshikov's weights in the flow U_r = r dU_r/dr, U_z = z dU_z/dz, which are given.
/// With equal pressures and impedances U* is the mean.
fn strain_of_a_linear_flow([by_r, by_z]: [f64; 2], corrected: bool) -> [Vec<f64>; 4] {
    let choices = (WEIGHTS[2].0, Flux::FirstOrder, corrected);
    let physics = with(|m| (m.scheme, m.flux, m.strain_correction) = choices);
    let mut particles = liquid::block([12, 12], 0.3, 0.3, &mut Random::new(23));
    for p in &mut particles {
        p.velocity = [by_r * p.position[0], by_z * p.position[1]];
    }
    let mut block = Block::new(&physics, &particles);
    block.step();
    ["strain_rate", "moment_rr", "moment_zz", "moment_rz"].map(|name| block.column(name))
}

#[test]
fn parshikovs_strain_is_the_moment_matrix_times_the_gradient() {
    // The pair sum is L : grad U exactly, whatever the packing, so that the strain is exact where L is the identity.
    let [by_r, by_z] = [0.8 / SIZE, -0.5 / SIZE];
    let [strain, rr, zz, _] = strain_of_a_linear_flow([by_r, by_z], false);
    let expected: Vec<f64> = (0..rr.len()).map(|i| by_r * rr[i] + by_z * zz[i] + by_r).collect();
    agree("strain_rate", "linear field", &strain, &expected);
}

#[test]
fn the_corrected_strain_of_a_linear_flow_is_exact_in_any_packing() {
    let [by_r, by_z] = [0.8 / SIZE, -0.5 / SIZE];
    let [strain, rr, zz, rz] = strain_of_a_linear_flow([by_r, by_z], true);
    // Corners keep too few neighbours for a gradient.
    let is_known =
        |&i: &usize| rr[i] + zz[i] - ((rr[i] - zz[i]).powi(2) + 4.0 * rz[i] * rz[i]).sqrt() > 2.0 * 0.2;
    let known: Vec<f64> = (0..strain.len()).filter(is_known).map(|i| strain[i]).collect();
    assert!(known.len() > strain.len() - 4, "{} of {}", known.len(), strain.len());
    agree("strain_rate", "linear field", &known, &vec![2.0 * by_r + by_z; known.len()]);
}

#[test]
fn a_constant_pressure_gives_no_force_with_ghosts() {
    for (scheme, axis) in WEIGHTS {
        for flux in FLUXES {
            let physics = with(|m| (m.scheme, m.axis, m.flux) = (scheme, axis, flux));
            let mut particles = liquid::block([16, 18], 0.5, 0.1, &mut Random::new(29));
            let pressure = 3e4;
            for particle in &mut particles {
                // Density at rest: the pressure is minus the reference, and so is the ghost's.
                particle.reference_pressure = -pressure;
            }
            let mut block = Block::new(&physics, &particles);
            block.step();
            let surface = block.surface();
            let flagged: Vec<usize> = (0..surface.len()).filter(|&i| surface[i] != 0).collect();
            assert!(flagged.len() > 40 && flagged.len() < surface.len(), "{}", flagged.len());
            for name in ["force_r", "force_z", "dissipation_r", "dissipation_z"] {
                let column = block.column(name);
                for &i in &flagged {
                    // Against P/D, what a particle open to one side would feel.
                    let error = column[i].abs() * SIZE / pressure;
                    assert!(error < 1e-12, "{name} of {i} is {error:e} of P/D");
                }
            }
        }
    }
}

/// What a sum over all particles and their images leaves of each one's surroundings, beyond the .01 that settled packings
/// have (`stages/src/void_closing.rs`).
fn voids(simulation: &Simulation) -> Vec<f64> {
    let [r, z, mass, density] =
        ["radius", "axial", "mass", "density"].map(|name| drops::column(simulation, name));
    let surface = simulation.world.store.by_name::<u32>("surface").expect("a column");
    let packing = Packing {
        domain: simulation.physics.domain,
        theta: simulation.physics.method.theta,
        largest_size: 2.0 * simulation.physics.particle_size,
    };
    let area: Vec<f64> = (0..r.len()).map(|i| packing.area(r[i], density[i], mass[i])).collect();
    let period = packing.domain.period.map_or(0.0, |(_, length)| length);
    let shifts: &[f64] = if period > 0.0 { &[-period, 0.0, period] } else { &[0.0] };
    let filled = |i: usize| {
        let reach = (4.0 * packing.theta + 1.0) * area[i].sqrt().min(packing.largest_size);
        let kernel = |dr: f64, dz: f64| {
            let inside = (1.0 - (dr * dr + dz * dz) / (reach * reach)).max(0.0);
            3.0 / (std::f64::consts::PI * reach * reach) * inside * inside
        };
        let images = |b: usize| {
            let of = |shift: &f64| {
                let dz = z[b] + shift - z[i];
                kernel(r[b] - r[i], dz) + kernel(-r[b] - r[i], dz)
            };
            area[b] * shifts.iter().map(of).sum::<f64>()
        };
        (0..r.len()).map(images).sum::<f64>()
    };
    let beyond = |i: usize| match surface[i] {
        INSIDE => (1.0 - filled(i)) - (1.0 - filled(i)).clamp(-0.01, 0.01),
        _ => 0.0,
    };
    (0..r.len()).map(beyond).collect()
}

#[test]
fn voids_are_what_all_particles_leave() {
    const JET: &str = include_str!("../../cases/rayleigh-plateau-jet/pinch-off.toml");
    let scenes = [drops::drop(&["amplitude=0.6"]), drops::scene(JET, &["particle_size=radius/7"])];
    for scene in &scenes {
        let mut simulation = drops::start(scene);
        drops::advance(&mut simulation, 400);
        // Lists are some steps old, and the next look is not yet due.
        simulation.world.clock.step = 0;
        assert!(simulation.run_stage("void-closing").is_ok_and(|is_there| is_there));
        let found = drops::column(&simulation, "void_fraction");
        let expected = voids(&simulation);
        assert!(
            expected.iter().filter(|void| **void != 0.0).count() > 10,
            "{}: hardly any voids",
            scene.title
        );
        for (i, (found, expected)) in found.iter().zip(&expected).enumerate() {
            assert!((found - expected).abs() < 1e-12, "{}, {i}: {found:e}, not {expected:e}", scene.title);
        }
    }
}
