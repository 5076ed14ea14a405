//! `skipgrid papers` as its user meets it, on tiny pictures: every form, counts and claims; never a time.

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn skipgrid(folder: &Path, args: &[&str]) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_skipgrid")).arg("papers").args(args).current_dir(folder).output();
    output.expect("the program starts")
}

pub fn folder(test: &str) -> PathBuf {
    crate::folder("papers", test)
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("the program writes Unicode")
}

/// The JSON report of a run that must go well.
pub fn report(folder: &Path, args: &[&str]) -> Value {
    let output = skipgrid(folder, &[args, &["--format", "json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{args:?}: {}", text(&output.stderr));
    let value: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(value["wrong"], 0, "{args:?}");
    value
}

/// The rows of a table.
pub fn rows<'a>(report: &'a Value, name: &str) -> &'a Vec<Value> {
    let tables = report["tables"].as_array().expect("tables");
    let table = tables.iter().find(|t| t["name"] == name).unwrap_or_else(|| panic!("no table `{name}`"));
    table["rows"].as_array().expect("rows")
}

pub fn verdicts(report: &Value) -> Vec<(&str, &str)> {
    let claims = report["claims"].as_array().expect("claims").iter();
    claims.map(|c| (c["id"].as_str().expect("an id"), c["verdict"].as_str().expect("a verdict"))).collect()
}

pub fn number(row: &Value, column: &str) -> f64 {
    row[column].as_f64().unwrap_or_else(|| panic!("`{column}` of {row}"))
}

/// Checks that the elements of an SVG are nested properly, and counts those of each name.
pub fn elements(svg: &str) -> std::collections::BTreeMap<&str, usize> {
    let mut counts = std::collections::BTreeMap::new();
    let mut open = Vec::new();
    for tag in svg.split('<').skip(1) {
        let (tag, rest) = tag.split_once('>').expect("every tag ends");
        assert!(!rest.contains('&') || rest.contains(';'), "a bare ampersand: {rest}");
        let name = tag.trim_start_matches('/').split([' ', '/', '\n']).next().expect("a name");
        if tag.starts_with('/') {
            assert_eq!(open.pop(), Some(name));
            continue;
        }
        assert_eq!(tag.matches('"').count() % 2, 0, "an open attribute: {tag}");
        *counts.entry(name).or_insert(0) += 1;
        if !tag.ends_with('/') {
            open.push(name);
        }
    }
    assert!(open.is_empty(), "{open:?}");
    counts
}

#[test]
fn the_loop_as_printed_costs_what_the_paper_says_and_the_scenes_are_the_papers() {
    let folder = folder("amanatides-woo");
    let report =
        report(&folder, &["amanatides-woo", "--size", "24", "--rounds", "1", "--grids", "2,8", "--svg", "a.svg"]);
    let counted: Vec<f64> = rows(&report, "operations").iter().map(|row| number(row, "counted")).collect();
    // Two float compares, one float addition, two integer compares, one integer addition; 33 to 40 to start.
    assert_eq!(counted[..5], [2.0, 1.0, 2.0, 1.0, 33.0]);
    assert!((33.0..=40.0).contains(&counted[5]), "{counted:?}");

    let table = rows(&report, "table");
    let facts: Vec<[f64; 2]> = table.iter().map(|r| ["objects", "subdivision"].map(|c| number(r, c))).collect();
    assert_eq!(facts, [[4.0, 20.0], [31.0, 20.0], [62.0, 30.0], [3540.0, 40.0]]);
    for row in table.iter().chain(rows(&report, "subdivision")) {
        // A ray never meets an object more often with rayID than without.
        assert!(number(row, "tests/ray rayID") <= number(row, "tests/ray"), "{row}");
    }
    for row in rows(&report, "subdivision").iter().filter(|r| r["subdivision"] == 2) {
        assert!(number(row, "objects/voxel") > 0.0, "{row}");
    }
    let verdicts = verdicts(&report);
    assert_eq!(verdicts.iter().map(|v| v.0).collect::<Vec<_>>(), ["A13", "A14", "A15"]);
    let svg = fs::read_to_string(folder.join("a.svg")).expect("was written");
    assert_eq!(elements(&svg)["polyline"], 4);
}

#[test]
fn every_skip_method_enters_fewer_voxels_and_answers_alike() {
    let folder = folder("semwal-kvarnstrom");
    let size = ["--size", "16", "--rounds", "1", "--grids", "16,8"];
    let report = report(&folder, &[&["semwal-kvarnstrom"][..], &size, &["--svg", "s.svg"]].concat());
    let verdicts = verdicts(&report);
    assert_eq!(verdicts.len(), 12);
    for (i, (id, verdict)) in verdicts.iter().enumerate() {
        assert_eq!(*id, format!("C{}", i + 1));
        assert!(["holds", "does not hold here"].contains(verdict), "{id}: {verdict}");
    }
    for scene in ["random", "lanes", "flakes", "cars"] {
        let rows = rows(&report, scene);
        // Three views, two grids, ten methods.
        assert_eq!(rows.len(), 60);
        for methods in rows.chunks(10) {
            assert_eq!(methods[0]["method"], "grid");
            assert_eq!(methods[0]["leaps"], 0);
            for row in methods {
                assert_eq!(row["wrong rays"], 0, "{row}");
                assert_eq!(row["rays"], methods[0]["rays"], "{row}");
                // Skipping leaves out empty voxels only: no more steps and the same tests.
                assert!(number(row, "steps") <= number(&methods[0], "steps"), "{row}");
                assert_eq!(row["tests/ray"], methods[0]["tests/ray"], "{row}");
                let distance = number(&methods[0], "steps") / number(row, "steps");
                assert!((number(row, "mean distance") - distance).abs() < 1e-12, "{row}");
            }
        }
    }
    // 8 x 8 x 8 voxels for 10 x 10 x 10 spheres: every voxel has one or more.
    let properties = rows(&report, "properties");
    let lanes = properties.iter().find(|r| r["scene"] == "lanes" && r["grid"] == 8).expect("a row");
    assert_eq!(number(lanes, "empty voxels %"), 0.0);
    assert!(number(lanes, "objects/occupied voxel") * 512.0 >= 1000.0, "{lanes}");
    // Three methods on four scenes in two grids, and on two fillings of boxes with two thresholds.
    assert_eq!(rows(&report, "landing").len(), 3 * (4 * 2 + 2 * 2));
    assert_eq!(rows(&report, "brute").len(), 1);
    let svg = fs::read_to_string(folder.join("s.svg")).expect("was written");
    // Eight panels of ten rows with two dots each, and the legend: a title for each.
    assert_eq!(elements(&svg)["title"], 8 * 10 * 2 + 2);
}

#[test]
fn any_scene_goes_through_all_accelerators() {
    let folder = folder("spd");
    let args = ["spd", "--quick", "--size", "16", "--scene", "flakes:depth=2", "--scene", "cubes:n=2"];
    let report = report(&folder, &[&args[..], &["--svg", "s.svg"]].concat());
    let rows = rows(&report, "spd");
    assert_eq!(rows.len(), 2 * 12);
    for row in rows {
        assert_eq!(row["wrong rays"], 0, "{row}");
        assert_eq!(row["steps/ray"].is_null(), row["accelerator"].as_str().is_some_and(|a| a.starts_with("obvhs")));
        assert!(number(row, "bytes") > 0.0, "{row}");
    }
    // 1 + 9 + 81 spheres and the floor's two triangles.
    assert_eq!((&rows[0]["primitives"], &rows[0]["accelerator"]), (&93.into(), &"grid".into()));
    elements(&fs::read_to_string(folder.join("s.svg")).expect("was written"));
}

#[test]
fn walks_over_solid_voxels_answer_as_lists_and_nodes_do() {
    let folder = folder("dda");
    let args = ["dda", "--quick", "--size", "16", "--scene", "voxel-terrain:n=16", "--svg", "d.svg"];
    let report = report(&folder, &args);
    let rows_of = rows(&report, "rays");
    // Three lists, eleven accelerators or ten without BVHs.
    let accels = rows_of.len() / 3;
    assert!(rows_of.len().is_multiple_of(3) && (10..=11).contains(&accels), "{}", rows_of.len());
    for list in rows_of.chunks(accels) {
        let [plain, branchless] = [&list[0], &list[1]];
        assert_eq!((&plain["accelerator"], &plain["leaps/ray"]), (&"voxels".into(), &0.0.into()));
        // The same voxels in the same order.
        for column in ["steps/ray", "tests/ray"] {
            assert_eq!(plain[column], branchless[column], "{branchless}");
        }
        for row in list {
            assert_eq!(row["wrong rays"], 0, "{row}");
            let skips = row["accelerator"].as_str().is_some_and(|a| a.contains("skip="));
            assert!(!skips || number(row, "steps/ray") <= number(plain, "steps/ray"), "{row}");
        }
    }
    let verdicts = verdicts(&report);
    assert_eq!(verdicts.iter().map(|v| v.0).collect::<Vec<_>>(), ["B7", "B1", "B3", "B4"]);
    assert!(verdicts[1..].iter().all(|v| v.1 == "does not hold here"), "{verdicts:?}");
    // Half of 10 000 rays within five standard deviations, and every step at a tie.
    let printed: Vec<f64> = rows(&report, "printed").iter().map(|row| number(row, "printed")).collect();
    assert!((4750.0..=5250.0).contains(&printed[4]) && printed[5] == 1000.0, "{printed:?}");
    elements(&fs::read_to_string(folder.join("d.svg")).expect("was written"));
}

#[test]
fn shadow_voxels_spare_rays_and_change_no_pixel() {
    let folder = folder("shadow-voxels");
    let args = ["shadow-voxels", "--quick", "--size", "16", "--scene", "teapot:n=6", "--scene", "flakes:depth=2"];
    let report = report(&folder, &[&args[..], &["--svg", "s.svg"]].concat());
    let rows = rows(&report, "shadow");
    let lights: Vec<f64> = rows.iter().map(|row| number(row, "lights")).collect();
    assert_eq!(lights, [1.0, 4.0, 16.0, 1.0, 4.0, 16.0]);
    for row in rows {
        assert_eq!(row["wrong pixels"], 0, "{row}");
        assert!(number(row, "spared %") + number(row, "shortened %") <= 100.0, "{row}");
        assert!(number(row, "spared %") > 0.0, "{row}");
    }
    assert_eq!(verdicts(&report).iter().map(|v| v.0).collect::<Vec<_>>(), ["A11", "A11t"]);
    elements(&fs::read_to_string(folder.join("s.svg")).expect("was written"));
}

#[test]
fn all_forms_say_the_same() {
    let folder = folder("forms");
    let args = ["semwal-kvarnstrom", "--size", "8", "--rounds", "1", "--grids", "8", "--scene", "lanes"];
    let args = [&args[..], &["--accel", "grid-dsz"]].concat();
    let output = |more: &[&str]| {
        let output = skipgrid(&folder, &[&args[..], more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    let report = report(&folder, &args);
    let steps = rows(&report, "lanes")[1]["steps"].to_string();
    assert!(verdicts(&report).contains(&("C1", "not measured")), "clouds were not asked for");

    let plain = output(&[]);
    assert!(plain.lines().any(|line| line.starts_with("camera") && line.contains(&steps)), "{plain}");
    assert!(plain.contains("C12 ") && plain.contains("NOT MEASURED"), "{plain}");

    assert_eq!(output(&["-o", "r.csv", "-q"]), "");
    let csv = fs::read_to_string(folder.join("r.csv")).expect("was written");
    assert_eq!(csv.lines().next(), Some("table,row,column,value"));
    assert!(csv.contains(&format!("\nlanes,1,steps,{steps}\n")), "{csv}");
    assert!(csv.contains("\nclaims,0,verdict,not measured\n"), "{csv}");

    assert_eq!(output(&["-o", "r.md", "--svg", "plot.svg", "-q"]), "");
    let page = fs::read_to_string(folder.join("r.md")).expect("was written");
    assert!(page.starts_with("# Semwal & Kvarnstrom 1997") && page.contains("(plot.svg)"), "{page}");
    assert!(page.contains(&format!("| {steps} |")), "{page}");
    for table in page.split("\n\n").filter(|block| block.starts_with("| ")) {
        let bars = |line: &str| line.replace("\\|", "").matches('|').count();
        let widths: Vec<usize> = table.lines().map(bars).collect();
        assert!(widths.iter().all(|w| *w == widths[0]), "{table}");
    }
    let mut names: Vec<_> =
        fs::read_dir(&folder).expect("readable").map(|e| e.expect("readable").file_name()).collect();
    names.sort();
    assert_eq!(names, ["plot.svg", "r.csv", "r.md"]);
}

#[test]
fn the_printed_landing_is_not_held_against_the_exact_ones() {
    let folder = folder("landing");
    let args = ["semwal-kvarnstrom", "--size", "32", "--rounds", "1", "--grids", "64", "--scene", "flakes"];
    let report = report(&folder, &[&args[..], &["--accel", "grid-dsz", "--accel", "grid-dsz:landing=paper"]].concat());
    let landing = rows(&report, "landing");
    assert_eq!((landing.len(), &landing[0]["method"]), (1 + 4, &"grid-dsz:landing=paper".into()));
    // Boxes of one voxel show the fault: 3-D leaps of D - 1 units pass over filled voxels.
    let unlimited = landing.iter().filter(|r| r["method"] == "grid-dsz:landing=paper,threshold=1");
    assert!(unlimited.map(|r| number(r, "wrong rays")).sum::<f64>() > 0.0, "{landing:?}");
    // The same rule on the same rays, as one of the methods.
    let printed = rows(&report, "flakes").iter().filter(|r| r["method"] == "grid-dsz:landing=paper");
    assert_eq!(printed.map(|r| number(r, "wrong rays")).sum::<f64>(), number(&landing[0], "wrong rays"));
}

#[test]
fn mistakes_are_explained() {
    let folder = folder("mistakes");
    for (code, named, args) in [
        (2, "did you mean `lanes`", vec!["semwal-kvarnstrom", "--scene", "lane"]),
        (2, "gird", vec!["semwal-kvarnstrom", "--quick", "--accel", "gird"]),
        (2, "density", vec!["spd", "--quick", "--scene", "cubes", "--density=-1"]),
        (2, "does not consist of solid voxels", vec!["dda", "--quick", "--scene", "cornell"]),
        (2, "nowhere", vec!["spd", "--quick", "--scene", "nowhere"]),
        (3, "gone", vec!["amanatides-woo", "-o", "gone/a.md"]),
        (3, "gone", vec!["amanatides-woo", "--svg", "gone/a.svg"]),
        (2, "--size", vec!["spd", "--size", "0"]),
        (2, "--grids", vec!["semwal-kvarnstrom", "--grids", "0"]),
        (2, "wood", vec!["amanatides-wood"]),
    ] {
        let output = skipgrid(&folder, &args);
        let stderr = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{args:?}: {stderr}");
        assert!(stderr.contains(named) && !stderr.contains("panicked"), "{args:?}: {stderr}");
        assert!(output.stdout.is_empty());
    }
    assert_eq!(fs::read_dir(&folder).expect("readable").count(), 0);
}
