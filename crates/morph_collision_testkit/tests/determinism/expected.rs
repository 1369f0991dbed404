//! The file of expected hashes: a line for each scene, its name last.

use std::fmt;
use std::path::Path;

use crate::answers::COLUMNS;
use crate::hash::Hash;

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/determinism/expected.txt");
/// Set to anything to write the file again.
const WRITE: &str = "WRITE_EXPECTED";

/// What a scene comes to.
#[derive(Clone, Debug)]
pub(crate) struct Line {
    pub(crate) scene: String,
    pub(crate) inputs: u64,
    pub(crate) hashes: [Hash; COLUMNS.len()],
}

impl fmt::Display for Line {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:016x} ", self.inputs)?;
        for hash in self.hashes {
            write!(f, "{:016x} ", hash.value())?;
        }
        f.write_str(&self.scene)
    }
}

/// Compares with the file, line by line, or writes it if that is asked for.
pub(crate) fn check(lines: &[Line]) {
    let head = format!("# FNV-1a of: inputs {}, scene", COLUMNS.join(" "));
    let found: Vec<String> = std::iter::once(head).chain(lines.iter().map(Line::to_string)).collect();
    if std::env::var_os(WRITE).is_some() {
        std::fs::write(Path::new(FILE), found.join("\n") + "\n").expect("the file can be written");
        return;
    }
    let text = std::fs::read_to_string(FILE).expect("the file can be read");
    let expected: Vec<&str> = text.lines().collect();
    let differences: Vec<String> = (0..found.len().max(expected.len()))
        .filter_map(|i| difference(expected.get(i).copied(), found.get(i).map(String::as_str)))
        .collect();
    assert!(
        differences.is_empty(),
        "{}\nIf the change is meant: {WRITE}=1 cargo test -p morph_collision_testkit --test determinism",
        differences.join("\n")
    );
}

/// What differs in a line; where the inputs do, so must the rest.
fn difference(expected: Option<&str>, found: Option<&str>) -> Option<String> {
    if expected == found {
        return None;
    }
    let fields = |line: Option<&str>| {
        line.unwrap_or("")
            .splitn(COLUMNS.len() + 2, ' ')
            .map(str::to_owned)
            .collect()
    };
    let (expected, found): (Vec<String>, Vec<String>) = (fields(expected), fields(found));
    let names = std::iter::once("inputs").chain(COLUMNS).chain(["scene"]);
    let other: Vec<&str> = names
        .enumerate()
        .filter(|(i, _)| expected.get(*i) != found.get(*i))
        .map(|(_, name)| name)
        .collect();
    let scene = found.last().or(expected.last());
    Some(format!("{}: other {}", scene.map_or("", |s| s), other.join(", ")))
}
