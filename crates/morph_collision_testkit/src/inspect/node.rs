//! The part of a report about a node that shows a mesh.

use glam::Affine3A;
use serde::Serialize;

use crate::gltf_read::GltfFile;

/// A node that shows a mesh, and where it is in the world at rest.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NodeReport {
    /// Its index in the file.
    pub index: usize,
    /// Its name, or a default name.
    pub name: String,
    /// The position of its origin.
    pub translation: [f32; 3],
    /// Its rotation, a quaternion `x, y, z, w`.
    pub rotation: [f32; 4],
    /// Its scale along its own axes.
    pub scale: [f32; 3],
}

impl NodeReport {
    /// The nodes that show a mesh. Those that cannot be placed are skipped.
    pub(super) fn all(file: &GltfFile, mesh: usize) -> Vec<Self> {
        let place = |node| file.world_from_node(mesh, node).ok().map(|place| (node, place));
        let nodes = file.nodes_of(mesh).filter_map(place);
        nodes
            .map(|(node, place)| Self::new(node, file.node_name(node), &place))
            .collect()
    }

    fn new(index: usize, name: String, world_from_node: &Affine3A) -> Self {
        let (scale, rotation, translation) = world_from_node.to_scale_rotation_translation();
        Self {
            index,
            name,
            translation: translation.to_array(),
            rotation: rotation.to_array(),
            scale: scale.to_array(),
        }
    }

    /// Whether it leaves the mesh where its own space is the world.
    #[must_use]
    pub fn is_identity(&self) -> bool {
        let [x, y, z, _] = self.rotation;
        self.translation == [0.0; 3] && self.scale == [1.0; 3] && [x, y, z] == [0.0; 3]
    }
}
