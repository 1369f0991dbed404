//! Names for the parts of a mesh: its materials and its connected pieces.

use std::cmp::Reverse;
use std::collections::BTreeSet;
use std::ops::Range;

use morph_collision::{MorphModel, TrianglePair, touching_regions};

use crate::messages::counted;

/// The piece and the primitive of each triangle.
#[derive(Debug)]
pub(super) struct Parts {
    /// Pieces are numbered by descending number of triangles.
    piece_of_triangle: Vec<u32>,
    piece_sizes: Vec<usize>,
    primitives: Vec<Range<u32>>,
    materials: Vec<Option<String>>,
}

impl Parts {
    pub(super) fn new(model: &MorphModel, primitives: &[Range<u32>], materials: Vec<Option<String>>) -> Self {
        // Triangles that share vertices are one region, also if each is paired with itself.
        let alone = |triangle| TrianglePair {
            triangle_a: triangle,
            triangle_b: triangle,
        };
        let triangles: Vec<TrianglePair> = (0..model.triangle_count() as u32).map(alone).collect();
        let mut pieces = touching_regions(model, &triangles);
        // Stable: pieces of the same size stay in the order of their first triangles.
        pieces.sort_by_key(|piece| Reverse(piece.len()));
        let mut piece_of_triangle = vec![0; triangles.len()];
        for (piece, number) in pieces.iter().zip(0..) {
            for triangle in piece {
                piece_of_triangle[triangle.triangle_a as usize] = number;
            }
        }
        Self {
            piece_of_triangle,
            piece_sizes: pieces.iter().map(Vec::len).collect(),
            primitives: primitives.to_vec(),
            materials,
        }
    }

    /// The names of the parts that some triangles belong to. Empty if the mesh has only one part, without a name.
    pub(super) fn names(&self, triangles: &[u32]) -> Vec<String> {
        let of_triangle = |&triangle: &u32| {
            let piece = self.piece_of_triangle.get(triangle as usize).copied();
            let primitive = self.primitives.iter().position(|range| range.contains(&triangle));
            (primitive, piece)
        };
        let found: BTreeSet<(Option<usize>, Option<u32>)> = triangles.iter().map(of_triangle).collect();
        let names = found.into_iter().map(|(primitive, piece)| self.name(primitive, piece));
        names.filter(|name| !name.is_empty()).collect()
    }

    fn name(&self, primitive: Option<usize>, piece: Option<u32>) -> String {
        let material = primitive.and_then(|primitive| self.materials.get(primitive)?.clone());
        let primitive = primitive.filter(|_| self.primitives.len() > 1);
        let first = material.or_else(|| Some(format!("primitive {}", primitive?)));
        let piece = piece.filter(|_| self.piece_sizes.len() > 1);
        let second = piece.map(|piece| {
            format!(
                "piece {piece} ({})",
                counted(self.piece_sizes[piece as usize], "triangle", "triangles")
            )
        });
        [first, second].into_iter().flatten().collect::<Vec<_>>().join(" ")
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use morph_collision::ModelError;

    use super::*;

    #[test]
    fn pieces_are_numbered_by_size_and_named_by_material() -> Result<(), ModelError> {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let mut positions: Vec<Vec3> = corners.to_vec();
        positions.extend([5.0, 6.0, 7.0, 8.0].map(|x| Vec3::new(x, x * x, 0.0)));
        let triangles = [[0, 1, 2], [3, 4, 5], [4, 5, 6]];
        let model = MorphModel::from_displacements::<[Vec3; 0]>(&positions, &triangles, &[])?;
        let parts = Parts::new(&model, &[0..1, 1..3], vec![Some("skin".into()), None]);
        assert_eq!(
            parts.names(&[2, 0, 1]),
            ["skin piece 1 (1 triangle)", "primitive 1 piece 0 (2 triangles)"]
        );
        let whole = MorphModel::from_displacements::<[Vec3; 0]>(&positions, &triangles[1..], &[])?;
        assert!(
            Parts::new(&whole, std::slice::from_ref(&(0..2)), vec![None])
                .names(&[0, 1])
                .is_empty()
        );
        Ok(())
    }
}
