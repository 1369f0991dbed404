//! What was left out of a mesh.

use std::fmt::{self, Display, Formatter};

/// How much was left out of a mesh that was read with [`ReadOptions::skip_bad`](super::ReadOptions::skip_bad).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Skipped {
    /// Triangles with a corner that is not a vertex, and lists of corners that end in the middle of a triangle.
    pub triangles: usize,
    /// Targets that do not move the vertices of a primitive because the primitive has fewer targets than others of the mesh, or a
    /// target of another length than its vertices; counted once per primitive.
    pub targets: usize,
}

impl Skipped {
    /// Whether the mesh is complete.
    #[must_use]
    pub fn is_nothing(&self) -> bool {
        *self == Self::default()
    }
}

/// The counts in words, such as "2 triangles and 1 target of a primitive".
impl Display for Skipped {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let counted = |count: usize, one: &str, many: &str| match count {
            0 => None,
            1 => Some(format!("1 {one}")),
            _ => Some(format!("{count} {many}")),
        };
        let parts = [
            counted(self.triangles, "triangle", "triangles"),
            counted(self.targets, "target of a primitive", "targets of primitives"),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        match &parts[..] {
            [] => f.write_str("nothing"),
            [one] => f.write_str(one),
            [rest @ .., last] => write!(f, "{} and {last}", rest.join(", ")),
        }
    }
}
