//! Interrupts, sent for real.
#![cfg(unix)]

use super::{Run, folder, names, write};
use skipgrid::picture::io;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

fn start(folder: &Path, args: &[&str]) -> Child {
    crate::program(folder).args(args).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program starts")
}

fn send(signal: &str, child: &Child) {
    crate::await_listener(child);
    let sent = Command::new("kill").args([signal, &child.id().to_string()]).status().expect("kill is there");
    assert!(sent.success(), "the program has ended by itself");
}

fn end(child: Child) -> Run {
    Run::new(&"interrupted", &child.wait_with_output().expect("it ends"))
}

/// Renders for hours unless interrupted, and sends `signal` after a while; if that was too early for a single pixel, waits
/// longer.
fn interrupted(folder: &Path, out: &str, signal: &str) -> Run {
    for seconds in [1, 4, 16, 64] {
        let args = ["render", "cornell", "--size", "1000x1000", "--spp", "4096", "--threads", "2", "-o", out];
        let child = start(folder, &args);
        std::thread::sleep(Duration::from_secs(seconds));
        send(signal, &child);
        let run = end(child);
        assert_eq!(run.code, Some(130), "{}", run.stderr);
        if run.stderr.contains("pixels have all") {
            return run;
        }
    }
    panic!("no pixel in a minute");
}

#[test]
fn a_picture_is_kept_as_far_as_it_is_and_says_so() {
    let folder = folder("partial");
    for (out, partial, signal) in [("a.exr", "a.partial.exr", "-INT"), ("a.b.png", "a.b.partial.png", "-TERM")] {
        write(&folder, out, "the old one");
        let run = interrupted(&folder, out, signal);
        assert!(run.stderr.contains("interrupted") && run.stderr.contains(partial), "{}", run.stderr);
        assert!(run.stdout.is_empty(), "{}", run.stdout);
        assert_eq!(fs::read(folder.join(out)).expect("still there"), b"the old one");
        let picture = io::read(folder.join(partial)).expect("a whole file");
        assert_eq!((picture.width, picture.height), (1000, 1000));
        let lit = picture.pixels.iter().filter(|p| **p != [0.0; 3]).count();
        assert!(lit > 0 && lit < 1_000_000, "{lit} pixels");
    }
    let attributes = io::read_attributes(folder.join("a.partial.exr")).expect("a whole file");
    let state = attributes.get(io::PARTIAL).expect("it says so");
    assert!(state.contains("of 1000000 pixels have all their 4096 samples"), "{state}");
    let png = fs::read(folder.join("a.b.partial.png")).expect("there");
    assert!(png.windows(13).any(|w| w == b"tEXtpartial\0".iter().chain(&w[12..]).copied().collect::<Vec<_>>()));
    assert_eq!(names(&folder), ["a.b.partial.png", "a.b.png", "a.exr", "a.partial.exr"]);
}

#[test]
fn pixels_of_a_partial_picture_are_those_of_the_whole_one() {
    use skipgrid::render::{Sampler, Settings, render, render_until};
    use std::sync::atomic::{AtomicBool, Ordering};
    let scene = skipgrid::scene::load("cornell", &Default::default()).expect("a scene");
    let accel = scene.accel("grid").expect("a grid");
    let settings =
        Settings { width: 48, height: 48, sampler: Sampler::Sobol(2), threads: Some(1), ..Settings::default() };
    let whole = render(&scene, &*accel, &settings, &|_, _| {}).expect("a film");
    let stop = AtomicBool::new(false);
    // After the third of nine tiles.
    let progress = |done: usize, _: usize| stop.store(done >= 3, Ordering::Relaxed);
    let part = render_until(&scene, &*accel, &settings, &progress, &stop).expect("a film");
    assert_eq!(part.finished, 3 * 16 * 16);
    for (i, sum) in part.film.sum.iter().enumerate() {
        let expected = if i / 48 < 16 { whole.sum[i] } else { glam::DVec3::ZERO };
        assert_eq!(*sum, expected, "pixel {i}");
    }
}

#[test]
fn a_second_interrupt_and_other_verbs_end_with_nothing_left() {
    let folder = folder("ends");
    let render = ["render", "cornell", "--size", "1000x1000", "--spp", "4096", "-o", "out.pfm"];
    let child = start(&folder, &render);
    std::thread::sleep(Duration::from_millis(500));
    send("-INT", &child);
    // It may have ended by the first already.
    let _ = Command::new("kill").args(["-INT", &child.id().to_string()]).stderr(Stdio::null()).status();
    assert_eq!(end(child).code, Some(130));
    let _ = fs::remove_file(folder.join("out.partial.pfm"));
    assert!(!names(&folder).contains(&"out.pfm".into()));
    let long = ["compare", "random:n=20000", "--rounds", "1000000", "--max-rays", "4000"];
    let child = start(&folder, &long);
    std::thread::sleep(Duration::from_secs(1));
    send("-INT", &child);
    let run = end(child);
    assert_eq!(run.code, Some(130), "{}", run.stderr);
    assert!(run.stdout.is_empty() && run.stderr.contains("interrupted"), "{}", run.stderr);
}

#[test]
fn a_validation_reports_what_is_finished() {
    let folder = folder("validation");
    skipgrid_renders(&folder);
    // Hours of other seeds; the comparison itself takes a moment.
    let common = ["validate", "--scene", "cornell", "--theirs", "a.pfm", "b.pfm", "--accel", "grid", "--threads", "2"];
    for seconds in [2, 8, 32, 64] {
        let args = [&common[..], &["--spp", "4", "--reseed", "10000", "--report", "r.html"]].concat();
        let child = start(&folder, &args);
        std::thread::sleep(Duration::from_secs(seconds));
        send("-INT", &child);
        let run = end(child);
        assert_eq!(run.code, Some(130), "{}", run.stderr);
        // Too early for a comparison, or for one with other seeds.
        if !run.stdout.contains("reseeded: ") {
            continue;
        }
        assert!(
            run.stdout.contains("1 comparisons passed; interrupted, ") && run.stdout.contains("reseeded: "),
            "{}",
            run.stdout
        );
        assert!(fs::read_to_string(folder.join("r.partial.html")).expect("the report").contains("interrupted"));
        let numbers = fs::read_to_string(folder.join("r.partial.json")).expect("its numbers");
        let numbers: serde_json::Value = serde_json::from_str(&numbers).expect("JSON");
        assert!(numbers["report"]["unfinished"].as_u64() > Some(0), "{numbers}");
        assert_eq!(names(&folder), ["a.pfm", "b.pfm", "r.partial.html", "r.partial.json"]);
        return;
    }
    panic!("no comparison in a minute");
}

/// Measurements that take hours: an interrupt, sent later and later until something is finished, leaves what is finished
/// under names of its own, whole, and the older file as it was.
#[test]
fn measurements_keep_what_is_finished() {
    let folder = folder("measurements");
    let files = ["--csv", "m.csv", "--json", "m.json", "--svg", "m.svg"];
    // They listen between scenes and between options, of which each takes a second or so, and all together minutes.
    let scenes: Vec<String> = (10..100).map(|n| format!("random:n={n}")).collect();
    for (signal, verb) in [
        ("-INT", format!("bench {} --accel brute --rays 64 --rounds 100", scenes.join(" "))),
        ("-TERM", "sweep random:n=500 --accel grid --accel grid-* --size 8x8 --rounds 30".into()),
        ("-INT", "converge cornell --accel grid --size 64x64 --spp 131072 --reference a.pfm".into()),
    ] {
        write(&folder, "a.pfm", [&b"PF\n64 64\n-1.0\n"[..], &[0; 64 * 64 * 12]].concat());
        write(&folder, "m.csv", "the old one");
        let args: Vec<&str> = verb.split(' ').chain(files).collect();
        let kept = [1, 2, 4, 8, 16, 32].iter().find_map(|seconds| {
            let child = start(&folder, &args);
            std::thread::sleep(Duration::from_secs(*seconds));
            send(signal, &child);
            let run = end(child);
            assert_eq!(run.code, Some(130), "{verb}: {}", run.stderr);
            assert_eq!(fs::read(folder.join("m.csv")).expect("still there"), b"the old one");
            let nothing = run.stderr.contains("nothing was finished, nothing is written");
            assert_eq!(nothing, run.stdout.is_empty(), "{verb}: {}", run.stderr);
            if nothing {
                assert_eq!(names(&folder), ["a.pfm", "m.csv"], "{verb}");
            }
            (!nothing).then_some(run)
        });
        let run = kept.unwrap_or_else(|| panic!("{verb}: nothing in half a minute"));
        assert!(run.stderr.contains("written: m.partial.json"), "{verb}: {}", run.stderr);
        assert_eq!(names(&folder), ["a.pfm", "m.csv", "m.partial.csv", "m.partial.json", "m.partial.svg"]);
        let read = |name: &str| fs::read_to_string(folder.join(name)).expect("whole");
        let numbers: serde_json::Value = serde_json::from_str(&read("m.partial.json")).expect("JSON");
        assert_eq!(numbers["interrupted"], true);
        let widths: Vec<usize> = read("m.partial.csv").lines().map(|line| line.split(',').count()).collect();
        assert!(widths.len() > 1 && widths.iter().all(|n| *n == widths[0]), "{verb}: {widths:?}");
        assert!(read("m.partial.svg").trim_end().ends_with("</svg>"), "{verb}");
        ["m.partial.csv", "m.partial.json", "m.partial.svg"].iter().for_each(|name| {
            fs::remove_file(folder.join(name)).expect("there");
        });
    }
}

/// Verbs that keep nothing: the signal ends them, and no file is there.
#[test]
fn other_verbs_leave_no_file() {
    let folder = folder("nothing");
    for (signal, verb) in [
        ("-TERM", "stress --accel brute --rays 100000000 --csv m.csv --json m.json --html m.html"),
        ("-INT", "papers spd --rounds 1000 -o m.json --svg m.svg"),
        ("-TERM", "shard cornell --size 1000x1000 --spp 4096 --tile 0,0,1000,1000 --samples 0..4096 -o m.shard.exr"),
    ] {
        let child = start(&folder, &verb.split(' ').collect::<Vec<_>>());
        std::thread::sleep(Duration::from_secs(1));
        send(signal, &child);
        let run = end(child);
        assert_eq!(run.code, Some(130), "{verb}: {}", run.stderr);
        assert!(run.stdout.is_empty() && run.stderr.contains("interrupted"), "{verb}: {}", run.stderr);
        assert_eq!(names(&folder), [""; 0], "{verb}");
    }
}

/// Two small renders of `cornell`, `a.pfm` and `b.pfm`.
fn skipgrid_renders(folder: &Path) {
    for (out, seed) in [("a.pfm", "100"), ("b.pfm", "101")] {
        let args = ["render", "cornell", "--size", "24x24", "--spp", "4", "--seed", seed, "-o", out];
        assert_eq!(end(start(folder, &args)).code, Some(0));
    }
}
