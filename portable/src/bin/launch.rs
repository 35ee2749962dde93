//! The launcher of a portable build: becomes the command that is built for the best level which the processor
//! knows. It lies beside them under the name `meniscus`.

use std::env;
use std::os::unix::process::CommandExt;
use std::process::{Command, ExitCode};

use meniscus_portable::{LEVELS, Level};

fn main() -> ExitCode {
    let problem = launch();
    eprintln!("{problem}");
    ExitCode::from(2)
}

/// Returns only where nothing could be started, and says why. The program takes the place of this one: its
/// arguments, its exit code and the signals to it pass through no one's hands.
fn launch() -> String {
    let Some(level) = Level::best(&LEVELS) else {
        return "this build of meniscus needs an x86-64 processor with AVX2; \
                build it for this one from its sources: cargo build --release"
            .to_owned();
    };
    let program = match env::current_exe() {
        Ok(launcher) => launcher.with_file_name(level.program()),
        Err(error) => return format!("cannot tell where meniscus lies: {error}"),
    };
    let error = Command::new(&program).args(env::args_os().skip(1)).exec();
    format!(
        "cannot start `{}`: {error}; the launcher meniscus needs the builds beside it: copy the whole folder \
         that `cargo portable` made",
        program.display()
    )
}
