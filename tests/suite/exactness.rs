//! `skipgrid papers exactness` at tiny sizes: counts, verdicts and the plot; never a time.

use crate::papers::{elements, folder, number, report, rows, verdicts};
use serde_json::Value;
use skipgrid::registry::ENTRIES;
use std::fs;

fn named<'a>(rows: &'a [Value], column: &str, name: &str) -> &'a Value {
    rows.iter().find(|row| row[column] == name).unwrap_or_else(|| panic!("no row `{name}`"))
}

/// Exact arithmetic is the oracle's, which shares no code with the grid; the textbook's walk and tests must be seen to fail,
/// or the mix would show nothing.
#[test]
fn only_the_exact_test_makes_no_error() {
    let folder = folder("exactness");
    let args = ["exactness", "--quick", "--size", "12", "--rays", "400", "--scene", "bumpy:n=12", "--svg", "e.svg"];
    let report = report(&folder, &args);
    let errors = rows(&report, "errors");
    let of = |name: &str| number(named(errors, "test and walk", name), "errors");
    assert_eq!(of("exact, recomputed f64"), 0.0);
    assert!(number(named(errors, "test and walk", "exact, recomputed f64"), "t error ulp") <= 0.5);
    for test in ["Woop f32", "Möller-Trumbore f32"] {
        for walk in ["accumulated f32", "recomputed f64"] {
            assert!(of(&format!("{test}, {walk}")) > 0.0, "{test}, {walk}: {errors:?}");
        }
    }
    // An edge decided in f32 misses more of what is there than one in f64.
    assert!(of("Möller-Trumbore f64, recomputed f64") < of("Möller-Trumbore f32, recomputed f64"), "{errors:?}");
    // Nothing is lost between the tables: 8 cases of 400 rays.
    let cases = rows(&report, "cases");
    for row in errors {
        let mine = cases.iter().filter(|case| case["test and walk"] == row["test and walk"]);
        let all: f64 =
            mine.map(|case| number(case, "missed") + number(case, "invented") + number(case, "other primitive")).sum();
        assert!((number(row, "errors") - all * 1e6 / (8.0 * 400.0)).abs() < 1e-6, "{row}");
    }
    let verdict = |id: &str| verdicts(&report).into_iter().find(|(i, _)| *i == id).map(|(_, verdict)| verdict);
    assert_eq!((verdict("X2"), verdict("X3")), (Some("holds"), Some("holds")));

    // A mark for each row that has a time, which all have, and one for each of three series in the legend.
    let svg = fs::read_to_string(folder.join("e.svg")).expect("the plot");
    let counts = elements(&svg);
    assert_eq!(counts["title"], errors.len() + 3, "{counts:?}");
    // Four tests by two walks, and the peers that can be had.
    let peers = ENTRIES.iter().filter(|entry| !entry.exact && entry.missing().is_none()).count();
    assert_eq!(errors.len(), 8 + peers);
}

#[test]
fn the_cost_is_measured_on_the_same_rays() {
    let folder = folder("exactness-cost");
    let args = ["exactness", "--quick", "--size", "12", "--rays", "20", "--scene", "bumpy:n=12", "--no-peers"];
    let report = report(&folder, &args);
    let cost = rows(&report, "cost");
    let stages = rows(&report, "stages");
    assert_eq!((cost.len(), stages.len()), (3 * 4, 3), "three kinds of rays, four tests");
    for rows in cost.chunks(4) {
        let measure = named(rows, "test", "Woop f32");
        assert_eq!(["ratio", "least", "greatest", "fastest"].map(|column| number(measure, column)), [1.0; 4]);
        assert_eq!(number(&rows[0], "rays that differ"), 0.0, "the exact test is the first");
    }
    for row in stages {
        let share = number(row, "on to f64 %");
        assert!(number(row, "tests/ray") > 0.0 && share > 0.0 && share < 100.0, "{row}");
    }
    assert_eq!(rows(&report, "errors").len(), 8);
}
