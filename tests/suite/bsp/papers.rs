//! `skipgrid papers arvo` on small trees and a tiny picture: counts and claims; never a time.

use crate::papers::{elements, folder, number, report, rows, verdicts};
use std::fs;

#[test]
fn the_notes_counts_are_measured_and_judged() {
    let folder = folder("arvo");
    let args = ["arvo", "--quick", "--grids", "16,4", "--rays", "50", "--size", "16", "--scene", "flakes:depth=1"];
    let report = report(&folder, &[&args[..], &["--svg", "a.svg"]].concat());
    let regular = rows(&report, "regular");
    assert_eq!(regular.len(), 2 * 5);
    for (trees, (n, path)) in regular.chunks(5).zip([(4.0, 7.0), (16.0, 13.0)]) {
        for row in trees {
            assert_eq!(number(row, "N"), n);
            // All walks meet the same leaves, at most 3N.
            assert_eq!(row["leaves/ray"], trees[0]["leaves/ray"], "{row}");
            assert!(number(row, "most leaves/N") <= 3.0, "{row}");
        }
        for row in &trees[..3] {
            assert!(number(row, "nodes/leaf most") < 6.1, "{row}");
            assert_eq!(row["nodes/ray"], trees[0]["nodes/ray"], "{row}");
        }
        assert!((number(&trees[3], "nodes/leaf") - path).abs() < 1e-9, "{}", trees[3]);
    }
    let cases = rows(&report, "cases");
    assert_eq!(cases.len(), 2 * 2 * 5);
    for row in cases.iter().filter(|row| row["case"] == "best") {
        let path = 3.0 * number(row, "N").log2() + 1.0;
        assert_eq!((number(row, "leaves"), number(row, "nodes")), (1.0, path), "{row}");
    }
    for row in cases.iter().filter(|row| row["case"] == "worst" && row["N"] == 16) {
        // Nearly a diagonal: 16 leaves on each axis, so 3 x 15 faces are crossed.
        assert_eq!(row["leaves"], 46, "{row}");
    }
    let scenes = rows(&report, "scenes");
    assert_eq!((scenes.len(), &scenes[0]["accelerator"]), (9, &"grid".into()));
    let [interval, segment, midpoint, again, climb] = [1, 2, 3, 4, 5].map(|i| &scenes[i]);
    for row in scenes {
        assert_eq!(row["wrong rays"], 0, "{row}");
        assert!(number(row, "bytes") > 0.0, "{row}");
        assert_eq!(row["leaves/ray"].is_null(), !row["accelerator"].as_str().is_some_and(|a| a.starts_with("bsp")));
    }
    for row in [segment, midpoint] {
        assert_eq!(row["steps/ray"], interval["steps/ray"], "{row}");
    }
    for row in [segment, midpoint, again, climb] {
        assert_eq!(row["tests/ray"], interval["tests/ray"], "{row}");
    }
    assert!(number(again, "steps/ray") >= number(climb, "steps/ray"), "{again} {climb}");
    let verdicts = verdicts(&report);
    assert_eq!(verdicts.iter().map(|v| v.0).collect::<Vec<_>>(), ["R10", "R11a", "R11b", "R11c", "R12"]);
    assert!(verdicts[..4].iter().all(|v| v.1 == "holds"), "{verdicts:?}");
    let svg = fs::read_to_string(folder.join("a.svg")).expect("was written");
    assert_eq!(elements(&svg)["polyline"], 3);
}
