//! Pages of `docs/measurements`.

use morph_collision_testkit::report::Store;

use std::fmt::{Display, Formatter, Result};

/// A page before it is written.
#[derive(Clone, Debug, Default)]
pub(crate) struct Page {
    /// The topic, which is also the name of the file.
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    /// What is measured, and how to read it.
    pub(crate) intro: &'static str,
    /// How the numbers are made again, unless it is `just report --only NAME`.
    pub(crate) command: &'static str,
    /// The data files, unless there is one, of the same name.
    pub(crate) data: &'static [&'static str],
    /// The origins of its rows.
    pub(crate) origins: Origins,
    pub(crate) body: String,
}

impl Page {
    /// Adds rows: where each is from, and what it is about.
    pub(crate) fn about<'a>(mut self, rows: impl IntoIterator<Item = (&'a str, &'a str)>) -> Self {
        for (measured, title) in rows {
            self.origins.add(measured, title);
        }
        self
    }

    /// The Markdown, with links to those data files of the store that exist.
    pub(crate) fn text(&self, store: &Store) -> String {
        let Self { name, title, intro, .. } = self;
        let command = match self.command {
            "" => &format!("just report --only {name}"),
            command => command,
        };
        let data = if self.data.is_empty() { &[*name][..] } else { self.data };
        let mut text =
            format!("<!-- Written by `just report`. Change its source instead. -->\n\n# {title}\n\n{intro}\n");
        if self.origins.0.is_empty() {
            return text + &format!("Run `{command}` to fill this page.\n");
        }
        text += &self.origins.to_string();
        let links: Vec<_> = data
            .iter()
            .filter(|name| store.path(name).exists())
            .map(|name| format!("[{name}.csv](data/{name}.csv)"))
            .collect();
        text += &format!(
            "\n- Command: `{command}`\n- Data: {}\n- [All measurements](../performance.md)\n",
            links.join(", ")
        );
        format!("{text}\n{}", self.body.trim_start())
    }
}

/// Where and when rows were measured, with the titles of those rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Origins(Vec<(String, Vec<String>)>);

impl Origins {
    pub(crate) fn add(&mut self, measured: &str, title: &str) {
        if !self.0.iter().any(|(of, _)| of == measured) {
            self.0.push((measured.to_owned(), Vec::new()));
        }
        let of_same = self.0.iter_mut().filter(|(of, _)| of == measured);
        for (_, titles) in of_same.filter(|(_, titles)| titles.iter().all(|of| of != title)) {
            titles.push(title.to_owned());
        }
    }
}

/// A line for each origin. If there are several, each says what it is about.
impl Display for Origins {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        if let [(measured, _)] = self.0.as_slice() {
            return writeln!(f, "Measured on {measured}.");
        }
        for (measured, titles) in &self.0 {
            writeln!(f, "- Measured on {measured}.\n  {}.", titles.join(";\n  "))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    #[test]
    fn a_page_without_rows_says_how_to_fill_it() {
        let store = Store::below(Path::new("no/such/folder"));
        let page = Page {
            title: "Rays",
            intro: "What rays cost.\n",
            name: "rays",
            ..Page::default()
        };
        let text = page.text(&store);
        assert!(
            text.ends_with("# Rays\n\nWhat rays cost.\n\nRun `just report --only rays` to fill this page.\n"),
            "{text}"
        );
        let text = page.clone().about([("today", "a head")]).text(&store);
        assert!(text.contains("\nMeasured on today.\n\n- Command:"), "{text}");
        assert!(!text.contains("rays.csv"), "{text}");
    }

    #[test]
    fn rows_of_several_origins_are_told_apart() {
        let mut origins = Origins::default();
        for (measured, title) in [
            ("Monday", "heads"),
            ("Sunday", "horses"),
            ("Monday", "crowd"),
            ("Monday", "heads"),
        ] {
            origins.add(measured, title);
        }
        let expected = "- Measured on Monday.\n  heads;\n  crowd.\n- Measured on Sunday.\n  horses.\n";
        assert_eq!(origins.to_string(), expected);
    }
}
