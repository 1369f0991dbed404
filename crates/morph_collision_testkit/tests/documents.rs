//! Links in the repository's documents lead somewhere, and the tests and commands that they promise exist.

use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The files below a folder, without what tools make.
fn files(folder: &Path, found: &mut Vec<PathBuf>) -> Result<(), Box<dyn Error>> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name();
        let name = name.to_string_lossy();
        if name.starts_with('.') || ["target", "node_modules"].contains(&name.as_ref()) {
            continue;
        }
        if entry.file_type()?.is_dir() {
            files(&entry.path(), found)?;
        } else {
            found.push(entry.path());
        }
    }
    Ok(())
}

fn of_kind(extensions: &[&str]) -> Result<Vec<PathBuf>, Box<dyn Error>> {
    let mut found = Vec::new();
    files(&root(), &mut found)?;
    let is_wanted = |path: &PathBuf| {
        path.extension()
            .is_some_and(|is| extensions.iter().any(|wanted| is == *wanted))
    };
    found.retain(is_wanted);
    Ok(found)
}

/// The links of a document, to files and pictures of the repository, and the anchors of its headings.
#[derive(Debug, Default, PartialEq)]
struct Document {
    links: Vec<String>,
    anchors: BTreeSet<String>,
}

impl Document {
    fn parse(text: &str) -> Self {
        let mut document = Self::default();
        let mut heading: Option<String> = None;
        for event in Parser::new_ext(text, Options::ENABLE_TABLES) {
            match event {
                Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) => {
                    let is_elsewhere = ["https:", "http:", "mailto:"]
                        .iter()
                        .any(|scheme| dest_url.starts_with(scheme));
                    document.links.extend((!is_elsewhere).then(|| dest_url.to_string()));
                }
                Event::Start(Tag::Heading { .. }) => heading = Some(String::new()),
                Event::End(TagEnd::Heading(_)) => document.add_anchor(&heading.take().unwrap_or_default()),
                Event::Text(text) | Event::Code(text) => {
                    if let Some(heading) = &mut heading {
                        heading.push_str(&text);
                    }
                }
                _ => {}
            }
        }
        document
    }

    /// The anchor that GitHub makes for a heading. The second of two equal ones gets a number.
    fn add_anchor(&mut self, heading: &str) {
        let kept = |c: &char| c.is_alphanumeric() || [' ', '-', '_'].contains(c);
        let anchor = heading
            .to_lowercase()
            .chars()
            .filter(kept)
            .collect::<String>()
            .replace(' ', "-");
        let numbered = (1..).map(|number| format!("{anchor}-{number}"));
        let free = [anchor.clone()]
            .into_iter()
            .chain(numbered)
            .find(|anchor| !self.anchors.contains(anchor));
        self.anchors.extend(free);
    }
}

#[test]
fn links_and_anchors_of_all_documents_exist() -> Result<(), Box<dyn Error>> {
    let mut documents = BTreeMap::new();
    for path in of_kind(&["md"])? {
        let document = Document::parse(&fs::read_to_string(&path)?);
        documents.insert(path.canonicalize()?, document);
    }
    let (mut dead, mut count) = (Vec::new(), 0);
    for (path, document) in &documents {
        for link in &document.links {
            let (file, anchor) = link
                .split_once('#')
                .map_or((link.as_str(), None), |(file, anchor)| (file, Some(anchor)));
            let folder = path.parent().ok_or("a file is in a folder")?;
            let target = if file.is_empty() {
                path.clone()
            } else {
                folder.join(file)
            };
            let target = target.canonicalize().ok();
            let is_there = match (&target, anchor) {
                (None, _) => false,
                (Some(_), None) => true,
                (Some(target), Some(anchor)) => documents.get(target).is_some_and(|to| to.anchors.contains(anchor)),
            };
            count += 1;
            if !is_there {
                dead.push(format!("{}: {link}", path.display()));
            }
        }
    }
    assert!(dead.is_empty(), "dead links:\n{}", dead.join("\n"));
    assert!(count > 100, "only {count} links");
    Ok(())
}

#[test]
fn documents_that_sources_name_exist() -> Result<(), Box<dyn Error>> {
    let (mut missing, mut count) = (Vec::new(), 0);
    let mut sources = of_kind(&["rs", "toml", "sh", "mjs", "js", "html"])?;
    sources.push(root().join("justfile"));
    for path in sources {
        let text = fs::read_to_string(&path)?;
        let words = text.split(|c: char| !c.is_alphanumeric() && !"_-./".contains(c));
        for word in words
            .map(|word| word.trim_end_matches('.'))
            .filter(|word| word.ends_with(".md"))
        {
            let Some(start) = word.find("docs/") else { continue };
            count += 1;
            if !root().join(&word[start..]).exists() {
                missing.push(format!("{}: {word}", path.display()));
            }
        }
    }
    assert!(
        missing.is_empty(),
        "documents that do not exist:\n{}",
        missing.join("\n")
    );
    assert!(count > 10, "only {count} documents are named");
    Ok(())
}

/// The texts between backticks, and the files that are linked, of a line of a document.
fn code_and_files(line: &str) -> (Vec<String>, Vec<String>) {
    let (mut code, mut files) = (Vec::new(), Vec::new());
    for event in Parser::new(line) {
        match event {
            Event::Code(text) => code.push(text.to_string()),
            Event::Start(Tag::Link { dest_url, .. }) => files.push(dest_url.to_string()),
            _ => {}
        }
    }
    (code, files)
}

#[test]
fn tests_and_commands_that_guarantees_name_exist() -> Result<(), Box<dyn Error>> {
    let recipes = fs::read_to_string(root().join("justfile"))?;
    let is_recipe = |name: &str| {
        let mut lines = recipes.lines().filter_map(|line| line.strip_prefix(name));
        lines.any(|rest| rest.starts_with([':', ' ']))
    };
    let (mut missing, mut count) = (Vec::new(), [0, 0]);
    for line in fs::read_to_string(root().join("docs/guarantees.md"))?.lines() {
        let (code, files) = code_and_files(line);
        let files = files.iter().filter(|file| file.ends_with(".rs"));
        let sources: String = files
            .map(|file| fs::read_to_string(root().join("docs").join(file)))
            .collect::<Result<_, _>>()?;
        for name in code {
            let is_there = if let Some(command) = name.strip_prefix("just ") {
                count[0] += 1;
                is_recipe(command.split(' ').next().unwrap_or_default())
            } else if name.matches('_').count() > 2 {
                count[1] += 1;
                sources.contains(&format!("fn {name}("))
            } else {
                continue;
            };
            if !is_there {
                missing.push(name);
            }
        }
    }
    assert!(missing.is_empty(), "not there: {missing:?}");
    assert!(count[0] > 15 && count[1] > 25, "only {count:?} commands and tests");
    Ok(())
}

#[test]
fn links_and_anchors_are_read_as_github_reads_them() {
    let text = "# A `Pose`, and its boxes\n\n[a](b.md#c) ![d](e.png) [f](https://example.com)\n\n## Rays\n\n## Rays\n\n\
                | [g](#rays-1) |\n|---|\n";
    let document = Document::parse(text);
    assert_eq!(document.links, ["b.md#c", "e.png", "#rays-1"]);
    assert_eq!(
        document.anchors,
        ["a-pose-and-its-boxes", "rays", "rays-1"].map(str::to_owned).into()
    );
}
