//! The cost of the flux pass and of the whole step, per particle: `cargo bench -p meniscus-benches`.
//!
//! One thread, the oscillating drop with everything on; throughput is in particles, so that criterion's
//! "thrpt" is particles per second: 10 Melem/s are 100 ns per particle and step.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use meniscus_benches::drop_in_motion;
use rayon::ThreadPoolBuilder;

fn step(criterion: &mut Criterion) {
    let pool = ThreadPoolBuilder::new().num_threads(1).build().expect("one thread can be had");
    let variants = [
        ("defaults", "71.4 nm", "paper=false"),
        ("defaults", "35.7 nm", "paper=false"),
        ("paper", "35.7 nm", "paper=true"),
    ];
    for (name, size, choices) in variants {
        let mut simulation = drop_in_motion(&[&format!("particle_size={size}"), choices]);
        let particles = simulation.world.store.len() as u64;
        let mut group = criterion.benchmark_group(name);
        group.throughput(Throughput::Elements(particles));
        group.bench_function(BenchmarkId::new("whole step", particles), |bencher| {
            pool.install(|| bencher.iter(|| simulation.step().expect("the drop is stable")));
        });
        for stage in ["sort-bin", "equation-of-state", "flux"] {
            group.bench_function(BenchmarkId::new(stage, particles), |bencher| {
                pool.install(|| bencher.iter(|| simulation.run_stage(stage).expect("the drop is stable")));
            });
        }
        group.finish();
    }
}

criterion_group!(benches, step);
criterion_main!(benches);
