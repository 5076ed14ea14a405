//! Shards that are ended in the middle: nothing half-made is left, and the plan goes on from there.
#![cfg(unix)]

use super::*;
use std::os::unix::process::ExitStatusExt;
use std::process::{Command, Stdio};

/// Starts `line`, sends `signal` to it once it listens, and waits.
fn ended(folder: &Path, line: &str, signal: &str) -> std::process::ExitStatus {
    let mut command = Command::new("sh");
    // The shard takes the place of the shell, so that the signal reaches it.
    command.args(["-c", &format!("exec {line}")]).current_dir(folder).stdin(Stdio::null());
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("a shell");
    crate::await_listener(&child);
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status().expect("kill is there");
    assert!(sent.success(), "the shard has ended by itself");
    child.wait().expect("it ends")
}

#[test]
fn a_plan_goes_on_after_a_kill() {
    let folder = folder("kill");
    let picture = ["cornell", "--size", "64x64", "--spp", "16"];
    // The same shards, but for the number of samples, would take minutes.
    let long = plan(&folder, &["cornell", "--size", "640x640", "--spp", "4096"], &["--tiles", "2x1"]);
    let lines = plan(&folder, &picture, &["--tiles", "2x2"]);
    follow(&folder, &lines[0]).done(&["million rays"]);
    assert_eq!(ended(&folder, &long[1], "-KILL").signal(), Some(9));
    assert_eq!(ended(&folder, &long[0], "-INT").code(), Some(130));
    assert_eq!(ended(&folder, &long[0], "-TERM").code(), Some(130));
    let there = names(&folder.join("parts"));
    assert_eq!(there.len(), 1, "{there:?}");
    follow(&folder, &lines[0]).done(&["is there already"]);
    // What a kill within a write leaves has another name, and is no shard; a later process may have the number of that one.
    lines[1..].iter().for_each(|line| {
        let file = line.rsplit(' ').next().expect("a file name");
        follow(&folder, &format!("echo half > {file}.$$-0.part; exec {line}")).done(&["million rays"]);
        let left = names(&folder.join("parts")).into_iter().filter(|name| name.ends_with("-0.part"));
        left.for_each(|name| assert_eq!(fs::read(folder.join("parts").join(name)).expect("there"), b"half\n"));
    });
    assert_eq!(names(&folder.join("parts")).len(), 4 + 3);
    merge(&folder, "merged.exr").done(&["4 shards"]);
    assert!(fs::read(folder.join("merged.exr")).expect("written") == unsharded(&folder, &picture, "whole.exr"));
}
