//! A stress test as text, CSV and JSON.

use crate::cli::document::measured;
use crate::cli::input::bits;
use crate::cli::table::{Table, short};
use crate::stress::cases::{Case, FAMILIES};
use crate::stress::{CaseResult, Outcome, Row, Study, Tally};
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// With more exact accelerators than this, they share a column.
const MOST_COLUMNS: usize = 4;

/// Tables for people: one for each family, with a column for each accelerator, or one for all exact ones together.
pub(super) fn text(study: &Study) -> String {
    let accels = study.accels();
    let exact = accels.iter().filter(|(_, exact)| *exact).count();
    let mut columns: Vec<Column> = Vec::new();
    if exact > MOST_COLUMNS {
        columns.push(Column { title: format!("{exact} exact"), accel: None });
    }
    let own = accels.into_iter().filter(|(_, is_exact)| !is_exact || exact <= MOST_COLUMNS);
    columns.extend(own.map(|(name, _)| Column { title: name.clone(), accel: Some(name) }));

    let mut out = format!(
        "skipgrid {}: stress test\n{}\nat most {} rays a case, {} timed rounds\n\n\
         Cells: rays per million missed/false/wrong primitive against exact arithmetic, where not 0; largest error of t in\n\
         units in the last place; time per ray over that of ordinary rays. A column of several has the worst of each.\n",
        env!("CARGO_PKG_VERSION"),
        study.machine,
        study.rays,
        study.rounds
    );
    for family in FAMILIES {
        let of_family = |result: &&CaseResult| family.cases.iter().any(|case| case.name == result.case.name);
        let results: Vec<&CaseResult> = study.results.iter().filter(of_family).collect();
        if results.is_empty() {
            continue;
        }
        let mut header = vec!["<case".to_string(), "rays".into(), "hit %".into(), "ties %".into()];
        header.extend(columns.iter().map(|column| column.title.clone()));
        let mut table = Table::new(&header.iter().map(String::as_str).collect::<Vec<_>>());
        for result in results {
            let percent = |n: u64| format!("{:.1}", 100.0 * n as f64 / result.rays.max(1) as f64);
            let mut cells =
                vec![result.case.name.to_string(), result.rays.to_string(), percent(result.hits), percent(result.ties)];
            cells.extend(columns.iter().map(|column| column.cell(result)));
            table.row(cells);
        }
        out += &format!("\n{}: {}\n\n{}", family.name, family.title, table.text());
    }
    if !study.walks.is_empty() {
        out += "\nwalks: the voxels that walks visit, against the exact sequence\n\n";
        out += &walks(study).text();
    }
    out += "\n";
    out += &refusals(study);
    out += &faults(study);
    for v in study.verdicts() {
        let word = if v.met { "met   " } else { "MISSED" };
        let note = if v.decides { "" } else { " (does not decide)" };
        out += &format!("{word}  {}{note}: {}\n", v.bar, v.numbers);
    }
    out + if study.passed() { "passed\n" } else { "FAILED\n" }
}

/// A column of the text: one accelerator, or all exact ones.
struct Column {
    title: String,
    accel: Option<String>,
}

impl Column {
    fn cell(&self, result: &CaseResult) -> String {
        let belongs = |row: &&Row| self.accel.as_ref().map_or(row.exact, |name| row.accel == *name);
        let rows: Vec<&Row> = result.rows.iter().filter(belongs).collect();
        let panicked = rows.iter().filter(|row| matches!(row.outcome, Outcome::Panicked(_))).count();
        let tallies: Vec<&Tally> = rows.iter().filter_map(|row| row.tally()).collect();
        if panicked > 0 {
            return "build panics".into();
        }
        // The worst is the one with most hits that are wrong; with none, the one with most to say otherwise.
        let worst = tallies.iter().max_by_key(|tally| (tally.strict(), tally.per_million().len()));
        let Some(worst) = worst else {
            return if rows.is_empty() { "-" } else { "refused" }.into();
        };
        let t_error = tallies.iter().fold(0.0f64, |most, tally| most.max(tally.t_error));
        let ratios = rows.iter().filter_map(|row| row.times());
        let ratio = ratios.map(|times| times.ratio()).fold(f64::NAN, f64::max);
        let time = if ratio.is_nan() { String::new() } else { format!(" {}x", short(ratio)) };
        format!("{} {}{time}", worst.per_million(), ulps(t_error))
    }
}

/// An error in a few characters.
fn ulps(error: f64) -> String {
    if error < 1000.0 { format!("{error:.2}u") } else { format!("{error:.0e}u") }
}

/// One row for each case of the voxel walks, walk and kind of rays.
fn walks(study: &Study) -> Table {
    let columns =
        ["<case", "<walk", "<kind", "rays", "wrong voxels", "missed", "lost ppm", "uncovered", "t error, voxels"];
    let mut table = Table::new(&columns);
    for (case, row) in study.walks.iter().flat_map(|result| result.rows.iter().map(move |row| (result.case.name, row)))
    {
        let tally = &row.tally;
        let mut cells = [case, row.walk.name(), row.rays.name()].map(String::from).to_vec();
        cells.extend([tally.rays, tally.wrong, tally.missed].map(|n| n.to_string()));
        cells.extend([
            format!("{:.3}", tally.lost_ppm()),
            tally.uncovered.to_string(),
            format!("{:.1e}", tally.t_error),
        ]);
        table.row(cells);
    }
    table
}

/// What could not be built, each reason once.
fn refusals(study: &Study) -> String {
    let reasons: BTreeSet<String> = study
        .rows()
        .filter_map(|(result, row)| match &row.outcome {
            Outcome::Refused(reason) => Some(format!("{} refuses {}: {reason}\n", row.accel, result.case.name)),
            Outcome::Panicked(message) => {
                Some(format!("{} panics when built over {}: {message}\n", row.accel, result.case.name))
            }
            Outcome::Traced { .. } => None,
        })
        .collect();
    if reasons.is_empty() { String::new() } else { reasons.into_iter().collect::<String>() + "\n" }
}

/// What exact accelerators got wrong, with rays to try again. Those that are wrong alike on a case stand together.
fn faults(study: &Study) -> String {
    let mut groups: Vec<(&CaseResult, &Tally, Vec<&str>)> = Vec::new();
    for (result, row) in study.failures() {
        let Some(tally) = row.tally() else { continue };
        let alike = |(other, known, _): &&mut (&CaseResult, &Tally, Vec<&str>)| {
            other.case.name == result.case.name && known.per_million() == tally.per_million()
        };
        match groups.iter_mut().find(alike) {
            Some((_, _, names)) => names.push(&row.accel),
            None => groups.push((result, tally, vec![&row.accel])),
        }
    }
    let mut out = String::new();
    for (result, tally, names) in groups {
        out += &format!(
            "FAULTY: {}: {}; {} parameters not the nearest, error up to {}; {}\n",
            result.case.name,
            tally.per_million(),
            tally.not_rounded,
            ulps(tally.t_error),
            names.join(", ")
        );
        for fault in &tally.faults {
            out += &format!(
                "  ray {}: {}; answer: {}; exact: {}\n    bits (ox oy oz tmin dx dy dz tmax): {}\n",
                fault.index,
                fault.kind,
                fault.answer,
                fault.truth,
                bits(&fault.ray).join(" ")
            );
        }
    }
    if out.is_empty() { out } else { out + "\n" }
}

/// The counts of a tally by name, in the order of the CSV.
fn counts(tally: &Tally) -> [(&'static str, u64); 15] {
    [
        ("answers", tally.rays),
        ("missed", tally.missed),
        ("false", tally.false_hits),
        ("wrong", tally.wrong),
        ("outside", tally.outside),
        ("not_finite", tally.not_finite),
        ("not_rounded", tally.not_rounded),
        ("any", tally.any),
        ("counted", tally.counted),
        ("differing", tally.differing),
        ("panics", tally.panics),
        ("hangs", tally.hangs),
        ("untraced", tally.untraced),
        ("most_steps", tally.most_steps),
        ("most_tests", tally.most_tests),
    ]
}

fn family(case: &Case) -> &'static str {
    FAMILIES.iter().find(|family| family.cases.iter().any(|c| c.name == case.name)).map_or("", |family| family.name)
}

/// What became of the row, and why.
fn outcome(row: &Row) -> (&'static str, &str) {
    match &row.outcome {
        Outcome::Traced { .. } => ("traced", ""),
        Outcome::Refused(reason) => ("refused", reason),
        Outcome::Panicked(message) => ("panicked", message),
    }
}

/// One line for each case and accelerator.
pub(super) fn csv(study: &Study) -> String {
    let mut columns = vec!["<family", "<case", "<accelerator", "exact", "<outcome", "rays", "hits", "ties"];
    let names = counts(&Tally::default()).map(|(name, _)| name);
    columns.extend(names);
    columns.extend(["t_error_ulp", "ns_case", "ns_ordinary", "ratio"]);
    let mut table = Table::new(&columns);
    for (result, row) in study.rows() {
        let case = result.case;
        let mut cells = [family(case), case.name, &row.accel, if row.exact { "1" } else { "0" }, outcome(row).0]
            .map(String::from)
            .to_vec();
        cells.extend([result.rays, result.hits, result.ties].map(|n| n.to_string()));
        match row.tally() {
            Some(tally) => {
                cells.extend(counts(tally).map(|(_, n)| n.to_string()));
                cells.push(format!("{:.6}", tally.t_error));
            }
            None => cells.extend(std::iter::repeat_n("-".to_string(), names.len() + 1)),
        }
        let times = row.times();
        cells.push(times.map_or("-".into(), |times| format!("{:.1}", times.case)));
        cells.push(times.map_or("-".into(), |times| format!("{:.1}", times.ordinary)));
        cells.push(times.map_or("-".into(), |times| format!("{:.3}", times.ratio())));
        table.row(cells);
    }
    table.csv()
}

/// Everything.
pub(super) fn json(study: &Study) -> Value {
    let cases: Vec<Value> = study
        .results
        .iter()
        .map(|result| {
            let case = result.case;
            json!({
                "family": family(case),
                "case": case.name,
                "summary": case.summary,
                "must_hit": case.must_hit,
                "bad_input": case.bad_input,
                "primitives": result.primitives,
                "rays": result.rays,
                "hits": result.hits,
                "ties": result.ties,
                "seconds": result.seconds,
                "accelerators": result.rows.iter().map(json_row).collect::<Vec<_>>(),
            })
        })
        .collect();
    let walk = |case: &'static str, row: &crate::stress::walks::Row| {
        let tally = &row.tally;
        json!({
            "case": case,
            "walk": row.walk.name(),
            "kind": row.rays.name(),
            "rays": tally.rays,
            "refused": tally.refused,
            "wrong_rays": tally.wrong_rays,
            "voxels": tally.voxels,
            "wrong": tally.wrong,
            "missed": tally.missed,
            "lost_ppm": tally.lost_ppm(),
            "longest": tally.longest,
            "uncovered": tally.uncovered,
            "uncovered_ppm": tally.uncovered_ppm(),
            "t_error_voxels": tally.t_error,
        })
    };
    let walks: Vec<Value> =
        study.walks.iter().flat_map(|result| result.rows.iter().map(|row| walk(result.case.name, row))).collect();
    let verdicts: Vec<Value> = study
        .verdicts()
        .iter()
        .map(|v| json!({ "bar": v.bar, "met": v.met, "decides": v.decides, "numbers": v.numbers }))
        .collect();
    let body = json!({
        "rays": study.rays,
        "rounds": study.rounds,
        "passed": study.passed(),
        "verdicts": verdicts,
        "cases": cases,
        "walks": walks,
    });
    measured("skipgrid.stress/1", &study.machine, body)
}

fn json_row(row: &Row) -> Value {
    let (kind, reason) = outcome(row);
    let mut value = json!({
        "accelerator": row.accel,
        "exact": row.exact,
        "outcome": kind,
        "reason": reason,
        "fails": row.exact && row.fails(),
    });
    if let Some(tally) = row.tally() {
        for (name, n) in counts(tally) {
            value[name] = n.into();
        }
        value["t_error_ulp"] = tally.t_error.into();
        let fault = |fault: &crate::stress::Fault| {
            json!({
                "ray": fault.index,
                "bits": bits(&fault.ray),
                "kind": fault.kind,
                "answer": fault.answer,
                "exact": fault.truth,
            })
        };
        value["faults"] = tally.faults.iter().map(fault).collect();
    }
    if let Some(times) = row.times() {
        value["ns_case"] = times.case.into();
        value["ns_ordinary"] = times.ordinary.into();
        value["ratio"] = times.ratio().into();
    }
    value
}
