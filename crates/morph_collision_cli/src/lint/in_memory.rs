//! Lint without a command line: a file in memory becomes the page that `--html` writes.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use morph_collision_models::gltf::read::{GltfFile, ReadOptions};
use morph_collision_models::memory;
use morph_collision_models::text::Printable;

use super::options::LintOptions;
use super::{html, report_of};
use crate::error::CliError;
use crate::messages::progress;

/// What to try besides single targets, clips and random mixtures. The fields are the options of `morph-collide lint`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lint {
    /// All pairs of targets.
    pub pairs: bool,
    /// The largest weights that do not clip.
    pub suggest: bool,
    /// Proofs for all weights from 0 to 1.
    pub prove: bool,
}

/// The result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LintPage {
    /// A page that needs no other file.
    pub html: String,
    /// The number of findings.
    pub findings: usize,
    /// The number of shapes that were tried.
    pub shapes: usize,
}

impl Lint {
    /// Tries all shapes of all meshes of a .glb or .gltf file, on this thread, with the default limit of memory, to which
    /// `bytes` themselves do not count. Its buffers must be within it.
    ///
    /// # Errors
    /// The message of the command for the same file. It may name options of the command.
    pub fn page(self, name: &str, bytes: &[u8]) -> Result<LintPage, String> {
        self.checked(Path::new(name), bytes, memory::DEFAULT_LIMIT)
            .map_err(|error| Printable(&error.to_string()).to_string())
    }

    fn checked(self, name: &Path, bytes: &[u8], memory_limit: u64) -> Result<LintPage, CliError> {
        progress::doing(format!("reading {}", name.display()));
        let options = ReadOptions {
            memory_limit,
            ..ReadOptions::default()
        };
        let file = GltfFile::parse(bytes, name, &options)?;
        let report = report_of(&self.options(name.to_owned()), &file)?;
        Ok(LintPage {
            html: html::page(&report),
            findings: report.all().count(),
            shapes: report.shapes(),
        })
    }

    fn options(self, model: PathBuf) -> LintOptions {
        LintOptions {
            model,
            pairs: self.pairs,
            suggest: self.suggest,
            prove: self.prove,
            pictures: true,
            threads: Some(NonZeroUsize::MIN),
            ..LintOptions::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;
    use crate::messages::progress::{Message, listen};

    static HEARD: Mutex<Vec<String>> = Mutex::new(Vec::new());

    fn hear(told: Message<'_>) {
        let line = match told {
            Message::Progress { what, steps: None } => what.to_owned(),
            Message::Progress {
                what,
                steps: Some((done, all)),
            } => format!("{what} {done}/{all}"),
            Message::Warning(warning) => warning.to_owned(),
        };
        HEARD.lock().into_iter().for_each(|mut heard| heard.push(line.clone()));
    }

    /// A triangle and, as a second mesh, one that refers to a buffer in another file.
    const MODEL: &str = r#"{"asset":{"version":"2.0"},
        "buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"},
                   {"byteLength":36,"uri":"elsewhere.bin"}],
        "bufferViews":[{"buffer":0,"byteLength":36},{"buffer":1,"byteLength":36}],
        "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
                     {"bufferView":1,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0},"targets":[{"POSITION":0}]}]},
                  {"primitives":[{"attributes":{"POSITION":1}}]}]}"#;

    #[test]
    fn a_file_in_memory_becomes_a_page_and_the_listener_hears_of_it() -> Result<(), String> {
        listen(hear);
        let page = std::thread::scope(|scope| {
            // What begins on another thread meanwhile takes no step away.
            let other = scope.spawn(|| (0..1000).for_each(|_| drop(Lint::default().page("bad.glb", b""))));
            let page = Lint::default().page("two <meshes>.gltf", MODEL.as_bytes());
            drop(other.join());
            page
        })?;
        assert_eq!((page.findings, page.shapes), (0, 4 + 100));
        assert!(page.html.contains("Lint of two &lt;meshes&gt;.gltf"), "{}", page.html);
        assert!(page.html.contains("Nothing was found."));
        let heard = HEARD.lock().map_err(|error| error.to_string())?;
        for part in [
            "reading two <meshes>.gltf",
            "building the tree of 1 triangles",
            "single target 0/4",
            "single target 4/4",
            "mixture 100/100",
        ] {
            assert!(heard.iter().any(|line| line == part), "no {part} in {heard:?}");
        }
        assert!(
            heard
                .iter()
                .any(|line| line.starts_with("warning: left out:") && line.contains("elsewhere.bin")),
            "{heard:?}"
        );
        Ok(())
    }

    #[test]
    fn bad_files_and_too_little_memory_are_errors_that_name_the_file() {
        let page = |bytes: &[u8]| Lint::default().page("bad.glb", bytes);
        for bytes in [&b""[..], b"no model", b"glTF"] {
            let error = page(bytes);
            assert!(
                error.as_ref().is_err_and(|error| error.starts_with("bad.glb: ")),
                "{error:?}"
            );
        }
        let small = Lint::default().checked(Path::new("bad.glb"), MODEL.as_bytes(), MODEL.len() as u64);
        let small = small.map_err(|error| error.to_string());
        assert!(
            small
                .as_ref()
                .is_err_and(|error| error.contains("--memory-limit raises it")),
            "{small:?}"
        );
    }
}
