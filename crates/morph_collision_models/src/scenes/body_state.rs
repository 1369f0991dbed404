//! A body in one frame of a scene.

use glam::{Affine3A, Quat, Vec3};
use serde::{Deserialize, Serialize};

use crate::weight_list::WeightList;

/// A body's placement and shape in one frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyState {
    /// One weight per target, or weights by name. Targets without a weight have that of the clip, or without a clip their default
    /// weight.
    #[serde(default, skip_serializing_if = "WeightList::is_empty")]
    pub weights: WeightList,
    /// A unit quaternion `x, y, z, w`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotation: Option<[f32; 4]>,
    /// The model's origin in world space.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub translation: Option<[f32; 3]>,
    /// Factors along the model's axes; 0 and negative factors are allowed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scale: Option<[f32; 3]>,
    /// The name of a clip of the model, or of a clip of another file: `FILE#NAME`, relative to the scene's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clip: Option<String>,
    /// The time in the clip, in seconds; 0 by default. The first pose holds before the clip, and the last one after it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<f32>,
    /// A comment, for people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub comment: Option<String>,
}

impl BodyState {
    /// A state from weights and a rigid placement; the scale is left out.
    pub fn rigid(weights: &[f32], world_from_model: &Affine3A) -> Self {
        let (_, rotation, translation) = world_from_model.to_scale_rotation_translation();
        // Six digits are enough and keep files small.
        let round6 = |value: f32| crate::generated::round6(f64::from(value));
        Self {
            weights: WeightList::All(weights.to_vec()),
            rotation: Some(rotation.to_array().map(round6)),
            translation: Some(translation.to_array().map(round6)),
            ..Self::default()
        }
    }

    /// Scale, then rotation (normalized), then translation.
    pub fn world_from_model(&self) -> Affine3A {
        Affine3A::from_scale_rotation_translation(
            self.scale.map_or(Vec3::ONE, Vec3::from_array),
            self.rotation
                .map_or(Quat::IDENTITY, |xyzw| Quat::from_array(xyzw).normalize()),
            self.translation.map_or(Vec3::ZERO, Vec3::from_array),
        )
    }

    /// All numbers with the names of their lists in the format, and their indices there.
    pub(super) fn numbers(&self) -> impl Iterator<Item = (&'static str, usize, f32)> {
        let placement = [
            ("rotation", self.rotation.as_ref().map_or(&[][..], |list| list)),
            ("translation", self.translation.as_ref().map_or(&[][..], |list| list)),
            ("scale", self.scale.as_ref().map_or(&[][..], |list| list)),
            ("time", self.time.as_slice()),
        ];
        let placement = placement.into_iter().flat_map(|(what, list)| {
            let indexed = list.iter().enumerate();
            indexed.map(move |(index, &value)| (what, index, value))
        });
        let weights = self.weights.values().enumerate();
        weights.map(|(index, value)| ("weights", index, value)).chain(placement)
    }
}
