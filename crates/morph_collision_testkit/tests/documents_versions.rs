//! All versions that the documents name are those of the manifest and of the changelog.

use std::collections::BTreeMap;
use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};

type Outcome = Result<(), Box<dyn Error>>;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn read(path: &str) -> Result<String, Box<dyn Error>> {
    fs::read_to_string(root().join(path)).map_err(|error| format!("{path}: {error}").into())
}

/// The text between the first quotation marks after a word.
fn quoted_after<'a>(text: &'a str, word: &str) -> Option<&'a str> {
    text.split_once(word)?.1.split('"').nth(1)
}

/// The versions in the workspace's manifest, by name: of this repository's crates, of what they depend on, and of Rust.
fn manifest() -> Result<BTreeMap<String, String>, Box<dyn Error>> {
    let text = read("Cargo.toml")?;
    let package = text.split_once("[workspace.package]").ok_or("no workspace")?.1;
    let mut versions = BTreeMap::new();
    let rust = quoted_after(package, "rust-version").ok_or("no Rust version")?;
    versions.insert("Rust".into(), rust.into());
    let own = quoted_after(package, "version").ok_or("no version")?;
    versions.insert("workspace".into(), own.into());
    let dependencies = package
        .split_once("[workspace.dependencies]")
        .ok_or("no dependencies")?
        .1;
    for line in dependencies.lines().take_while(|line| !line.starts_with('[')) {
        let Some((name, value)) = line.split_once(" = ") else {
            continue;
        };
        let version = match value.starts_with('"') {
            true => value.split('"').nth(1),
            false => quoted_after(value, "version"),
        };
        versions.extend(version.map(|version| (name.to_owned(), version.to_owned())));
    }
    Ok(versions)
}

/// Whether a document may write `short` for the version `full`: all of it, or without its last numbers.
fn is_short_for(short: &str, full: &str) -> bool {
    full == short || full.strip_prefix(short).is_some_and(|rest| rest.starts_with('.'))
}

/// The names and versions in a document's tables whose header is a list of crates.
fn tables(text: &str, known: &BTreeMap<String, String>) -> Vec<(String, String)> {
    let cells = |line: &str| -> Vec<String> {
        let line = line.trim().trim_matches('|');
        line.split('|').map(|cell| cell.trim().to_owned()).collect()
    };
    let lines: Vec<&str> = text.lines().collect();
    let mut found = Vec::new();
    for rows in lines.windows(3) {
        let names = cells(rows[0]);
        if rows[0].starts_with('|') && rows[1].starts_with("|---") && names.iter().all(|name| known.contains_key(name))
        {
            found.extend(names.into_iter().zip(cells(rows[2])));
        }
    }
    found
}

#[test]
fn the_changelog_and_all_manifests_name_one_version() -> Outcome {
    let versions = manifest()?;
    let own = &versions["workspace"];
    for name in [
        "morph_collision",
        "bevy_morph_collision",
        "morph_collision_models",
        "bevy_morph_physics",
        "bevy_morph_rapier",
        "bevy_morph_avian",
        "morph_collision_cli",
    ] {
        assert_eq!(&versions[name], own, "{name} under workspace.dependencies");
        let manifest = read(&format!("crates/{name}/Cargo.toml"))?;
        assert!(
            manifest.contains("\nversion.workspace = true\n"),
            "crates/{name}/Cargo.toml"
        );
    }
    let changelog = read("CHANGELOG.md")?;
    let headings = changelog
        .lines()
        .filter_map(|line| line.strip_prefix("## [")?.split_once(']'));
    let newest = headings
        .map(|(version, _)| version)
        .find(|version| *version != "Unreleased");
    assert_eq!(newest, Some(own.as_str()), "the newest version in CHANGELOG.md");
    for path in ["Cargo.lock", "fuzz/Cargo.lock"] {
        let lock = read(path)?;
        let mut packages = lock.split("[[package]]");
        let locked = packages.find(|package| package.contains("\nname = \"morph_collision\"\n"));
        let version = locked.and_then(|package| quoted_after(package, "version = "));
        assert_eq!(version, Some(own.as_str()), "{path}");
    }
    Ok(())
}

#[test]
fn the_tables_of_versions_are_true() -> Outcome {
    let versions = manifest()?;
    let readmes = [
        "README.md",
        "crates/morph_collision/README.md",
        "crates/bevy_morph_collision/README.md",
        "crates/morph_collision_models/README.md",
        "crates/bevy_morph_physics/README.md",
        "crates/bevy_morph_rapier/README.md",
        "crates/bevy_morph_avian/README.md",
        "crates/morph_collision_cli/README.md",
    ];
    for path in readmes {
        let table = tables(&read(path)?, &versions);
        assert!(table.len() >= 3, "{path} has a table of versions: {table:?}");
        for (name, version) in table {
            let full = &versions[&name];
            assert!(
                is_short_for(&version, full),
                "{path} says {name} {version}, but it is {full}"
            );
        }
    }
    Ok(())
}

#[test]
fn versions_to_type_are_true() -> Outcome {
    let versions = manifest()?;
    let own = &versions["workspace"];
    let mut typed = 0;
    let readmes = [
        "README.md",
        "crates/bevy_morph_collision/README.md",
        "crates/bevy_morph_rapier/README.md",
        "crates/bevy_morph_avian/README.md",
    ];
    for path in readmes {
        let text = read(path)?;
        for word in text
            .lines()
            .filter(|line| line.starts_with("cargo add "))
            .flat_map(str::split_whitespace)
        {
            let Some((name, version)) = word.split_once('@') else {
                continue;
            };
            let full = versions.get(name).ok_or_else(|| format!("{path}: who is {name}?"))?;
            assert!(is_short_for(version, full), "{path}: {word}, but {name} is {full}");
            typed += 1;
        }
    }
    assert!(typed >= 6, "{typed} versions in commands");
    let mut programs = 0;
    for crate_name in ["bevy_morph_rapier", "bevy_morph_avian"] {
        for entry in fs::read_dir(root().join(format!("crates/{crate_name}/examples")))? {
            let path = entry?.path();
            let text = fs::read_to_string(&path)?;
            let Some(version) = quoted_after(&text, &format!("{crate_name} = ")) else {
                continue;
            };
            assert!(
                is_short_for(version, own),
                "{}: {version}, but it is {own}",
                path.display()
            );
            programs += 1;
        }
    }
    assert!(programs >= 2, "{programs} programs name the version");
    let models = read("crates/morph_collision_models/README.md")?;
    assert!(
        models.contains(&format!("(`={own}`)")),
        "the README of the models names their exact version"
    );
    Ok(())
}

#[test]
fn a_short_version_is_the_beginning_of_a_whole_one() {
    assert!(is_short_for("0.20", "0.20.1") && is_short_for("0.2.0", "0.2.0"));
    assert!(!is_short_for("0.2", "0.20.1") && !is_short_for("0.1", "0.2.0") && !is_short_for("0.20.1", "0.20"));
}
