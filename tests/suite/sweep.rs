//! The sweep over options: what it covers, its forms, and what it refuses; never how fast anything is.

use serde_json::Value;
use skipgrid::measure::{Axis, RayOptions, SweepOptions, sweep};
use skipgrid::scene::{LoadOptions, load};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

fn folder(test: &str) -> PathBuf {
    crate::folder("sweep", test)
}

/// Exit code, standard output and standard error of the verb.
fn skipgrid(folder: &Path, args: &[&str]) -> (Option<i32>, String, String) {
    crate::ended(crate::program(folder).arg("sweep").args(args))
}

fn options() -> SweepOptions {
    let rays = RayOptions { width: 12, height: 12, ..RayOptions::default() };
    SweepOptions { densities: vec![0.125, 2.0, 64.0], rounds: 1, rays }
}

#[test]
fn every_option_is_swept_and_work_follows_the_density() {
    let scene = load("random:n=300", &LoadOptions::default()).expect("a scene");
    let accels = ["grid", "grid-octant", "bsp", "nested:density=1"].map(String::from);
    let done = sweep(&scene, &accels, &options(), &|_, _, _| {}, &AtomicBool::new(false)).expect("a sweep");
    assert!(done.identical() && !done.interrupted && done.left_out.is_empty());
    let of = |accel: usize, axis: Option<Axis>| -> Vec<&str> {
        let settings = done.settings.iter().filter(|s| s.accel == accel && s.axis == axis);
        settings.map(|s| s.value.as_str()).collect()
    };
    assert_eq!(of(0, None), [""]);
    assert_eq!(of(0, Some(Axis::Density)), ["0.125", "2", "64"]);
    assert_eq!(of(0, Some(Axis::Mailbox)), ["off", "on"]);
    assert_eq!(of(0, Some(Axis::Leap)), [""; 0]);
    assert_eq!(of(1, Some(Axis::Leap)), ["1", "2", "3", "5", "8", "16"]);
    assert_eq!(of(2, Some(Axis::Leaf)), ["1", "2", "4", "8", "16", "32"]);
    assert_eq!((of(3, None).len(), of(3, Some(Axis::Density)).len()), (1, 0));

    // Finer grids: more steps, fewer tests, more bytes. Counts do not depend on the machine.
    let grids: Vec<_> = done.settings.iter().filter(|s| s.accel == 0 && s.axis == Some(Axis::Density)).collect();
    for (coarse, fine) in grids.iter().zip(&grids[1..]) {
        assert!(coarse.build.memory.total() < fine.build.memory.total());
        for (a, b) in coarse.rates.iter().zip(&fine.rates) {
            let (a, b) = (a.expect("rays").counts, b.expect("rays").counts);
            assert!(a.steps < b.steps && a.tests > b.tests, "{a:?} {b:?}");
        }
    }
    // A mailbox spares tests and no step.
    let [off, on] = [0, 1].map(|i| done.settings.iter().filter(|s| s.axis == Some(Axis::Mailbox)).nth(i).expect("two"));
    for (off, on) in off.rates.iter().zip(&on.rates) {
        let (off, on) = (off.expect("rays").counts, on.expect("rays").counts);
        assert!(off.steps == on.steps && off.tests > on.tests, "{off:?} {on:?}");
    }
    // Each accelerator's best for each kind of rays, timed once more: one of its settings; itself at exactly 1.
    assert_eq!(done.finals.len(), 4 * 3);
    for best in &done.finals {
        assert!(best.gain() > 0.0 && best.spread() >= 0.0);
        assert!(done.settings.iter().any(|s| s.spec == best.setting.spec && s.accel == best.setting.accel));
        assert!(best.setting.axis.is_some() || (best.gain(), best.spread(), best.is_clear()) == (1.0, 0.0, false));
    }
    for kind in 0..3 {
        let fastest = done.fastest(kind).expect("timed");
        let of = |f: &&skipgrid::measure::Final| f.kind == kind;
        assert!(done.finals.iter().filter(of).all(|f| f.setting.ratios[kind] <= fastest.setting.ratios[kind]));
    }
}

#[test]
fn what_cannot_be_built_is_left_out_with_its_reason() {
    let scene = load("random:n=300", &LoadOptions::default()).expect("a scene");
    let accels = ["grid:memory=20K".to_string()];
    let done = sweep(&scene, &accels, &options(), &|_, _, _| {}, &AtomicBool::new(false)).expect("a sweep");
    assert!(done.left_out.len() == 1 && done.left_out[0].0.contains("density=64"), "{:?}", done.left_out);
    assert!(done.left_out[0].1.contains("allowed"), "{:?}", done.left_out);
    assert!(done.settings.iter().all(|s| s.value != "64") && done.settings.len() == 5);

    let stopped = sweep(&scene, &accels, &options(), &|_, _, _| {}, &AtomicBool::new(true)).expect("a sweep");
    assert!(stopped.interrupted && stopped.settings.is_empty() && stopped.finals.is_empty());
}

#[test]
fn text_csv_json_and_figure_say_the_same() {
    let folder = folder("forms");
    let mut args =
        vec!["random:n=60", "--accel", "grid", "--accel", "grid-cl*", "--accel", "bsp", "--densities", "0.5,4"];
    args.extend(["--size", "8x8", "--rounds", "2", "--csv", "a.csv", "--json", "a.json", "--svg", "a.svg"]);
    let (code, text, notes) = skipgrid(&folder, &args);
    assert_eq!(code, Some(0), "{notes}");
    assert!(text.contains("identical hits") && text.contains("fastest of all is"), "{text}");
    let read = |name: &str| fs::read_to_string(folder.join(name)).expect("written");
    let json: Value = serde_json::from_str(&read("a.json")).expect("JSON");
    let settings = json["settings"].as_array().expect("settings");
    // grid: itself, 2 densities, 2 mailboxes; clouds: 6 thresholds more; bsp: itself and 6 leaves.
    assert_eq!(settings.len(), 5 + 11 + 7);
    assert_eq!(json["best"].as_array().map(Vec::len), Some(9));
    let csv = read("a.csv");
    let (header, lines) = csv.split_once('\n').expect("a header");
    assert_eq!(lines.lines().count(), 3 * settings.len());
    let column =
        |name: &str| header.split(',').position(|h| h == name).unwrap_or_else(|| panic!("no {name}: {header}"));
    let (rays, steps, bytes) = (column("rays"), column("steps_per_ray"), column("bytes"));
    let mut lines = lines.lines();
    for setting in settings {
        for rate in setting["rates"].as_array().expect("rates") {
            // No specification here has a comma.
            let cells: Vec<&str> = lines.next().expect("a line").split(',').collect();
            assert_eq!(rate["rays"], cells[rays]);
            assert_eq!(setting["bytes"].as_u64(), cells[bytes].parse().ok());
            let count =
                json["kinds"].as_array().expect("kinds").iter().find(|k| k["rays"] == rate["rays"]).expect("it");
            let per_ray = rate["steps"].as_f64().expect("steps") / count["count"].as_f64().expect("rays");
            assert!((cells[steps].parse::<f64>().expect("a number") - per_ray).abs() <= 1e-12 * per_ray, "{cells:?}");
        }
    }
    let svg = read("a.svg");
    for words in
        ["camera rays over density", "diffuse rays over threshold", "shadow rays over leaf", "nanoseconds a ray"]
    {
        assert!(svg.contains(words), "{words}");
    }
    // Three lines in the panels of densities, one in those of thresholds and of leaves: bsp has no density.
    let elements = crate::papers::elements(&svg);
    assert_eq!((elements["svg"], elements["polyline"]), (1, 3 * (2 + 1 + 1)), "{elements:?}");
}

#[test]
fn bad_input_has_its_code_and_says_why() {
    let folder = folder("bad");
    let cases: [(&[&str], i32, &str); 6] = [
        (&["random:n=9", "--accel", "gird"], 2, "did you mean `grid`?"),
        (&["random:n=9", "--accel", "grod*"], 2, "no accelerator's name begins so"),
        (&["random:n=9", "--densities", "1,0"], 2, "above 0"),
        (&["random:n=9", "--rounds", "0"], 2, "0"),
        (&["absent.obj"], 3, "absent.obj"),
        (&["random:n=9", "--csv", "nowhere/a.csv"], 3, "nowhere"),
    ];
    for (args, code, cause) in cases {
        let (found, stdout, stderr) = skipgrid(&folder, args);
        assert_eq!((found, stdout.as_str()), (Some(code), ""), "{args:?}: {stderr}");
        assert!(stderr.contains(cause), "{args:?}: {stderr}");
    }
}
