//! The part of a report about a node that shows a mesh.

use std::collections::HashMap;

use glam::Affine3A;
use serde::Serialize;

use crate::gltf::read::{Drawing, GltfFile};

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
    /// How many times the default scene draws the mesh at this node: 0 if the node is outside the scene or hidden, and more than once for
    /// instances.
    pub drawn: usize,
}

/// How many times the default scene draws the mesh of each node.
#[derive(Debug, Default)]
pub(super) struct DrawnNodes(HashMap<usize, usize>);

impl DrawnNodes {
    pub(super) fn of(drawing: &Drawing) -> Self {
        let mut counts = HashMap::new();
        for node in drawing.drawn.iter().filter_map(|drawn| drawn.node) {
            *counts.entry(node).or_default() += 1;
        }
        Self(counts)
    }
}

impl NodeReport {
    /// The nodes that show a mesh. Those that cannot be placed are skipped.
    pub(super) fn all(file: &GltfFile, mesh: usize, drawn: &DrawnNodes) -> Vec<Self> {
        let place = |node| file.world_from_node(mesh, node).ok().map(|place| (node, place));
        let nodes = file.nodes_of(mesh).filter_map(place);
        let report = |(node, place)| {
            let drawn = drawn.0.get(&node).copied().unwrap_or(0);
            Self::new(node, file.node_name(node), &place, drawn)
        };
        nodes.map(report).collect()
    }

    fn new(index: usize, name: String, world_from_node: &Affine3A, drawn: usize) -> Self {
        let (scale, rotation, translation) = world_from_node.to_scale_rotation_translation();
        Self {
            index,
            name,
            translation: translation.to_array(),
            rotation: rotation.to_array(),
            scale: scale.to_array(),
            drawn,
        }
    }

    /// Whether it leaves the mesh where its own space is the world.
    #[must_use]
    pub fn is_identity(&self) -> bool {
        let [x, y, z, _] = self.rotation;
        self.translation == [0.0; 3] && self.scale == [1.0; 3] && [x, y, z] == [0.0; 3]
    }
}
