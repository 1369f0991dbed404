//! Writes influences as attributes, and joints as nodes with their inverse bind matrices.

use gltf_json::{
    self as json, Index, Node, Root, accessor::Type, mesh::Semantic, scene::UnitQuaternion, validation::Checked,
};

use super::Attributes;
use super::buffer::Packer;
use crate::mesh::MeshSkin;
use crate::skeleton::{LocalTransform, Skeleton};

/// Adds the sets of influences to the attributes of the vertices.
pub(super) fn add_influences(skin: &MeshSkin, attributes: &mut Attributes, root: &mut Root, packer: &mut Packer) {
    for (number, set) in (0..).zip(&skin.sets) {
        let joints = packer.joints(root, &set.joints, skin.joint_count());
        let weights = packer.vertices(root, Type::Vec4, &set.weights, false);
        attributes.insert(Checked::Valid(Semantic::Joints(number)), joints);
        attributes.insert(Checked::Valid(Semantic::Weights(number)), weights);
    }
}

/// A skeleton in the file.
pub(super) struct Bones {
    pub(super) skin: Index<json::Skin>,
    /// The nodes of the skeleton.
    pub(super) nodes: Vec<Index<Node>>,
    /// The ancestor of all of them.
    pub(super) root: Index<Node>,
}

/// Writes the nodes of a skeleton and its joints.
pub(super) fn bones(skeleton: &Skeleton, root: &mut Root, packer: &mut Packer) -> Bones {
    let written = skeleton.nodes.iter().map(|node| {
        let LocalTransform {
            translation,
            rotation,
            scale,
        } = node.rest;
        let rest = LocalTransform::default();
        root.push(Node {
            name: Some(node.name.clone()),
            translation: (translation != rest.translation).then(|| translation.to_array()),
            rotation: (rotation != rest.rotation).then(|| UnitQuaternion(rotation.to_array())),
            scale: (scale != rest.scale).then(|| scale.to_array()),
            ..Node::default()
        })
    });
    let nodes: Vec<Index<Node>> = written.collect();
    let mut tops = Vec::new();
    for (node, &index) in skeleton.nodes.iter().zip(&nodes) {
        match node.parent {
            Some(parent) => {
                let above = &mut root.nodes[nodes[parent as usize].value()];
                above.children.get_or_insert_default().push(index);
            }
            None => tops.push(index),
        }
    }
    let top = match tops.as_slice() {
        [top] => *top,
        _ => root.push(Node {
            name: Some("skeleton".into()),
            children: Some(tops),
            ..Node::default()
        }),
    };
    let matrices = skeleton.joints.iter().map(|joint| joint.inverse_bind.to_cols_array());
    let matrices = packer.values(root, Type::Mat4, matrices);
    let skin = root.push(json::Skin {
        extensions: None,
        extras: None,
        inverse_bind_matrices: Some(matrices),
        joints: skeleton.joints.iter().map(|joint| nodes[joint.node as usize]).collect(),
        name: None,
        skeleton: None,
    });
    Bones { skin, nodes, root: top }
}
