//! Neighbour lists and memory order, on one thread: `cargo bench -p meniscus-benches --bench lists`.
//!
//! Throughput is in particles.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use meniscus_benches::{drop_of, one_thread, shuffled, start};
use meniscus_cases::simulation::Simulation;
use meniscus_engine::morton;
use meniscus_engine::neighbours::{NeighbourList, WINDOW};
use std::hint::black_box;

fn column(simulation: &Simulation, name: &str) -> Vec<f64> {
    simulation.world.store.by_name::<f64>(name).expect("every scene has it").to_vec()
}

fn lists(criterion: &mut Criterion) {
    let pool = one_thread();
    let mut group = criterion.benchmark_group("lists");
    group.sample_size(20);
    for particles in [10_000, 100_000] {
        let simulation = pool.install(|| start(&drop_of(particles)));
        let [r, z, reach] = ["list_radius", "list_axial", "list_reach"].map(|name| column(&simulation, name));
        group.throughput(Throughput::Elements(r.len() as u64));
        group.bench_function(BenchmarkId::new("build", particles), |bencher| {
            let mut list = NeighbourList::default();
            let domain = simulation.physics.domain;
            pool.install(|| bencher.iter(|| list.build([&r, &z, &reach], &domain)));
        });
        let cell = reach.iter().copied().fold(0.0, f64::max);
        let mut sort = |name: &str, r: &[f64], z: &[f64]| {
            group.bench_function(BenchmarkId::new(name, particles), |bencher| {
                let mut memory = Vec::new();
                let mut order = || morton::order(r, z, cell, WINDOW, &mut memory).map(<[u32]>::len);
                pool.install(|| bencher.iter(|| black_box(order())));
            });
        };
        sort("Morton order, found in order", &r, &z);
        let mixed = |column: &[f64]| shuffled(column.len()).iter().map(|&i| column[i as usize]).collect();
        let [r, z]: [Vec<f64>; 2] = [mixed(&r), mixed(&z)];
        sort("Morton order, sorted from chance", &r, &z);
    }
    group.finish();
}

criterion_group!(benches, lists);
criterion_main!(benches);
