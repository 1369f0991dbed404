//! Vertices of skinned meshes that no joint moves: all of them end up at the origin of the world.

use std::fmt;

use super::morph_mesh::MorphMesh;
use crate::text::Grouped;

/// What [`MorphMesh::leave_out_unweighted`] left out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unweighted {
    /// The number of vertices of triangles whose weights are all 0.
    pub vertices: usize,
    /// The number of triangles with such a vertex.
    pub triangles: usize,
    /// The former number of each triangle that is left, ascending.
    pub kept: Vec<u32>,
}

impl fmt::Display for Unweighted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let noun = |count: usize, one, many| if count == 1 { one } else { many };
        write!(
            f,
            "{} {} no joint weights, so they are all at the origin; left out the {} {} with such a vertex",
            Grouped(self.vertices as u64),
            noun(self.vertices, "vertex has", "vertices have"),
            Grouped(self.triangles as u64),
            noun(self.triangles, "triangle", "triangles"),
        )
    }
}

impl MorphMesh {
    /// Removes the triangles of a skinned mesh that have a vertex whose joint weights are all 0; `None` if there are none. Vertices and their
    /// numbers stay.
    ///
    /// Such vertices are all at the same point, so most of these triangles touch each other.
    pub fn leave_out_unweighted(&mut self) -> Option<Unweighted> {
        let sets = &self.skin.as_ref()?.sets;
        let is_unweighted = |vertex: &u32| {
            let mut weights = sets.iter().filter_map(|set| set.weights.get(*vertex as usize));
            weights.all(|weights| *weights == [0.0; 4])
        };
        let mut vertices: Vec<u32> = self.triangles.iter().flatten().copied().collect();
        vertices.sort_unstable();
        vertices.dedup();
        vertices.retain(is_unweighted);
        if vertices.is_empty() {
            return None;
        }
        let is_left_out = |triangle: &[u32; 3]| triangle.iter().any(|vertex| vertices.binary_search(vertex).is_ok());
        let numbered = (0..).zip(&self.triangles);
        let kept: Vec<u32> = numbered
            .filter(|(_, triangle)| !is_left_out(triangle))
            .map(|(number, _)| number)
            .collect();
        let triangles = self.triangles.len() - kept.len();
        self.triangles.retain(|triangle| !is_left_out(triangle));
        for range in &mut self.primitives {
            let place = |end: u32| kept.partition_point(|&number| number < end) as u32;
            *range = place(range.start)..place(range.end);
        }
        Some(Unweighted {
            vertices: vertices.len(),
            triangles,
            kept,
        })
    }
}
