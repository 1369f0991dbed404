//! What has got inside a solid surface, and where it is to leave.
//!
//! Contacts push out what reaches into a surface by less than half of itself. They leave alone what is in deeper: its middle is
//! behind every triangle. It is driven out by its velocity instead, as fast as the engine pushes bodies apart.

use std::hash::Hash;

use bevy::math::{DVec3, Vec3};
use bevy::platform::collections::HashMap;
use morph_collision::{Body, Pose, RayQuery, ShapeQuery, WorldFromModel};
use parry3d::math::Pose as Place;
use parry3d::shape::Shape;

use super::follow::Following;
use super::inside::Probe;
use super::part::Pace;
use super::placed::into_query;
use super::point::SurfacePoint;

/// How deep a point on the outside of something may be inside, relative to half the smallest extent of that, while it counts as lying on the surface.
const SLACK: f64 = 0.5;

/// How fast something leaves, as a share of how fast it may be driven while it is deep inside.
const AT_THE_DOOR: f64 = 0.3;

/// Who is inside a solid surface. `C` is what a physics engine knows colliders by.
pub(crate) struct Expelling<C> {
    known: HashMap<C, Known>,
    /// How the mesh is placed in the space that all of this is in, if that is its collider's and not the world.
    in_collider: Option<WorldFromModel>,
    step: u32,
    shapes: ShapeQuery,
    rays: RayQuery,
}

/// A collider near a surface.
pub(crate) struct Guest {
    /// The middle of it, or at least a point of it, at the begin of the step.
    pub(crate) center: DVec3,
    /// How deep that may be inside before it counts.
    pub(crate) slack: f64,
    /// Half its smallest extent.
    pub(crate) size: f64,
    /// How far it can be from there in this step, all of it.
    pub(crate) reach: f64,
}

impl Guest {
    /// A shape at a place; nothing if it has no points.
    pub(crate) fn of(shape: &dyn Shape, place: &Place, reach: f32) -> Option<Self> {
        let probe = Probe::of(shape)?;
        let size = 0.5 * f64::from(shape.compute_local_aabb().extents().min_element());
        Some(Self {
            center: place.transform_point(probe.point).as_dvec3(),
            slack: if probe.is_outside { SLACK * size } else { 0.0 },
            size,
            reach: f64::from(reach),
        })
    }
}

/// What is known of a collider near a surface.
#[derive(Default)]
struct Known {
    /// The last step in which it was near, and where it was.
    step: u32,
    center: DVec3,
    reach: f64,
    /// Where it was when it was compared with the surface, and how far that had travelled.
    looked_at: DVec3,
    travelled: f64,
    /// The distance between them then; 0 inside.
    room: f64,
    /// What was closest to it when it was outside: there it leaves.
    door: Option<SurfacePoint>,
    /// How fast it was driven in the last step.
    driven: f64,
}

/// How something that is inside leaves.
pub(crate) struct Exit {
    /// Where on the surface.
    point: SurfacePoint,
    pub(crate) direction: DVec3,
    /// How fast it is to move there, as the surface sees it, and was in the last step; 0 if it was outside.
    speed: f64,
    driven: f64,
}

/// How bodies are driven out.
#[derive(Clone, Copy)]
pub(crate) struct Drive {
    /// How fast at most.
    pub(crate) limit: f32,
    /// The length of the step.
    pub(crate) dt: f32,
}

impl<C> Default for Expelling<C> {
    fn default() -> Self {
        Self {
            known: HashMap::default(),
            in_collider: None,
            step: 0,
            shapes: ShapeQuery::default(),
            rays: RayQuery::default(),
        }
    }
}

impl<C: Copy + Eq + Hash> Expelling<C> {
    /// Begins a step. All will be in world space, or in that of the surface's collider, if the place of the mesh in there is given.
    pub(crate) fn begin(&mut self, in_collider: Option<&WorldFromModel>) {
        self.step += 1;
        if self.in_collider.as_ref() == in_collider {
            return;
        }
        if self.in_collider.is_some() == in_collider.is_some() {
            // Another scale: everything may be nearer than it was.
            self.known.values_mut().for_each(|known| known.room = 0.0);
        } else {
            self.known.clear();
        }
        self.in_collider = in_collider.copied();
    }

    /// Remembers a collider that rests, as does the surface.
    pub(crate) fn keep(&mut self, collider: C) {
        if let Some(known) = self.known.get_mut(&collider) {
            known.step = self.step;
        }
    }

    /// Ends it: lets go of colliders that went away.
    pub(crate) fn forget(&mut self) {
        let step = self.step;
        self.known.retain(|_, known| known.step == step);
    }

    /// Lets go of everything.
    pub(crate) fn stop(&mut self) {
        self.known.clear();
    }

    /// Where a collider leaves, if its middle is inside.
    ///
    /// All is in the space that `place` leads to, where the surface has `travelled` so far. `outward` says whether normals point outward, 1 or -1.
    /// Costs next to nothing for what is farther away from the surface than both have moved since it was last looked at.
    pub(crate) fn exit(
        &mut self,
        collider: C,
        guest: &Guest,
        (pose, place): (&mut Pose, &WorldFromModel),
        travelled: f64,
        outward: f64,
        drive: Drive,
    ) -> Option<Exit> {
        let known = self.known.entry(collider).or_default();
        let &Guest {
            center,
            slack,
            size,
            reach,
        } = guest;
        if known.center.distance(center) > known.reach {
            // It has not come here from there: somebody has put it here.
            known.door = None;
        }
        (known.step, known.center, known.reach) = (self.step, center, reach);
        let moved = center.distance(known.looked_at) + travelled - known.travelled;
        if moved < known.room {
            return None;
        }
        (known.looked_at, known.travelled, known.room) = (center, travelled, 0.0);
        let asked = into_query(center, pose, place);
        let is_inside = self.rays.encloses(Body::new(pose, place), asked).ok()?;
        let within = if is_inside { f64::INFINITY } else { reach };
        let closest = self.shapes.closest_point(Body::new(pose, place), asked, within).ok()?;
        let depth = closest.as_ref().filter(|_| is_inside).map(|closest| closest.distance);
        let Some(nearest) = depth.filter(|&depth| depth >= slack) else {
            if !is_inside {
                known.room = closest.as_ref().map_or(reach, |closest| closest.distance);
            }
            known.door = closest.map(SurfacePoint::from);
            known.driven = 0.0;
            return None;
        };
        let closest = closest?;
        // By the way that it came, if that is not much longer: what is pushed into a wall does not leave on the other side.
        let mut door = known.door.and_then(|door| Some((door, door.place(pose, place)?)));
        if door.is_none_or(|(_, (at, _))| at.distance(center) > 4.0 * nearest + reach) {
            let nearest = SurfacePoint::from(closest);
            door = nearest.place(pose, place).map(|at| (nearest, at));
        }
        let (point, (at, normal)) = door?;
        let depth = at.distance(center);
        let direction = if depth > 1e-3 * size {
            (at - center) / depth
        } else {
            outward * normal?
        };
        let speed = drive.speed(depth - slack, size.max(f64::MIN_POSITIVE));
        Some(Exit {
            point,
            direction,
            speed,
            driven: std::mem::replace(&mut known.driven, speed),
        })
    }
}

impl Exit {
    /// By how much the speed at which something leaves, as the surface sees it, has to change.
    pub(crate) fn change(&self, speed: f64) -> f64 {
        if speed < self.speed {
            self.speed - speed
        } else {
            // It slows down, by no more than it was driven faster before.
            -(speed.min(self.driven) - self.speed).max(0.0)
        }
    }

    /// By how much a velocity has to change for it to leave a surface that pushes with parts.
    pub(crate) fn change_of(&self, velocity: Vec3, following: &mut Following, pace: &Pace) -> Vec3 {
        let surface = following
            .velocity_at(self.point, pace.max_acceleration)
            .unwrap_or_default();
        let speed = self.direction.dot(velocity.as_dvec3() - surface);
        (self.change(speed) * self.direction).as_vec3()
    }
}

impl Drive {
    /// How fast something moves whose middle is so deep inside.
    ///
    /// More slowly where that may be outside after the step: from there on contacts push it, which take no velocity away. In the step they may move it as far as
    /// it is driven.
    fn speed(&self, depth: f64, size: f64) -> f64 {
        let step = 2.0 * f64::from(self.limit * self.dt);
        let share = ((depth - step) / size).clamp(AT_THE_DOOR, 1.0);
        let at_once = (depth + size) / f64::from(self.dt);
        (share * f64::from(self.limit)).min(at_once)
    }
}
