//! The clip that a skinned mesh plays in its generated scene.

use glam::Affine3A;

use morph_collision_models::clip::WeightAnimation;
use morph_collision_models::clip::looped;
use morph_collision_models::mesh::MorphMesh;
use morph_collision_models::skeleton::{JointClip, Skeleton};

/// Steps per second at which clips are played.
const RATE: f64 = 60.0;

/// The motion of a skinned mesh's joints.
pub(super) struct Played {
    skeleton: Skeleton,
    joints: Option<JointClip>,
    /// The weight clip that belongs to it.
    weights: Option<WeightAnimation>,
}

impl Played {
    /// `None` for a mesh without a skin.
    pub(super) fn of(mesh: &MorphMesh) -> Option<Self> {
        let skeleton = &mesh.skin.as_ref()?.skeleton;
        let fits = |clip: &&WeightAnimation| is_playable(clip, mesh.targets.len());
        let weights = |joints: &JointClip| {
            mesh.animations
                .iter()
                .filter(fits)
                .find(|clip| clip.name == joints.name)
        };
        let both = skeleton.clips.iter().find(|clip| weights(clip).is_some());
        let joints = both.or(skeleton.clips.first());
        Some(Self {
            weights: joints.and_then(weights).cloned(),
            joints: joints.cloned(),
            skeleton: skeleton.clone(),
        })
    }

    /// The time in the clip's loops at a step, for a body at a share of the clip.
    fn seconds(&self, step: usize, own: f64) -> f32 {
        let duration = self.joints.as_ref().map_or(0.0, JointClip::duration);
        (step as f64 / RATE + own * f64::from(duration)) as f32
    }

    /// The joint matrices at a step.
    pub(super) fn joints(&self, step: usize, own: f64) -> Vec<Affine3A> {
        let length = self.joints.as_ref().map_or(0.0, JointClip::duration);
        let seconds = looped(self.seconds(step, own), length);
        self.skeleton.world_from_mesh(self.joints.as_ref(), seconds)
    }

    /// The weights at a step, if the clip moves them.
    pub(super) fn weights(&self, step: usize, own: f64) -> Option<Vec<f32>> {
        let clip = self.weights.as_ref()?;
        Some(clip.sample(looped(self.seconds(step, own), clip.duration())))
    }
}

/// Whether a clip has keys, with one weight per target.
pub(super) fn is_playable(clip: &WeightAnimation, targets: usize) -> bool {
    !clip.weights.is_empty() && clip.weights.iter().all(|weights| weights.len() == targets)
}
