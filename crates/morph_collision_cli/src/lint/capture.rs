//! Tables of recorded weights: a line of names, then a line of numbers per frame.

use std::path::Path;

use morph_collision_models::memory::MemoryBudget;
use morph_collision_models::text::Printable;
use morph_collision_models::text::suggestion;

use crate::error::CliError;
use crate::files::model::FileArgs;
use crate::files::text::TextFile;

/// Upper bound on the bytes that a column takes while its name is looked up: its name, its target, and the list of targets, twice, in lists
/// that grow.
const BYTES_PER_COLUMN: u64 = 128;
/// At most this many columns that are no targets are named.
const MOST_IGNORED: usize = 12;
/// Suggestions are made for this many columns.
const MOST_SUGGESTED: usize = 100;
/// Longer names and numbers are cut in messages.
const MOST_CHARACTERS: usize = 60;

/// Recorded weights of some or all targets of a mesh.
#[derive(Debug)]
pub(super) struct Capture {
    /// The file.
    pub(super) name: String,
    /// The targets that have a column.
    targets: Vec<usize>,
    /// Row by row, one weight for each of `targets`.
    weights: Vec<f32>,
    /// Names of the first columns that are no targets.
    pub(super) ignored: Vec<String>,
    /// How many more there are.
    pub(super) more_ignored: usize,
}

impl Capture {
    /// Reads a table for a mesh with targets of these names.
    pub(super) fn read(
        path: &Path,
        names: &[String],
        files: &FileArgs,
        budget: &MemoryBudget,
    ) -> Result<Self, CliError> {
        let flag = "--capture";
        let file = TextFile { flag, path };
        Self::parse(&file, &file.read(files, budget)?, names, budget)
    }

    fn parse(file: &TextFile<'_>, text: &str, names: &[String], budget: &MemoryBudget) -> Result<Self, CliError> {
        let text = text.trim_start_matches('\u{feff}');
        let lines = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim()));
        let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
        let Some((_, header)) = lines.next() else {
            return Err(file.error("has no line with the names of targets"));
        };
        let count = header.split(',').count();
        file.take(budget, count as u64, BYTES_PER_COLUMN, "its columns")?;
        let columns: Vec<&str> = header.split(',').map(|name| name.trim().trim_matches('"')).collect();
        let found: Vec<Option<usize>> = columns.iter().map(|column| find(column, names)).collect();
        let targets: Vec<usize> = found.iter().copied().flatten().collect();
        if targets.is_empty() {
            let columns = columns.iter().take(MOST_SUGGESTED);
            let mut hints = columns.map(|column| suggestion(start(column), names.iter().map(String::as_str)));
            let hint = hints.find(|hint| !hint.is_empty()).unwrap_or_default();
            return Err(file.error(format_args!(
                "no column of the first line, \"{}\", has the name of a target{hint}",
                Printable(start(header))
            )));
        }
        let mut seen = targets.clone();
        seen.sort_unstable();
        if let Some(twice) = seen.windows(2).find(|pair| pair[0] == pair[1]) {
            let name = Printable(&names[twice[0]]);
            return Err(file.error(format_args!("two columns are for target \"{name}\"")));
        }
        let rows = lines.clone().count() as u64;
        let numbers = rows.saturating_mul(targets.len() as u64);
        file.take(budget, numbers, size_of::<f32>() as u64, "its weights")?;
        let mut weights = Vec::with_capacity(usize::try_from(numbers).unwrap_or(0));
        for (line, row) in lines {
            let cells = row.split(',').count();
            if cells != count {
                return Err(file.error(format_args!("line {line}: expected {count} columns, found {cells}")));
            }
            for ((cell, column), target) in row.split(',').map(str::trim).zip(&columns).zip(&found) {
                if target.is_some() {
                    let number = cell.parse().ok().filter(|number: &f32| number.is_finite());
                    weights.push(number.ok_or_else(|| {
                        let (column, cell) = (Printable(start(column)), Printable(start(cell)));
                        file.error(format_args!(
                            "line {line}: {column}: expected a number, found \"{cell}\""
                        ))
                    })?);
                }
            }
        }
        let ignored = columns.iter().zip(&found).filter(|(_, target)| target.is_none());
        let ignored = ignored.map(|(column, _)| start(column).to_owned());
        Ok(Self {
            name: file.path.display().to_string(),
            ignored: ignored.take(MOST_IGNORED).collect(),
            more_ignored: (count - targets.len()).saturating_sub(MOST_IGNORED),
            targets,
            weights,
        })
    }

    /// The number of rows.
    pub(super) fn len(&self) -> usize {
        self.weights.len() / self.targets.len()
    }

    /// The targets and weights of one row.
    pub(super) fn row(&self, row: usize) -> impl Iterator<Item = (usize, f32)> {
        let start = row * self.targets.len();
        self.targets.iter().copied().zip(self.weights[start..].iter().copied())
    }
}

/// The first characters of a text, for messages.
fn start(text: &str) -> &str {
    let end = text.char_indices().nth(MOST_CHARACTERS);
    end.map_or(text, |(end, _)| &text[..end])
}

/// The target of a column. Recorders write names in other cases, so case matters only if several names differ in nothing else.
fn find(column: &str, names: &[String]) -> Option<usize> {
    let exact = names.iter().position(|name| name == column);
    exact.or_else(|| {
        let mut similar = (0..names.len()).filter(|&target| names[target].eq_ignore_ascii_case(column));
        similar.next().filter(|_| similar.next().is_none())
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse_within(text: &str, limit: u64) -> Result<Capture, String> {
        let names = ["jawOpen", "mouthClose"].map(str::to_owned);
        let (flag, path) = ("--capture", Path::new("take.csv"));
        let file = TextFile { flag, path };
        Capture::parse(&file, text, &names, &MemoryBudget::new(limit)).map_err(|error| error.to_string())
    }

    fn parse(text: &str) -> Result<Capture, String> {
        parse_within(text, 1 << 20)
    }

    #[test]
    fn columns_are_found_by_name_and_others_are_ignored() -> Result<(), String> {
        let capture = parse("\u{feff}Timecode,MouthClose,jawOpen\n# take 3\n00:01,0.25,1\n\n00:02,0,-0.5\n")?;
        assert_eq!((capture.len(), &capture.ignored[..]), (2, &["Timecode".to_owned()][..]));
        assert_eq!(capture.more_ignored, 0);
        let row = |row| capture.row(row).collect::<Vec<_>>();
        assert_eq!(row(0), [(1, 0.25), (0, 1.0)]);
        assert_eq!(row(1), [(1, 0.0), (0, -0.5)]);
        Ok(())
    }

    #[test]
    fn columns_and_weights_are_counted_and_only_the_first_that_are_ignored_are_named() -> Result<(), String> {
        let wide = format!("jawOpen{}\n", ",".repeat(1000));
        let capture = parse_within(&wide, 1001 * BYTES_PER_COLUMN)?;
        assert_eq!((capture.ignored.len(), capture.more_ignored), (MOST_IGNORED, 988));
        let error = parse_within(&wide, 1001 * BYTES_PER_COLUMN - 1)
            .err()
            .unwrap_or_default();
        assert!(
            error.contains("its columns would take") && error.contains("--memory-limit"),
            "{error}"
        );
        let long = format!("jawOpen\n{}", "1\n".repeat(1000));
        assert_eq!(parse_within(&long, BYTES_PER_COLUMN + 4000)?.len(), 1000);
        let error = parse_within(&long, BYTES_PER_COLUMN + 3999).err().unwrap_or_default();
        assert!(error.contains("its weights would take"), "{error}");
        let error = parse(&format!("jawOpen\n{}", "x".repeat(1000)))
            .err()
            .unwrap_or_default();
        assert!(error.len() < 200, "{error}");
        Ok(())
    }

    #[test]
    fn mistakes_are_named_with_their_line() {
        for (text, part) in [
            ("", "no line"),
            ("jawOpn,x\n1,2", "did you mean \"jawOpen\""),
            ("jawOpen,JAWOPEN\n1,2", "two columns are for target \"jawOpen\""),
            ("jawOpen,mouthClose\n1,2\n1", "line 3: expected 2 columns, found 1"),
            ("jawOpen\n1\n\nNaN", "line 4: jawOpen: expected a number, found \"NaN\""),
            ("jawOpen\nopen", "line 2: jawOpen: expected a number, found \"open\""),
        ] {
            let error = parse(text).err().unwrap_or_default();
            assert!(error.contains(part), "{text:?}: {error}");
        }
    }
}
