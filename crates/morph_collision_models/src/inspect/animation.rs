//! The parts of a report about animations.

use serde::Serialize;

use crate::clip::WeightAnimation;
use crate::gltf::read::AnimationInfo;
use crate::text::number;

/// An animation of the file.
#[derive(Debug, Serialize)]
pub struct FileAnimationReport {
    /// Its index in the file.
    pub index: usize,
    /// Its name, or a default name.
    pub name: String,
    /// The time of its last key in seconds.
    pub seconds: f32,
    /// The meshes whose weights it animates.
    pub meshes: Vec<usize>,
    /// Number of nodes that it moves.
    pub nodes_moved: usize,
    /// Number of its channels.
    pub channels: usize,
    /// Channels without a node, or that animate something else; they are ignored.
    pub channels_ignored: usize,
    /// The interpolations of its samplers.
    pub interpolations: Vec<String>,
}

/// A clip's weights, including overshoots between the keys of a cubic clip.
#[derive(Debug, Serialize)]
pub struct AnimationReport {
    /// The animation of the file that it is part of.
    pub animation: usize,
    /// Its name, or a default name.
    pub name: String,
    /// Number of keys.
    pub keys: usize,
    /// Its interpolation as the file names it: `LINEAR`, `STEP` or `CUBICSPLINE`.
    pub interpolation: &'static str,
    /// Its length in seconds.
    pub seconds: f32,
    /// One range per target.
    pub weights: Vec<WeightRange>,
    /// Sum of all weights, at the keys and between them.
    pub weight_sum: WeightRange,
}

/// A range of weights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct WeightRange {
    /// The smallest.
    #[serde(serialize_with = "number")]
    pub min: f64,
    /// The largest.
    #[serde(serialize_with = "number")]
    pub max: f64,
}

impl FileAnimationReport {
    pub(super) fn new(index: usize, info: AnimationInfo) -> Self {
        Self {
            index,
            name: info.name,
            seconds: info.seconds,
            meshes: info.meshes,
            nodes_moved: info.nodes,
            channels: info.channels,
            channels_ignored: info.ignored,
            interpolations: info.interpolations,
        }
    }
}

impl AnimationReport {
    pub(super) fn new(clip: &WeightAnimation, animation: usize, interpolation: &'static str, targets: usize) -> Self {
        Self {
            animation,
            name: clip.name.clone(),
            keys: clip.times.len(),
            interpolation,
            seconds: clip.duration(),
            weights: (0..targets).map(|target| WeightRange::of(clip.range(target))).collect(),
            weight_sum: WeightRange::of(clip.range_of_sum()),
        }
    }
}

impl WeightRange {
    /// Zero to zero if there is no weight, because a clip without keys leaves weights at rest.
    pub(super) fn of(range: Option<(f64, f64)>) -> Self {
        let (min, max) = range.unwrap_or_default();
        Self { min, max }
    }

    /// A range that contains both.
    pub(super) fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_animation_is_the_extremes_of_its_keys() {
        let clip = WeightAnimation {
            name: "clip".into(),
            times: vec![0.0, 0.5, 2.0],
            weights: vec![vec![0.25, 1.0], vec![-0.5, 0.5], vec![0.0, 4.0]],
            ..WeightAnimation::default()
        };
        let report = AnimationReport::new(&clip, 3, "LINEAR", 2);
        assert_eq!((report.animation, report.keys, report.seconds), (3, 3, 2.0));
        assert_eq!(
            report.weights,
            [WeightRange { min: -0.5, max: 0.25 }, WeightRange { min: 0.5, max: 4.0 }]
        );
        assert_eq!(report.weight_sum, WeightRange { min: 0.0, max: 4.0 });
    }

    #[test]
    fn a_clip_without_keys_leaves_all_weights_at_zero() {
        let report = AnimationReport::new(&WeightAnimation::default(), 0, "LINEAR", 1);
        assert_eq!(report.weights, [WeightRange { min: 0.0, max: 0.0 }]);
    }
}
