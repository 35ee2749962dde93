//! Checkpoints of a hundred thousand particles, to the disk and back: `cargo bench -p meniscus-benches --bench
//! checkpoint`.
//!
//! Throughput is in bytes of the file. Writing ends with the flush to the disk, so the disk is measured as well.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use meniscus_benches::{advance, drop_of, start};
use meniscus_cases::simulation::Simulation;
use meniscus_engine::checkpoint::{self, Mapped};
use std::hint::black_box;

fn checkpoints(criterion: &mut Criterion) {
    let scene = drop_of(100_000);
    let mut simulation = start(&scene);
    advance(&mut simulation, 1);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join(checkpoint::file_name(1));
    let state = simulation.checkpoint(&scene);
    checkpoint::write(&path, &state).expect("the folder can be written");
    let bytes = std::fs::metadata(&path).expect("it was just written").len();

    let mut group = criterion.benchmark_group("checkpoint");
    group.sample_size(20).throughput(Throughput::Bytes(bytes));
    group.bench_function("gather the state", |bencher| bencher.iter(|| simulation.checkpoint(&scene)));
    group.bench_function("write", |bencher| {
        bencher.iter(|| checkpoint::write(&path, &state).expect("the folder can be written"));
    });
    group.bench_function("read", |bencher| {
        bencher.iter(|| checkpoint::read(&path).expect("it was written whole"));
    });
    group.bench_function("map, columns unread", |bencher| {
        bencher.iter(|| black_box(Mapped::open(&path).expect("it was written whole")));
    });
    group.bench_function("resume from what was read", |bencher| {
        bencher.iter(|| black_box(Simulation::resume(&scene, &state).is_ok()));
    });
    group.finish();
}

criterion_group!(benches, checkpoints);
criterion_main!(benches);
