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
    /// The number of vertices that are moved by no joint, by one, by two, and so on.
    pub vertices_by_influences: Vec<usize>,
    /// The sum of a vertex's joint weights. It should be 1; otherwise the mesh is pulled towards the world's origin.
    pub weight_sum: WeightRange,
    /// Number of vertices whose sum differs from 1 by more than 0.001.
    pub vertices_not_summing_to_1: usize,
    /// Clips that move its joints.
    pub clips: Vec<JointClipReport>,
}

/// A clip that moves joints.
#[derive(Debug, Serialize)]
pub struct JointClipReport {
    /// The animation of the file that it is part of.
    pub animation: usize,
    /// Its name, or a default name.
    pub name: String,
    /// Its length in seconds.
    pub seconds: f32,
    /// Number of nodes that it moves: joints and their ancestors.
    pub nodes_moved: usize,
}

impl SkinReport {
    /// `animations` are the animations of the file that the skin's clips are part of.
    pub(super) fn new(skin: &MeshSkin, animations: &[usize]) -> Self {
        let vertices = skin.sets.first().map_or(0, |set| set.weights.len());
        let weights = |vertex: usize| skin.sets.iter().flat_map(move |set| set.weights[vertex]);
        let influences = |vertex| weights(vertex).filter(|weight| *weight != 0.0).count();
        let mut by_influences = vec![0; 4 * skin.sets.len() + 1];
        (0..vertices).for_each(|vertex| by_influences[influences(vertex)] += 1);
        let most = by_influences.iter().rposition(|&count| count > 0).unwrap_or(0);
        by_influences.truncate(most + 1);
        let sums = (0..vertices).map(|vertex| weights(vertex).map(f64::from).sum::<f64>());
        // A sum that is NaN is off, too.
        let is_off = |sum: &f64| sum.is_nan() || (sum - 1.0).abs() > 1e-3;
        let off = sums.clone().filter(is_off).count();
        let range = sums.map(|sum| (sum, sum)).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
        let skeleton = &skin.skeleton;
        let name = |joint: &crate::skeleton::Joint| skeleton.nodes[joint.node as usize].name.clone();
        Self {
            joints: skeleton.joints.iter().map(name).collect(),
            most_influences: most,
            vertices_by_influences: by_influences,
            weight_sum: WeightRange::of(range),
            vertices_not_summing_to_1: off,
            clips: (skeleton.clips.iter().zip(animations))
                .map(|(clip, &animation)| JointClipReport::new(clip, animation))
                .collect(),
        }
    }
}

impl JointClipReport {
    fn new(clip: &JointClip, animation: usize) -> Self {
        let mut nodes: Vec<u32> = clip.channels.iter().map(|channel| channel.node).collect();
        nodes.sort_unstable();
        nodes.dedup();
        Self {
            animation,
            name: clip.name.clone(),
            seconds: clip.duration(),
            nodes_moved: nodes.len(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generated::rigs::{tube, unnormalised};
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
            end: 0.0,
        });
        let report = SkinReport::new(&skin, &[7]);
        assert_eq!((report.joints.len(), &*report.joints[2]), (6, "joint_2"));
        assert_eq!(report.most_influences, 3);
        assert_eq!(report.vertices_by_influences.len(), 4);
        assert_eq!(
            report.vertices_by_influences.iter().sum::<usize>(),
            skin.sets[0].weights.len()
        );
        assert!((1..=skin.sets[0].weights.len()).contains(&report.vertices_not_summing_to_1));
        assert!(
            report.weight_sum.min == 0.0 && report.weight_sum.max > 2.0,
            "{report:?}"
        );
        let [clip] = &report.clips[..] else {
            panic!("{report:?}")
        };
        assert_eq!(
            (clip.animation, &*clip.name, clip.seconds, clip.nodes_moved),
            (7, "wave", 2.5, 2)
        );
    }
}
