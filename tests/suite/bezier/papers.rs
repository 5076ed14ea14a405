//! `skipgrid papers newton-seeds` on tiny pictures, and the program's verbs on patches; never a time.

use crate::papers::folder;
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn skipgrid(folder: &Path, args: &[&str]) -> Output {
    let output = Command::new(env!("CARGO_BIN_EXE_skipgrid")).args(args).current_dir(folder).output();
    let output = output.expect("the program starts");
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{args:?}: {complaint}");
    output
}

fn rows<'a>(report: &'a Value, name: &str) -> &'a Vec<Value> {
    let mut tables = report["tables"].as_array().expect("tables").iter();
    tables.find(|t| t["name"] == name).expect("the table")["rows"].as_array().expect("rows")
}

#[test]
fn seeds_are_measured_and_judged() {
    let folder = folder("newton-seeds");
    let args = ["papers", "newton-seeds", "--size", "24", "--rounds", "1", "--grids", "16,4", "--meshes", "4,8"];
    let output = skipgrid(&folder, &[&args[..], &["--format", "json", "--svg", "seeds.svg"]].concat());
    let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(report["wrong"], 0);
    let number = |row: &Value, column: &str| row[column].as_f64().expect(column);
    let seeds = rows(&report, "seeds");
    assert_eq!(seeds.len(), 2 * 3);
    for ways in seeds.chunks(3) {
        let [voxel, fixed, halved] = ways else { panic!("three ways") };
        assert!(number(voxel, "seed bytes") > 0.0 && number(fixed, "seed bytes") == 0.0);
        assert_eq!(number(halved, "iterations/test"), 0.0);
        // A part of a patch needs no more halvings than the whole, and the whole fewer with Newton's method than without.
        assert!(number(voxel, "halvings/test") <= number(fixed, "halvings/test"), "{voxel} {fixed}");
        assert!(number(fixed, "halvings/test") < number(halved, "halvings/test"), "{fixed} {halved}");
        // A test that looks at the whole patch may find the winner of a voxel further on, and end the walk earlier.
        assert!(number(voxel, "tests/ray") >= number(fixed, "tests/ray"));
    }
    for row in rows(&report, "alone") {
        assert!(number(row, "hits") > 50.0, "{row}");
        assert!(number(row, "iterations seed") > 0.0 && number(row, "failures % seed") <= 100.0, "{row}");
    }
    let forms = rows(&report, "tessellation");
    assert_eq!(forms.len(), 3);
    assert_eq!((number(&forms[0], "primitives"), number(&forms[0], "mean depth error")), (32.0, 0.0));
    assert!(number(&forms[1], "median depth error") > 2.0 * number(&forms[2], "median depth error"), "{forms:?}");
    let ids: Vec<_> = report["claims"].as_array().expect("claims").iter().map(|c| c["id"].clone()).collect();
    assert_eq!(ids, ["A10", "A10 time"]);
    let svg = std::fs::read_to_string(folder.join("seeds.svg")).expect("was written");
    assert_eq!(svg.matches("<polyline").count(), 3);
}

#[test]
fn the_verbs_take_patches() {
    let folder = folder("patch-verbs");
    let info = skipgrid(&folder, &["info", "teapot-patches", "--accel", "grid:resolution=8", "--format", "json"]);
    let info: Value = serde_json::from_slice(&info.stdout).expect("JSON");
    assert_eq!((&info["patches"], &info["triangles"]), (&32.into(), &0.into()));
    assert!(info["built"].as_str().expect("text").contains("seeds of"), "{info}");
    let middle = skipgrid(&folder, &["info", "teapot-patches", "--accel", "grid:seeds=fixed"]);
    assert!(String::from_utf8_lossy(&middle.stdout).contains("tests begin in the middle"));
    // Compared to the bit; a difference would be exit code 1.
    let few = ["--size", "16x16", "--rounds", "1", "--max-rays", "256"];
    let accels = ["--accel", "grid", "--accel", "grid:seeds=fixed", "--accel", "grid-dsz", "--accel", "brute"];
    skipgrid(&folder, &[&["compare", "teapot-patches"][..], &few, &accels].concat());
    skipgrid(&folder, &["render", "teapot-patches", "--size", "24x24", "--spp", "1", "-o", "pot.png"]);
    skipgrid(&folder, &["export", "teapot-patches", "--to", "povray", "-o", "pot.pov"]);
    let scene = "[[procedural]]\ntype = \"teapot-patches\"\nscale = 2.0\nrotate = [0.0, 30.0, 0.0]\n";
    std::fs::write(folder.join("pot.toml"), scene).expect("writable");
    skipgrid(&folder, &["info", "pot.toml"]);
}
