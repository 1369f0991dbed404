//! The drawn positions of vertices, according to the file's own clips.

use bevy::animation::ActiveAnimation;
use bevy::math::{Affine3A, DVec3};
use bevy::prelude::*;
use morph_collision_models::clip::WeightAnimation;
use morph_collision_models::skeleton::JointClip;
use morph_collision_testkit::oracle::{posed_vertices, skinned_vertices};
use morph_collision_workspace::drawn;

use super::{Part, Stage};

impl Stage {
    fn global(&self, entity: Entity) -> Affine3A {
        self.app.world().get::<GlobalTransform>(entity).unwrap().affine()
    }

    /// The drawn positions of a part's vertices: with the app's joints, and everything else from the file.
    pub(super) fn vertices(&self, part: &Part) -> Vec<DVec3> {
        drawn::vertices(self.app.world(), &self.meshes[part.mesh], part.entity)
    }

    /// The same by the file's own clip, evaluated here; `None` if the clip has ended.
    pub(super) fn vertices_by_clip(&self, part: &Part, clip: &str) -> Option<Vec<DVec3>> {
        let mesh = &self.meshes[part.mesh];
        let skin = mesh.skin.as_ref()?;
        let seconds = self.seconds(part.root)?;
        let clip_of_joints = skin.skeleton.clip(clip);
        let clip_of_weights = mesh.animations.iter().find(|animation| animation.name == clip);
        let durations = [
            clip_of_joints.map(JointClip::duration),
            clip_of_weights.map(WeightAnimation::duration),
        ];
        if durations.into_iter().flatten().any(|duration| seconds >= duration) {
            return None;
        }
        let weights = clip_of_weights.map_or_else(
            || drawn::weights(self.app.world(), part.entity),
            |clip| clip.sample(seconds),
        );
        let posed = posed_vertices(&mesh.positions, &mesh.targets, &weights);
        let root = self.global(part.root);
        let joints = skin.skeleton.world_from_mesh(clip_of_joints, seconds);
        let joints: Vec<Affine3A> = joints.into_iter().map(|joint| root * joint).collect();
        Some(skinned_vertices(&posed, &skin.sets, &joints))
    }

    /// The current time of a clip played below a root.
    pub(super) fn seconds(&self, root: Entity) -> Option<f32> {
        let world = self.app.world();
        let mut below = vec![root];
        while let Some(entity) = below.pop() {
            if let Some(player) = world.get::<AnimationPlayer>(entity) {
                return player
                    .playing_animations()
                    .next()
                    .map(|(_, active): (_, &ActiveAnimation)| active.seek_time());
            }
            below.extend(world.get::<Children>(entity).into_iter().flatten());
        }
        None
    }
}
