//! What a surface is drawn with: now, and in the last few frames.

use bevy::math::{Affine3A, Vec3};
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;

use super::ahead::rigid_place;
use super::clock::Span;
use super::placed::joints_in;
use super::timeline::{DrawnJoints, Timeline};
use crate::posing::{BindPoses, Skeletons, drawn_weights};

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
    /// Whether its place is what is drawn, and not where a physics engine has it.
    pub(crate) stands_alone: bool,
    /// Whether it is on a body, which a physics engine moves after a step.
    pub(crate) on_body: bool,
    /// Where the last step left it, if it is on a body.
    stopped_at: Option<Affine3A>,
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
            on_body: false,
            stopped_at: None,
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

    /// Says that the game puts it somewhere else: its next change is no motion.
    pub(crate) fn put(&mut self) {
        self.weights.put();
        self.joints.put();
        self.place.put();
    }

    /// Says that time stands still until the next step: what changes until then is no motion.
    pub(crate) fn pause(&mut self) {
        self.weights.pause();
        self.joints.pause();
        self.place.pause();
    }

    /// Compares with the last step while no steps come. What has changed is no motion.
    pub(crate) fn rest(
        &mut self,
        live: &Live,
        count: usize,
        (weights, shared): (Option<&MeshMorphWeights>, &Query<&MorphWeights>),
    ) {
        if let Ok(weights) = drawn_weights(count, weights, shared, &mut Vec::new()) {
            self.weights.rest(&weights.to_vec());
        }
        if let Some(joints) = &live.joints {
            self.joints.rest(joints);
        }
        if self.on_body {
            // The last step saw it before the engine moved the body.
            if *self.stopped_at.get_or_insert(live.place) != live.place {
                self.place.pause();
            }
            self.place.step(&live.place);
        } else {
            self.place.rest(&live.place);
        }
    }

    /// Says where it is drawn. The first place after a step is where the engine left it.
    pub(crate) fn stop_at(&mut self, place: Affine3A) {
        if self.on_body {
            self.stopped_at.get_or_insert(place);
        }
    }

    fn place_follows_frames(&self) -> bool {
        self.stands_alone && self.place.follows_frames()
    }

    /// Declares that only frames change it, not steps.
    pub(crate) fn follow_frames(&mut self) {
        self.weights.follow_frames();
        self.joints.follow_frames();
        self.place.follow_frames();
    }

    /// Updates it with what a step finds.
    pub(crate) fn at_step(&mut self, live: &Live) {
        self.stopped_at = None;
        self.place.step(&live.place);
        if let Some(joints) = &live.joints {
            self.joints.step(joints);
        }
    }

    pub(crate) fn weights_at_step(&mut self, weights: &[f32]) {
        self.weights.step(&weights.to_vec());
    }

    /// Whether something that the coming step uses directly has changed without motion. The caller knows whether its shape and its
    /// place have changed.
    pub(crate) fn is_put_in_step(&mut self, reshaped: bool, moved: bool) -> bool {
        let weights = self.weights.is_put_in_step(reshaped) && !self.weights.follows_frames();
        let joints = self.joints.is_put_in_step(reshaped) && !self.joints.follows_frames();
        let place = self.place.is_put_in_step(moved) && self.has_live_place();
        weights || joints || place
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
        self.weights.follows_frames() || self.joints.follows_frames() || self.place_follows_frames()
    }

    /// Whether its place is used directly.
    pub(crate) fn has_live_place(&self) -> bool {
        !self.place_follows_frames()
    }

    /// Whether it was put elsewhere between two times.
    pub(crate) fn is_put_between(&self, begin: f64, end: f64) -> bool {
        self.weights.follows_frames() && self.weights.is_put_between(begin, end)
            || self.joints.follows_frames() && self.joints.is_put_between(begin, end)
            || self.place_follows_frames() && self.place.is_put_between(begin, end)
    }

    /// Forgets frames that steps from this time on do not need.
    pub(crate) fn forget_before(&mut self, time: f64) {
        self.weights.forget_before(time);
        self.joints.forget_before(time);
        self.place.forget_before(time);
    }

    /// The times of the frames around a step, and of one frame before them. If it was put elsewhere before the step, they begin
    /// right after that.
    pub(crate) fn frames_around(&self, span: Span) -> Vec<f64> {
        let mut times: Vec<f64> = Vec::new();
        if self.weights.follows_frames() {
            times.extend(self.weights.frames_around(span.begin, span.end));
        }
        if self.joints.follows_frames() {
            times.extend(self.joints.frames_around(span.begin, span.end));
        }
        if self.place_follows_frames() {
            times.extend(self.place.frames_around(span.begin, span.end));
        }
        let puts = [
            self.weights.last_put(span.begin),
            self.joints.last_put(span.begin),
            self.place.last_put(span.begin),
        ];
        if let Some(put) = puts.into_iter().flatten().max_by(f64::total_cmp) {
            times.retain(|&time| time > put);
            times.push(put.next_up());
        }
        times.sort_unstable_by(f64::total_cmp);
        times.dedup();
        times
    }
}
