//! The flux pass by the layout of its data, on one thread: `cargo bench -p meniscus-benches --bench flux`.
//!
//! Throughput is in particles. The scalar loop is the reference of the tests: the same sums over the same list,
//! one neighbour after the other, from one record a particle.

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use meniscus_benches::{advance, drop_of, drop_scene, one_thread, shuffled, start};
use meniscus_cases::simulation::Simulation;
use meniscus_engine::neighbours::NeighbourList;
use meniscus_stages::reference_pressure::FIRST_REFERENCE;
use meniscus_tests::drops::column;
use meniscus_tests::liquid::medium;
use meniscus_tests::reference::{Medium, Particle, Sums};
use std::hint::black_box;
use std::time::Instant;

fn run(simulation: &mut Simulation, stage: &str) {
    let found = simulation.run_stage(stage).unwrap_or_else(|fault| panic!("{fault}"));
    assert!(found, "no stage `{stage}`");
}

/// List, rows and sums of one moment.
fn prepare(simulation: &mut Simulation) {
    for stage in ["sort-bin", "equation-of-state", "flux"] {
        run(simulation, stage);
    }
}

fn bench(group: &mut BenchmarkGroup<WallTime>, name: BenchmarkId, simulation: &mut Simulation) {
    prepare(simulation);
    group.throughput(Throughput::Elements(simulation.world.store.len() as u64));
    group.bench_function(name, |bencher| {
        one_thread().install(|| bencher.iter(|| run(simulation, "flux")));
    });
}

fn rows(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("flux by rows");
    let size = "particle_size=35.7 nm";
    let variants: [(&str, &[&str]); 2] = [
        ("flow state, first-order", &[size, "method.flux=first-order", "method.kernel_correction=false"]),
        ("with rates of deformation, low dissipation", &[size]),
    ];
    for (name, settings) in variants {
        let mut simulation = start(&drop_scene(settings));
        advance(&mut simulation, 20);
        bench(&mut group, BenchmarkId::from_parameter(name), &mut simulation);
    }
    group.finish();
}

fn precision(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("flux by precision");
    for precision in ["double", "mixed"] {
        let setting = format!("method.precision={precision}");
        let mut simulation = start(&drop_scene(&["particle_size=35.7 nm", &setting]));
        advance(&mut simulation, 20);
        bench(&mut group, BenchmarkId::from_parameter(precision), &mut simulation);
    }
    group.finish();
}

fn memory_order(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("flux by memory order");
    group.sample_size(20);
    for particles in [10_000, 100_000] {
        let mut simulation = start(&drop_of(particles));
        bench(&mut group, BenchmarkId::new("Morton", particles), &mut simulation);
        let order = shuffled(simulation.world.store.len());
        simulation.world.store.permute(&order);
        // Without a list one is built where the particles now lie in memory; they aren't sorted anew.
        simulation.world.neighbours = NeighbourList::default();
        bench(&mut group, BenchmarkId::new("chance", particles), &mut simulation);
    }
    group.finish();
}

fn lanes(criterion: &mut Criterion) {
    let mut simulation = start(&drop_scene(&["particle_size=35.7 nm"]));
    advance(&mut simulation, 20);
    let mut group = criterion.benchmark_group("flux by lanes");
    bench(&mut group, BenchmarkId::from_parameter("eight particles side by side"), &mut simulation);

    let (medium, particles) = (medium(&simulation.physics), particles(&simulation));
    let list = &simulation.world.neighbours;
    let strain = column(&simulation, "strain_rate");
    let scale = strain.iter().fold(0.0f64, |most, rate| most.max(rate.abs()));
    for (a, strain) in strain.iter().enumerate() {
        let error = (sums(&medium, &particles, list, a).strain_rate - strain).abs() / scale;
        assert!(error < 1e-9, "the scalar loop sums something else: {error:e} of the largest strain rate");
    }
    let scalar =
        || -> Vec<Sums> { (0..particles.len()).map(|a| sums(&medium, &particles, list, a)).collect() };
    group.bench_function("scalar", |bencher| bencher.iter(scalar));
    group.finish();
    let scalar = least_time(|| drop(black_box(scalar())));
    let lanes = one_thread().install(|| least_time(|| run(&mut simulation, "flux")));
    println!("the scalar loop takes {:.1} times as long", scalar / lanes);
}

/// Seconds that the fastest of some calls takes.
fn least_time(mut call: impl FnMut()) -> f64 {
    let times = (0..20).map(|_| {
        let start = Instant::now();
        call();
        start.elapsed().as_secs_f64()
    });
    times.fold(f64::INFINITY, f64::min)
}

fn sums(medium: &Medium, particles: &[Particle], list: &NeighbourList, a: usize) -> Sums {
    let neighbours = list.of(a).map(|number| match number.checked_sub(particles.len()) {
        None => (number, 0.0, false),
        Some(image) => {
            let image = &list.images()[image];
            (image.source as usize, image.shift, image.mirrored)
        }
    });
    medium.sums_over(particles, a, neighbours)
}

fn particles(simulation: &Simulation) -> Vec<Particle> {
    let [r, z, u, w] = ["radius", "axial", "velocity_r", "velocity_z"].map(|name| column(simulation, name));
    let [density, mass, reference_pressure, kernel_scale] =
        ["density", "mass", "reference_pressure", "kernel_scale"].map(|name| column(simulation, name));
    let first_reference = simulation.world.clock.number(FIRST_REFERENCE);
    // The rate of deformation of the step before, moved on to the present.
    let elapsed = simulation.world.clock.previous_step_size;
    let [rr, shear, zz] = ["rr", "shear", "zz"].map(|component| {
        let [rate, change] = ["deformation", "deformation_change"]
            .map(|name| column(simulation, &format!("{name}_{component}")));
        rate.iter().zip(&change).map(|(rate, change)| rate + elapsed * change).collect::<Vec<f64>>()
    });
    let particle = |i: usize| Particle {
        position: [r[i], z[i]],
        velocity: [u[i], w[i]],
        density: density[i],
        mass: mass[i],
        reference_pressure: first_reference + reference_pressure[i],
        gradient: [[rr[i], 0.5 * shear[i]], [0.5 * shear[i], zz[i]]],
        kernel_scale: kernel_scale[i],
    };
    (0..r.len()).map(particle).collect()
}

criterion_group!(benches, rows, precision, memory_order, lanes);
criterion_main!(benches);
