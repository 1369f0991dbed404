//! A surface that moves: where it is at the end of the coming step, and what has moved it there.

use std::sync::Arc;

use bevy::prelude::*;
use bevy_morph_collision::physics_api::WeightsProblem;
use morph_collision::{Body, MorphBvh, WorldFromModel};

use super::moment::{Moments, coordinates, displacement, pose};
use super::prediction::Prediction;
use crate::posing::SurfaceJoints;
use crate::shape::{MeshLayout, MorphSurface, Posed};
use crate::time::{DrawnHistory, Live, Span, StepTime, WeightSource};

/// The last moments of a surface. Its current pose is in the [`MorphSurface`] that the engine has.
pub struct MovingSurface {
    /// The shape, in the pose at the end of the coming step.
    pub surface: MorphSurface,
    /// Where it is, and was.
    pub moments: Moments,
    /// Whether it moves during the coming step.
    pub moves: bool,
    /// Whether that is no motion: it was teleported, or has changed while time stood still.
    jumps: bool,
    /// Its transform one step before the start of the coming step, and the length of that step, if there was one and it moved.
    pub(super) last_transform: Option<(WorldFromModel, f64)>,
    /// Whether its shape has changed, in its collider's space.
    pub reshaped: bool,
    /// The time that its motion in the last step took, if it moved in that step.
    pub(super) moved_for: Option<f64>,
    /// The maximum change of a velocity per second, in world units per second. A faster change may be a jump.
    pub max_acceleration: f32,
    /// The maximum distance that any vertex moves during the coming step, in world units; `None` until someone asks.
    pub(super) displacement: Option<f64>,
    /// The sum of the displacements that were asked for.
    pub(super) travelled: f64,
    last_step: f32,
    /// How much of its change is motion in that step.
    share: f64,
    /// Whether a dynamic body carries it. All moments then use the transform of the body at the start of the step, so only changes of
    /// shape move it.
    pub(super) carried: bool,
    /// Whether it is on a dynamic body, which moves it.
    pub on_dynamic: bool,
    /// What it is drawn with.
    pub drawn: DrawnHistory,
    /// The span of drawn frames that the coming step uses, if it looks between frames.
    pub(super) span: Option<Span>,
    /// Whether it is skinned and has had no joints yet.
    lacks_joints: bool,
    rest: Vec<f32>,
    /// The last problem with its weights, which is reported once.
    complaint: Option<String>,
}

/// What the span of a step has to do with that of the last one.
struct Spans {
    coming: Option<Span>,
    last_end: Option<f64>,
}

impl Spans {
    /// Whether drawn changes between the two steps are left out.
    fn skip_changes(&self) -> bool {
        self.coming
            .is_some_and(|span| self.last_end.is_none_or(|end| !span.continues(end)))
    }
}

impl MovingSurface {
    /// Starts at rest. The first step determines where it is.
    pub fn new(entity: Entity, bvh: &Arc<MorphBvh>, weights: &[f32], layout: &Arc<MeshLayout>) -> Self {
        let middle = pose(bvh, weights).get().bounds().center();
        Self {
            surface: MorphSurface::new(entity, pose(bvh, weights), WorldFromModel::IDENTITY, layout.clone()),
            moments: Moments::new(bvh, weights),
            moves: false,
            jumps: false,
            last_transform: None,
            reshaped: true,
            moved_for: None,
            // The first step sets it.
            max_acceleration: f32::INFINITY,
            displacement: Some(0.0),
            travelled: 0.0,
            last_step: 0.0,
            share: 1.0,
            carried: false,
            on_dynamic: false,
            drawn: DrawnHistory::new(middle),
            span: None,
            lacks_joints: bvh.model().joint_count().is_some(),
            rest: Vec::new(),
            complaint: None,
        }
    }

    /// The tree of its mesh.
    pub fn bvh(&self) -> &Arc<MorphBvh> {
        self.moments.start.pose.bvh()
    }

    /// The length of the coming step, or of the last one; 0 before the first.
    pub fn last_step(&self) -> f32 {
        self.last_step
    }

    /// The time in which it would change as in the coming step, if all of that change were motion.
    pub fn motion_time(&self) -> f64 {
        f64::from(self.last_step) / self.share
    }

    /// The maximum change of a velocity in the coming step.
    pub fn velocity_limit(&self) -> f64 {
        f64::from(self.max_acceleration * self.last_step)
    }

    /// Whether joints move the mesh.
    pub fn is_skinned(&self) -> bool {
        self.moments.start.pose.is_skinned()
    }

    /// Whether it is nowhere yet, because its joints are nowhere.
    pub fn lacks_joints(&self) -> bool {
        self.lacks_joints
    }

    /// Makes the next step the first one: changes until then do not count as motion. The caller must also forget everything about
    /// its surroundings.
    pub fn restart(&mut self) {
        self.last_step = 0.0;
        // Otherwise, a frame near infinity would make `travelled` infinite, or too large to add to.
        self.travelled = 0.0;
        self.displacement = Some(0.0);
        self.moves = false;
        self.drawn.forget();
    }

    fn target_count(&self) -> usize {
        self.moments.start.pose.weights().len()
    }

    /// Records what a frame is drawn with, at a time of the clock of physics.
    pub fn record(&mut self, time: f64, live: &Live, weights: &WeightSource) {
        let count = self.target_count();
        self.drawn.record(time, live, weights, count, self.max_acceleration);
    }

    /// Notices what changes while no steps come. That is no motion.
    pub fn rest(&mut self, live: &Live, weights: &WeightSource) {
        let count = self.target_count();
        self.drawn.rest(live, weights, count);
    }

    /// Notices weights that changed after the last step of a frame saw them.
    pub fn after_steps(&mut self, weights: &WeightSource) {
        self.drawn.weights_after_steps(weights, self.target_count());
    }

    /// Whether it moves and does not jump as a whole.
    pub fn is_in_motion(&self) -> bool {
        self.moves && !self.jumps
    }

    /// Advances to the end of a step. With a span, values that frames change are as drawn at its end, and before the step as drawn at
    /// its start.
    ///
    /// # Errors
    /// Weights cannot be used, which is reported once; the last valid ones stay in use.
    pub fn advance(
        &mut self,
        weights: &WeightSource,
        prediction: Prediction,
        time: StepTime,
    ) -> Result<(), WeightsProblem> {
        let Prediction {
            world_from_model,
            collider_from_model,
            joints,
            carried,
        } = prediction;
        // If a body has just become dynamic, or stopped being dynamic, that has not moved the surface.
        let same_carrier = std::mem::replace(&mut self.carried, carried) == carried;
        let first = self.last_step == 0.0 || (self.lacks_joints && joints.is_some());
        self.lacks_joints &= joints.is_none();
        let spans = self.begin(time, first);
        let surface = self.surface.clone();
        let mut posed = surface.lock();
        let taken = self.take_weights(weights, &posed);
        self.take_joints(joints, &posed);
        let same_shape = self.keeps_shape(&mut posed, &world_from_model, first);
        if !same_shape && self.may_wait() {
            self.moments.next().find_bounds();
        }
        if first && self.is_skinned() {
            // Until now it was in its bind pose.
            posed.reset_mass();
        }
        if carried {
            self.moments.end = world_from_model;
            self.moments.start.world_from_model = world_from_model;
        }
        let moved = world_from_model != self.moments.end;
        let teleports = self.drawn.teleports_in_step(!same_shape, moved);
        if !same_shape || moved {
            self.moves = !first && same_carrier;
            self.reshaped |= !same_shape;
            self.moments.advance(&mut posed, world_from_model);
            if self.moves {
                self.judge(&mut posed, &spans, teleports);
            }
        }
        if carried {
            self.moments.earlier.world_from_model = world_from_model;
        }
        if let Some(span) = time.span {
            self.drawn.forget_before(span.begin);
        }
        self.reshaped |= posed.set_transform(collider_from_model);
        drop(posed);
        self.complain(taken)
    }

    /// Begins a step, in which nothing has moved yet.
    fn begin(&mut self, time: StepTime, first: bool) -> Spans {
        let last_end = std::mem::replace(&mut self.span, time.span).map(|span| span.end);
        self.moved_for = self.is_in_motion().then(|| self.motion_time());
        self.last_transform = self
            .moved_for
            .map(|last_step| (self.moments.start.world_from_model, last_step));
        self.last_step = time.dt;
        self.share = time.share;
        self.moves = false;
        self.jumps = false;
        self.reshaped = first;
        self.displacement = Some(0.0);
        Spans {
            coming: time.span,
            last_end,
        }
    }

    /// Gives the next pose its weights: those between frames, the current ones, or else the last valid ones.
    fn take_weights(&mut self, weights: &WeightSource, posed: &Posed) -> Result<(), WeightsProblem> {
        let next = self.moments.next();
        let taken = weights.pose(next, &mut self.rest);
        match &taken {
            Ok(_) => self.drawn.weights_at_step(next.weights()),
            Err(_) => {
                let _fits = next.set_weights(posed.pose.weights());
            }
        }
        if let Some(between_frames) = self.span.and_then(|span| self.drawn.weights.at(span.end)) {
            let _fits = next.set_weights(&between_frames);
        }
        taken.map(|_| ())
    }

    /// Gives the next pose its joints: the predicted ones, or else the last valid ones.
    fn take_joints(&mut self, joints: Option<SurfaceJoints>, posed: &Posed) {
        let next = self.moments.next();
        // The collider also reports invalid joints.
        let fit = joints.is_some_and(|joints| next.set_joints(&joints));
        if let (false, Some(last)) = (fit, posed.pose.joints()) {
            next.set_joints(last);
        }
    }

    /// Whether the next pose is the current one.
    fn keeps_shape(&mut self, posed: &mut Posed, world_from_model: &WorldFromModel, first: bool) -> bool {
        let may_wait = self.may_wait();
        let next = self.moments.next();
        if next.weights() != posed.pose.weights() {
            return false;
        }
        let same_joints = match (next.joints(), posed.pose.joints()) {
            (Some(next), Some(now)) => next.is_drawn_as(now),
            (next, now) => next.is_none() && now.is_none(),
        };
        if same_joints {
            return true;
        }
        if first || (may_wait && !posed.pose.is_seen()) {
            // Nobody has looked at the current shape, so nobody keeps anything for it.
            return false;
        }
        // Rounding errors from removing the collider's transform are not a change.
        let size = coordinates(posed.pose.compare(), world_from_model);
        let place = WorldFromModel::IDENTITY;
        let before = Body::new(posed.pose.compare(), &place);
        size.is_finite() && Body::new(next.compare(), &place).moved_at_most(1e-6 * size, before)
    }

    /// Whether its shape may wait until somebody looks at it. A dynamic body could not sleep if its surface seemed to change.
    fn may_wait(&self) -> bool {
        !self.on_dynamic && !self.carried
    }

    /// Finds out whether it jumps. How far it moves is computed when something near it needs that.
    fn judge(&mut self, posed: &mut Posed, spans: &Spans, teleports: bool) {
        let Moments { end, start, .. } = &mut self.moments;
        let span = spans.coming;
        self.jumps = teleports
            || span.is_some_and(|span| {
                let last_end = spans.last_end.filter(|&end| span.continues(end));
                self.drawn.teleports_between(last_end.unwrap_or(span.begin), span.end)
            });
        self.displacement = None;
        if let Some(span) = span.filter(|_| self.drawn.is_interpolated()) {
            self.moved_for = None;
            if spans.skip_changes() {
                let jump = displacement(start, posed.pose.get(), end);
                // Changes since the last step, before this span, are not motion.
                start.set_from_history(&self.drawn, span.begin);
                let displacement = jump.max(displacement(start, posed.pose.get(), end));
                self.displacement = Some(displacement);
                self.travelled += displacement;
            }
        }
    }

    /// Reports a problem with weights once.
    fn complain(&mut self, taken: Result<(), WeightsProblem>) -> Result<(), WeightsProblem> {
        // The collider reports a wrong number of weights once it is clear that it will stay.
        let problem = taken.err().filter(|problem| !problem.is_count());
        // Compared as texts, because NaN differs from itself.
        let complaint = problem.as_ref().map(ToString::to_string);
        if self.complaint == complaint {
            return Ok(());
        }
        self.complaint = complaint;
        problem.map_or(Ok(()), Err)
    }
}
