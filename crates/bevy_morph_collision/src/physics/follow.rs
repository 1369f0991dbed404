//! Where a surface is and was: at the end of the coming step, of the last one, and of the one before.

use std::sync::Arc;

use bevy::math::DVec3;
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::prelude::*;
use morph_collision::{Aabb, Body, MorphBvh, Pose, ShapeQuery, WorldFromModel};
use parry3d::bounding_volume::Aabb as ParryAabb;

use super::ahead::Ahead;
use super::clock::{Span, StepTime};
use super::drawn::{Drawn, Live};
use super::layout::MeshLayout;
use super::moment::{Moment, coordinates, displacement, posed_vertices};
use super::motion::{between, continuous};
use super::placed::{region, world_bounds};
use super::surface::MorphSurface;
use crate::posing::take_weights;

/// The last moments of a surface. Its current state is in the [`MorphSurface`] that Rapier has.
pub(crate) struct Following {
    pub(crate) surface: MorphSurface,
    /// Its place at the end of the coming step.
    pub(crate) world_from_model: WorldFromModel,
    /// Its state one step earlier. Valid only if it moves.
    pub(crate) before: Moment,
    /// Its state two steps earlier. Valid only if it also moved then.
    pub(crate) past: Moment,
    /// Whether it moves during the coming step.
    pub(crate) moves: bool,
    /// Whether that is no motion: it was put elsewhere, or has changed while time stood still.
    jumps: bool,
    /// Its place one step before `before`, and the length of that step, if there was one and it moved.
    place_before: Option<(WorldFromModel, f64)>,
    /// Whether its shape has changed, in its collider's space.
    pub(crate) reshaped: bool,
    /// The time that its motion in the last step took, if it moved in that step.
    pub(crate) moved_for: Option<f64>,
    /// The maximum change of a velocity per second, in world units per second. A faster change may be a jump.
    pub(crate) max_acceleration: f32,
    /// The maximum distance that any vertex moves during the coming step, in world units.
    pub(crate) displacement: f64,
    /// The sum of all displacements so far.
    pub(crate) travelled: f64,
    last_step: f32,
    /// How much of its change is motion in that step.
    share: f64,
    /// Whether a dynamic body carries it. All moments then use the place of the body at the start of the step, so only changes of
    /// shape move it.
    carried: bool,
    /// What it is drawn with.
    pub(crate) drawn: Drawn,
    /// The span of drawn frames that the coming step uses, if it looks between frames.
    span: Option<Span>,
    /// Whether it is skinned and has had no joints yet.
    lacks_joints: bool,
    rest: Vec<f32>,
    complaint: Option<String>,
}

impl Following {
    /// Starts at rest. The first step determines where it is.
    pub(crate) fn new(entity: Entity, bvh: &Arc<MorphBvh>, weights: &[f32], layout: &Arc<MeshLayout>) -> Self {
        let moment = || {
            let mut pose = Pose::new(bvh.clone());
            // They come from a pose of the same tree.
            let _fits = pose.set_weights(weights);
            pose
        };
        let still = |pose| Moment {
            pose,
            world_from_model: WorldFromModel::IDENTITY,
        };
        Self {
            surface: MorphSurface::new(entity, moment(), WorldFromModel::IDENTITY, layout.clone()),
            world_from_model: WorldFromModel::IDENTITY,
            before: still(moment()),
            past: still(moment()),
            moves: false,
            jumps: false,
            place_before: None,
            reshaped: true,
            moved_for: None,
            // The first step sets it.
            max_acceleration: f32::INFINITY,
            displacement: 0.0,
            travelled: 0.0,
            last_step: 0.0,
            share: 1.0,
            carried: false,
            drawn: Drawn::new(moment().bounds().center()),
            span: None,
            lacks_joints: bvh.model().joint_count().is_some(),
            rest: Vec::new(),
            complaint: None,
        }
    }

    /// The length of the coming step, or of the last one; 0 before the first.
    pub(crate) fn last_step(&self) -> f32 {
        self.last_step
    }

    /// The time in which it would change as in the coming step, if all of that change were motion.
    pub(crate) fn motion_time(&self) -> f64 {
        f64::from(self.last_step) / self.share
    }

    /// The maximum change of a velocity in the coming step.
    pub(crate) fn velocity_limit(&self) -> f64 {
        f64::from(self.max_acceleration * self.last_step)
    }

    /// Whether joints move the mesh.
    pub(crate) fn is_skinned(&self) -> bool {
        self.before.pose.joints().is_some()
    }

    /// Whether it has no place yet, because its joints have none.
    pub(crate) fn lacks_joints(&self) -> bool {
        self.lacks_joints
    }

    /// Makes the next step the first one: changes until then do not count as motion. The caller must also forget everything about
    /// its surroundings.
    pub(crate) fn restart(&mut self) {
        self.last_step = 0.0;
        // Otherwise, a frame near infinity would make `travelled` infinite, or too large to add to.
        self.travelled = 0.0;
        self.moves = false;
        self.drawn.forget();
    }

    /// Records what a frame is drawn with, at a time of the clock of physics.
    pub(crate) fn record(
        &mut self,
        time: f64,
        live: &Live,
        weights: (Option<&MeshMorphWeights>, &Query<&MorphWeights>),
    ) {
        let count = self.before.pose.weights().len();
        self.drawn.record(time, live, count, weights, self.max_acceleration);
    }

    /// Notices what changes while no steps come. That is no motion.
    pub(crate) fn rest(&mut self, live: &Live, weights: (Option<&MeshMorphWeights>, &Query<&MorphWeights>)) {
        let count = self.before.pose.weights().len();
        self.drawn.rest(live, count, weights);
    }

    /// Whether it moves and does not jump as a whole.
    pub(crate) fn is_in_motion(&self) -> bool {
        self.moves && !self.jumps
    }

    /// Advances to the end of a step. If weights cannot be used, returns what is wrong, once; the last valid ones
    /// stay in use.
    ///
    /// With a `span`, values that frames change are as drawn at its end, and before the step as drawn at its start.
    pub(crate) fn advance(
        &mut self,
        weights: Option<&MeshMorphWeights>,
        shared: &Query<&MorphWeights>,
        ahead: Ahead,
        time: StepTime,
    ) -> Result<(), String> {
        let StepTime { dt, span, share } = time;
        let Ahead {
            world_from_model,
            collider_from_model,
            joints,
            mirrored,
            carried,
        } = ahead;
        // If a body has just become dynamic, or stopped being dynamic, that has not moved the surface.
        let same_carrier = std::mem::replace(&mut self.carried, carried) == carried;
        let last_end = std::mem::replace(&mut self.span, span).map(|span| span.end);
        let first = self.last_step == 0.0 || (self.lacks_joints && joints.is_some());
        self.lacks_joints &= joints.is_none();
        self.moved_for = self.is_in_motion().then(|| self.motion_time());
        self.place_before = self
            .moved_for
            .map(|last_step| (self.before.world_from_model, last_step));
        self.last_step = dt;
        self.share = share;
        self.moves = false;
        self.jumps = false;
        self.reshaped = first;
        self.displacement = 0.0;
        let mut posed = self.surface.lock();
        // Reuse the oldest pose for the newest.
        let taken = take_weights(&mut self.past.pose, weights, shared, &mut self.rest);
        match &taken {
            Ok(_) => self.drawn.weights_at_step(self.past.pose.weights()),
            Err(_) => {
                let _fits = self.past.pose.set_weights(posed.pose.weights());
            }
        }
        // The collider reports a wrong number of weights once it is clear that it will stay.
        let complaint = taken.err().filter(|problem| !problem.is_count());
        let complaint = complaint.map(|problem| problem.to_string());
        // The collider also reports invalid joints.
        let joints = joints.filter(|joints| self.past.pose.set_joints(joints).is_ok());
        let mirrored = if joints.is_none() && self.past.pose.joints().is_some() {
            posed.mirrored
        } else {
            mirrored
        };
        if let Some(between_frames) = span.and_then(|span| self.drawn.weights.at(span.end)) {
            let _fits = self.past.pose.set_weights(&between_frames);
        }
        if let (None, Some(last)) = (joints, posed.pose.joints()) {
            let _fits = self.past.pose.set_joints(last);
        }
        let mut same_shape = self.past.pose.weights() == posed.pose.weights();
        if same_shape && self.past.pose.joints() != posed.pose.joints() {
            // Rounding errors from removing the collider's place are not a change.
            let size = coordinates(&mut posed.pose, &world_from_model);
            same_shape =
                !first && size.is_finite() && self.past.pose.displacement_from_pose(&mut posed.pose) <= 1e-6 * size;
        }
        if first && self.past.pose.joints().is_some() {
            // Until now it was in its bind pose.
            posed.forget_mass();
        }
        if carried {
            self.world_from_model = world_from_model;
            self.before.world_from_model = world_from_model;
        }
        let moved = world_from_model != self.world_from_model;
        let is_put = self.drawn.is_put_in_step(!same_shape, moved);
        if !same_shape || moved {
            self.moves = !first && same_carrier;
            self.reshaped |= !same_shape;
            std::mem::swap(&mut self.past, &mut self.before);
            // `before` now holds the new pose. Swap it with the pose of the surface, which becomes the previous one.
            std::mem::swap(&mut self.before.pose, &mut posed.pose);
            self.before.world_from_model = self.world_from_model;
            self.world_from_model = world_from_model;
            if self.moves {
                let follows = |(span, end): (Span, f64)| if span.follows(end) { end } else { span.begin };
                self.jumps = is_put
                    || span.is_some_and(|span| {
                        let begin = last_end.map_or(span.begin, |end| follows((span, end)));
                        self.drawn.is_put_between(begin, span.end)
                    });
                self.displacement = displacement(&mut self.before, &posed.pose, &world_from_model);
                if let Some(span) = span.filter(|_| self.drawn.follows_frames()) {
                    self.moved_for = None;
                    if last_end.is_none_or(|end| !span.follows(end)) {
                        // Changes since the last step, before this span, are not motion.
                        self.before.see(&self.drawn, span.begin);
                        let seen = displacement(&mut self.before, &posed.pose, &world_from_model);
                        self.displacement = self.displacement.max(seen);
                    }
                }
                self.travelled += self.displacement;
            }
        }
        if carried {
            self.past.world_from_model = world_from_model;
        }
        if let Some(span) = span {
            self.drawn.forget_before(span.begin);
        }
        self.reshaped |= posed.place(collider_from_model, mirrored);
        drop(posed);
        if self.complaint == complaint {
            return Ok(());
        }
        self.complaint = complaint;
        self.complaint.clone().map_or(Ok(()), Err)
    }

    /// Whether vertices move continuously, through the frames that a step covers, from the frame before.
    ///
    /// A frame that changes a velocity by more than `max_acceleration` allows is a jump and not motion, however many steps it
    /// covers.
    pub(crate) fn goes_on(&mut self, vertices: &[u32]) -> bool {
        let Some(span) = self.span else { return true };
        if !self.place_goes_on(vertices) {
            return false;
        }
        let (mut earlier, mut before): (Option<Vec<DVec3>>, Option<(f64, Vec<DVec3>)>) = (None, None);
        // If a body carries it, only what it is drawn with counts.
        self.past.world_from_model = self.world_from_model;
        let posed = self.surface.lock();
        let _fits = self.past.pose.set_weights(posed.pose.weights());
        if let Some(joints) = posed.pose.joints() {
            let _fits = self.past.pose.set_joints(joints);
        }
        drop(posed);
        for time in self.drawn.frames_around(span) {
            self.past.see(&self.drawn, time);
            let mut now = Vec::new();
            self.past.vertices(vertices, &mut now);
            if let Some((last, before)) = &before {
                let frame = time - last;
                let mut velocities = Vec::new();
                between(before, &now, frame, &mut velocities);
                let is_seen = time > span.begin;
                if is_seen
                    && !continuous(
                        &velocities,
                        earlier.as_deref(),
                        f64::from(self.max_acceleration) * frame,
                    )
                {
                    return false;
                }
                earlier = Some(velocities);
            }
            before = Some((time, now));
        }
        true
    }

    /// Whether vertices move continuously with a place that frames do not change, such as that of a body.
    fn place_goes_on(&mut self, vertices: &[u32]) -> bool {
        let places = [self.world_from_model, self.before.world_from_model];
        if !self.drawn.has_live_place() || places[0] == places[1] {
            return true;
        }
        let earlier = self.place_before.filter(|_| !self.carried);
        let mut posed = self.surface.lock();
        let mut at = |place: &WorldFromModel| {
            let mut points = Vec::new();
            posed_vertices(&mut posed.pose, place, vertices, &mut points);
            points
        };
        let velocities = |from: &[DVec3], to: &[DVec3], dt: f64| {
            let mut velocities = Vec::new();
            between(from, to, dt, &mut velocities);
            velocities
        };
        let [now, before] = [&places[0], &places[1]].map(&mut at);
        let earlier = earlier.map(|(place, dt)| velocities(&at(&place), &before, dt));
        let limit = self.velocity_limit();
        let velocities = velocities(&before, &now, f64::from(self.last_step));
        continuous(&velocities, earlier.as_deref(), limit)
    }

    /// Whether vertices move and do not jump. `before` are their positions before the step, and `velocities` those to the end of it.
    pub(crate) fn is_motion(&mut self, vertices: &[u32], before: &[DVec3], velocities: &[DVec3]) -> bool {
        if self.looks_between_frames() {
            return self.goes_on(vertices);
        }
        let limit = self.velocity_limit();
        if continuous(velocities, None, limit) {
            return true;
        }
        let Some(time) = self.moved_for else { return false };
        let (mut past, mut earlier) = (Vec::new(), Vec::new());
        self.past.vertices(vertices, &mut past);
        between(&past, before, time, &mut earlier);
        continuous(velocities, Some(&earlier), limit)
    }

    /// Whether the coming step uses values between frames.
    pub(crate) fn looks_between_frames(&self) -> bool {
        self.span.is_some() && self.drawn.follows_frames()
    }

    /// The surface at the start of the coming step, and its place: in world space, or for a skinned mesh that of its collider.
    pub(crate) fn at_begin<T>(&mut self, ask: impl FnOnce(&mut Pose, &WorldFromModel) -> T) -> T {
        if self.moves {
            let Moment { pose, world_from_model } = &mut self.before;
            ask(pose, world_from_model)
        } else {
            ask(&mut self.surface.lock().pose, &self.world_from_model)
        }
    }

    /// The maximum distance that any vertex has travelled before the coming step.
    pub(crate) fn travelled_before(&self) -> f64 {
        self.travelled - if self.moves { self.displacement } else { 0.0 }
    }

    /// A box around the surface during the coming step.
    pub(crate) fn bounds(&mut self) -> Aabb {
        let now = world_bounds(&mut self.surface.lock().pose, &self.world_from_model);
        if !self.moves {
            return now;
        }
        let Moment { pose, world_from_model } = &mut self.before;
        now.union(&world_bounds(pose, world_from_model))
    }

    /// Appends the triangles that intersect a world-space box at the end of the coming step.
    pub(crate) fn triangles_in(&mut self, bounds: &ParryAabb, query: &mut ShapeQuery, into: &mut Vec<u32>) {
        let mut posed = self.surface.lock();
        if let Ok(region) = region(bounds, &posed.pose, &self.world_from_model) {
            let body = Body::new(&mut posed.pose, &self.world_from_model);
            query.all_in_region(body, &region, into);
        }
    }

    /// The positions of vertices in world space at the end of the coming step.
    pub(crate) fn vertices(&mut self, vertices: &[u32], into: &mut Vec<DVec3>) {
        posed_vertices(&mut self.surface.lock().pose, &self.world_from_model, vertices, into);
    }
}
