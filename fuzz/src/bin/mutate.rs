//! A driver without a fuzzer: mutates valid inputs at random, on the stable compiler.
//!
//! ```text
//! cargo run --manifest-path fuzz/Cargo.toml -- TARGET EXECUTIONS [SEED]
//! ```
//!
//! Tells how many inputs were tried, the slowest of them and the most memory that the process held;
//! an input that panics is written to `fuzz-TARGET-SEED-NUMBER.input`, and the exit code is 1.

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use meniscus_engine::checkpoint;

type Target = fn(&[u8]);

const CONDITIONS: [&str; 6] = [
    "density < 990 kg/m3 and not speed > 3 m/s or identity == 7",
    "0 < r <= 1 um and abs(strain_rate) >= 2 MHz",
    "sqrt(r^2 + z^2) < 3 um or -z^3/(1 m)^3 != legendre(2, z/r)",
    "max(r, 2*z) < min(1 um, r) and exp(-r/(1 um)) > 0.5",
    "force*r^2/(2 pi) > 1 nN/m and sin(pi*r/z)^2 < 1",
    "1.5e-6 m^2/s^2 < speed^2 and speed*(1 s) < r/3",
];

/// What mutations put in: pieces of the grammars, and numbers that are awkward.
const WORDS: [&str; 40] = [
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    "\"",
    "'",
    "=",
    "<",
    ">=",
    "!=",
    "==",
    "^",
    "-",
    "/",
    "*",
    ",",
    ".",
    "\n",
    " and ",
    " or ",
    "not ",
    "1e308",
    "-1",
    "0",
    "1e-320",
    "nan",
    "inf",
    "9999999999999999999",
    "um",
    "kg/m3",
    "r",
    "z",
    "sqrt(",
    "\u{b5}",
    "\u{1f4a7}",
    "\\",
    "#",
    "auto",
];

struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn below(&mut self, limit: usize) -> usize {
        (self.next() % limit.max(1) as u64) as usize
    }
}

/// Changes some places of an input.
fn mutate(input: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    for _ in 0..=random.below(4) {
        let place = random.below(input.len() + 1);
        let length = random.below(1 + random.0 as usize % 40);
        let end = (place + length).min(input.len());
        match random.below(8) {
            0 if place < input.len() => input[place] ^= 1 << random.below(8),
            1 if place < input.len() => input[place] = random.next() as u8,
            2 => drop(input.drain(place..end)),
            3 => {
                let piece = input[place..end].to_vec();
                let at = random.below(input.len() + 1);
                input.splice(at..at, piece);
            }
            4 => drop(input.splice(place..end, WORDS[random.below(WORDS.len())].bytes())),
            5 => {
                let from = random.below(other.len() + 1);
                let piece = &other[from..(from + length).min(other.len())];
                input.splice(place..place, piece.iter().copied());
            }
            6 if place + 8 <= input.len() => {
                let word = random.next() >> random.below(64);
                input[place..place + 8].copy_from_slice(&word.to_le_bytes());
            }
            7 if random.below(50) == 0 => {
                let word = WORDS[random.below(WORDS.len())].repeat(1 + random.below(3000));
                input.splice(place..place, word.bytes());
            }
            _ => {}
        }
    }
}

fn corpus(target: &str) -> Vec<Vec<u8>> {
    match target {
        "scene" => scenes(),
        "condition" => CONDITIONS.iter().map(|text| text.as_bytes().to_vec()).collect(),
        "checkpoint" => {
            let file = std::env::temp_dir().join(format!("meniscus-fuzz-{}.meniscus", std::process::id()));
            checkpoint::write(&file, meniscus_fuzz::valid()).expect("a file");
            let bytes = fs::read(&file).expect("the same file");
            fs::remove_file(&file).expect("the same file");
            // Once as it is, once with checksums that are made to fit.
            [0, 1, 1].map(|first| [&[first], &bytes[..]].concat()).to_vec()
        }
        _ => vec![vec![0; 12], vec![7; 60], (0..240).collect()],
    }
}

/// All scenes of the repository.
fn scenes() -> Vec<Vec<u8>> {
    let cases = concat!(env!("CARGO_MANIFEST_DIR"), "/../cases");
    let folders = fs::read_dir(cases).expect("the cases").map(|entry| entry.expect("a case").path());
    let files = folders.filter_map(|folder| fs::read_dir(folder).ok()).flatten();
    let files = files.map(|entry| entry.expect("a file").path());
    let scenes = files.filter(|path| path.extension().is_some_and(|ending| ending == "toml"));
    let mut scenes: Vec<Vec<u8>> = scenes.map(|path| fs::read(path).expect("a scene")).collect();
    scenes.push(meniscus_fuzz::SMALL.as_bytes().to_vec());
    scenes
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let targets: [(&str, Target); 4] = [
        ("scene", meniscus_fuzz::scene),
        ("condition", meniscus_fuzz::condition),
        ("checkpoint", meniscus_fuzz::checkpoint),
        ("state", meniscus_fuzz::state),
    ];
    let number = |index: usize| arguments.get(index).and_then(|text| text.parse::<u64>().ok());
    let target = targets.into_iter().find(|(name, _)| arguments.first().is_some_and(|word| word == name));
    let (Some((name, target)), Some(executions)) = (target, number(1)) else {
        eprintln!("usage: mutate scene|condition|checkpoint|state EXECUTIONS [SEED]");
        return ExitCode::from(2);
    };
    let seed = number(2).unwrap_or(1);
    let corpus = corpus(name);
    let mut random = Random(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1);
    let started = Instant::now();
    let (mut slowest, mut panics) = (Duration::ZERO, 0);
    for execution in 0..executions {
        let mut input = corpus[random.below(corpus.len())].clone();
        let other = &corpus[random.below(corpus.len())];
        mutate(&mut input, other, &mut random);
        let start = Instant::now();
        if catch_unwind(AssertUnwindSafe(|| target(&input))).is_err() {
            panics += 1;
            let file = format!("fuzz-{name}-{seed}-{execution}.input");
            fs::write(&file, &input).expect("a place to write to");
            eprintln!("PANIC on {file}");
        }
        let elapsed = start.elapsed();
        if elapsed > slowest {
            slowest = elapsed;
            if elapsed > Duration::from_secs(1) {
                let file = format!("fuzz-{name}-{seed}-{execution}.slow");
                fs::write(&file, &input).expect("a place to write to");
            }
        }
    }
    println!(
        "{name}: {executions} executions in {:.0} s (seed {seed}), {panics} panics, slowest {:.1} ms, most memory {}",
        started.elapsed().as_secs_f64(),
        slowest.as_secs_f64() * 1e3,
        most_memory()
    );
    ExitCode::from(u8::from(panics > 0))
}

/// The most memory that this process has held, in the system's words.
fn most_memory() -> String {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.map_or("unknown".to_owned(), |line| line.trim().to_owned())
}
