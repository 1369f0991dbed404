//! Groups pairs of triangles by where they are.

use std::collections::HashMap;

use crate::model::MorphModel;
use crate::query::triangle_pair::TrianglePair;

/// Groups intersecting triangle pairs of one mesh, such as those from [`SelfQuery::all`](crate::SelfQuery::all), into regions: the
/// lips, an arm and the chest.
///
/// Two pairs are in the same region if a triangle of one and a triangle of the other share a vertex, directly or by way of further
/// pairs. Regions are in the order of their first pairs, and each keeps the order of its pairs. Triangles that the model does not
/// have are skipped.
///
/// ```
/// # use glam::Vec3;
/// # use morph_collision::{MorphModel, TrianglePair, touching_regions};
/// # let corner = |i: u32| Vec3::new(i as f32, (i * i) as f32, 0.0);
/// # let strip: Vec<Vec3> = (0..8).map(corner).collect();
/// // A strip of six triangles: each shares vertices with the next two.
/// let triangles: Vec<[u32; 3]> = (0..6).map(|i| [i, i + 1, i + 2]).collect();
/// let model = MorphModel::from_displacements(&strip, &triangles, &[] as &[Vec<Vec3>])?;
/// let pair = |triangle_a, triangle_b| TrianglePair { triangle_a, triangle_b };
/// let regions = touching_regions(&model, &[pair(0, 3), pair(1, 4)]);
/// assert_eq!(regions, [[pair(0, 3), pair(1, 4)]]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn touching_regions(model: &MorphModel, pairs: &[TrianglePair]) -> Vec<Vec<TrianglePair>> {
    let corners = |pair: &TrianglePair| Some([model.triangle(pair.triangle_a)?, model.triangle(pair.triangle_b)?]);
    let mut sets = Sets::default();
    for corners in pairs.iter().filter_map(corners) {
        let first = corners[0][0];
        for &corner in corners.as_flattened() {
            sets.unite(first, corner);
        }
    }
    let (mut regions, mut indices) = (Vec::new(), HashMap::new());
    for pair in pairs {
        let Some([[first, ..], _]) = corners(pair) else {
            continue;
        };
        let index = *indices.entry(sets.root(first)).or_insert_with(|| {
            regions.push(Vec::new());
            regions.len() - 1
        });
        regions[index].push(*pair);
    }
    regions
}

/// Disjoint sets of vertices.
#[derive(Default)]
struct Sets {
    parent: HashMap<u32, u32>,
}

impl Sets {
    /// The vertex that stands for the set of a vertex.
    fn root(&mut self, vertex: u32) -> u32 {
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

    fn unite(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent.insert(a.max(b), a.min(b));
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;

    fn pair(triangle_a: u32, triangle_b: u32) -> TrianglePair {
        TrianglePair { triangle_a, triangle_b }
    }

    #[test]
    fn pairs_belong_together_if_a_chain_of_shared_vertices_joins_them() {
        // Twelve triangles; each shares an edge with the next, except the sixth with the seventh.
        let positions: Vec<Vec3> = (0..16).map(|i| Vec3::new(i as f32, (i * i) as f32, 0.0)).collect();
        let strip = |from: u32| (from..from + 6).map(|i| [i, i + 1, i + 2]);
        let triangles: Vec<[u32; 3]> = strip(0).chain(strip(8)).collect();
        let model = MorphModel::from_displacements(&positions, &triangles, &[] as &[Vec<Vec3>]).expect("a model");
        let regions = |pairs: &[TrianglePair]| touching_regions(&model, pairs);
        assert_eq!(regions(&[]), [[]; 0]);
        // Triangles 0 and 3 share no vertex, but the pair joins them.
        assert_eq!(
            regions(&[pair(0, 3), pair(8, 11), pair(3, 5), pair(6, 9)]),
            [vec![pair(0, 3), pair(3, 5)], vec![pair(8, 11), pair(6, 9)]]
        );
        // Joined by the last pair only.
        assert_eq!(
            regions(&[pair(0, 1), pair(7, 8), pair(1, 7)]),
            [[pair(0, 1), pair(7, 8), pair(1, 7)]]
        );
        assert_eq!(regions(&[pair(0, 99)]), [[]; 0], "there is no triangle 99");
    }
}
