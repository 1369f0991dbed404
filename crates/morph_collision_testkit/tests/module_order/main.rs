//! Each crate's folders import each other only in the order that its `lib.rs` states.
//!
//! The section "Order of the folders" of a crate's documentation lists its modules: a module uses only those to its right, and modules
//! joined by a comma do not use each other.

mod imports;
mod modules;
mod order;

use std::path::{Path, PathBuf};

use imports::Import;
use modules::Modules;
use order::Order;

/// Crates in which not even files import each other in a circle.
const FILES_IN_ORDER: [&str; 5] = [
    "bevy_morph_avian",
    "bevy_morph_collision",
    "bevy_morph_physics",
    "bevy_morph_rapier",
    "morph_collision",
];

fn crates() -> Vec<PathBuf> {
    let all = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap();
    let mut crates: Vec<PathBuf> = std::fs::read_dir(all)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .collect();
    crates.retain(|path| path.join("src/lib.rs").is_file());
    crates.sort();
    crates
}

fn name(folder: &Path) -> &str {
    folder.file_name().unwrap().to_str().unwrap()
}

#[test]
fn crates_import_in_the_order_that_they_state_and_in_no_circle() {
    let crates = crates();
    assert!(crates.len() >= 8, "{crates:?}");
    let mut wrong = Vec::new();
    for folder in crates {
        let modules = Modules::read(&folder.join("src/lib.rs"));
        let order = Order::of(modules.root_docs()).unwrap_or_else(|what| panic!("{}: {what}", name(&folder)));
        let imports = imports::all(&modules);
        assert!(!imports.is_empty());
        wrong.extend(order.check(name(&folder), &modules, &imports));
        wrong.extend(order::circles_of_folders(name(&folder), &modules, &imports));
        if FILES_IN_ORDER.contains(&name(&folder)) {
            wrong.extend(order::circles_of_files(name(&folder), &modules, &imports));
        }
    }
    assert!(
        wrong.is_empty(),
        "{} imports are wrong:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}

/// A crate in a temporary folder, from pairs of a file's name and text.
fn imports_of(files: &[(&str, &str)]) -> (Modules, Vec<Import>) {
    let folder = tempfile::tempdir().unwrap();
    for (file, text) in files {
        let path = folder.path().join(file);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    let modules = Modules::read(&folder.path().join("lib.rs"));
    let imports = imports::all(&modules);
    (modules, imports)
}

#[test]
fn an_import_against_the_order_is_found_however_it_is_written() {
    let lib = "//! # Order of the folders\n//!\n//! ```text\n//! high > low\n//! ```\nmod high;\nmod low;";
    let high = "mod thing;\npub use thing::Thing;";
    for low in [
        "use crate::high::Thing;",
        "use super::high::Thing as Other;",
        "use crate::{high::{self}};",
        "fn f() -> crate::high::Thing { todo!() }",
        "fn f() { println!(\"{}\", crate::high::Thing::NUMBER); }",
        "pub(crate) use crate::high::Thing;\nfn f(_: Thing) {}",
    ] {
        let files = [
            ("lib.rs", lib),
            ("low.rs", low),
            ("high/mod.rs", high),
            ("high/thing.rs", "pub struct Thing;"),
        ];
        let (modules, imports) = imports_of(&files);
        let wrong = Order::of(modules.root_docs())
            .unwrap()
            .check("test", &modules, &imports);
        assert_eq!(wrong.len(), 1, "{low}: {wrong:?}");
    }
    let files = [
        ("lib.rs", lib),
        (
            "low.rs",
            "pub struct Low;\n#[cfg(test)]\nmod tests { use crate::high::Thing; }",
        ),
        ("high/mod.rs", "mod thing;\npub use thing::Thing;\nuse crate::low::Low;"),
        ("high/thing.rs", "use crate::low::Low;\npub struct Thing(Low);"),
    ];
    let (modules, imports) = imports_of(&files);
    let wrong = Order::of(modules.root_docs())
        .unwrap()
        .check("test", &modules, &imports);
    assert!(wrong.is_empty() && imports.len() == 2, "{wrong:?} {imports:?}");
}

#[test]
fn circles_are_found_through_reexports() {
    let files = [
        ("lib.rs", "mod a;\nmod b;"),
        ("a/mod.rs", "mod one;\nmod two;\npub use one::One;\npub use two::Two;"),
        ("a/one.rs", "use super::two::Two;\npub struct One(Two);"),
        ("a/two.rs", "use crate::b::B;\npub struct Two(B);"),
        ("b/mod.rs", "mod inner;\npub use inner::B;"),
        ("b/inner.rs", "use crate::a::One;\npub struct B(Option<Box<One>>);"),
    ];
    let (modules, imports) = imports_of(&files);
    let folders = order::circles_of_folders("test", &modules, &imports);
    assert_eq!(folders.len(), 1, "{folders:?}");
    let files = order::circles_of_files("test", &modules, &imports);
    assert_eq!(files.len(), 1, "{files:?}");
    assert!(
        files[0].contains("a/one.rs") && files[0].contains("b/inner.rs"),
        "{files:?}"
    );
}
