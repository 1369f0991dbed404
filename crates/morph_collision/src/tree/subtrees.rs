use super::{Child, ChildKind, MorphBvh};

impl MorphBvh {
    /// Cuts the mesh into parts: the largest subtrees of at most `max_triangles` triangles each, every triangle in one of them.
    ///
    /// A leaf is not cut: where leaves are larger than `max_triangles`, so are parts. Triangles of a part are near each
    /// other on the shapes that the tree was built for. The parts come in an order in which neighbours are near, too.
    ///
    /// Cost: linear in the number of parts times the depth of the tree.
    #[must_use]
    pub fn subtrees(&self, max_triangles: usize) -> Vec<&[u32]> {
        let topology = self.topology();
        let mut parts = Vec::new();
        let mut open: Vec<Child> = topology.group(0).children().to_vec();
        while let Some(node) = open.pop() {
            let range = topology.range_below(node);
            match node.kind() {
                ChildKind::Group(group) if range.len() > max_triangles => {
                    open.extend(topology.group(group).children().iter().rev());
                }
                _ => parts.push(topology.triangles_at(range)),
            }
        }
        parts
    }
}
