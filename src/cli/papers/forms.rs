//! A paper's report as text, CSV, JSON or Markdown.

use crate::cli::document::measured;
use crate::cli::table::Table as Aligned;
use crate::papers::{Cell, Report, Table};
use serde_json::{Map, Value, json};
use std::path::Path;

/// Widest line of prose.
const WIDTH: usize = 110;

/// What was measured with which settings, by name.
fn facts(report: &Report) -> Vec<(&'static str, String)> {
    let mut facts = vec![("version", env!("CARGO_PKG_VERSION").to_string()), ("machine", report.machine.to_string())];
    facts.extend(report.settings.iter().cloned());
    facts.push(("wrong rays", report.wrong.to_string()));
    facts
}

/// For people at a terminal.
pub fn text(report: &Report) -> String {
    let mut out = format!("{}\n\n", wrapped(report.title, "", ""));
    for (name, value) in facts(report) {
        out += &format!("{name}: {value}\n");
    }
    out += "\n";
    for note in &report.notes {
        out += &format!("{}\n", wrapped(note, "- ", "  "));
    }
    for table in &report.tables {
        let heading = wrapped(&table.title, "", "");
        out += &format!("\n{heading}\n\n{}", aligned(table).text());
    }
    if !report.claims.is_empty() {
        out += &format!("\n{}\n", report.claims_heading());
    }
    for claim in &report.claims {
        out += &format!("\n{}\n", wrapped(&format!("{} {}", claim.id, claim.claim), "", "    "));
        out += &format!("    {}\n", claim.verdict.words().to_uppercase());
        out += &format!("{}\n", wrapped(&format!("rule: {}", claim.rule), "    ", "    "));
        if !claim.numbers.is_empty() {
            out += &format!("{}\n", wrapped(&format!("here: {}", claim.numbers), "    ", "    "));
        }
    }
    out
}

/// One line for each cell, so that tables of all shapes fit in one file.
pub fn csv(report: &Report) -> String {
    let mut out = Aligned::new(&["<table", "<row", "<column", "<value"]);
    let mut cell = |table: &str, row: String, column: &str, value: String| {
        out.row(vec![table.to_string(), row, column.to_string(), value]);
    };
    for (name, value) in facts(report) {
        cell("settings", "0".into(), name, value);
    }
    for table in &report.tables {
        for (i, row) in table.rows.iter().enumerate() {
            for (column, value) in table.columns.iter().zip(row) {
                cell(&table.name, i.to_string(), heading(column), value.exact());
            }
        }
    }
    for (i, claim) in report.claims.iter().enumerate() {
        let verdict = claim.verdict.words();
        let values = [claim.id, claim.claim, claim.rule, verdict, &claim.numbers];
        for (column, value) in ["id", "claim", "rule", "verdict", "numbers"].iter().zip(values) {
            cell("claims", i.to_string(), column, value.to_string());
        }
    }
    out.csv()
}

/// One object; rows are objects by the names of the columns, unknown numbers null.
pub fn json(report: &Report) -> String {
    let value = |cell: &Cell| match cell {
        Cell::Text(text) => json!(text),
        Cell::Count(n) => json!(n),
        // Not finite becomes null.
        Cell::Real(x) => json!(x),
    };
    let table = |table: &Table| {
        let row = |row: &Vec<Cell>| -> Map<String, Value> {
            table.columns.iter().zip(row).map(|(column, cell)| (heading(column).to_string(), value(cell))).collect()
        };
        let columns: Vec<&str> = table.columns.iter().map(|c| heading(c)).collect();
        let rows: Vec<_> = table.rows.iter().map(row).collect();
        json!({ "name": table.name, "title": table.title, "columns": columns, "rows": rows })
    };
    let claims: Vec<Value> = report
        .claims
        .iter()
        .map(|c| {
            let verdict = c.verdict.words();
            json!({ "id": c.id, "claim": c.claim, "rule": c.rule, "verdict": verdict, "numbers": c.numbers })
        })
        .collect();
    let settings: Map<String, Value> = report.settings.iter().map(|(k, v)| (k.to_string(), json!(v))).collect();
    let body = json!({
        "paper": report.paper,
        "title": report.title,
        "settings": settings,
        "notes": report.notes,
        "claims": claims,
        "tables": report.tables.iter().map(table).collect::<Vec<_>>(),
        "wrong": report.wrong,
    });
    format!("{:#}\n", measured("skipgrid.papers/1", &report.machine, body))
}

/// A page; `svg` is shown if there is one, by its name alone: it lies beside the page.
pub fn markdown(report: &Report, svg: Option<&Path>) -> String {
    let mut out = format!("# {}\n\n", report.title);
    for (name, value) in facts(report) {
        out += &format!("- {name}: {}\n", marked(&value));
    }
    out += "\n## How to read this\n\n";
    for note in &report.notes {
        out += &format!("{}\n", wrapped(&marked(note), "- ", "  "));
    }
    if let Some(name) = svg.and_then(|file| file.file_name()) {
        out += &format!("\n![The plot of the numbers below]({})\n", name.to_string_lossy());
    }
    if !report.claims.is_empty() {
        out += &format!(
            "\n## {}\n\n| | claim | verdict | numbers | rule |\n|---|---|---|---|---|\n",
            report.claims_heading()
        );
        for c in &report.claims {
            let verdict = c.verdict.words();
            let [claim, numbers, rule] = [c.claim, &c.numbers, c.rule].map(marked);
            out += &format!("| {} | {claim} | **{verdict}** | {numbers} | {rule} |\n", c.id);
        }
    }
    for table in &report.tables {
        out += &format!("\n## {}\n\n", marked(&table.title));
        let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        out += &line(table.columns.iter().map(|c| marked(heading(c))).collect());
        let rule = |column: &&str| if column.starts_with('<') { "---" } else { "---:" }.to_string();
        out += &line(table.columns.iter().map(rule).collect());
        for row in &table.rows {
            out += &line(row.iter().map(|cell| marked(&cell.short())).collect());
        }
    }
    out
}

fn aligned(table: &Table) -> Aligned {
    let mut out = Aligned::new(&table.columns);
    table.rows.iter().for_each(|row| out.row(row.iter().map(Cell::short).collect()));
    out
}

/// The name of a column without the mark of text.
fn heading(column: &str) -> &str {
    column.trim_start_matches('<')
}

/// Text that Markdown shows as it is.
fn marked(text: &str) -> String {
    text.replace('|', "\\|").replace('<', "&lt;")
}

/// Lines of at most [`WIDTH`] letters, where words allow.
fn wrapped(text: &str, first: &str, next: &str) -> String {
    let mut out = first.to_string();
    let mut length = first.chars().count();
    let mut begun = false;
    for word in text.split_whitespace() {
        let letters = word.chars().count();
        if begun && length + 1 + letters > WIDTH {
            out += "\n";
            out += next;
            length = next.chars().count();
            begun = false;
        }
        if begun {
            out += " ";
            length += 1;
        }
        out += word;
        length += letters;
        begun = true;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prose_is_wrapped_and_indented() {
        let text = "word ".repeat(40);
        let lines = wrapped(&text, "- ", "  ");
        assert!(lines.lines().count() == 2 && lines.lines().all(|l| l.len() <= WIDTH), "{lines}");
        assert!(lines.starts_with("- word") && lines.contains("\n  word"), "{lines}");
    }
}
