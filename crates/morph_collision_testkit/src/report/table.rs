//! Tables in Markdown, and the numbers in them.

use std::fmt::{Display, Formatter, Result};

/// A table. Columns with words are aligned to the left, those with numbers to the right.
#[derive(Clone, Debug)]
pub struct Table {
    head: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table without rows.
    pub fn new<T: Display>(head: impl IntoIterator<Item = T>) -> Self {
        Self {
            head: head.into_iter().map(|cell| cell.to_string()).collect(),
            rows: Vec::new(),
        }
    }

    /// Appends a row.
    pub fn row<T: Display>(&mut self, cells: impl IntoIterator<Item = T>) {
        self.rows.push(cells.into_iter().map(|cell| cell.to_string()).collect());
    }

    /// Leaves out the columns in which all cells are [`NOTHING`].
    #[must_use]
    pub fn without_empty_columns(mut self) -> Self {
        let is_used = |column: usize| {
            self.rows
                .iter()
                .any(|row| row.get(column).is_some_and(|cell| cell != NOTHING))
        };
        let used: Vec<bool> = (0..self.head.len()).map(is_used).collect();
        for row in self.rows.iter_mut().chain([&mut self.head]) {
            let mut used = used.iter();
            row.retain(|_| used.next().copied().unwrap_or(true));
        }
        self
    }
}

impl Display for Table {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let line = |cells: &[String]| -> String {
            let cell = |cell: &String| {
                if cell.is_empty() {
                    " |".to_owned()
                } else {
                    format!(" {cell} |")
                }
            };
            format!("|{}", cells.iter().map(cell).collect::<String>())
        };
        writeln!(f, "{}", line(&self.head))?;
        let is_text = |column: usize| {
            let cells = self.rows.iter().filter_map(|row| row.get(column));
            column == 0
                || cells
                    .into_iter()
                    .any(|cell| cell.starts_with(|first: char| first.is_alphabetic()))
        };
        let rule = |column| if is_text(column) { "---|" } else { "--:|" };
        writeln!(f, "|{}", (0..self.head.len()).map(rule).collect::<String>())?;
        self.rows.iter().try_for_each(|row| writeln!(f, "{}", line(row)))
    }
}

/// A cell without a number.
pub const NOTHING: &str = "-";

/// A ratio of times with two digits, or with all digits before the point.
#[must_use]
pub fn ratio(value: f64) -> String {
    match value {
        value if value >= 9.95 => format!("{value:.0}"),
        value if value >= 0.995 => format!("{value:.1}"),
        value => format!("{value:.2}"),
    }
}

/// Several ratios in a cell; [`NOTHING`] if there are none.
#[must_use]
pub fn ratios(values: impl IntoIterator<Item = Option<f64>>) -> String {
    let cells: Vec<_> = values
        .into_iter()
        .map(|value| value.map_or(NOTHING.to_owned(), ratio))
        .collect();
    if cells.iter().all(|cell| cell == NOTHING) {
        return NOTHING.to_owned();
    }
    cells.join(" / ")
}

/// The least and the greatest of some ratios.
#[must_use]
pub fn range(values: impl Iterator<Item = f64> + Clone) -> String {
    let (least, most) = (values.clone().fold(f64::INFINITY, f64::min), values.fold(0.0, f64::max));
    match (ratio(least), ratio(most)) {
        _ if least > most => NOTHING.to_owned(),
        (least, most) if least == most => least,
        (least, most) => format!("{least} to {most}"),
    }
}

/// A share as a percentage.
#[must_use]
pub fn percent(share: f64) -> String {
    format!("{:.0} %", 100.0 * share)
}

/// Four digits of a measured number; the rest is noise.
#[must_use]
pub fn short(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_two_digits_or_more() {
        assert_eq!(
            [0.0654, 0.996, 1.04, 9.96, 251.7].map(ratio),
            ["0.07", "1.0", "1.0", "10", "252"]
        );
        assert_eq!(ratios([Some(1.0), None]), "1.0 / -");
        assert_eq!(ratios([None, None]), NOTHING);
        assert_eq!(range([3.0, 0.5, 12.0].into_iter()), "0.50 to 12");
        assert_eq!(range([2.0].into_iter()), "2.0");
        assert_eq!(range(std::iter::empty()), NOTHING);
        assert_eq!(short(1234.56), 1235.0);
    }

    #[test]
    fn columns_with_words_are_aligned_to_the_left() {
        let mut table = Table::new(["", "wanted", "time"]);
        table.row(["1 ray", "all", "0.5"]);
        assert_eq!(table.to_string().lines().nth(1), Some("|---|---|--:|"));
    }

    #[test]
    fn a_table_leaves_out_columns_without_numbers() {
        let mut table = Table::new(["", "a", "b"]);
        table.row(["x", "1", NOTHING]);
        table.row(["y", "2", NOTHING]);
        assert_eq!(
            table.clone().without_empty_columns().to_string(),
            "| | a |\n|---|--:|\n| x | 1 |\n| y | 2 |\n"
        );
        assert_eq!(table.to_string().lines().count(), 4);
    }
}
