//! A Markdown page with places for tables, marked by comments: `<!-- table: NAME -->` to `<!-- end -->`.

use std::io;
use std::path::{Path, PathBuf};

/// A page being changed.
pub(crate) struct Page {
    path: PathBuf,
    text: String,
}

impl Page {
    pub(crate) fn read(path: &Path) -> io::Result<Self> {
        Ok(Self {
            path: path.to_owned(),
            text: std::fs::read_to_string(path)?,
        })
    }

    /// Puts a text between a place's markers.
    ///
    /// # Errors
    /// When the page has no such place.
    pub(crate) fn replace(&mut self, name: &str, content: &str) -> Result<(), String> {
        let opening = format!("<!-- table: {name} -->\n");
        let missing = || format!("{}: there is no place for \"{name}\"", self.path.display());
        let start = self.text.find(&opening).ok_or_else(missing)? + opening.len();
        let length = self.text[start..].find("<!-- end -->").ok_or_else(missing)?;
        self.text.replace_range(start..start + length, content);
        Ok(())
    }

    pub(crate) fn write(&self) -> io::Result<()> {
        std::fs::write(&self.path, &self.text)
    }
}
