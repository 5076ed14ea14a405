//! What a paper's experiments gave: tables, claims with verdicts, notes and a plot; one form for every output.

use super::plot::Plot;
use crate::measure::Machine;

/// The outcome of one paper's experiments.
#[derive(Clone, Debug)]
pub struct Report {
    /// Name on the command line.
    pub paper: &'static str,
    /// One line.
    pub title: &'static str,
    /// What it was measured on.
    pub machine: Machine,
    /// Settings by name.
    pub settings: Vec<(&'static str, String)>,
    /// How to read the tables, one sentence or more each.
    pub notes: Vec<String>,
    /// The paper's claims, judged.
    pub claims: Vec<Claim>,
    /// The tables.
    pub tables: Vec<Table>,
    /// What there is to look at.
    pub plot: Plot,
    /// Rays on which an accelerator that promises exact answers gave another answer than the plain grid, or than exact
    /// arithmetic.
    pub wrong: u64,
}

impl Report {
    /// Heading of the claims, without mark-up.
    pub fn claims_heading(&self) -> &'static str {
        if self.paper == super::exactness::NAME { "Our own claims" } else { "The paper's claims" }
    }
}

/// A claim of the paper and what is to be said of it here.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// Short name, such as `C4`.
    pub id: &'static str,
    /// What the paper says.
    pub claim: &'static str,
    /// What must be so in the measured numbers for the claim to hold.
    pub rule: &'static str,
    /// The outcome.
    pub verdict: Verdict,
    /// The numbers that decided.
    pub numbers: String,
}

/// What is to be said of a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The rule is met.
    Holds,
    /// It is not.
    Fails,
    /// What it needs was not part of the run.
    NotMeasured,
}

impl Verdict {
    /// [`Verdict::Holds`] if so.
    pub fn of(holds: bool) -> Self {
        if holds { Verdict::Holds } else { Verdict::Fails }
    }

    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Verdict::Holds => "holds",
            Verdict::Fails => "does not hold here",
            Verdict::NotMeasured => "not measured",
        }
    }
}

/// A table with one cell for each column in every row.
#[derive(Clone, Debug)]
pub struct Table {
    /// Short name, a word for machines.
    pub name: String,
    /// A line for people.
    pub title: String,
    /// Names of the columns, with units; a name that starts with `<` is a column of text.
    pub columns: Vec<&'static str>,
    /// The rows.
    pub rows: Vec<Vec<Cell>>,
}

impl Table {
    /// A table without rows.
    pub fn new(name: impl Into<String>, title: impl Into<String>, columns: &[&'static str]) -> Self {
        Self { name: name.into(), title: title.into(), columns: columns.to_vec(), rows: Vec::new() }
    }

    /// Adds a row with one cell for each column.
    pub fn row(&mut self, cells: impl Into<Vec<Cell>>) {
        let cells = cells.into();
        debug_assert_eq!(cells.len(), self.columns.len(), "{}", self.name);
        self.rows.push(cells);
    }
}

/// One entry of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A number of things.
    Count(u64),
    /// A measured or computed number; not finite: unknown.
    Real(f64),
}

impl Cell {
    /// For people: reals with three significant digits, unknown ones as `-`.
    pub fn short(&self) -> String {
        match self {
            Cell::Text(text) => text.clone(),
            Cell::Count(n) => n.to_string(),
            Cell::Real(x) => significant(*x),
        }
    }

    /// For programs: reals as the shortest text that gives the same bits, unknown ones as nothing.
    pub fn exact(&self) -> String {
        match self {
            Cell::Real(x) if x.is_finite() => x.to_string(),
            Cell::Real(_) => String::new(),
            _ => self.short(),
        }
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Cell::Text(text.to_string())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Cell::Text(text)
    }
}

impl From<u64> for Cell {
    fn from(n: u64) -> Self {
        Cell::Count(n)
    }
}

impl From<u32> for Cell {
    fn from(n: u32) -> Self {
        Cell::Count(n.into())
    }
}

impl From<f64> for Cell {
    fn from(x: f64) -> Self {
        Cell::Real(x)
    }
}

/// Three significant digits without an exponent, whole numbers from 100 on; `-` if it is not finite.
pub fn significant(x: f64) -> String {
    if !x.is_finite() {
        return "-".to_string();
    }
    if x == 0.0 {
        return "0".to_string();
    }
    // Digits behind the point; f64 has none beyond 350, and no such number occurs.
    let digits = (2.0 - x.abs().log10().floor()).clamp(0.0, 12.0) as usize;
    format!("{x:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        let texts = [1234.5, 99.96, 12.34, 1.0, 0.012345, 0.0, f64::NAN].map(significant);
        assert_eq!(texts, ["1234", "100.0", "12.3", "1.00", "0.0123", "0", "-"]);
        assert_eq!(Cell::Real(0.1).exact(), "0.1");
        assert_eq!(Cell::Real(f64::NAN).exact(), "");
    }
}
