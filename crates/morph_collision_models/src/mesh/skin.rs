//! The skin of a mesh: the data that lets joints move it.

use morph_collision::Influences;

use crate::skeleton::Skeleton;

/// The influences of a mesh's vertices, and the joints they name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshSkin {
    /// Sets of up to four influences per vertex, as glTF numbers them.
    pub sets: Vec<InfluenceSet>,
    /// The joints, their rest transforms and their clips.
    pub skeleton: Skeleton,
}

/// Four influences of every vertex; those with weight 0 do nothing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InfluenceSet {
    /// Indices of joints, one entry per vertex.
    pub joints: Vec<[u16; 4]>,
    /// Their weights, one entry per vertex. They need not sum to 1.
    pub weights: Vec<[f32; 4]>,
}

impl MeshSkin {
    /// The number of joints.
    #[must_use]
    pub fn joint_count(&self) -> usize {
        self.skeleton.joints.len()
    }

    /// The same skin for other vertices. Each takes the influences of one of the old vertices.
    pub fn renumbered<'a>(&self, vertices: impl Iterator<Item = &'a u32> + Clone) -> Self {
        let of = |set: &InfluenceSet| InfluenceSet {
            joints: vertices.clone().map(|&v| set.joints[v as usize]).collect(),
            weights: vertices.clone().map(|&v| set.weights[v as usize]).collect(),
        };
        Self {
            sets: self.sets.iter().map(of).collect(),
            skeleton: self.skeleton.clone(),
        }
    }

    /// The sets in the form that a model takes.
    pub fn influences(&self) -> Vec<Influences<'_>> {
        let sets = self.sets.iter();
        sets.map(|InfluenceSet { joints, weights }| Influences { joints, weights })
            .collect()
    }
}
