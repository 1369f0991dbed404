//! Which triangle owns each vertex and edge, so that a query over pairs of triangles looks at each pair of vertices, edges and faces
//! once: representative triangles (Curtis, Tamstorf and Manocha 2008).

use crate::model::MorphModel;

/// For each triangle, the corners and edges that it owns. Every vertex and every edge of the mesh has one owner.
#[derive(Debug, Default)]
pub(crate) struct Owners(Vec<u8>);

impl Owners {
    pub(super) fn new(model: &MorphModel) -> Self {
        let mut owners = vec![0; model.triangle_count()];
        let mut is_owned = vec![false; model.vertex_count()];
        let mut edges = Vec::with_capacity(3 * owners.len());
        for (triangle, owned) in owners.iter_mut().enumerate() {
            let corners = model.corners(triangle as u32);
            for (corner, vertex) in corners.into_iter().enumerate() {
                if !std::mem::replace(&mut is_owned[vertex as usize], true) {
                    *owned |= 1 << corner;
                }
            }
            for edge in 0..3 {
                let [a, b] = [corners[edge], corners[(edge + 1) % 3]];
                // A triangle that names a vertex twice has an edge without length. The vertex stands for it.
                if a != b {
                    edges.push(([a.min(b), a.max(b)], triangle as u32, edge as u8));
                }
            }
        }
        edges.sort_unstable();
        for equal in edges.chunk_by(|a, b| a.0 == b.0) {
            let (_, triangle, edge) = equal[0];
            owners[triangle as usize] |= 1 << (3 + edge);
        }
        Self(owners)
    }

    /// What a triangle owns.
    #[inline]
    pub(crate) fn of(&self, triangle: u32) -> Owned {
        Owned(self.0[triangle as usize])
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&*self.0)
    }
}

/// Corners and edges that a triangle owns.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Owned(u8);

impl Owned {
    /// All corners and edges.
    pub(crate) const ALL: Self = Self(0b11_1111);

    /// All but one of the edges.
    pub(crate) fn without_edge(self, edge: usize) -> Self {
        Self(self.0 & !(1 << (3 + edge)))
    }

    /// The corners, as a bit mask.
    #[inline]
    pub(crate) fn corners(self) -> u8 {
        self.0 & 0b111
    }

    /// The edges, as a bit mask. Edge `i` leads from corner `i` to the next one.
    #[inline]
    pub(crate) fn edges(self) -> u8 {
        self.0 >> 3
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    #[test]
    fn every_vertex_and_edge_has_one_owner() {
        // A strip of four triangles, one that names a corner twice, and one on the other side of an edge.
        let base: Vec<Vec3> = (0..6)
            .map(|i| Vec3::new(i as f32, (i % 2) as f32, 0.3 * i as f32))
            .collect();
        let triangles = [[0, 1, 2], [1, 3, 2], [2, 3, 4], [3, 5, 4], [4, 4, 5], [2, 1, 0]];
        let no_targets: [Vec<Vec3>; 0] = [];
        let model = MorphModel::from_displacements(&base, &triangles, &no_targets).unwrap();
        let owners = Owners::new(&model);
        let (mut vertices, mut edges) = (Vec::new(), Vec::new());
        for triangle in 0..model.triangle_count() as u32 {
            let corners = model.corners(triangle);
            for i in 0..3 {
                if owners.of(triangle).corners() >> i & 1 == 1 {
                    vertices.push(corners[i]);
                }
                if owners.of(triangle).edges() >> i & 1 == 1 {
                    let (a, b) = (corners[i], corners[(i + 1) % 3]);
                    edges.push([a.min(b), a.max(b)]);
                }
            }
        }
        vertices.sort_unstable();
        edges.sort_unstable();
        assert_eq!(vertices, (0..model.vertex_count() as u32).collect::<Vec<_>>());
        let count = edges.len();
        edges.dedup();
        assert_eq!((edges.len(), count), (9, 9));
    }
}
