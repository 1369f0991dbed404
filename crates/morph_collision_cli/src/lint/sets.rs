//! Disjoint sets, for connected regions.

use std::collections::HashMap;

/// Disjoint sets of vertices.
#[derive(Debug, Default)]
pub(super) struct Sets {
    parent: HashMap<u32, u32>,
}

impl Sets {
    /// The vertex that stands for the set of a vertex.
    pub(super) fn root(&mut self, vertex: u32) -> u32 {
        let mut root = vertex;
        while let Some(&parent) = self.parent.get(&root)
            && parent != root
        {
            root = parent;
        }
        // Everything on the way points to the root from now on.
        let mut at = vertex;
        while at != root {
            at = self.parent.insert(at, root).unwrap_or(root);
        }
        root
    }

    pub(super) fn unite(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent.insert(a.max(b), a.min(b));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_are_the_same_whatever_the_order() {
        let links = [[1, 2], [3, 4], [2, 4], [7, 8]];
        for rotation in 0..links.len() {
            let mut sets = Sets::default();
            for i in 0..links.len() {
                let [a, b] = links[(i + rotation) % links.len()];
                sets.unite(a, b);
            }
            let roots = [1, 2, 3, 4, 7, 8, 9].map(|vertex| sets.root(vertex));
            assert_eq!(roots, [1, 1, 1, 1, 7, 7, 9]);
        }
    }
}
