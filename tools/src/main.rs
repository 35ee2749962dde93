//! The command `meniscus`.

use std::process::ExitCode;

fn main() -> ExitCode {
    meniscus::command::main()
}
