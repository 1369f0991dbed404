//! What a surface is drawn with: now, and in the last few frames.

use bevy::ecs::query::QueryData;
use bevy::math::{Affine3A, Vec3};
use bevy::mesh::morph::MeshMorphWeights;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::prelude::*;
use bevy_morph_collision::physics_api::CurrentSkeletons;
use morph_collision::{InputError, JointMatrices};

use super::clock::Span;
use super::timeline::Timeline;
use super::weights::WeightSource;
use crate::math::rigid_part;
use crate::posing::SurfaceJoints;

/// The components that determine what a surface is drawn with.
#[derive(QueryData)]
pub struct SurfaceComponents {
    /// Where its entity is drawn.
    pub transform: &'static GlobalTransform,
    /// The weights of its targets.
    pub weights: Option<&'static MeshMorphWeights>,
    /// Its joints.
    pub skin: Option<&'static SkinnedMesh>,
}

/// The current transform of a surface's entity, and its joints.
pub struct Live {
    /// The transform of its entity.
    pub transform: Affine3A,
    /// `None` for a mesh without joints, or with invalid joints: the collider reports those, and the last valid ones stay in use. An error
    /// if they are valid in the world, but not in the space of the collider.
    pub joints: Result<Option<SurfaceJoints>, InputError>,
}

/// What a surface was drawn with in the last few frames.
pub struct DrawnHistory {
    /// The weights of its targets.
    pub weights: Timeline<Vec<f32>>,
    /// Its joints.
    pub joints: Timeline<SurfaceJoints>,
    /// The transform of its entity.
    pub transform: Timeline<Affine3A>,
    /// Whether its transform is what is drawn, and not where a physics engine has it.
    pub stands_alone: bool,
    /// Whether it is on a body, which a physics engine moves after a step.
    pub on_body: bool,
    /// Where the last step left it, if it is on a body.
    stopped_at: Option<Affine3A>,
    /// The middle of the mesh in its bind pose.
    middle: Vec3,
    /// The joints that were last read. A frame and the step after it often find the same.
    last_read: Option<SurfaceJoints>,
    /// Scratch memory.
    read_weights: Vec<f32>,
}

impl DrawnHistory {
    /// Nothing has been drawn yet.
    pub fn new(middle: Vec3) -> Self {
        Self {
            weights: Timeline::default(),
            joints: Timeline::default(),
            transform: Timeline::default(),
            stands_alone: true,
            on_body: false,
            stopped_at: None,
            middle,
            last_read: None,
            read_weights: Vec::new(),
        }
    }

    /// The middle of the mesh in its bind pose.
    pub fn middle(&self) -> Vec3 {
        self.middle
    }

    /// Forgets everything.
    pub fn forget(&mut self) {
        *self = Self::new(self.middle);
    }

    /// Reads the current transform of an entity and its joints.
    pub fn live(
        &mut self,
        transform: &GlobalTransform,
        skin: Option<&SkinnedMesh>,
        skeletons: &mut CurrentSkeletons,
    ) -> Live {
        let joints = skin.and_then(|skin| skeletons.of(skin).current_matrices());
        Live {
            transform: transform.affine(),
            joints: joints.map(|joints| self.read(joints, transform)).transpose(),
        }
    }

    /// Joints that are drawn now, with a collider at this transform.
    fn read(&mut self, joints: &JointMatrices, transform: &GlobalTransform) -> Result<SurfaceJoints, InputError> {
        let joints = SurfaceJoints::drawn(joints.clone(), rigid_part(transform), self.middle)?;
        // If they are the same, what was computed for them stays.
        let last = self.last_read.take().filter(|last| last.is_drawn_as(&joints));
        Ok(self.last_read.insert(last.unwrap_or(joints)).clone())
    }

    /// Records what a frame is drawn with. Weights that cannot be used are skipped.
    pub fn record(&mut self, time: f64, live: &Live, weights: &WeightSource, count: usize, max_acceleration: f32) {
        if weights.read(count, &mut self.read_weights).is_ok()
            && self.read_weights.len() == count
            && self.read_weights.iter().all(|weight| weight.is_finite())
        {
            self.weights.record(time, &self.read_weights, max_acceleration);
        }
        if let Ok(Some(joints)) = &live.joints {
            self.joints.record(time, joints, max_acceleration);
        }
        if live.transform.is_finite() {
            self.transform.record(time, &live.transform, max_acceleration);
        }
    }

    /// Says that the game puts it somewhere else: its next change is no motion.
    pub fn teleport(&mut self) {
        self.weights.teleport();
        self.joints.teleport();
        self.transform.teleport();
    }

    /// Says that time stands still until the next step: what changes until then is no motion.
    pub fn pause(&mut self) {
        self.weights.pause();
        self.joints.pause();
        self.transform.pause();
    }

    /// Compares with the last step while no steps come. What has changed is no motion.
    pub fn rest(&mut self, live: &Live, weights: &WeightSource, count: usize) {
        if weights.read(count, &mut self.read_weights).is_ok() {
            self.weights.rest(&self.read_weights);
        }
        if let Ok(Some(joints)) = &live.joints {
            self.joints.rest(joints);
        }
        if self.on_body {
            // The last step saw it before the engine moved the body.
            if *self.stopped_at.get_or_insert(live.transform) != live.transform {
                self.transform.pause();
            }
            self.transform.step(&live.transform);
        } else {
            self.transform.rest(&live.transform);
        }
    }

    /// Says where it is drawn. The first transform after a step is where the engine left it.
    pub fn stop_at(&mut self, transform: Affine3A) {
        if self.on_body {
            self.stopped_at.get_or_insert(transform);
        }
    }

    fn transform_is_interpolated(&self) -> bool {
        self.stands_alone && self.transform.is_interpolated()
    }

    /// Declares that only frames change it, not steps.
    pub fn interpolate(&mut self) {
        self.weights.interpolate();
        self.joints.interpolate();
        self.transform.interpolate();
    }

    /// Updates it with what a step finds.
    pub fn at_step(&mut self, live: &Live) {
        self.stopped_at = None;
        self.transform.step(&live.transform);
        if let Ok(Some(joints)) = &live.joints {
            self.joints.step(joints);
        }
    }

    /// Updates it with the weights that a step finds.
    pub fn weights_at_step(&mut self, weights: &[f32]) {
        self.read_weights.clear();
        self.read_weights.extend_from_slice(weights);
        self.weights.step(&self.read_weights);
    }

    /// Notices weights that changed after the last step of a frame saw them.
    pub fn weights_after_steps(&mut self, weights: &WeightSource, count: usize) {
        if weights.read(count, &mut self.read_weights).is_ok() {
            self.weights.after_steps(&self.read_weights);
        }
    }

    /// Whether something that the coming step uses directly has changed without motion. The caller knows whether its shape and its
    /// transform have changed.
    pub fn teleports_in_step(&mut self, reshaped: bool, moved: bool) -> bool {
        let weights = self.weights.teleports_in_step(reshaped) && !self.weights.is_interpolated();
        let joints = self.joints.teleports_in_step(reshaped) && !self.joints.is_interpolated();
        let transform = self.transform.teleports_in_step(moved) && self.has_live_transform();
        weights || joints || transform
    }

    /// What is drawn at some time, for values that frames change.
    pub fn at(&self, time: f64, live: Live) -> Live {
        Live {
            transform: self.transform.at(time).unwrap_or(live.transform),
            joints: live
                .joints
                .map(|joints| joints.map(|joints| self.joints.at(time).unwrap_or(joints))),
        }
    }

    /// Whether frames change any of it.
    pub fn is_interpolated(&self) -> bool {
        self.weights.is_interpolated() || self.joints.is_interpolated() || self.transform_is_interpolated()
    }

    /// Whether its transform is used directly.
    pub fn has_live_transform(&self) -> bool {
        !self.transform_is_interpolated()
    }

    /// Whether it was put elsewhere between two times.
    pub fn teleports_between(&self, begin: f64, end: f64) -> bool {
        self.weights.is_interpolated() && self.weights.teleports_between(begin, end)
            || self.joints.is_interpolated() && self.joints.teleports_between(begin, end)
            || self.transform_is_interpolated() && self.transform.teleports_between(begin, end)
    }

    /// Forgets frames that steps from this time on do not need.
    pub fn forget_before(&mut self, time: f64) {
        self.weights.forget_before(time);
        self.joints.forget_before(time);
        self.transform.forget_before(time);
    }

    /// The times of the frames around a step, and of one frame before them. If it was put elsewhere before the step, they begin
    /// right after that.
    pub fn frames_around(&self, span: Span) -> Vec<f64> {
        let mut times: Vec<f64> = Vec::new();
        if self.weights.is_interpolated() {
            times.extend(self.weights.frames_around(span.begin, span.end));
        }
        if self.joints.is_interpolated() {
            times.extend(self.joints.frames_around(span.begin, span.end));
        }
        if self.transform_is_interpolated() {
            times.extend(self.transform.frames_around(span.begin, span.end));
        }
        let teleports = [
            self.weights.last_teleport(span.begin),
            self.joints.last_teleport(span.begin),
            self.transform.last_teleport(span.begin),
        ];
        if let Some(teleport) = teleports.into_iter().flatten().max_by(f64::total_cmp) {
            times.retain(|&time| time > teleport);
            times.push(teleport.next_up());
        }
        times.sort_unstable_by(f64::total_cmp);
        times.dedup();
        times
    }
}
