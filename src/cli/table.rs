//! Rows of cells as aligned text or as CSV.

/// A table: the first column is text, the others are numbers unless they are named in [`Table::text`].
#[derive(Clone, Debug)]
pub struct Table {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
    left: Vec<bool>,
}

impl Table {
    /// A table whose columns have these names; a name that starts with `<` is a column of text, aligned to the left.
    pub fn new(columns: &[&str]) -> Self {
        let left = columns.iter().map(|name| name.starts_with('<')).collect();
        let header = columns.iter().map(|name| name.trim_start_matches('<').to_string()).collect();
        Self { header, rows: Vec::new(), left }
    }

    /// Adds a row with one cell for each column.
    pub fn row(&mut self, cells: Vec<String>) {
        debug_assert_eq!(cells.len(), self.header.len());
        self.rows.push(cells);
    }

    /// Columns aligned with two spaces between them.
    pub fn text(&self) -> String {
        let lines = || std::iter::once(&self.header).chain(&self.rows);
        let widths: Vec<usize> = (0..self.header.len())
            .map(|i| lines().filter_map(|row| row.get(i)).map(|cell| cell.chars().count()).max().unwrap_or(0))
            .collect();
        let mut out = String::new();
        for row in lines() {
            let mut line = String::new();
            for ((cell, &width), &left) in row.iter().zip(&widths).zip(&self.left) {
                let space = " ".repeat(width - cell.chars().count());
                let cell = if left { format!("{cell}{space}") } else { format!("{space}{cell}") };
                line.push_str(&cell);
                line.push_str("  ");
            }
            out.push_str(line.trim_end());
            out.push('\n');
        }
        out
    }

    /// Comma-separated values (RFC 4180, but lines end with a line feed alone).
    pub fn csv(&self) -> String {
        let line = |row: &Vec<String>| row.iter().map(|cell| quoted(cell)).collect::<Vec<_>>().join(",") + "\n";
        std::iter::once(&self.header).chain(&self.rows).map(line).collect()
    }
}

fn quoted(cell: &str) -> String {
    if cell.contains([',', '"', '\n', '\r']) { format!("\"{}\"", cell.replace('"', "\"\"")) } else { cell.to_string() }
}

/// `value` with about three significant digits, without an exponent; `-` if it is not finite.
pub fn short(value: f64) -> String {
    match value.abs() {
        _ if !value.is_finite() => "-".to_string(),
        size if size >= 100.0 => format!("{value:.0}"),
        size if size >= 10.0 => format!("{value:.1}"),
        _ => format!("{value:.2}"),
    }
}

/// Every digit of `value`, for machines; nothing if there is none or it is not finite.
pub fn exact(value: impl Into<Option<f64>>) -> String {
    value.into().filter(|v| v.is_finite()).map_or(String::new(), |v| v.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_aligned_and_csv_quoted() {
        let mut table = Table::new(&["<name", "n"]);
        table.row(vec!["a, \"b\"".into(), "12".into()]);
        table.row(vec!["c".into(), "3".into()]);
        assert_eq!(table.text(), "name     n\na, \"b\"  12\nc        3\n");
        assert_eq!(table.csv(), "name,n\n\"a, \"\"b\"\"\",12\nc,3\n");
    }

    #[test]
    fn numbers_are_short() {
        assert_eq!([1.234, 12.34, 123.4, f64::NAN].map(short), ["1.23", "12.3", "123", "-"]);
    }
}
