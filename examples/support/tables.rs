//! Shared by the reports: rewrites the tables of a page in place.

use std::path::Path;

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use morph_collision_testkit::bench::Page;

/// The options that all reports share.
#[derive(Args, Clone, Debug)]
pub struct TableOptions {
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
pub fn rewrite(path: &Path, options: &TableOptions, sections: &[Section<'_>]) -> Result<(), String> {
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

/// A progress bar of this length.
#[must_use]
pub fn progress(length: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:40} {pos}/{len} {eta}").unwrap_or(ProgressStyle::default_bar());
    ProgressBar::new(length).with_style(style)
}
