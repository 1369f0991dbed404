use morph_collision::Aabb;

/// A node of a rival's tree in a pose, for measuring its tightness.
#[derive(Clone, Copy, Debug)]
pub struct RivalNode<'a> {
    /// Its box: in model space, or in world space for a skinned mesh.
    pub bounds: Aabb,
    /// The triangles below it.
    pub triangles: &'a [u32],
    /// Number of child nodes; 0 for a leaf.
    pub children: usize,
}
