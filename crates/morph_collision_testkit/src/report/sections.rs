//! A Markdown page with sections for tables and plots, marked by comments: `<!-- table: NAME -->` to
//! `<!-- end -->`; and reports that measure and replace them.

use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use clap::Args;

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

/// The options that all reports share.
#[derive(Args, Clone, Debug)]
pub struct SectionOptions {
    /// Run few frames, for rough numbers.
    #[arg(long)]
    pub quick: bool,
    /// Rewrite only the table of this name.
    #[arg(long)]
    pub only: Option<String>,
}

/// A named section of a page, and the function that generates its content.
pub type Section<'a> = (&'a str, Box<dyn Fn() -> Result<String, String> + 'a>);

/// Rewrites the sections of a page, one after the other, and saves the page after each.
///
/// # Errors
/// The page cannot be read or written, it has no such section, or a section's function fails.
pub fn rewrite(path: &Path, options: &SectionOptions, sections: &[Section<'_>]) -> Result<(), String> {
    let is_wanted = |name: &str| options.only.as_ref().is_none_or(|only| only == name);
    if !sections.iter().any(|(name, _)| is_wanted(name)) {
        let names: Vec<&str> = sections.iter().map(|(name, _)| *name).collect();
        return Err(format!("there is no such place; there are {}", names.join(", ")));
    }
    let mut page = Page::read(path)?;
    for (name, make) in sections {
        if is_wanted(name) {
            eprintln!("{name}");
            page.replace(name, &make()?)?;
            page.write().map_err(|error| format!("{}: {error}", path.display()))?;
        }
    }
    Ok(())
}
