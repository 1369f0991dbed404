//! Tries every feature with every kind of collider, which makes the tables of docs/combinations.md.
//!
//! - `kinds`: a collider of each kind, which stretches upward.
//! - `alone`: what works without physics.
//! - `engines`: what works with Rapier and Avian.

mod alone;
mod engines;
mod kinds;

use std::path::Path;

use kinds::Kind;

/// A feature, and whether it works for a kind of collider.
struct Feature {
    /// Markdown.
    name: &'static str,
    works: fn(Kind) -> bool,
}

/// Compares a table of the document with what works now. With the variable `MORPH_COLLISION_STORE_TABLES`, it is written instead.
fn check(title: &str, features: &[Feature]) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/combinations.md");
    let heads: Vec<_> = Kind::ALL.iter().map(|kind| kind.name()).collect();
    let mut table = format!(
        "| {title} | {} |\n|---|{}\n",
        heads.join(" | "),
        ":-:|".repeat(heads.len())
    );
    for Feature { name, works } in features {
        let cells = Kind::ALL.map(|kind| if works(kind) { "yes" } else { "–" });
        table += &format!("| {name} | {} |\n", cells.join(" | "));
    }
    let text = std::fs::read_to_string(&path).expect("the document is there");
    let start = text.find(&format!("| {title} |")).expect("the document has this table");
    let end = text[start..]
        .find("\n\n")
        .map_or(text.len(), |length| start + length + 1);
    if std::env::var_os("MORPH_COLLISION_STORE_TABLES").is_some() {
        let new = [&text[..start], &table, &text[end..]].concat();
        std::fs::write(path, new).expect("the document can be written");
    } else {
        assert_eq!(
            text[start..end],
            table,
            "`just combinations` writes docs/combinations.md again"
        );
    }
}

// One test, because each table is a part of the same file.
#[test]
fn the_document_says_what_works() {
    check("Without physics", &alone::FEATURES);
    check("With Rapier", &engines::features::<engines::Rapier>());
    check("With Avian", &engines::features::<engines::Avian>());
}
