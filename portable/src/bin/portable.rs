//! Builds the command for every level and lays the launcher beside them: `cargo portable`.

use std::env;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use meniscus_portable::LEVELS;

/// What every processor of the architecture knows: the launcher must start on all of them.
const BASELINE: &str = "x86-64";

fn main() -> ExitCode {
    match build() {
        Ok(launcher) => {
            println!("{} starts the best of the builds beside it", launcher.display());
            ExitCode::SUCCESS
        }
        Err(problem) => {
            eprintln!("{problem}");
            ExitCode::FAILURE
        }
    }
}

/// Gives the launcher's place.
fn build() -> Result<PathBuf, Box<dyn Error>> {
    // This program lies in the folder of its profile in that of all builds.
    let program = env::current_exe()?;
    let target = program.ancestors().nth(2).ok_or("this program does not lie among cargo's builds")?;
    let folder = target.join("portable");
    fs::create_dir_all(&folder)?;
    for level in &LEVELS {
        let built = compile(["meniscus", "meniscus"], level.name, &target.join(level.name))?;
        place(&built, &folder.join(level.program()))?;
    }
    let launcher = folder.join("meniscus");
    place(&compile(["meniscus-portable", "launch"], BASELINE, &target.join(BASELINE))?, &launcher)?;
    Ok(launcher)
}

/// Builds a program of a package for a processor, in a folder of its own, and gives the program's place.
fn compile([package, program]: [&str; 2], processor: &str, target: &Path) -> Result<PathBuf, Box<dyn Error>> {
    let status = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .args(["build", "--release", "--package", package, "--bin", program, "--target-dir"])
        .arg(target)
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
        // Stronger than what the configuration says.
        .env("RUSTFLAGS", format!("-Ctarget-cpu={processor}"))
        .env_remove("CARGO_ENCODED_RUSTFLAGS")
        .status()?;
    if !status.success() {
        return Err(format!("`{program}` could not be built for {processor}").into());
    }
    Ok(target.join("release").join(program))
}

/// Copies a program, also over one that is running.
fn place(program: &Path, to: &Path) -> Result<(), Box<dyn Error>> {
    let copy = to.with_extension("new");
    fs::copy(program, &copy)?;
    Ok(fs::rename(&copy, to)?)
}
