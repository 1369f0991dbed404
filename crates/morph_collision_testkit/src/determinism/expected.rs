//! The file of expected hashes: one line per scene, with the scene's name last.

use std::io;
use std::path::Path;

use super::Line;
use super::answers::COLUMNS;

const EXPECTED: &str = include_str!("expected.txt");
const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/src/determinism/expected.txt");

/// The differences from the file, one message per scene; empty if all scenes have the expected bits.
#[must_use]
pub fn differences(lines: &[Line]) -> Vec<String> {
    let (found, expected) = (text(lines), EXPECTED.lines().collect::<Vec<_>>());
    (0..found.len().max(expected.len()))
        .filter_map(|i| difference(expected.get(i).copied(), found.get(i).map(String::as_str)))
        .collect()
}

/// Rewrites the file.
///
/// # Errors
/// The file cannot be written.
pub fn write(lines: &[Line]) -> io::Result<()> {
    std::fs::write(Path::new(FILE), text(lines).join("\n") + "\n")
}

fn text(lines: &[Line]) -> Vec<String> {
    let head = format!("# FNV-1a of: inputs {}, scene", COLUMNS.join(" "));
    std::iter::once(head).chain(lines.iter().map(Line::to_string)).collect()
}

/// The difference in a line. If the inputs differ, so must the rest.
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
