//! A triangle mesh with morph targets, weight animations and a skin, as stored in a file: not welded and not validated.

use std::ops::Range;

use glam::Vec3;
use morph_collision::{ModelError, MorphModel};

use super::skin::MeshSkin;
use crate::clip::WeightAnimation;

/// A mesh with dense displacements, in model space.
///
/// Nothing here is checked: [`MorphMesh::to_model`] validates it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MorphMesh {
    /// The mesh's name; a reader makes up a name if the file has none.
    pub name: String,
    /// Base positions, one per vertex.
    pub positions: Vec<Vec3>,
    /// Vertex indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// One name per target.
    pub target_names: Vec<String>,
    /// One list of displacements per target, each as long as `positions`, or empty if the target moves nothing.
    pub targets: Vec<Vec<Vec3>>,
    /// The weights that it has while no clip or caller sets others, one per target; empty if all are zero.
    pub default_weights: Vec<f32>,
    /// The parts as ranges of triangle indices, in order. Usually each has its own material.
    pub primitives: Vec<Range<u32>>,
    /// Clips that animate the weights.
    pub animations: Vec<WeightAnimation>,
    /// The joints that move its vertices after its targets, if there are any.
    pub skin: Option<MeshSkin>,
}

impl MorphMesh {
    /// A mesh of one primitive without targets.
    pub fn rigid(name: impl Into<String>, positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Self {
        let primitives = std::iter::once(0..triangles.len() as u32).collect();
        Self {
            name: name.into(),
            positions,
            triangles,
            primitives,
            ..Self::default()
        }
    }

    /// A mesh of one primitive from the positions of every reference. Reference 0 is the base; the others become targets named by
    /// `target_names`.
    ///
    /// Extra references or names are dropped if one list is longer than the other.
    pub fn from_references(
        name: impl Into<String>,
        references: &[Vec<Vec3>],
        triangles: Vec<[u32; 3]>,
        target_names: &[&str],
    ) -> Self {
        let base = references.first().cloned().unwrap_or_default();
        let targets: Vec<Vec<Vec3>> = references
            .iter()
            .skip(1)
            .zip(target_names)
            .map(|(reference, _)| reference.iter().zip(&base).map(|(&p, &b)| p - b).collect())
            .collect();
        let mut mesh = Self::rigid(name, base, triangles);
        mesh.target_names = target_names
            .iter()
            .take(targets.len())
            .map(ToString::to_string)
            .collect();
        mesh.targets = targets;
        mesh
    }

    /// The weights that it has while no clip or caller sets others, one per target.
    pub fn weights_at_rest(&self) -> Vec<f32> {
        let mut weights = self.default_weights.clone();
        weights.resize(self.targets.len(), 0.0);
        weights
    }

    /// The positions when only target `target` has a weight, of 1; the base if the target does not exist.
    pub fn reference(&self, target: usize) -> Vec<Vec3> {
        match self.targets.get(target) {
            Some(displacements) if !displacements.is_empty() => {
                self.positions.iter().zip(displacements).map(|(&b, &d)| b + d).collect()
            }
            _ => self.positions.clone(),
        }
    }

    /// The blended positions `base + sum of weight * displacement`, in ascending target order; missing weights are zero.
    pub fn posed(&self, weights: &[f32]) -> Vec<Vec3> {
        let mut posed = self.positions.clone();
        for (displacements, &weight) in self.targets.iter().zip(weights) {
            if weight != 0.0 {
                for (p, &d) in posed.iter_mut().zip(displacements) {
                    *p += d * weight;
                }
            }
        }
        posed
    }

    /// Estimate of the peak memory for building a tree of the mesh, including its model, in bytes.
    ///
    /// Looks at every displacement. Measured on meshes of random points moved by all targets, and rounded up. A model stores displacements
    /// in blocks of eight, which may each have a single one.
    pub fn tree_bytes(&self) -> u64 {
        let moving = |displacements: &Vec<Vec3>| displacements.iter().filter(|d| **d != Vec3::ZERO).count() as u64;
        let (vertices, triangles) = (self.positions.len() as u64, self.triangles.len() as u64);
        let of_target = |moved: u64| moved * 68 + moved.min(vertices.div_ceil(8)) * 96;
        let displacements: u64 = self.targets.iter().map(moving).map(of_target).sum();
        let influences = vertices * self.skin.as_ref().map_or(0, |skin| skin.sets.len() as u64);
        vertices * 64 + triangles * 160 + displacements + self.targets.len() as u64 * 64 + influences * 128
    }

    /// Estimate of a body's own memory beside its tree, in bytes: a pose, and for methods that need it a tree over blended
    /// vertices.
    pub fn body_bytes(&self, has_tree: bool) -> u64 {
        let (vertices, triangles) = (self.positions.len() as u64, self.triangles.len() as u64);
        if has_tree {
            vertices * 64 + triangles * 160
        } else {
            vertices * 24 + triangles * 24
        }
    }

    /// The immutable model from which the collision tree is built; a skinned one if the mesh has a skin.
    ///
    /// # Errors
    /// Those of [`MorphModel::from_displacements`] and [`MorphModel::skinned`]: the index of the first bad vertex, triangle,
    /// target or influence.
    pub fn to_model(&self) -> Result<MorphModel, ModelError> {
        let any_empty = self.targets.iter().any(Vec::is_empty);
        let zeros = vec![Vec3::ZERO; if any_empty { self.positions.len() } else { 0 }];
        let in_full = self
            .targets
            .iter()
            .map(|target| if target.is_empty() { &zeros } else { target });
        let targets: Vec<&[Vec3]> = in_full.map(Vec::as_slice).collect();
        match &self.skin {
            None => MorphModel::from_displacements(&self.positions, &self.triangles, &targets),
            Some(skin) => {
                let (count, influences) = (skin.joint_count(), skin.influences());
                MorphModel::skinned(&self.positions, &self.triangles, &targets, count, &influences)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn posing_with_one_full_weight_gives_the_reference() {
        let references = [vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![Vec3::Z, Vec3::X, Vec3::ONE]];
        let mesh = MorphMesh::from_references("m", &references, vec![[0, 1, 2]], &["up"]);
        assert_eq!(mesh.posed(&[1.0]), references[1]);
        assert_eq!(mesh.reference(0), references[1]);
    }

    #[test]
    fn an_empty_target_moves_nothing() -> Result<(), ModelError> {
        let mut mesh = MorphMesh::rigid("m", vec![Vec3::ZERO, Vec3::X, Vec3::Y], vec![[0, 1, 2]]);
        mesh.targets = vec![Vec::new(), vec![Vec3::Z; 3]];
        assert_eq!(mesh.reference(0), mesh.positions);
        assert_eq!(mesh.posed(&[5.0, 1.0]), mesh.reference(1));
        let model = mesh.to_model()?;
        assert_eq!([0, 1].map(|target| model.displaced_vertex_count(target)), [0, 3]);
        Ok(())
    }
}
