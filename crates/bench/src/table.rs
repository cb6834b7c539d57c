//! Tables in Markdown that read well as plain text too.

/// Whether a target is reached, as a word.
pub(crate) fn verdict(met: bool) -> &'static str {
    if met { "met" } else { "missed" }
}

/// A table; every row has a cell for each column of the header.
#[derive(Debug, Clone)]
pub(crate) struct Table {
    /// The header first.
    rows: Vec<Vec<String>>,
}

impl Table {
    pub(crate) fn new(header: &[&str]) -> Self {
        Self { rows: vec![header.iter().map(|&title| title.to_owned()).collect()] }
    }

    pub(crate) fn push(&mut self, cells: impl IntoIterator<Item = String>) {
        let row: Vec<String> = cells.into_iter().collect();
        debug_assert_eq!(row.len(), self.rows[0].len(), "{row:?}");
        self.rows.push(row);
    }

    /// The text, its columns aligned.
    pub(crate) fn markdown(&self) -> String {
        let width = |column: usize| self.rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..self.rows[0].len()).map(width).collect();
        let line = |row: &Vec<String>| {
            let cells = row.iter().zip(&widths).map(|(cell, &width)| format!(" {cell:<width$} |"));
            format!("|{}\n", cells.collect::<String>())
        };
        let rule = line(&widths.iter().map(|&width| "-".repeat(width)).collect());
        line(&self.rows[0]) + &rule + &self.rows[1..].iter().map(line).collect::<String>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned() {
        let mut table = Table::new(&["scene", "s"]);
        table.push(["Galleon (stand-in)".to_owned(), "1.25".to_owned()]);
        table.push(["Größe".to_owned(), "10.00".to_owned()]);
        let text = table.markdown();
        let borders = |line: &str| line.chars().enumerate().filter(|&(_, c)| c == '|').map(|(i, _)| i).collect();
        let lines: Vec<Vec<usize>> = text.lines().map(borders).collect();
        assert_eq!(lines.len(), 4, "{text}");
        assert!(lines.iter().all(|borders| *borders == [0, 21, 29]), "{text}");
        assert!(text.starts_with("| scene "), "{text}");
    }
}
