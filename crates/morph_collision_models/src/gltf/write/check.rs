//! What cannot be written.

use std::io;

use crate::mesh::{MeshSkin, MorphMesh};
use crate::skeleton::{Interpolation, LocalTransform};

/// Why a mesh could not be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The file could not be written.
    #[error("{}: {source}", path.display())]
    Io {
        /// The file.
        path: std::path::PathBuf,
        /// The system's error.
        source: io::Error,
    },
    /// The mesh has no vertices or no triangles, which glTF cannot express.
    #[error("mesh \"{0}\" has no vertices or no triangles, which glTF cannot hold")]
    Empty(String),
    /// A list has the wrong length.
    #[error("mesh \"{mesh}\": {what} {index} has {found} elements instead of {expected}")]
    Length {
        /// The mesh's name.
        mesh: String,
        /// The list: of a target, a clip, a channel of a clip, or a set of influences.
        what: &'static str,
        /// The index of the target, clip or set.
        index: usize,
        /// Its length.
        found: usize,
        /// The required length.
        expected: usize,
    },
    /// An index is out of range: a triangle's vertex, a primitive's triangle, an influence's joint, or anything's node.
    #[error("mesh \"{mesh}\": {what} {index} refers to elements that do not exist")]
    OutOfRange {
        /// The mesh's name.
        mesh: String,
        /// What has the bad index: a triangle, a primitive, the influences of a vertex, a node of the skeleton, a joint or a
        /// clip.
        what: &'static str,
        /// Its index.
        index: usize,
    },
    /// A skin has no joints, which glTF cannot express.
    #[error("mesh \"{0}\": its skin has no joints, which glTF cannot hold")]
    NoJoints(String),
    /// A node's rest transform is not finite.
    #[error("mesh \"{mesh}\": node {index} of the skeleton rests at a number that is not finite")]
    NotFinite {
        /// The mesh's name.
        mesh: String,
        /// The node's index.
        index: usize,
    },
    /// The file would be larger than glTF's 32-bit lengths allow.
    #[error("mesh \"{mesh}\": cannot be packed: {reason}")]
    Pack {
        /// The mesh's name.
        mesh: String,
        /// The reason.
        reason: String,
    },
}

/// Checks that the lengths of lists match and that all indices are valid.
pub(super) fn check(mesh: &MorphMesh) -> Result<(), WriteError> {
    let name = || mesh.name.clone();
    let length = |what, index, found, expected| same_length(mesh, what, index, found, expected);
    let vertices = mesh.positions.len();
    for (index, target) in mesh.targets.iter().enumerate() {
        if !target.is_empty() {
            length("target", index, target.len(), vertices)?;
        }
    }
    for (index, clip) in mesh.animations.iter().enumerate() {
        length("clip", index, clip.weights.len(), clip.times.len())?;
        if !clip.tangents.is_empty() {
            length("the tangents of clip", index, clip.tangents.len(), clip.times.len())?;
        }
        for weights in clip.weights.iter().chain(clip.tangents.iter().flatten()) {
            length("a key of clip", index, weights.len(), mesh.targets.len())?;
        }
    }
    if let Some(index) = mesh
        .triangles
        .iter()
        .position(|t| t.iter().any(|&v| v as usize >= vertices))
    {
        return Err(WriteError::OutOfRange {
            mesh: name(),
            what: "triangle",
            index,
        });
    }
    let bad_range =
        |range: &std::ops::Range<u32>| range.start >= range.end || range.end as usize > mesh.triangles.len();
    if let Some(index) = mesh.primitives.iter().position(bad_range) {
        return Err(WriteError::OutOfRange {
            mesh: name(),
            what: "primitive",
            index,
        });
    }
    if vertices == 0 || mesh.primitives.is_empty() {
        return Err(WriteError::Empty(name()));
    }
    mesh.skin.as_ref().map_or(Ok(()), |skin| check_skin(mesh, skin))
}

fn check_skin(mesh: &MorphMesh, skin: &MeshSkin) -> Result<(), WriteError> {
    let skeleton = &skin.skeleton;
    let out_of_range = |what, index| WriteError::OutOfRange {
        mesh: mesh.name.clone(),
        what,
        index,
    };
    if skeleton.joints.is_empty() {
        return Err(WriteError::NoJoints(mesh.name.clone()));
    }
    for (index, set) in skin.sets.iter().enumerate() {
        for found in [set.joints.len(), set.weights.len()] {
            same_length(mesh, "the influences of set", index, found, mesh.positions.len())?;
        }
        let exists = |joints: &[u16; 4]| joints.iter().all(|&joint| usize::from(joint) < skeleton.joints.len());
        if let Some(vertex) = set.joints.iter().position(|joints| !exists(joints)) {
            return Err(out_of_range("the influences of vertex", vertex));
        }
    }
    for (index, node) in skeleton.nodes.iter().enumerate() {
        if node.parent.is_some_and(|parent| parent as usize >= index) {
            return Err(out_of_range("the parent of node", index));
        }
        let LocalTransform {
            translation,
            rotation,
            scale,
        } = node.rest;
        if !(translation.is_finite() && rotation.is_finite() && scale.is_finite()) {
            let mesh = mesh.name.clone();
            return Err(WriteError::NotFinite { mesh, index });
        }
    }
    let exists = |node: u32| (node as usize) < skeleton.nodes.len();
    if let Some(joint) = skeleton.joints.iter().position(|joint| !exists(joint.node)) {
        return Err(out_of_range("joint", joint));
    }
    for (index, clip) in skeleton.clips.iter().enumerate() {
        for channel in &clip.channels {
            if !exists(channel.node) {
                return Err(out_of_range("a channel of the joints' clip", index));
            }
            let per_key = if channel.interpolation == Interpolation::CubicSpline {
                3
            } else {
                1
            };
            let (found, expected) = (channel.values.len(), channel.times.len() * per_key);
            same_length(mesh, "a channel of the joints' clip", index, found, expected)?;
        }
    }
    Ok(())
}

fn same_length(
    mesh: &MorphMesh,
    what: &'static str,
    index: usize,
    found: usize,
    expected: usize,
) -> Result<(), WriteError> {
    if found == expected {
        return Ok(());
    }
    Err(WriteError::Length {
        mesh: mesh.name.clone(),
        what,
        index,
        found,
        expected,
    })
}
