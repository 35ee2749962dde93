//! The launcher: what it starts, and that arguments, exit code and signals are those of what it has started.
#![cfg(target_arch = "x86_64")]

use std::io::{BufRead, BufReader};
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::{Command, Stdio};

use meniscus_portable::{LEVELS, Level};
use rustix::process::{Pid, Signal, kill_process};
use tempfile::TempDir;

fn best() -> Option<&'static Level> {
    Level::best(&LEVELS)
}

/// A folder with the launcher, and a shell in the place of the command that it should start.
fn folder() -> TempDir {
    let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).unwrap();
    // The launcher looks beside its own file, which a symbolic link would lead away from here.
    std::fs::hard_link(env!("CARGO_BIN_EXE_launch"), folder.path().join("meniscus")).unwrap();
    for level in &LEVELS {
        let right = best().is_some_and(|best| best.name == level.name);
        symlink(if right { "/bin/sh" } else { "/bin/false" }, folder.path().join(level.program())).unwrap();
    }
    folder
}

fn launcher(folder: &Path) -> Command {
    Command::new(folder.join("meniscus"))
}

#[test]
fn arguments_and_exit_code_pass_through() {
    let folder = folder();
    let script = r#"printf '<%s>' "$@"; exit 37"#;
    let output = launcher(folder.path()).args(["-c", script, "0", "two words", "", "*"]).output().unwrap();
    if best().is_none() {
        assert_eq!(output.status.code(), Some(2));
        assert!(String::from_utf8(output.stderr).unwrap().contains("needs an x86-64 processor with AVX2"));
        return;
    }
    assert_eq!(output.status.code(), Some(37));
    assert_eq!(String::from_utf8(output.stdout).unwrap(), "<two words><><*>");
}

#[test]
fn a_signal_reaches_what_was_started() {
    let folder = folder();
    let script = "trap 'exit 42' TERM; echo ready; while :; do sleep 0.01; done";
    let mut command = launcher(folder.path());
    let mut child = command.args(["-c", script]).stdout(Stdio::piped()).spawn().unwrap();
    let mut line = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
    if best().is_none() {
        assert_eq!(child.wait().unwrap().code(), Some(2));
        return;
    }
    assert_eq!(line, "ready\n");
    kill_process(Pid::from_child(&child), Signal::TERM).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(42));
}

#[test]
fn a_build_that_is_missing_is_named() {
    let Some(level) = best() else { return };
    let folder = folder();
    std::fs::remove_file(folder.path().join(level.program())).unwrap();
    let output = launcher(folder.path()).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains(&level.program()) && said.contains("copy the whole folder"), "{said}");
}
