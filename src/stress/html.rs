//! A run as one page that needs no network: verdicts first, then a table for each family.

use super::cases::{FAMILIES, Family};
use super::report::{CaseResult, Outcome, Row, Study};
use std::fmt::Write as _;

const STYLE: &str = "\
:root { color-scheme: light dark; --line: #8886; --zero: #1a7f3722; --some: #c6282833; --none: #8882; }
body { font: 14px/1.5 system-ui, sans-serif; margin: 2rem; }
h1, h2 { line-height: 1.2; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
.wide { overflow-x: auto; }
th, td { border: 1px solid var(--line); padding: .2rem .5rem; text-align: right; white-space: nowrap; }
th:first-child, td:first-child, .text { text-align: left; }
td.text { white-space: normal; }
thead th { vertical-align: bottom; }
.zero { background: var(--zero); }
.some { background: var(--some); font-weight: bold; }
.none { background: var(--none); }
small { display: block; opacity: .7; font-weight: normal; }
";

/// The page.
pub fn page(study: &Study) -> String {
    let mut page = String::from("<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n");
    page.push_str("<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n");
    let _ = write!(page, "<title>skipgrid: stress test</title>\n<style>\n{STYLE}</style>\n");
    let word = if study.passed() { "passed" } else { "FAILED" };
    let _ = writeln!(page, "<h1>Stress test: {word}</h1>");
    let _ = writeln!(
        page,
        "<p>skipgrid {}; {}; at most {} rays a case, {} timed rounds.</p>",
        env!("CARGO_PKG_VERSION"),
        escape(&study.machine.to_string()),
        study.rays,
        study.rounds
    );
    page.push_str(
        "<table>\n<thead><tr><th>bar</th><th>met</th><th class=\"text\">numbers</th></tr></thead>\n<tbody>\n",
    );
    for v in study.verdicts() {
        let (class, word) = if v.met { ("zero", "yes") } else { ("some", "NO") };
        let note = if v.decides { "" } else { "<small>reported, does not decide</small>" };
        let numbers = escape(&v.numbers);
        let bar = escape(v.bar);
        let _ = writeln!(
            page,
            "<tr><td>{bar}{note}</td><td class=\"{class}\">{word}</td><td class=\"text\">{numbers}</td></tr>"
        );
    }
    page.push_str("</tbody>\n</table>\n");
    page.push_str(
        "<p>A cell has the rays per million that were missed / false / wrong in the primitive, against exact arithmetic; below \
         it the largest error of t in units in the last place and the time per ray over that of ordinary rays.</p>\n",
    );
    for family in FAMILIES {
        section(&mut page, family, study);
    }
    walks(&mut page, study);
    faults(&mut page, study);
    page.push_str("</html>\n");
    page
}

fn section(page: &mut String, family: &Family, study: &Study) {
    let results: Vec<&CaseResult> =
        study.results.iter().filter(|result| family.cases.iter().any(|case| case.name == result.case.name)).collect();
    if results.is_empty() {
        return;
    }
    let _ = writeln!(page, "<h2>{}<small>{}</small></h2>", escape(family.name), escape(family.title));
    page.push_str("<div class=\"wide\"><table>\n<thead><tr><th>case</th><th>rays</th><th>hit %</th><th>ties %</th>");
    let accels = study.accels();
    for (name, exact) in &accels {
        let kind = if *exact { "exact" } else { "peer" };
        let _ = write!(page, "<th>{}<small>{kind}</small></th>", escape(name));
    }
    page.push_str("</tr></thead>\n<tbody>\n");
    for result in results {
        let percent = |n: u64| 100.0 * n as f64 / result.rays.max(1) as f64;
        let _ = write!(
            page,
            "<tr><td>{}<small>{}</small></td><td>{}</td><td>{:.1}</td><td>{:.1}</td>",
            escape(result.case.name),
            escape(result.case.summary),
            result.rays,
            percent(result.hits),
            percent(result.ties)
        );
        for (name, _) in &accels {
            match result.rows.iter().find(|row| row.accel == *name) {
                Some(row) => cell(page, row),
                None => page.push_str("<td class=\"none\"></td>"),
            }
        }
        page.push_str("</tr>\n");
    }
    page.push_str("</tbody>\n</table></div>\n");
}

fn cell(page: &mut String, row: &Row) {
    let (tally, times) = match &row.outcome {
        Outcome::Traced { tally, times } => (tally, times),
        Outcome::Refused(reason) => {
            let _ = write!(page, "<td class=\"none\" title=\"{}\">refused</td>", escape(reason));
            return;
        }
        Outcome::Panicked(message) => {
            let _ = write!(page, "<td class=\"some\" title=\"{}\">panics</td>", escape(message));
            return;
        }
    };
    let class = if tally.is_zero() && !row.fails() || (tally.strict() == 0 && !row.exact) { "zero" } else { "some" };
    let ratio = times.map_or("-".to_string(), |times| format!("{:.1}x", times.ratio()));
    let _ = write!(
        page,
        "<td class=\"{class}\">{}<small>{:.2} ulp, {ratio}</small></td>",
        escape(&tally.per_million()),
        tally.t_error
    );
}

fn walks(page: &mut String, study: &Study) {
    if study.walks.is_empty() {
        return;
    }
    page.push_str(
        "<h2>walks<small>the voxels that walks visit, against the exact sequence</small></h2>\n<table>\n<thead><tr>",
    );
    for heading in
        ["case", "walk", "rays", "count", "wrong voxels", "missed", "lost ppm", "uncovered", "t error, voxels"]
    {
        let _ = write!(page, "<th>{heading}</th>");
    }
    page.push_str("</tr></thead>\n<tbody>\n");
    for (case, row) in study.walks.iter().flat_map(|result| result.rows.iter().map(move |row| (result.case.name, row)))
    {
        let (tally, class) = (&row.tally, if row.tally.uncovered == 0 { "zero" } else { "some" });
        let _ = writeln!(
            page,
            "<tr><td>{case}</td><td class=\"text\">{}</td><td class=\"text\">{}</td><td>{}</td><td>{}</td><td>{}</td>\
             <td>{:.3}</td><td class=\"{class}\">{}</td><td>{:.1e}</td></tr>",
            row.walk.name(),
            row.rays.name(),
            tally.rays,
            tally.wrong,
            tally.missed,
            tally.lost_ppm(),
            tally.uncovered,
            tally.t_error
        );
    }
    page.push_str("</tbody>\n</table>\n");
}

fn faults(page: &mut String, study: &Study) {
    let failures: Vec<(&CaseResult, &Row)> = study.failures().collect();
    if failures.is_empty() {
        return;
    }
    page.push_str("<h2>Faults of exact accelerators</h2>\n<ul>\n");
    for (result, row) in failures {
        for fault in row.tally().iter().flat_map(|tally| &tally.faults) {
            let _ = writeln!(
                page,
                "<li>{}, {}, ray {}: {}; answer: {}; exact: {}</li>",
                escape(result.case.name),
                escape(&row.accel),
                fault.index,
                fault.kind,
                escape(&fault.answer),
                escape(&fault.truth)
            );
        }
    }
    page.push_str("</ul>\n");
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
