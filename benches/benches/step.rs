//! The whole step from ten thousand particles on, and each stage in the course of such steps, on one thread:
//! `cargo bench -p meniscus-benches --bench step`.
//!
//! Throughput is in particles: 10 Melem/s are 100 ns per particle and step. With `MENISCUS_MILLION` set in the
//! environment a million particles are measured, too.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use meniscus_benches::{advance, drop_of, drop_scene, one_thread, start};
use meniscus_cases::scene::Precision;
use meniscus_cases::simulation::Simulation;
use std::time::Duration;

fn whole_step(criterion: &mut Criterion) {
    let pool = one_thread();
    let million = std::env::var_os("MENISCUS_MILLION").map(|_| 1_000_000);
    let mut group = criterion.benchmark_group("whole step");
    group.sample_size(20);
    for particles in [10_000, 100_000].into_iter().chain(million) {
        for precision in [Precision::Double, Precision::Mixed] {
            let mut scene = drop_of(particles);
            scene.method.precision = precision;
            let mut simulation = pool.install(|| start(&scene));
            group.throughput(Throughput::Elements(simulation.world.store.len() as u64));
            let name = match precision {
                Precision::Double => BenchmarkId::from_parameter(particles),
                Precision::Mixed => BenchmarkId::new("mixed precision", particles),
            };
            group.bench_function(name, |bencher| {
                pool.install(|| bencher.iter(|| advance(&mut simulation, 1)));
            });
        }
    }
    group.finish();
}

fn stages(criterion: &mut Criterion) {
    let pool = one_thread();
    for (name, choices) in [("stages", "paper=false"), ("stages of the paper's method", "paper=true")] {
        let mut simulation = start(&drop_scene(&["particle_size=35.7 nm", choices]));
        let mut group = criterion.benchmark_group(name);
        group.sample_size(10).warm_up_time(Duration::from_millis(500));
        group.measurement_time(Duration::from_secs(2));
        group.throughput(Throughput::Elements(simulation.world.store.len() as u64));
        let stages: Vec<&'static str> = simulation.costs().iter().map(|cost| cost.stage).collect();
        for stage in stages {
            // A stage is timed where it belongs, between its neighbours: alone it would find its data in
            // the caches, and the curvature, which rests in most steps, would always or never work.
            group.bench_function(stage, |bencher| {
                bencher.iter_custom(|steps| {
                    let before = time_in(&simulation, stage);
                    pool.install(|| advance(&mut simulation, steps));
                    time_in(&simulation, stage) - before
                });
            });
        }
        group.finish();
    }
}

fn time_in(simulation: &Simulation, stage: &str) -> Duration {
    simulation.costs().iter().filter(|cost| cost.stage == stage).map(|cost| cost.time).sum()
}

criterion_group!(benches, whole_step, stages);
criterion_main!(benches);
