use super::*;
use crate::scene::parse;
use crate::simulation::to_the_end;

const DROP: &str = r#"format = 1
[liquid]
density = "1000 kg/m3"
surface_tension = "0.074 N/m"
[[body]]
shape = { spheroid = { radial = "1 um", axial = "1.1 um" } }
velocity = { r = "0 m/s", z = "0.3 m/s" }
[particles]
size = "90 nm"
[run]
until = "1 us"
"#;

fn scene(set: &[&str]) -> Scene {
    let settings: Vec<String> = set.iter().map(|s| (*s).to_owned()).collect();
    parse("drop.toml", DROP, &settings).unwrap()
}

fn start(scene: &Scene) -> Simulation {
    Simulation::new(scene, &mut to_the_end).unwrap()
}

fn run(mut simulation: Simulation, steps: u64) -> Simulation {
    for _ in 0..steps {
        simulation.step().unwrap();
    }
    simulation
}

fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build().unwrap().install(work)
}

/// Every column as bits: equal numbers are not enough.
fn bits(checkpoint: &Checkpoint) -> Vec<(String, Vec<u64>)> {
    let column = |column: &Column| {
        let bits = match &column.data {
            Data::F64(values) => values.iter().map(|value| value.to_bits()).collect(),
            Data::U32(values) => values.iter().map(|value| u64::from(*value)).collect(),
        };
        (column.name.clone(), bits)
    };
    checkpoint.columns.iter().map(column).collect()
}

fn assert_same(a: &Checkpoint, b: &Checkpoint) {
    assert_eq!(a.clock, b.clock);
    for ((name, a), (other, b)) in bits(a).iter().zip(&bits(b)) {
        assert_eq!(name, other);
        assert!(a == b, "`{name}` differs");
    }
    assert_eq!(a.columns.len(), b.columns.len());
}

/// Lists are renewed and curvatures skipped at various steps: each cut lies elsewhere between them.
#[test]
fn an_interruption_leaves_no_trace() {
    for set in [&[][..], &["paper=true"], &["method.shifting=0.5"], &["method.precision=mixed"]] {
        let scene = scene(set);
        let whole = with_threads(1, || run(start(&scene), 250).checkpoint(&scene));
        for cut in [0, 1, 97, 143] {
            let half = with_threads(1, || run(start(&scene), cut).checkpoint(&scene));
            let rest = with_threads(2, || {
                let resumed = Simulation::resume(&scene, &half).unwrap();
                run(resumed, 250 - cut).checkpoint(&scene)
            });
            assert_same(&whole, &rest);
        }
    }
}

#[test]
fn a_checkpoint_comes_back_as_it_was() {
    let scene = scene(&[]);
    let checkpoint = run(start(&scene), 3).checkpoint(&scene);
    let again = Simulation::resume(&scene, &checkpoint).unwrap();
    assert_same(&checkpoint, &again.checkpoint(&scene));
    assert_eq!(checkpoint.scene, scene.text);
}

#[test]
fn what_does_not_fit_is_said() {
    let scene = scene(&[]);
    let good = run(start(&scene), 2).checkpoint(&scene);
    let refused = |change: &dyn Fn(&mut Checkpoint), fragment: &str| {
        let mut bad = good.clone();
        change(&mut bad);
        let Err(error) = Simulation::resume(&scene, &bad) else {
            panic!("taken in spite of {fragment}");
        };
        let said = error.to_string();
        assert!(said.contains(fragment), "{said}");
    };
    let mark = |checkpoint: &mut Checkpoint, name: &str, value: u32| {
        let column = checkpoint.columns.iter_mut().find(|c| c.name == name);
        match column.map(|column| &mut column.data) {
            Some(Data::U32(values)) => values[4] = value,
            _ => panic!("no {name}"),
        }
    };
    let set = |checkpoint: &mut Checkpoint, name: &str, value: f64| {
        let column = checkpoint.columns.iter_mut().find(|c| c.name == name);
        match column.map(|column| &mut column.data) {
            Some(Data::F64(values)) => values[4] = value,
            _ => panic!("no {name}"),
        }
    };
    let without = |checkpoint: &mut Checkpoint| checkpoint.columns.retain(|c| c.name != "mass");
    refused(&without, "lacks `mass`");
    refused(&|c| c.columns.clear(), "lacks ");
    refused(&|c| set(c, "velocity_r", f64::NAN), "velocity_r");
    refused(&|c| set(c, "density", 0.0), "a density is 0");
    refused(&|c| set(c, "radius", -1e-9), "a radius is");
    refused(&|c| mark(c, "drop", u32::MAX), "a drop has the number 4294967295");
    refused(&|c| c.clock.time = f64::NAN, "time is NaN");
    refused(
        &|c| c.clock.scalars.push(("gauge".to_owned(), f64::NAN)),
        "the number `gauge` of its clock is NaN",
    );
    refused(&|c| mark(c, "identity", u32::MAX), "the largest there is");
    let crashed = |c: &mut Checkpoint| {
        let told = ["fault in stage flux", "fault of quantity density", "fault of particle"];
        let told = told.into_iter().chain(["fault at radius", "fault at axial"]);
        c.clock.scalars.extend(told.map(|name| (name.to_owned(), 1.0)));
    };
    refused(&crashed, "in it `flux` broke down");
    if good.column("refinement").is_some() {
        refused(&|c| set(c, "refinement", 1.0), "a refinement is 1e0");
    }
}
