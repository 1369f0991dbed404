//! The node trees of a file.

use super::GltfFile;

impl GltfFile {
    /// The topmost nodes above what places a mesh that a node shows: above the joints of its skin, or else above the node. Ascending.
    ///
    /// Meshes with a common one belong to the same skeleton or node tree. Broken nodes and joints are skipped.
    #[must_use]
    pub fn roots_of(&self, mesh: usize, node: usize) -> Vec<usize> {
        let skin = self
            .root
            .meshes
            .get(mesh, &self.budget)
            .ok()
            .and_then(|json| self.skin_of(mesh, json, Some(node)));
        let skin = skin.and_then(|skin| self.root.skins.get(skin, &self.budget).ok());
        let mut roots: Vec<usize> = match skin {
            Some(skin) => skin.joints.iter().filter_map(|&joint| self.root_above(joint)).collect(),
            None => self.root_above(node).into_iter().collect(),
        };
        roots.sort_unstable();
        roots.dedup();
        roots
    }

    /// The topmost node above a node. In a cycle, any node of it.
    fn root_above(&self, node: usize) -> Option<usize> {
        let parents = self.parents().ok()?;
        let mut at = node;
        for _ in 0..parents.len() {
            match parents.get(at)? {
                Some(parent) => at = *parent,
                None => return Some(at),
            }
        }
        Some(at)
    }
}
