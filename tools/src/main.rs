//! The command `meniscus`.

use std::process::ExitCode;

#[cfg(unix)]
#[global_allocator]
static MEMORY: meniscus_engine::memory::StaggeredMemory = meniscus_engine::memory::StaggeredMemory::new();

fn main() -> ExitCode {
    meniscus::command::main()
}
