//! Plans under runners of commands that others wrote, where they are installed.
#![cfg(unix)]

use super::*;
use std::process::Command;

const PICTURE: [&str; 7] = ["cornell", "--size", "40x30", "--spp", "8", "--threads", "1"];

/// A folder with `plan.txt`, of twelve shards.
fn planned(test: &str) -> PathBuf {
    let folder = folder(test);
    let lines = plan(&folder, &PICTURE, &["--tiles", "3x2", "--samples-per-shard", "4"]);
    assert_eq!(lines.len(), 12);
    write(&folder, "plan.txt", lines.join("\n") + "\n");
    folder
}

fn merged_as_one_render(folder: &Path) {
    merge(folder, "merged.exr").done(&["12 shards"]);
    assert!(fs::read(folder.join("merged.exr")).expect("written") == unsharded(folder, &PICTURE, "whole.exr"));
}

/// Whether `command` prints `words`; if not, the test skips, and says so.
fn installed(command: &str, words: &str) -> bool {
    let output = Command::new(command).arg("--version").output();
    let found = output.is_ok_and(|output| String::from_utf8_lossy(&output.stdout).contains(words));
    if !found {
        eprintln!("skipped: {words} `{command}` is not installed");
    }
    found
}

#[test]
fn gnu_parallel_runs_a_plan_and_goes_on_where_it_was_ended() {
    if !installed("parallel", "GNU") {
        return;
    }
    let folder = planned("parallel");
    let parallel = "parallel --will-cite --jobs 2 --joblog log --resume";
    // As if ended after the fifth command, with one shard lost since.
    shell(&folder, &format!("head -n 5 plan.txt | {parallel}"), &[]).done(&["million rays"]);
    assert_eq!(shards(&folder).len(), 5);
    let first = fs::metadata(&shards(&folder)[0]).and_then(|meta| meta.modified()).expect("there");
    let run = shell(&folder, &format!("{parallel} < plan.txt"), &[]);
    run.done(&["million rays"]);
    assert_eq!(run.stderr.matches("million rays").count(), 7, "{}", run.stderr);
    let log = fs::read_to_string(folder.join("log")).expect("a log");
    let codes: Vec<&str> = log.lines().skip(1).map(|line| line.split('\t').nth(6).expect("a code")).collect();
    assert_eq!(codes, ["0"; 12], "{log}");
    assert_eq!(fs::metadata(&shards(&folder)[0]).and_then(|meta| meta.modified()).expect("there"), first);
    // Nothing is left to do; without its log, nothing is made twice either.
    assert!(!shell(&folder, &format!("{parallel} < plan.txt"), &[]).stderr.contains("million rays"));
    let again = shell(&folder, "parallel --will-cite --jobs 2 < plan.txt", &[]);
    assert_eq!(again.stderr.matches("is there already").count(), 12, "{}", again.stderr);
    merged_as_one_render(&folder);
}

#[test]
fn xargs_runs_a_plan() {
    if !installed("xargs", "GNU") {
        return;
    }
    let folder = planned("xargs");
    shell(&folder, "xargs -d '\\n' -n 1 -P 2 sh -c < plan.txt", &[]).done(&["million rays"]);
    merged_as_one_render(&folder);
}
