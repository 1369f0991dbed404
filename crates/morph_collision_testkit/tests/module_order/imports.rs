//! Which module of a crate uses which other one.

use std::collections::BTreeSet;

use proc_macro2::{TokenStream, TokenTree};
use syn::visit::Visit;
use syn::{Attribute, Item, ItemUse, Macro, Path, Visibility};

use crate::modules::{ModulePath, Modules, is_for_tests, leaves};

/// A use of something that another module defines.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Import {
    pub(crate) user: ModulePath,
    pub(crate) used: ModulePath,
    /// As it is written.
    pub(crate) path: String,
}

/// All uses between modules of a crate, without those in tests and documentation. A re-export is a use only if its module needs the
/// name itself.
pub(crate) fn all(modules: &Modules) -> Vec<Import> {
    let mut imports = BTreeSet::new();
    for (user, module) in &modules.all {
        let mut written = Written::default();
        let is_code = |item: &&Item| !matches!(item, Item::Use(_));
        module
            .items
            .iter()
            .filter(is_code)
            .for_each(|item| written.visit_item(item));
        let uses = module.items.iter().filter_map(|item| match item {
            Item::Use(item) if !is_for_tests(&item.attrs) => Some(item),
            _ => None,
        });
        for item in uses {
            let is_private = matches!(item.vis, Visibility::Inherited);
            for (path, name) in leaves(&item.tree) {
                let is_needed = name.is_none_or(|name| written.names.contains(&name));
                // An unused private import does not compile without a warning, so each of them counts.
                if is_private || is_needed {
                    written.paths.insert(path);
                }
            }
        }
        for path in &written.paths {
            let used = modules.definition(user, path);
            // The root only names the modules.
            if let Some(used) = used.filter(|used| used != user && !user.is_empty() && !used.is_empty()) {
                let path = path.join("::");
                imports.insert(Import {
                    user: user.clone(),
                    used,
                    path,
                });
            }
        }
    }
    imports.into_iter().collect()
}

/// What stands in the code of a module.
#[derive(Default)]
struct Written {
    names: BTreeSet<String>,
    paths: BTreeSet<Vec<String>>,
}

impl<'a> Visit<'a> for Written {
    fn visit_ident(&mut self, name: &'a proc_macro2::Ident) {
        self.names.insert(name.to_string());
    }

    fn visit_path(&mut self, path: &'a Path) {
        let segments: Vec<String> = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        if segments.len() > 1 {
            self.paths.insert(segments);
        }
        syn::visit::visit_path(self, path);
    }

    fn visit_item(&mut self, item: &'a Item) {
        let attrs: &[Attribute] = match item {
            Item::Fn(item) => &item.attrs,
            Item::Impl(item) => &item.attrs,
            Item::Struct(item) => &item.attrs,
            Item::Const(item) => &item.attrs,
            _ => &[],
        };
        if !is_for_tests(attrs) {
            syn::visit::visit_item(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'a ItemUse) {
        // Within a function.
        self.paths.extend(leaves(&item.tree).into_iter().map(|(path, _)| path));
    }

    fn visit_macro(&mut self, macro_: &'a Macro) {
        self.visit_tokens(macro_.tokens.clone());
        syn::visit::visit_macro(self, macro_);
    }
}

impl Written {
    /// The tokens of a macro's call, in which paths are not parsed.
    fn visit_tokens(&mut self, tokens: TokenStream) {
        let mut path: Vec<String> = Vec::new();
        let mut colons = 0;
        for token in tokens {
            match token {
                TokenTree::Ident(name) => {
                    self.names.insert(name.to_string());
                    if colons != 2 {
                        self.end_of_path(&mut path);
                    }
                    path.push(name.to_string());
                    colons = 0;
                }
                TokenTree::Punct(punct) if punct.as_char() == ':' => colons += 1,
                TokenTree::Group(group) => {
                    self.end_of_path(&mut path);
                    self.visit_tokens(group.stream());
                    colons = 0;
                }
                _ => {
                    self.end_of_path(&mut path);
                    colons = 0;
                }
            }
        }
        self.end_of_path(&mut path);
    }

    fn end_of_path(&mut self, path: &mut Vec<String>) {
        let path = std::mem::take(path);
        if path.len() > 1 {
            self.paths.insert(path);
        }
    }
}
