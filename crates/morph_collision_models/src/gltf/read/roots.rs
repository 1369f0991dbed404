//! The node trees of a file.

use std::collections::HashMap;

use super::GltfFile;

/// Which node trees of a file belong together: those that a skin has joints in. Takes about 24 bytes per node of the file.
#[derive(Debug)]
pub struct Trees<'f> {
    file: &'f GltfFile,
    /// For each node, the topmost one above it. In a cycle, one of its nodes.
    roots: Vec<usize>,
    /// For each root, one that it was joined with, and that is closer to the one that stands for all of them.
    joined: Vec<usize>,
    /// For each skin whose trees are joined, the root above its first joint.
    skins: HashMap<usize, Option<usize>>,
}

impl GltfFile {
    /// The node trees of the file, none of them joined yet. Cost: one step per node. If they cannot be told, no node has a tree.
    #[must_use]
    pub fn trees(&self) -> Trees<'_> {
        let parents = self.parents().unwrap_or_default();
        let mut known: Vec<Option<usize>> = vec![None; parents.len()];
        let mut path = Vec::new();
        for start in 0..parents.len() {
            let mut at = start;
            let root = loop {
                if let Some(root) = known[at] {
                    break root;
                }
                // Until the root is found; in a cycle, that is the first node that is met again.
                known[at] = Some(at);
                path.push(at);
                match parents[at] {
                    Some(parent) if parent < parents.len() => at = parent,
                    _ => break at,
                }
            };
            for node in path.drain(..) {
                known[node] = Some(root);
            }
        }
        Trees {
            file: self,
            roots: known.into_iter().flatten().collect(),
            joined: (0..parents.len()).collect(),
            skins: HashMap::new(),
        }
    }
}

impl Trees<'_> {
    /// Joins the trees of what places a mesh that a node shows: of the joints of its skin, or else of the node. Returns the root of one of them.
    /// Broken nodes and joints are skipped. Cost: one step per joint, once for each skin.
    pub fn join(&mut self, mesh: usize, node: usize) -> Option<usize> {
        let (root, budget) = (&self.file.root, &self.file.budget);
        let json = root.meshes.get(mesh, budget).ok();
        let index = json.and_then(|json| self.file.skin_of(mesh, json, Some(node)));
        let skin = index.and_then(|index| Some((index, root.skins.get(index, budget).ok()?)));
        let Some((index, skin)) = skin else {
            return self.roots.get(node).copied();
        };
        if let Some(known) = self.skins.get(&index) {
            return *known;
        }
        let mut first = None;
        for joint in &skin.joints {
            let Some(&root) = self.roots.get(*joint) else {
                continue;
            };
            let with = *first.get_or_insert(root);
            let (one, other) = (self.of_root(with), self.of_root(root));
            self.joined[one.max(other)] = one.min(other);
        }
        self.skins.insert(index, first);
        first
    }

    /// The root that stands for all that a root was joined with so far: the first of them in the file.
    pub fn of_root(&mut self, root: usize) -> usize {
        let mut at = root;
        while let Some(&next) = self.joined.get(at).filter(|next| **next != at) {
            // Shortens the way for the next time.
            self.joined[at] = self.joined[next];
            at = next;
        }
        at
    }
}
