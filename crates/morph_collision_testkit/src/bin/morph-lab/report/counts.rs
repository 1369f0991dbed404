//! Counts of instructions, which recipes print and pass on.

use std::error::Error;
use std::io::BufRead;

use serde::{Deserialize, Serialize};

use morph_collision_testkit::report::{NOTHING, Table};

use crate::report::context::Context;

/// The data files: those of `just instructions-rivals`, of `just instructions-motion`, and of `just instructions-profiles`.
pub(crate) const DATA: [&str; 3] = [SCENES, MOTION, PROFILES];
pub(crate) const SCENES: &str = "instructions";
pub(crate) const MOTION: &str = "instructions_motion";
pub(crate) const PROFILES: &str = "instructions_profiles";

/// A number in a table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Count {
    pub(crate) row: String,
    pub(crate) column: String,
    pub(crate) value: f64,
    pub(crate) measured: String,
}

impl Count {
    /// Where it is from, and what it is about.
    pub(crate) fn origin(&self) -> (&str, &str) {
        (&self.measured, &self.row)
    }
}

/// Stores counts that a recipe prints.
///
/// # Errors
/// A line has another form, or there is none.
pub(crate) fn take(context: &Context, data: &str, input: impl BufRead) -> Result<(), Box<dyn Error>> {
    let lines = input.lines().collect::<Result<Vec<_>, _>>()?;
    let counts = lines
        .iter()
        .map(|line| parse(line, &context.origin))
        .collect::<Result<Vec<_>, _>>()?;
    if counts.is_empty() {
        return Err("there is nothing to read on standard input".into());
    }
    context.store.write(data, &counts)
}

/// A line: the row, which may have several words, the column and the number.
fn parse(line: &str, measured: &str) -> Result<Count, String> {
    let wrong = || format!("\"{line}\" is not a row, a column and a number");
    let (rest, value) = line.trim_end().rsplit_once(' ').ok_or_else(wrong)?;
    let (row, column) = rest.trim_end().rsplit_once(' ').ok_or_else(wrong)?;
    Ok(Count {
        row: row.trim().to_owned(),
        column: column.to_owned(),
        value: value.parse().map_err(|_| wrong())?,
        measured: measured.to_owned(),
    })
}

/// A table of counts.
pub(crate) fn table(counts: &[Count], head: &str) -> Table {
    let (mut rows, mut columns): (Vec<&str>, Vec<&str>) = (Vec::new(), Vec::new());
    for count in counts {
        if !rows.contains(&count.row.as_str()) {
            rows.push(&count.row);
        }
        if !columns.contains(&count.column.as_str()) {
            columns.push(&count.column);
        }
    }
    let mut table = Table::new([head].into_iter().chain(columns.iter().copied()));
    for row in rows {
        let value = |column: &&str| counts.iter().find(|count| count.row == row && count.column == *column);
        let cell = |column: &&str| value(column).map_or(NOTHING.to_owned(), |count| count.value.to_string());
        table.row([row.to_owned()].into_iter().chain(columns.iter().map(cell)));
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_a_row_a_column_and_a_number() {
        let count = parse("dolphins-564         all         5.655", "today").expect("it is one");
        assert_eq!(
            (count.row.as_str(), count.column.as_str(), count.value),
            ("dolphins-564", "all", 5.655)
        );
        assert_eq!(
            parse("beside 0.1 discrete 6.1", "").expect("it is one").row,
            "beside 0.1"
        );
        for wrong in ["", "a b", "a b c", "skipped: no model here"] {
            assert!(parse(wrong, "").is_err(), "{wrong}");
        }
    }

    #[test]
    fn counts_are_shown_by_row_and_column() {
        let lines = ["a all 1.5", "a first 0.5", "b all 2"].map(|line| parse(line, "").expect("it is one"));
        assert_eq!(
            table(&lines, "scene").to_string(),
            "| scene | all | first |\n|---|--:|--:|\n| a | 1.5 | 0.5 |\n| b | 2 | - |\n"
        );
    }
}
