//! The part of a report about the skin of a mesh.

use serde::Serialize;

use super::WeightRange;
use crate::mesh::MeshSkin;
use crate::skeleton::JointClip;

/// The joints that move a mesh.
#[derive(Debug, Serialize)]
pub struct SkinReport {
    /// One name per joint, in the order of the influences' joint indices.
    pub joints: Vec<String>,
    /// The largest number of joints that move one vertex.
    pub most_influences: usize,
    /// The sum of a vertex's joint weights. It should be 1; otherwise the mesh is pulled towards the world's origin.
    pub weight_sum: WeightRange,
    /// Clips that move its joints.
    pub clips: Vec<JointClipReport>,
}

/// A clip that moves joints.
#[derive(Debug, Serialize)]
pub struct JointClipReport {
    /// Its name, or a default name.
    pub name: String,
    /// Its length in seconds.
    pub seconds: f32,
    /// Number of nodes that it moves: joints and their ancestors.
    pub nodes_moved: usize,
}

impl SkinReport {
    pub(super) fn new(skin: &MeshSkin) -> Self {
        let vertices = skin.sets.first().map_or(0, |set| set.weights.len());
        let weights = |vertex: usize| skin.sets.iter().flat_map(move |set| set.weights[vertex]);
        let influences = |vertex| weights(vertex).filter(|weight| *weight != 0.0).count();
        let sums = (0..vertices).map(|vertex| weights(vertex).map(f64::from).sum::<f64>());
        let range = sums.map(|sum| (sum, sum)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
        let skeleton = &skin.skeleton;
        let name = |joint: &crate::skeleton::Joint| skeleton.nodes[joint.node as usize].name.clone();
        Self {
            joints: skeleton.joints.iter().map(name).collect(),
            most_influences: (0..vertices).map(influences).max().unwrap_or(0),
            weight_sum: WeightRange::of(range),
            clips: skeleton.clips.iter().map(JointClipReport::new).collect(),
        }
    }
}

impl JointClipReport {
    fn new(clip: &JointClip) -> Self {
        let mut nodes: Vec<u32> = clip.channels.iter().map(|channel| channel.node).collect();
        nodes.sort_unstable();
        nodes.dedup();
        Self {
            name: clip.name.clone(),
            seconds: clip.duration(),
            nodes_moved: nodes.len(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::rigs::{tube, unnormalised};
    use crate::skeleton::{Interpolation, JointChannel, Property};

    #[test]
    fn joints_influences_sums_and_clips_are_told() {
        let mesh = unnormalised(&tube(1, 6, 3, 0), 2);
        let mut skin = mesh.skin.expect("a tube is skinned");
        let channel = |node, property| JointChannel {
            node,
            property,
            interpolation: Interpolation::Step,
            times: vec![0.0, 2.5],
            values: Vec::new(),
        };
        skin.skeleton.clips.push(JointClip {
            name: "wave".into(),
            channels: vec![
                channel(1, Property::Scale),
                channel(3, Property::Scale),
                channel(1, Property::Rotation),
            ],
        });
        let report = SkinReport::new(&skin);
        assert_eq!((report.joints.len(), &*report.joints[2]), (6, "joint_2"));
        assert_eq!(report.most_influences, 3);
        assert!(
            report.weight_sum.min == 0.0 && report.weight_sum.max > 2.0,
            "{report:?}"
        );
        let [clip] = &report.clips[..] else {
            panic!("{report:?}")
        };
        assert_eq!((&*clip.name, clip.seconds, clip.nodes_moved), ("wave", 2.5, 2));
    }
}
