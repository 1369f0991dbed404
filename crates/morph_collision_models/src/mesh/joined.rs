//! Two meshes as one, to compare them as parts of one mesh: a garment and the body that wears it.

use glam::Vec3;
use thiserror::Error;

use super::morph_mesh::MorphMesh;
use super::skin::{InfluenceSet, MeshSkin};
use crate::skeleton::{Joint, Skeleton};
use crate::text::suggestion;

/// Why two meshes cannot be joined.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum JoinError {
    /// Only one of them is moved by joints.
    #[error("\"{with}\" is moved by joints, \"{without}\" is not")]
    OneSkin {
        /// The name of the mesh with joints.
        with: String,
        /// The name of the mesh without.
        without: String,
    },
    /// The other mesh has a joint that the first mesh's skeleton does not have.
    #[error("\"{other}\" has the joint \"{joint}\", which the skeleton of \"{mesh}\" does not have{hint}")]
    NoSuchJoint {
        /// The name of the first mesh.
        mesh: String,
        /// The name of the other mesh.
        other: String,
        /// The name of the joint.
        joint: String,
        /// The name that is meant, perhaps.
        hint: String,
    },
    /// Together they have too many vertices, triangles or joints to number.
    #[error("\"{mesh}\" and \"{other}\" have too many {what} together")]
    TooMany {
        /// The name of the first mesh.
        mesh: String,
        /// The name of the other mesh.
        other: String,
        /// What there is too much of.
        what: &'static str,
    },
}

impl MorphMesh {
    /// This mesh followed by another one. Vertices, triangles and primitives of the other mesh get the numbers after this mesh's.
    ///
    /// Targets with the same name become one target, other targets of the other mesh follow. Both are in the same space. Joints of the other mesh are
    /// found in this mesh's skeleton by name. Clips are this mesh's.
    ///
    /// # Errors
    /// Only one mesh has joints, a joint of the other mesh is missing here, or there is too much to number.
    pub fn joined(&self, other: &Self) -> Result<Self, JoinError> {
        let too_many = |what| JoinError::TooMany {
            mesh: self.name.clone(),
            other: other.name.clone(),
            what,
        };
        let first_vertex = u32::try_from(self.positions.len()).map_err(|_| too_many("vertices"))?;
        let first_triangle = u32::try_from(self.triangles.len()).map_err(|_| too_many("triangles"))?;
        let moved = |corner: &u32| corner.checked_add(first_vertex).ok_or(too_many("vertices"));
        let mut joined = self.clone();
        joined.name = format!("{} and {}", self.name, other.name);
        joined.positions.extend_from_slice(&other.positions);
        for [a, b, c] in &other.triangles {
            joined.triangles.push([moved(a)?, moved(b)?, moved(c)?]);
        }
        for range in &other.primitives {
            let moved = |end: u32| end.checked_add(first_triangle).ok_or(too_many("triangles"));
            joined.primitives.push(moved(range.start)?..moved(range.end)?);
        }
        joined.default_weights = self.weights_at_rest();
        let rest = other.weights_at_rest();
        // A list for each target, as long as all positions or empty.
        for target in joined.targets.iter_mut().filter(|target| !target.is_empty()) {
            target.resize(joined.positions.len(), Vec3::ZERO);
        }
        for ((name, displacements), &weight) in other.target_names.iter().zip(&other.targets).zip(&rest) {
            let same = self.target_names.iter().position(|own| own == name);
            let target = same.unwrap_or(joined.targets.len());
            if same.is_none() {
                joined.target_names.push(name.clone());
                joined.targets.push(Vec::new());
                joined.default_weights.push(weight);
            }
            if !displacements.is_empty() {
                let target = &mut joined.targets[target];
                target.resize(joined.positions.len(), Vec3::ZERO);
                let added = target.iter_mut().skip(self.positions.len());
                added.zip(displacements).for_each(|(moved, &by)| *moved = by);
            }
        }
        for clip in &mut joined.animations {
            for weights in &mut clip.weights {
                weights.extend_from_slice(&joined.default_weights[self.targets.len()..]);
            }
            for tangent in clip.tangents.iter_mut().flatten() {
                tangent.resize(joined.targets.len(), 0.0);
            }
        }
        joined.skin = match (&self.skin, &other.skin) {
            (None, None) => None,
            (Some(own), Some(others)) => Some(self.joined_skin(own, other, others)?),
            (own, _) => {
                let [with, without] = if own.is_some() { [self, other] } else { [other, self] };
                return Err(JoinError::OneSkin {
                    with: with.name.clone(),
                    without: without.name.clone(),
                });
            }
        };
        Ok(joined)
    }

    fn joined_skin(&self, own: &MeshSkin, other: &Self, others: &MeshSkin) -> Result<MeshSkin, JoinError> {
        let first_joint = own.joint_count();
        let all = first_joint + others.joint_count();
        if all > usize::from(u16::MAX) {
            return Err(JoinError::TooMany {
                mesh: self.name.clone(),
                other: other.name.clone(),
                what: "joints",
            });
        }
        let mut skeleton: Skeleton = own.skeleton.clone();
        for joint in &others.skeleton.joints {
            let node = others.skeleton.nodes.get(joint.node as usize);
            let name = node.map(|node| node.name.clone()).unwrap_or_default();
            let Some(node) = own.skeleton.nodes.iter().position(|node| node.name == name) else {
                let names = own.skeleton.nodes.iter().map(|node| node.name.as_str());
                return Err(JoinError::NoSuchJoint {
                    mesh: self.name.clone(),
                    other: other.name.clone(),
                    hint: suggestion(&name, names),
                    joint: name,
                });
            };
            // Its own bind pose: both meshes may have been bound in different ones.
            let (node, inverse_bind) = (node as u32, joint.inverse_bind);
            skeleton.joints.push(Joint { node, inverse_bind });
        }
        let (before, behind) = (self.positions.len(), other.positions.len());
        let empty = |vertices: usize| InfluenceSet {
            joints: vec![[0; 4]; vertices],
            weights: vec![[0.0; 4]; vertices],
        };
        let sets = (0..own.sets.len().max(others.sets.len())).map(|index| {
            let mut set = own.sets.get(index).cloned().unwrap_or_else(|| empty(before));
            let added = others.sets.get(index).cloned().unwrap_or_else(|| empty(behind));
            // Joints that are out of range stay so, for the check of the model.
            let moved = |joint: u16| joint.saturating_add(first_joint as u16);
            set.joints.extend(added.joints.iter().map(|joints| joints.map(moved)));
            set.weights.extend(added.weights);
            set
        });
        Ok(MeshSkin {
            sets: sets.collect(),
            skeleton,
        })
    }
}
