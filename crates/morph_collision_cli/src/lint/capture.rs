//! Tables of recorded weights: a line of names, then a line of numbers per frame.

use std::io::Read;
use std::path::Path;

use morph_collision_models::gltf::read::{LFS_POINTER, is_lfs_pointer};
use morph_collision_models::memory::MemoryBudget;
use morph_collision_models::text::Printable;
use morph_collision_models::text::suggestion;

use crate::error::CliError;

/// Recorded weights of some or all targets of a mesh.
#[derive(Debug)]
pub(super) struct Capture {
    /// The file.
    pub(super) name: String,
    /// The targets that have a column.
    targets: Vec<usize>,
    /// Row by row, one weight for each of `targets`.
    weights: Vec<f32>,
    /// Names of columns that are no targets.
    pub(super) ignored: Vec<String>,
}

impl Capture {
    /// Reads a table for a mesh with targets of these names.
    pub(super) fn read(path: &Path, names: &[String], budget: &MemoryBudget) -> Result<Self, CliError> {
        let fail = |reason: String| CliError::Flag {
            flag: "--capture",
            reason: format!("{}: {reason}", path.display()),
        };
        let most = budget.left();
        let mut text = String::new();
        let file = std::fs::File::open(path).map_err(|error| fail(error.to_string()))?;
        let read = file.take(most).read_to_string(&mut text);
        read.map_err(|error| fail(error.to_string()))?;
        if text.len() as u64 >= most {
            return Err(fail("is larger than the memory limit; raise --memory-limit".to_owned()));
        }
        if is_lfs_pointer(text.as_bytes()) {
            return Err(fail(LFS_POINTER.to_owned()));
        }
        // A number takes at least two characters of the text and four bytes here.
        let taken = budget.take(text.len() as u64, 3, || "its table of weights".to_owned());
        taken.map_err(|over| fail(format!("{over}; raise --memory-limit")))?;
        Self::parse(path.display().to_string(), &text, names).map_err(fail)
    }

    fn parse(name: String, text: &str, names: &[String]) -> Result<Self, String> {
        let text = text.trim_start_matches('\u{feff}');
        let mut lines = text.lines().enumerate().map(|(index, line)| (index + 1, line.trim()));
        let mut lines = lines
            .by_ref()
            .filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
        let Some((_, header)) = lines.next() else {
            return Err("has no line with the names of targets".to_owned());
        };
        let columns: Vec<&str> = header.split(',').map(|name| name.trim().trim_matches('"')).collect();
        let found: Vec<Option<usize>> = columns.iter().map(|column| find(column, names)).collect();
        let targets: Vec<usize> = found.iter().copied().flatten().collect();
        if targets.is_empty() {
            let hint = columns
                .iter()
                .map(|column| suggestion(column, names.iter().map(String::as_str)));
            let hint = hint.into_iter().find(|hint| !hint.is_empty()).unwrap_or_default();
            return Err(format!(
                "no column of the first line, \"{}\", has the name of a target{hint}",
                Printable(&header.chars().take(60).collect::<String>())
            ));
        }
        let mut seen = targets.clone();
        seen.sort_unstable();
        if let Some(twice) = seen.windows(2).find(|pair| pair[0] == pair[1]) {
            return Err(format!(
                "two columns are for target \"{}\"",
                Printable(&names[twice[0]])
            ));
        }
        let mut weights = Vec::new();
        for (line, row) in lines {
            let cells: Vec<&str> = row.split(',').map(str::trim).collect();
            if cells.len() != columns.len() {
                return Err(format!(
                    "line {line}: expected {} columns, found {}",
                    columns.len(),
                    cells.len()
                ));
            }
            for ((cell, column), target) in cells.into_iter().zip(&columns).zip(&found) {
                if target.is_some() {
                    let number = cell.parse().ok().filter(|number: &f32| number.is_finite());
                    let wrong = || {
                        format!(
                            "line {line}: {}: expected a number, found \"{}\"",
                            Printable(column),
                            Printable(cell)
                        )
                    };
                    weights.push(number.ok_or_else(wrong)?);
                }
            }
        }
        let ignored = columns.iter().zip(&found).filter(|(_, target)| target.is_none());
        let ignored = ignored.map(|(column, _)| (*column).to_owned()).collect();
        Ok(Self {
            name,
            targets,
            weights,
            ignored,
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

    fn parse(text: &str) -> Result<Capture, String> {
        let names = ["jawOpen", "mouthClose"].map(str::to_owned);
        Capture::parse("take.csv".to_owned(), text, &names)
    }

    #[test]
    fn columns_are_found_by_name_and_others_are_ignored() -> Result<(), String> {
        let capture = parse("\u{feff}Timecode,MouthClose,jawOpen\n# take 3\n00:01,0.25,1\n\n00:02,0,-0.5\n")?;
        assert_eq!((capture.len(), &capture.ignored[..]), (2, &["Timecode".to_owned()][..]));
        let row = |row| capture.row(row).collect::<Vec<_>>();
        assert_eq!(row(0), [(1, 0.25), (0, 1.0)]);
        assert_eq!(row(1), [(1, 0.0), (0, -0.5)]);
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
