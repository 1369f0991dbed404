//! A Markdown page with sections for tables and plots, marked by comments: `<!-- table: NAME -->` to
//! `<!-- end -->`.

use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// A page that is being changed.
#[derive(Clone, Debug)]
pub struct Page {
    path: PathBuf,
    text: String,
}

impl Page {
    /// Reads an existing page.
    ///
    /// # Errors
    /// The page cannot be read.
    pub fn read(path: &Path) -> Result<Self, String> {
        let text = std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
        Ok(Self {
            path: path.to_owned(),
            text,
        })
    }

    /// The text between a section's markers.
    ///
    /// # Errors
    /// The page has no such section.
    pub fn content(&self, name: &str) -> Result<&str, String> {
        Ok(&self.text[self.place(name)?])
    }

    /// Replaces the text between a section's markers.
    ///
    /// # Errors
    /// The page has no such section.
    pub fn replace(&mut self, name: &str, content: &str) -> Result<(), String> {
        let place = self.place(name)?;
        self.text.replace_range(place, content);
        Ok(())
    }

    fn place(&self, name: &str) -> Result<Range<usize>, String> {
        let opening = format!("<!-- table: {name} -->\n");
        let missing = || format!("{}: there is no place for \"{name}\"", self.path.display());
        let start = self.text.find(&opening).ok_or_else(missing)? + opening.len();
        let length = self.text[start..].find("<!-- end -->").ok_or_else(missing)?;
        Ok(start..start + length)
    }

    /// Writes the page back to its file.
    ///
    /// # Errors
    /// The page cannot be written.
    pub fn write(&self) -> io::Result<()> {
        std::fs::write(&self.path, &self.text)
    }
}
