//! The order of a crate's modules, and circles among them.

use std::collections::{BTreeMap, BTreeSet};

use crate::imports::Import;
use crate::modules::{ModulePath, Modules};

/// The modules of a crate, from those that use others to those that others use.
pub(crate) struct Order(BTreeMap<String, usize>);

impl Order {
    /// Reads the order from a crate's documentation.
    pub(crate) fn of(docs: &str) -> Result<Self, String> {
        let section = docs.split("# Order of the folders").nth(1);
        let section = section.ok_or("its lib.rs has no section `# Order of the folders`")?;
        let block = section.split("```").nth(1).and_then(|block| block.strip_prefix("text"));
        let block = block.ok_or("the section `# Order of the folders` has no block ```text")?;
        let mut ranks = BTreeMap::new();
        for (rank, group) in block.split('>').enumerate() {
            for name in group.split([',', ' ', '\n']).filter(|name| !name.is_empty()) {
                if ranks.insert(name.to_owned(), rank).is_some() {
                    return Err(format!("`{name}` is twice in the order of the folders"));
                }
            }
        }
        Ok(Self(ranks))
    }

    /// What is against the order: modules that it lacks or that do not exist, and imports.
    pub(crate) fn check(&self, of: &str, modules: &Modules, imports: &[Import]) -> Vec<String> {
        let mut wrong = Vec::new();
        // A prelude only names what others define.
        let top: BTreeSet<&str> = modules.top().filter(|name| *name != "prelude").collect();
        let missing = top.iter().filter(|name| !self.0.contains_key(**name));
        wrong.extend(missing.map(|name| format!("{of}: `{name}` is not in the order")));
        let unknown = self.0.keys().filter(|name| !top.contains(name.as_str()));
        wrong.extend(unknown.map(|name| format!("{of}: there is no module `{name}`")));
        for Import { user, used, path } in imports {
            let (Some(from), Some(to)) = (self.0.get(&user[0]), self.0.get(&used[0])) else {
                continue;
            };
            if user[0] != used[0] && from >= to {
                let file = modules.file(user);
                wrong.push(format!("{of}: {file} uses `{path}` of {}", modules.file(used)));
            }
        }
        wrong
    }
}

/// Circles among the folders directly below each folder of a crate.
pub(crate) fn circles_of_folders(of: &str, modules: &Modules, imports: &[Import]) -> Vec<String> {
    let is_folder = |path: &ModulePath| {
        modules
            .all
            .keys()
            .any(|other| other.len() > path.len() && other.starts_with(path))
    };
    let mut graphs: BTreeMap<ModulePath, Graph> = BTreeMap::new();
    for Import { user, used, .. } in imports {
        let common = user.iter().zip(used).take_while(|(a, b)| a == b).count();
        if common == user.len() || common == used.len() {
            continue;
        }
        let (a, b) = (user[..=common].to_vec(), used[..=common].to_vec());
        if is_folder(&a) && is_folder(&b) {
            graphs
                .entry(user[..common].to_vec())
                .or_default()
                .entry(a)
                .or_default()
                .insert(b);
        }
    }
    let circles = graphs.values().flat_map(circles);
    circles
        .map(|circle| {
            format!(
                "{of}: {}",
                circle
                    .iter()
                    .map(|path| path.join("/") + "/")
                    .collect::<Vec<_>>()
                    .join(", ")
            )
        })
        .collect()
}

/// Circles among the files of a crate.
pub(crate) fn circles_of_files(of: &str, modules: &Modules, imports: &[Import]) -> Vec<String> {
    let mut graph: Graph = BTreeMap::new();
    for Import { user, used, .. } in imports {
        let (a, b) = (modules.file(user), modules.file(used));
        if a != b {
            graph.entry(vec![a]).or_default().insert(vec![b]);
        }
    }
    let circles = circles(&graph);
    circles
        .into_iter()
        .map(|circle| format!("{of}: a circle of {}", circle.concat().join(", ")))
        .collect()
}

type Graph = BTreeMap<Vec<String>, BTreeSet<Vec<String>>>;

/// The sets of nodes each of which reaches all others of its set.
fn circles(graph: &Graph) -> Vec<Vec<Vec<String>>> {
    let reach: BTreeMap<&Vec<String>, BTreeSet<&Vec<String>>> =
        graph.keys().map(|node| (node, reachable(graph, node))).collect();
    let mut circles = BTreeSet::new();
    for (node, reached) in &reach {
        if reached.contains(node) {
            let same = reached
                .iter()
                .filter(|other| reach.get(**other).is_some_and(|back| back.contains(node)));
            circles.insert(same.map(|other| (*other).clone()).collect::<Vec<_>>());
        }
    }
    circles.into_iter().collect()
}

fn reachable<'g>(graph: &'g Graph, from: &Vec<String>) -> BTreeSet<&'g Vec<String>> {
    let mut reached = BTreeSet::new();
    let mut open: Vec<&Vec<String>> = graph.get(from).into_iter().flatten().collect();
    while let Some(node) = open.pop() {
        if reached.insert(node) {
            open.extend(graph.get(node).into_iter().flatten());
        }
    }
    reached
}
