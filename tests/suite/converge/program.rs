//! `skipgrid converge`: its forms, what it refuses, and the other renderers where they are installed.

use super::folder;
use serde_json::Value;
use skipgrid::picture::{Picture, io};
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

/// Exit code, standard output and standard error of the verb; `path` stands for the search path if given.
fn skipgrid(folder: &Path, args: &[&str], path: Option<&str>) -> (Option<i32>, String, String) {
    let path = path.map(|path| ("PATH", path));
    crate::ended(crate::program(folder).arg("converge").args(args).envs(path))
}

#[test]
fn bad_input_has_its_code_and_says_why() {
    let folder = folder("bad");
    let picture =
        |w: u32, h: u32, value: f32| Picture { width: w, height: h, pixels: vec![[value; 3]; (w * h) as usize] };
    io::write(folder.join("3x2.pfm"), &picture(3, 2, 0.5), &io::Attributes::default()).expect("written");
    io::write(folder.join("nan.pfm"), &picture(8, 8, f32::NAN), &io::Attributes::default()).expect("written");
    let cases: [(&[&str], i32, &str); 13] = [
        (
            &["cornell", "--size", "8x8", "--reference", "3x2.pfm"],
            2,
            "3x2.pfm: the reference is 3 x 2, the pictures are 8 x 8",
        ),
        (&["cornell", "--size", "8x8", "--reference", "nan.pfm"], 2, "nan.pfm"),
        (&["cornell", "--reference", "absent.exr"], 3, "absent.exr"),
        (&["cornell", "--reference", "self:0"], 2, "self:SPP"),
        (&["cornell", "--reference", "self:3"], 2, "even number"),
        (&["cornell", "--spp", "0"], 2, "0"),
        (&["cornell", "--spp", "1"], 2, "1"),
        (&["cornell", "--replicates", "2"], 2, "2"),
        (&["cornell", "--accel", "gird"], 2, "did you mean `grid`?"),
        (&["cornell", "--against", "blender"], 2, "blender"),
        (&["cornell", "--target", "0"], 2, "above 0"),
        (&["cornell", "--equal-time", "1"], 2, "--pictures"),
        (&["cornell", "--svg", "nowhere/a.svg"], 3, "nowhere"),
    ];
    for (args, code, cause) in cases {
        let (found, stdout, stderr) = skipgrid(&folder, args, None);
        assert_eq!((found, stdout.as_str()), (Some(code), ""), "{args:?}: {stderr}");
        assert!(stderr.contains(cause), "{args:?}: {stderr}");
    }
}

#[test]
fn text_csv_json_curves_and_pictures_say_the_same() {
    let folder = folder("forms");
    let mut args =
        vec!["cornell", "--size", "8x8", "--spp", "8", "--reference", "self:64", "--accel", "grid", "--accel", "brute"];
    args.extend(["--csv", "a.csv", "--json", "a.json", "--svg", "a.svg", "--target", "1e-9", "--target", "1e9"]);
    args.extend(["--equal-time", "0.5", "--pictures", "equal", "--against", "mitsuba,povray"]);
    // An empty search path: the other renderers are absent.
    let (code, text, notes) = skipgrid(&folder, &args, Some(""));
    assert_eq!(code, Some(0), "{notes}");
    assert!(notes.contains("mitsuba is left out: ") && notes.contains("povray is left out: "), "{notes}");
    assert!(text.contains("identical pictures") && text.contains("efficiency"), "{text}");
    let read = |name: &str| fs::read_to_string(folder.join(name)).expect("written");
    let json: Value = serde_json::from_str(&read("a.json")).expect("JSON");
    assert_eq!((&json["identical"], &json["interrupted"]), (&Value::Bool(true), &Value::Bool(false)));
    let curves = json["curves"].as_array().expect("curves");
    assert_eq!(curves.iter().map(|c| c["renderer"].as_str()).collect::<Vec<_>>(), [Some("grid"), Some("brute")]);
    assert_eq!(json["crossovers"].as_array().map(Vec::len), Some(1));

    let csv = read("a.csv");
    let (header, lines) = csv.split_once('\n').expect("a header");
    assert_eq!(lines.lines().count(), 6);
    for line in lines.lines() {
        let get = |name: &str| {
            let column =
                header.split(',').position(|h| h == name).unwrap_or_else(|| panic!("no column {name}: {header}"));
            line.split(',').nth(column).unwrap_or_else(|| panic!("no {name}: {line}"))
        };
        let number = |name: &str| get(name).parse::<f64>().unwrap_or_else(|_| panic!("{name} of {line}"));
        let curve = curves.iter().find(|c| c["renderer"] == get("accelerator")).expect("the curve");
        let points = curve["points"].as_array().expect("points");
        let point = points.iter().find(|p| p["spp"].as_u64() == get("spp").parse().ok()).expect("the point");
        for (name, key) in [("mse", "mse"), ("seconds_total", "seconds"), ("variance", "variance"), ("bias2", "bias2")]
        {
            let value = point[key].as_f64().expect("a number");
            // Reading JSON rounds the last bit either way.
            assert!((value - number(name)).abs() <= 1e-12 * value.abs(), "{name}: {value} is not {line}");
        }
        let parts = number("seconds_build") + number("seconds_trace");
        assert!((parts - number("seconds_total")).abs() <= 1e-12 * parts, "{line}");
        assert!((number("efficiency") * number("mse") * number("seconds_total") - 1.0).abs() < 1e-9, "{line}");
        assert_eq!((get("scene"), get("clock"), get("replicates")), ("cornell", "processor", "3"));
    }
    let targets = curves[0]["targets"].as_array().expect("targets");
    assert_ne!(targets[0]["how"], "measured");
    assert_eq!((&targets[1]["how"], targets[1]["spp"].as_f64()), (&Value::from("measured"), Some(2.0)));

    let svg = read("a.svg");
    assert!(svg.contains("1 / seconds") && svg.contains("stroke-dasharray"), "{svg}");
    // For each of two curves a band and a line, and the guide; the marks of grid are circles, those of brute squares.
    let elements = crate::papers::elements(&svg);
    assert_eq!((elements["polygon"], elements["polyline"], elements["circle"]), (2, 3, 3 + 1), "{elements:?}");
    for name in ["reference", "1-grid", "2-brute"] {
        for extension in ["exr", "png"] {
            let picture = io::read(folder.join(format!("equal/{name}.{extension}"))).expect("a picture");
            assert_eq!((picture.width, picture.height), (8, 8));
        }
    }
    let shots = json["equal_time"].as_array().expect("equal time");
    assert!(shots.iter().all(|s| s["samples"].as_u64().is_some_and(|n| n >= 2 && n % 2 == 0)), "{shots:?}");
}

/// Whether a program runs here; says so if not.
fn runs(program: &str, args: &[&str]) -> bool {
    let there = Command::new(program).args(args).stdin(Stdio::null()).output().is_ok_and(|o| o.status.success());
    if !there {
        eprintln!("skipped: `{program}` does not run here");
    }
    there
}

#[test]
fn mitsuba_converges_to_our_picture() {
    if !runs("python3", &["-c", "import mitsuba, numpy"]) {
        return;
    }
    let folder = folder("mitsuba");
    let args =
        ["cornell", "--size", "16x16", "--spp", "16", "--accel", "grid", "--against", "mitsuba", "--format", "json"];
    let (code, stdout, stderr) = skipgrid(&folder, &args, None);
    assert_eq!(code, Some(0), "{stderr}");
    let json: Value = serde_json::from_str(&stdout).expect("JSON");
    let curve = &json["curves"][1];
    assert_eq!((&curve["renderer"], &curve["clock"]), (&Value::from("mitsuba"), &Value::from("wall")));
    let points = curve["points"].as_array().expect("points");
    assert_eq!(points.len(), 4);
    let of = |point: &Value, key: &str| point[key].as_f64().expect("a number");
    // Independent samples: an eighth, if nothing but noise is there; three replicates scatter by far less than a factor of two.
    let ratio = of(&points[0], "mse") / of(&points[3], "mse");
    assert!((4.0..16.0).contains(&ratio), "{ratio}");
    let (bias, error) = (of(&points[3], "bias2"), of(&points[3], "bias2_error"));
    // Student's quantiles for 1 in 100 and 1 in 20 and two degrees of freedom are 9.92 and 4.30.
    assert!(bias <= 9.92 / 4.30 * error, "{bias} +- {error}");
}

#[test]
fn povray_comes_near_our_whitted_picture() {
    if !runs("povray", &["--version"]) {
        return;
    }
    let folder = folder("povray");
    let scene = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference/scenes/lanes.toml").display().to_string();
    let mut args = vec![scene.as_str(), "--size", "24x18", "--spp", "64", "--accel", "grid", "--against", "povray"];
    args.extend(["--integrator", "whitted", "--format", "json", "--reference", "self:1024"]);
    let (code, stdout, stderr) = skipgrid(&folder, &args, None);
    assert_eq!(code, Some(0), "{stderr}");
    let json: Value = serde_json::from_str(&stdout).expect("JSON");
    let points = json["curves"][1]["points"].as_array().expect("points");
    assert_eq!(points.iter().map(|p| p["spp"].as_u64()).collect::<Vec<_>>(), [Some(4), Some(16), Some(64)]);
    assert!(points.iter().all(|p| p["variance"].is_null() && p["replicates"].as_array().is_some_and(|r| r.len() == 1)));
    let mse = |i: usize| points[i]["mse"].as_f64().expect("a number");
    // The regular grid misses edges by at most half a cell: its error falls at least by four for each halving of the cells,
    // and no picture of another scene does that.
    assert!(mse(1) < mse(0) / 2.0 && mse(2) < mse(1) / 2.0, "{} {} {}", mse(0), mse(1), mse(2));
}
