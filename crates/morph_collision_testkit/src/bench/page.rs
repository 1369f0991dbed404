//! A Markdown page with places for tables and plots, marked by comments: `<!-- table: NAME -->` to `<!-- end -->`.

use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// A page being changed.
#[derive(Clone, Debug)]
pub struct Page {
    path: PathBuf,
    text: String,
}

impl Page {
    /// A page that is there.
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn read(path: &Path) -> Result<Self, String> {
        let text = std::fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
        Ok(Self {
            path: path.to_owned(),
            text,
        })
    }

    /// What stands between a place's markers.
    ///
    /// # Errors
    /// When the page has no such place.
    pub fn content(&self, name: &str) -> Result<&str, String> {
        Ok(&self.text[self.place(name)?])
    }

    /// Puts a text between a place's markers.
    ///
    /// # Errors
    /// When the page has no such place.
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

    /// Puts the page back in its place.
    ///
    /// # Errors
    /// When it cannot be written.
    pub fn write(&self) -> io::Result<()> {
        std::fs::write(&self.path, &self.text)
    }
}
