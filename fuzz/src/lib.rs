//! What each target does with its bytes. None may panic, hang, or take memory without bound; whether
//! the input is accepted does not matter. cargo-fuzz and the driver `mutate` call the same functions.

use std::path::Path;
use std::sync::OnceLock;

use meniscus_cases::assemble::{Physics, assemble};
use meniscus_cases::scene::{self, Condition, Scene};
use meniscus_cases::simulation::Simulation;
use meniscus_engine::checkpoint::{self, Checkpoint, Data};
use xxhash_rust::xxh3::xxh3_64;

/// A scene of some fifty particles.
pub const SMALL: &str = r#"format = 1
[liquid]
density = "1000 kg/m3"
surface_tension = "0.074 N/m"
[[body]]
shape = { sphere = { radius = "1 um" } }
velocity = { r = "-0.1 m/s * r/(1 um)", z = "0.2 m/s * z/(1 um)" }
[particles]
size = "190 nm"
[run]
until = "1 us"
"#;

const FIELDS: [(&str, &str); 5] =
    [("density", "kg/m3"), ("speed", "m/s"), ("strain_rate", "1/s"), ("identity", "1"), ("force", "N/m3")];

/// The reader of scenes, and what looks at a scene before any particle exists.
pub fn scene(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    match scene::parse("fuzz.toml", &text, &[]) {
        Ok(scene) => {
            let _ = assemble(&Physics::of(&scene));
            assert!(scene::parse("again.toml", &scene.text, &[]).is_ok(), "a scene's own text is read again");
        }
        Err(diagnosis) => {
            let _ = (diagnosis.to_string(), diagnosis.line(), diagnosis.blamed());
        }
    }
}

/// The reader of expressions, by conditions: these hold all that expressions do.
pub fn condition(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    match Condition::parse(&text, &FIELDS) {
        Ok(condition) => {
            let _ = condition.holds(1e-6, -2e-6, &[998.0, 3.0, f64::NAN, 7.0, -1e300]);
        }
        Err(diagnosis) => {
            let _ = (diagnosis.to_string(), diagnosis.blamed());
        }
    }
}

/// The reader of checkpoints. Where the first byte is odd the checksums are made to fit, so that the
/// checks behind them are reached.
pub fn checkpoint(bytes: &[u8]) {
    let Some((first, bytes)) = bytes.split_first() else {
        return;
    };
    let mut bytes = bytes.to_vec();
    if first % 2 == 1 {
        forge(&mut bytes);
    }
    if let Ok(checkpoint) = checkpoint::parse(Path::new("fuzz"), &bytes) {
        let _ = Simulation::resume(small(), &checkpoint);
    }
}

/// A whole checkpoint with forged values: whatever the particles are said to be, a run that goes on from
/// them goes on, or names what is wrong.
pub fn state(bytes: &[u8]) {
    let mut checkpoint = valid().clone();
    for change in bytes.chunks_exact(12).take(20) {
        let (place, value) = change.split_at(4);
        let column = place[0] as usize % checkpoint.columns.len();
        let row = u16::from_le_bytes([place[1], place[2]]) as usize;
        let mut word = [0; 8];
        word.copy_from_slice(value);
        match &mut checkpoint.columns[column].data {
            Data::F64(values) => {
                let row = row % values.len();
                let old = values[row];
                values[row] = match place[3] % 4 {
                    0 => f64::from_le_bytes(word),
                    1 => old * f64::from(value[0]),
                    2 => -old,
                    _ => old * 10_f64.powi(i32::from(value[0] as i8)),
                };
            }
            Data::U32(values) => {
                let row = row % values.len();
                values[row] = u32::from_le_bytes([value[0], value[1], value[2], value[3]]);
            }
        }
    }
    if let Ok(mut simulation) = Simulation::resume(small(), &checkpoint) {
        for _ in 0..3 {
            if let Err(fault) = simulation.step() {
                let _ = fault.to_string();
                break;
            }
        }
    }
}

/// Puts right checksums into what is long enough to have some.
pub fn forge(bytes: &mut [u8]) {
    const PAGE: usize = 4096;
    if bytes.len() < PAGE {
        return;
    }
    let length = |bytes: &[u8], place: usize| {
        let word = bytes[place..place + 8].try_into().map_or(0, u64::from_le_bytes);
        usize::try_from(word).ok()?.checked_next_multiple_of(PAGE)
    };
    let preface = length(bytes, 24).and_then(|length| Some(PAGE..PAGE.checked_add(length)?));
    let columns = preface.clone().and_then(|preface| {
        let end = preface.end.checked_add(length(bytes, 40)?)?;
        Some(preface.end..end)
    });
    for (range, place) in [(preface, 32), (columns, 48)] {
        if let Some(section) = range.and_then(|range| bytes.get(range)) {
            let checksum = xxh3_64(section).to_le_bytes();
            bytes[place..place + 8].copy_from_slice(&checksum);
        }
    }
    let checksum = xxh3_64(&bytes[..PAGE - 8]).to_le_bytes();
    bytes[PAGE - 8..PAGE].copy_from_slice(&checksum);
}

/// The small scene.
pub fn small() -> &'static Scene {
    static SCENE: OnceLock<Scene> = OnceLock::new();
    SCENE.get_or_init(|| scene::parse("small.toml", SMALL, &[]).expect("a scene"))
}

/// The small scene after some steps.
pub fn valid() -> &'static Checkpoint {
    static CHECKPOINT: OnceLock<Checkpoint> = OnceLock::new();
    CHECKPOINT.get_or_init(|| {
        let mut simulation = Simulation::new(small(), &mut |_| {}).expect("a start");
        (0..5).for_each(|_| simulation.step().expect("a step"));
        simulation.checkpoint(small())
    })
}
