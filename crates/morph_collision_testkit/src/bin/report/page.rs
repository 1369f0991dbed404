//! Pages of `docs/measurements`.

/// A page before it is written.
#[derive(Clone, Debug, Default)]
pub(crate) struct Page {
    /// The topic, which is also the name of the file.
    pub(crate) name: &'static str,
    pub(crate) title: &'static str,
    /// What is measured, and how to read it.
    pub(crate) intro: &'static str,
    /// How the numbers are made again.
    pub(crate) command: &'static str,
    /// The data files.
    pub(crate) data: &'static [&'static str],
    /// The origins of the rows, each once.
    pub(crate) measured: Vec<String>,
    pub(crate) body: String,
}

impl Page {
    /// Adds the origins of rows.
    pub(crate) fn measured_at<'a>(mut self, origins: impl IntoIterator<Item = &'a String>) -> Self {
        for origin in origins {
            if !self.measured.contains(origin) {
                self.measured.push(origin.clone());
            }
        }
        self
    }

    /// The Markdown.
    pub(crate) fn text(&self) -> String {
        let Self {
            title, intro, command, body, ..
        } = self;
        let mut text = format!("<!-- Written by `just report`. Change its source instead. -->\n\n# {title}\n\n{intro}\n");
        if self.measured.is_empty() {
            return text + &format!("Run `{command}` to fill this page.\n");
        }
        text += &origins(&self.measured);
        let links: Vec<_> = self.data.iter().map(|name| format!("[{name}.csv](data/{name}.csv)")).collect();
        text += &format!("\nCommand: `{command}`. Data: {}. [All measurements](../performance.md)\n", links.join(", "));
        text + "\n" + body
    }
}

/// A line for each origin.
pub(crate) fn origins(measured: &[String]) -> String {
    measured.iter().map(|origin| format!("- Measured on {origin}.\n")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_page_without_rows_says_how_to_fill_it() {
        let page = Page {
            title: "Rays",
            intro: "What rays cost.\n",
            command: "just report --only rays",
            ..Page::default()
        };
        let text = page.text();
        assert!(text.ends_with("# Rays\n\nWhat rays cost.\n\nRun `just report --only rays` to fill this page.\n"), "{text}");
        let text = page.measured_at(&["a".to_owned(), "b".to_owned(), "a".to_owned()]).text();
        assert!(text.contains("\n- Measured on a.\n- Measured on b.\n\nCommand:"), "{text}");
    }
}
