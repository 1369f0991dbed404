//! The files of measured rows, and the plots.

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::Figure;

/// The folder of the pages, with the folders `data` and `plots`.
#[derive(Clone, Debug)]
pub struct Store {
    pages: PathBuf,
    data: PathBuf,
}

impl Store {
    /// The store of the pages in a folder.
    #[must_use]
    pub fn below(pages: &Path) -> Self {
        Self {
            pages: pages.to_owned(),
            data: pages.join("data"),
        }
    }

    /// The rows of a file; none if there is no such file.
    ///
    /// # Errors
    /// The file cannot be read, or its rows are of another kind.
    pub fn rows<T: DeserializeOwned>(&self, name: &str) -> Result<Vec<T>, Box<dyn Error>> {
        let path = self.path(name);
        if !path.exists() {
            return Ok(Vec::new());
        }
        let told = |error: csv::Error| format!("{}: {error}", path.display());
        let mut reader = csv::Reader::from_path(&path).map_err(told)?;
        let rows = reader.deserialize().collect::<Result<_, _>>();
        Ok(rows.map_err(told)?)
    }

    /// Replaces the rows of a file.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write<T: Serialize>(&self, name: &str, rows: &[T]) -> Result<(), Box<dyn Error>> {
        fs::create_dir_all(&self.data)?;
        let path = self.path(name);
        let mut writer = csv::Writer::from_path(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        for row in rows {
            writer.serialize(row)?;
        }
        Ok(writer.flush()?)
    }

    /// Draws a figure, and returns the Markdown that shows it on a page.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn plot(&self, figure: &Figure, alt: &str) -> Result<String, Box<dyn Error>> {
        let plots = self.pages.join("plots");
        fs::create_dir_all(&plots)?;
        figure.draw(&plots.join(&figure.name).with_extension("svg"))?;
        Ok(format!("![{alt}](plots/{}.svg)\n", figure.name))
    }

    /// The folder of the pages.
    #[must_use]
    pub fn pages(&self) -> &Path {
        &self.pages
    }

    /// The same data, with pages and plots elsewhere.
    #[must_use]
    pub fn with_pages(&self, pages: &Path) -> Self {
        Self {
            pages: pages.to_owned(),
            data: self.data.clone(),
        }
    }

    /// The file of some rows.
    #[must_use]
    pub fn path(&self, name: &str) -> PathBuf {
        self.data.join(name).with_extension("csv")
    }
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::*;

    #[derive(Debug, PartialEq, Serialize, Deserialize)]
    struct Row {
        title: String,
        size: Option<usize>,
        ratio: f64,
    }

    #[derive(Serialize)]
    struct Other {
        count: usize,
    }

    #[test]
    fn rows_are_read_as_they_were_written() -> Result<(), Box<dyn Error>> {
        let folder = tempfile::tempdir()?;
        let store = Store::below(folder.path());
        assert_eq!(store.rows::<Row>("times")?, []);
        let row = |title: &str, size, ratio| Row {
            title: title.to_owned(),
            size,
            ratio,
        };
        let rows = [
            row("Dolphins, 12 x 564", Some(564), 0.81),
            row("\"quoted\"", None, 1e-7),
        ];
        store.write("times", &rows)?;
        assert_eq!(store.rows::<Row>("times")?, rows);
        store.write("times", &rows[1..])?;
        assert_eq!(store.rows::<Row>("times")?, rows[1..]);
        Ok(())
    }

    #[test]
    fn rows_of_another_kind_are_an_error_that_names_the_file() -> Result<(), Box<dyn Error>> {
        let folder = tempfile::tempdir()?;
        let store = Store::below(folder.path());
        store.write("times", &[Other { count: 1 }])?;
        let error = store.rows::<Row>("times").map_err(|error| error.to_string());
        assert!(error.expect_err("it has no title").contains("times.csv"));
        Ok(())
    }
}
