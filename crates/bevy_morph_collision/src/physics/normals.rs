//! The normals that contacts with a triangle may have.

use parry3d::math::{Real, Vector};
use parry3d::query::details::NormalConstraints;
use parry3d::shape::TrianglePseudoNormals;

/// The normals that contacts with a triangle may have: those between its own normal and its neighbours', on either side. Without
/// this limit, bodies that slide over a surface are caught by interior edges.
///
/// They are computed when a contact needs them: most triangles near a body do not touch it.
#[derive(Clone, Copy)]
pub(crate) struct NormalLimits {
    pub(super) corners: [Vector; 3],
    /// The third corners of the neighbours, across the edges from a corner to the next.
    pub(super) across: [Option<Vector>; 3],
    /// For the surface of a solid body: whether the normal, by the triangles' winding, points outward (1) or inward (-1).
    /// Contacts then ignore what is inside.
    pub(super) outward: Option<Real>,
}

impl NormalLimits {
    /// `None` for a triangle without area.
    fn pseudo_normals(&self) -> Option<TrianglePseudoNormals> {
        let [a, b, c] = self.corners;
        let face = (b - a).cross(c - a).try_normalize()?;
        let edge = |from: Vector, to: Vector, across: Option<Vector>| {
            // The neighbour's normal for consistent winding.
            let neighbour = across.and_then(|third| (from - to).cross(third - to).try_normalize());
            neighbour
                .and_then(|neighbour| (face + neighbour).try_normalize())
                .unwrap_or(face)
        };
        let sign = self.outward.unwrap_or(1.0);
        let across = self.across;
        Some(TrianglePseudoNormals {
            face: sign * face,
            edges: [edge(a, b, across[0]), edge(b, c, across[1]), edge(c, a, across[2])].map(|edge| sign * edge),
            two_sided: self.outward.is_none(),
        })
    }
}

impl NormalConstraints for NormalLimits {
    fn project_local_normal_mut(&self, normal: &mut Vector) -> bool {
        // A triangle without area limits nothing.
        self.pseudo_normals()
            .is_none_or(|normals| normals.project_local_normal_mut(normal))
    }
}
