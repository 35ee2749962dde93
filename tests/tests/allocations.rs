//! A step takes no memory from the system once the run is warm.

use meniscus_tests::drops;
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicU64, Ordering};

/// Counts what the process asks for.
struct Counting;

static REQUESTS: AtomicU64 = AtomicU64::new(0);

// SAFETY: everything goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        REQUESTS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller's promise is passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise is passed on.
        unsafe { System.dealloc(memory, layout) }
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        REQUESTS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: the caller's promise is passed on.
        unsafe { System.realloc(memory, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Requests in steps without and with a rebuild of the list, and how many rebuilds there were.
fn requests(settings: &[&str], warm_up: usize, steps: usize) -> (u64, u64, u64) {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(2)
        .build()
        .expect("a pool");
    // From inside the pool: handing work to a pool from outside takes memory of its own.
    pool.install(|| {
        let mut simulation = drops::start(&drops::drop(settings));
        drops::advance(&mut simulation, warm_up);
        let (mut without, mut with, mut rebuilds) = (0, 0, 0);
        for _ in 0..steps {
            let builds = simulation.world.neighbours.builds();
            let before = REQUESTS.load(Ordering::Relaxed);
            drops::advance(&mut simulation, 1);
            let taken = REQUESTS.load(Ordering::Relaxed) - before;
            if simulation.world.neighbours.builds() == builds {
                without += taken;
            } else {
                (with, rebuilds) = (with + taken, rebuilds + 1);
            }
        }
        (without, with, rebuilds)
    })
}

// One test alone: the count is the process's.
#[test]
fn a_warm_step_takes_no_memory() {
    let cases: [(&str, &[&str]); 3] = [
        ("default", &["resolution=20"]),
        ("shifting", &["resolution=20", "method.shifting=0.5"]),
        ("paper", &["resolution=20", "paper=true"]),
    ];
    for (name, settings) in cases {
        let (without, with, rebuilds) = requests(settings, 100, 200);
        println!("{name}: {without} without a rebuild, {with} in {rebuilds} rebuilds");
        assert_eq!(without, 0, "{name}: requests in steps without a rebuild");
    }
    // A fast flow: lists age quickly.
    let (without, with, rebuilds) = requests(&["resolution=20", "amplitude=3"], 600, 400);
    println!("fast: {without} without a rebuild, {with} in {rebuilds} rebuilds");
    assert_eq!(without, 0, "requests in steps without a rebuild");
    assert!(rebuilds > 0, "no rebuild in the steps that were watched");
}
