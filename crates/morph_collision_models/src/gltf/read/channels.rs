//! What the channels of an animation animate: a property of a node, or what an animation pointer names.

use super::document::ChannelTarget;
use crate::skeleton::Property;

/// What a channel animates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Animated<'a> {
    /// The weights of the mesh that a node shows; the pointer to it if it is only one of them.
    NodeWeights(usize, Option<&'a str>),
    /// The same of a mesh, for nodes that have no weights of their own.
    MeshWeights(usize, Option<&'a str>),
    /// Where a node is.
    Node(usize, Property),
    /// A part of a node, a mesh or a skin that is not animated here: the pointer to it.
    NotApplied(&'a str),
    /// Something that neither poses nor places a mesh, or nothing.
    Other,
}

impl ChannelTarget {
    /// What it names: by an animation pointer if it has one, or else by its node and path.
    pub(super) fn animated(&self) -> Animated<'_> {
        if let Some(extension) = &self.extensions.pointer {
            return of_pointer(&extension.pointer);
        }
        match (self.node, &*self.path) {
            (Some(node), "weights") => Animated::NodeWeights(node, None),
            (Some(node), path) => property(path).map_or(Animated::Other, |property| Animated::Node(node, property)),
            (None, _) => Animated::Other,
        }
    }
}

fn of_pointer(pointer: &str) -> Animated<'_> {
    let mut parts = pointer.split('/');
    let (start, list, index) = (parts.next(), parts.next(), parts.next());
    let (name, rest) = (parts.next(), parts.next());
    let index = index.and_then(|index| index.parse::<usize>().ok());
    match (start, list, index, name, rest) {
        (Some(""), Some("nodes"), Some(node), Some("weights"), one) => {
            Animated::NodeWeights(node, one.and(Some(pointer)))
        }
        (Some(""), Some("meshes"), Some(mesh), Some("weights"), one) => {
            Animated::MeshWeights(mesh, one.and(Some(pointer)))
        }
        (Some(""), Some("nodes"), Some(node), Some(name), None) if property(name).is_some() => {
            property(name).map_or(Animated::Other, |property| Animated::Node(node, property))
        }
        (Some(""), Some("nodes" | "meshes" | "skins"), ..) => Animated::NotApplied(pointer),
        _ => Animated::Other,
    }
}

fn property(name: &str) -> Option<Property> {
    Some(match name {
        "translation" => Property::Translation,
        "rotation" => Property::Rotation,
        "scale" => Property::Scale,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn target(json: &str) -> ChannelTarget {
        serde_json::from_str(json).expect("it is valid")
    }

    #[test]
    fn pointers_name_what_nodes_and_paths_name() {
        for (json, animated) in [
            (r#"{"node":3,"path":"weights"}"#, Animated::NodeWeights(3, None)),
            (r#"{"node":3,"path":"scale"}"#, Animated::Node(3, Property::Scale)),
            (r#"{"path":"weights"}"#, Animated::Other),
            (r#"{"node":3,"path":"colour"}"#, Animated::Other),
        ] {
            assert_eq!(target(json).animated(), animated, "{json}");
        }
        for (pointer, animated) in [
            ("/nodes/7/weights", Animated::NodeWeights(7, None)),
            ("/nodes/7/rotation", Animated::Node(7, Property::Rotation)),
            ("/meshes/2/weights", Animated::MeshWeights(2, None)),
            (
                "/nodes/7/weights/1",
                Animated::NodeWeights(7, Some("/nodes/7/weights/1")),
            ),
            (
                "/meshes/7/weights/1",
                Animated::MeshWeights(7, Some("/meshes/7/weights/1")),
            ),
            ("/skins/7/joints", Animated::NotApplied("/skins/7/joints")),
            (
                "/nodes/7/extensions/KHR_node_visibility/visible",
                Animated::NotApplied("/nodes/7/extensions/KHR_node_visibility/visible"),
            ),
            ("/materials/0/alphaCutoff", Animated::Other),
            ("nodes/7/weights", Animated::Other),
            ("", Animated::Other),
        ] {
            let json =
                format!(r#"{{"path":"pointer","extensions":{{"KHR_animation_pointer":{{"pointer":"{pointer}"}}}}}}"#);
            assert_eq!(target(&json).animated(), animated, "{pointer}");
        }
    }
}
