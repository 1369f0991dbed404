//! The modules of a crate, and what they re-export.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use syn::{Attribute, Item, UseTree};

/// Where a module is in its crate, from the root; empty for the root.
pub(crate) type ModulePath = Vec<String>;

/// A module with a file of its own, or a module within another one's file.
pub(crate) struct Module {
    pub(crate) file: PathBuf,
    pub(crate) items: Vec<Item>,
    /// Names that a `use` brings into the module, with the paths that they stand for.
    names: BTreeMap<String, Vec<String>>,
    /// Modules all of whose names are brought into this one.
    globs: Vec<Vec<String>>,
    docs: String,
}

/// The modules of a crate, without those for tests.
pub(crate) struct Modules {
    folder: PathBuf,
    pub(crate) all: BTreeMap<ModulePath, Module>,
}

impl Modules {
    /// Reads a crate from its `lib.rs`.
    pub(crate) fn read(lib: &Path) -> Self {
        let folder = lib.parent().unwrap().to_owned();
        let mut modules = Self {
            folder: folder.clone(),
            all: BTreeMap::new(),
        };
        modules.read_file(lib, &folder, Vec::new());
        modules
    }

    /// The documentation of the crate.
    pub(crate) fn root_docs(&self) -> &str {
        &self.all[&Vec::new()].docs
    }

    /// A file's name within the crate's source.
    pub(crate) fn file(&self, module: &ModulePath) -> String {
        let file = &self.all[module].file;
        file.strip_prefix(&self.folder).unwrap().display().to_string()
    }

    /// The modules directly below the root.
    pub(crate) fn top(&self) -> impl Iterator<Item = &str> {
        self.all
            .keys()
            .filter(|path| path.len() == 1)
            .map(|path| path[0].as_str())
    }

    /// The module that defines what a path names, through re-exports; `None` if it is not in this crate.
    pub(crate) fn definition(&self, from: &ModulePath, path: &[String]) -> Option<ModulePath> {
        self.resolve(from, path, &mut BTreeSet::new())
    }

    fn resolve(
        &self,
        from: &ModulePath,
        path: &[String],
        seen: &mut BTreeSet<(ModulePath, Vec<String>)>,
    ) -> Option<ModulePath> {
        // Re-exports in a circle.
        if seen.len() > 50 || !seen.insert((from.clone(), path.to_vec())) {
            return None;
        }
        let mut at = from.clone();
        let mut rest = path;
        match path.first()?.as_str() {
            "crate" => (at, rest) = (Vec::new(), &path[1..]),
            "self" => rest = &path[1..],
            "super" => {
                while rest.first().is_some_and(|first| first == "super") {
                    at.pop()?;
                    rest = &rest[1..];
                }
            }
            _ => {}
        }
        let is_explicit = rest.len() < path.len();
        while let Some(name) = rest.first() {
            let child: ModulePath = at.iter().chain([name]).cloned().collect();
            if self.all.contains_key(&child) {
                (at, rest) = (child, &rest[1..]);
                continue;
            }
            let module = self.all.get(&at)?;
            if let Some(stands_for) = module.names.get(name) {
                let whole: Vec<String> = stands_for.iter().chain(&rest[1..]).cloned().collect();
                return self.resolve(&at, &whole, seen);
            }
            for glob in &module.globs {
                let whole: Vec<String> = glob.iter().chain(rest).cloned().collect();
                if let Some(found) = self.resolve(&at, &whole, seen) {
                    return Some(found);
                }
            }
            // It is defined here, if the path leads here at all.
            let is_here = is_explicit || at != *from;
            let defines = module
                .items
                .iter()
                .any(|item| defined(item).is_some_and(|is| is == *name));
            return (is_here && (defines || !module.items.is_empty()) || defines).then_some(at);
        }
        Some(at)
    }

    fn read_file(&mut self, file: &Path, folder: &Path, path: ModulePath) {
        let text = std::fs::read_to_string(file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        let parsed = syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
        self.add(file, folder, path, &parsed.attrs, parsed.items);
    }

    fn add(&mut self, file: &Path, folder: &Path, path: ModulePath, attrs: &[Attribute], items: Vec<Item>) {
        let mut kept = Vec::new();
        let (mut names, mut globs) = (BTreeMap::new(), Vec::new());
        for item in items {
            if let Item::Mod(module) = item {
                if is_for_tests(&module.attrs) {
                    continue;
                }
                let name = module.ident.to_string();
                let below: ModulePath = path.iter().cloned().chain([name.clone()]).collect();
                let own = folder.join(&name);
                if let Some((_, items)) = module.content {
                    self.add(file, &own, below, &module.attrs, items);
                } else {
                    let flat = folder.join(format!("{name}.rs"));
                    let file = if flat.is_file() { flat } else { own.join("mod.rs") };
                    self.read_file(&file, &own, below);
                }
                continue;
            }
            if let Item::Use(item) = &item {
                for (used, name) in leaves(&item.tree) {
                    match name {
                        Some(name) => _ = names.insert(name, used),
                        None => globs.push(used),
                    }
                }
            }
            kept.push(item);
        }
        let docs = docs(attrs);
        self.all.insert(
            path,
            Module {
                file: file.to_owned(),
                items: kept,
                names,
                globs,
                docs,
            },
        );
    }
}

/// The paths of a `use`, each with the name that it brings; `None` for a glob.
pub(crate) fn leaves(tree: &UseTree) -> Vec<(Vec<String>, Option<String>)> {
    match tree {
        UseTree::Path(path) => {
            let first = path.ident.to_string();
            let below = leaves(&path.tree).into_iter();
            below
                .map(|(rest, name)| {
                    (
                        [first.clone()].into_iter().chain(rest).collect(),
                        name.map(|name| if name == "self" { first.clone() } else { name }),
                    )
                })
                .collect()
        }
        UseTree::Name(name) if name.ident == "self" => vec![(Vec::new(), Some("self".into()))],
        UseTree::Name(name) => vec![(vec![name.ident.to_string()], Some(name.ident.to_string()))],
        UseTree::Rename(rename) => vec![(vec![rename.ident.to_string()], Some(rename.rename.to_string()))],
        UseTree::Glob(_) => vec![(Vec::new(), None)],
        UseTree::Group(group) => group.items.iter().flat_map(leaves).collect(),
    }
}

/// The name that an item defines.
fn defined(item: &Item) -> Option<String> {
    Some(match item {
        Item::Const(item) => item.ident.to_string(),
        Item::Enum(item) => item.ident.to_string(),
        Item::Fn(item) => item.sig.ident.to_string(),
        Item::Static(item) => item.ident.to_string(),
        Item::Struct(item) => item.ident.to_string(),
        Item::Trait(item) => item.ident.to_string(),
        Item::Type(item) => item.ident.to_string(),
        Item::Macro(item) => item.ident.as_ref()?.to_string(),
        _ => return None,
    })
}

pub(crate) fn is_for_tests(attrs: &[Attribute]) -> bool {
    attrs.iter().any(|attr| {
        let syn::Meta::List(list) = &attr.meta else {
            return false;
        };
        let condition = list.tokens.to_string();
        list.path.is_ident("cfg")
            && (condition == "test" || condition.starts_with("all (test") || condition == "doctest")
    })
}

fn docs(attrs: &[Attribute]) -> String {
    let lines = attrs.iter().filter_map(|attr| {
        let syn::Meta::NameValue(pair) = &attr.meta else {
            return None;
        };
        let syn::Expr::Lit(syn::ExprLit {
            lit: syn::Lit::Str(text),
            ..
        }) = &pair.value
        else {
            return None;
        };
        pair.path.is_ident("doc").then(|| text.value() + "\n")
    });
    lines.collect()
}
