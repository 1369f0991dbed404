//! What a surface is drawn with: now, and in the last few frames.

use bevy::math::{Affine3A, Vec3};
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;

use super::ahead::rigid_place;
use super::clock::Span;
use super::placed::joints_in;
use super::timeline::{DrawnJoints, Timeline};
use crate::skeletons::{BindPoses, Skeletons};
use crate::weights::drawn_weights;

/// The components that determine what a surface is drawn with.
pub(crate) type Shows = (
    &'static GlobalTransform,
    Option<&'static MeshMorphWeights>,
    Option<&'static SkinnedMesh>,
);

/// The current transform of a surface's entity, and its joints.
pub(crate) struct Live {
    pub(crate) place: Affine3A,
    /// `None` for a mesh without joints, or with invalid joints: the collider reports those, and the last valid ones stay in use.
    pub(crate) joints: Option<DrawnJoints>,
}

/// What a surface was drawn with in the last few frames.
pub(crate) struct Drawn {
    pub(crate) weights: Timeline<Vec<f32>>,
    pub(crate) joints: Timeline<DrawnJoints>,
    pub(crate) place: Timeline<Affine3A>,
    /// Whether no body carries it.
    pub(crate) stands_alone: bool,
    /// The middle of the mesh in its bind pose.
    middle: Vec3,
}

impl Drawn {
    pub(crate) fn new(middle: Vec3) -> Self {
        Self {
            weights: Timeline::default(),
            joints: Timeline::default(),
            place: Timeline::default(),
            stands_alone: true,
            middle,
        }
    }

    pub(crate) fn forget(&mut self) {
        *self = Self::new(self.middle);
    }

    /// Reads the current transform of an entity and its joints.
    pub(crate) fn live(
        &self,
        place: &GlobalTransform,
        skin: Option<&SkinnedMesh>,
        skeletons: &mut Skeletons,
        bind_poses: Option<&BindPoses>,
        globals: &Query<&GlobalTransform>,
    ) -> Live {
        let global_of = |joint: Entity| Some(globals.get(joint).ok()?.affine());
        let joints = skin.and_then(|skin| {
            let joints = skeletons.of(skin, bind_poses, global_of).world_from_mesh()?;
            Some(DrawnJoints {
                matrices: joints_in(&rigid_place(place), joints),
                middle: self.middle,
            })
        });
        Live {
            place: place.affine(),
            joints,
        }
    }

    /// Records what a frame is drawn with. Weights that cannot be used are skipped.
    pub(crate) fn record(
        &mut self,
        time: f64,
        live: &Live,
        count: usize,
        (weights, shared): (Option<&MeshMorphWeights>, &Query<&MorphWeights>),
        max_acceleration: f32,
    ) {
        if let Ok(weights) = drawn_weights(count, weights, shared, &mut Vec::new())
            && weights.len() == count
            && weights.iter().all(|weight| weight.is_finite())
        {
            self.weights.record(time, &weights.to_vec(), max_acceleration);
        }
        if let Some(joints) = &live.joints {
            self.joints.record(time, joints, max_acceleration);
        }
        if live.place.is_finite() {
            self.place.record(time, &live.place, max_acceleration);
        }
    }

    /// Declares that only frames change it, not steps.
    pub(crate) fn follow_frames(&mut self) {
        self.weights.follow_frames();
        self.joints.follow_frames();
        self.place.follow_frames();
    }

    /// Updates it with what a step finds.
    pub(crate) fn at_step(&mut self, live: &Live) {
        self.place.step(&live.place);
        if let Some(joints) = &live.joints {
            self.joints.step(joints);
        }
    }

    pub(crate) fn weights_at_step(&mut self, weights: &[f32]) {
        self.weights.step(&weights.to_vec());
    }

    /// What is drawn at some time, for values that frames change.
    pub(crate) fn at(&self, time: f64, live: Live) -> Live {
        Live {
            place: self.place.at(time).unwrap_or(live.place),
            joints: live.joints.map(|joints| self.joints.at(time).unwrap_or(joints)),
        }
    }

    /// Whether frames change any of it.
    pub(crate) fn follows_frames(&self) -> bool {
        self.weights.follows_frames()
            || self.joints.follows_frames()
            || self.stands_alone && self.place.follows_frames()
    }

    /// The times of the frames around a step, and of one frame before them.
    pub(crate) fn frames_around(&self, span: Span) -> Vec<f64> {
        let mut times: Vec<f64> = Vec::new();
        if self.weights.follows_frames() {
            times.extend(self.weights.frames_around(span.begin, span.end));
        }
        if self.joints.follows_frames() {
            times.extend(self.joints.frames_around(span.begin, span.end));
        }
        if self.stands_alone && self.place.follows_frames() {
            times.extend(self.place.frames_around(span.begin, span.end));
        }
        times.sort_unstable_by(f64::total_cmp);
        times.dedup();
        times
    }
}
