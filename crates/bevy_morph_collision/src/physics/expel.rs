//! Finds what is inside a solid surface, and where it should leave.
//!
//! Contacts push out bodies that reach into a surface by less than half their size. They ignore deeper bodies, because the middle
//! of such a body is behind every triangle. Those are driven out by their velocity instead, at the speed at which the engine
//! separates bodies.

use std::hash::Hash;

use bevy::math::{DVec3, Vec3};
use bevy::platform::collections::HashMap;
use morph_collision::{Body, Pose, RayQuery, ShapeQuery, WorldFromModel};
use parry3d::math::Pose as Place;
use parry3d::shape::Shape;

use super::follow::Following;
use super::inside::Probe;
use super::placed::into_query;
use super::point::SurfacePoint;

/// How deep a point on the outside of a shape may be inside, relative to half the shape's smallest extent, while it still counts
/// as on the surface.
const SLACK: f64 = 0.5;

/// The speed at which something leaves, as a fraction of the maximum speed deep inside.
const AT_THE_DOOR: f64 = 0.3;

/// The colliders inside a solid surface. `C` identifies a collider in the physics engine.
pub(crate) struct Expelling<C> {
    known: HashMap<C, Known>,
    /// The transform from mesh to collider, if all values are in the collider's space and not in world space.
    in_collider: Option<WorldFromModel>,
    step: u32,
    shapes: ShapeQuery,
    rays: RayQuery,
}

/// A collider near a surface.
pub(crate) struct Guest {
    /// Its middle, or at least one of its points, at the start of the step.
    pub(crate) center: DVec3,
    /// How deep the point may be inside before it counts.
    pub(crate) slack: f64,
    /// Half its smallest extent.
    pub(crate) size: f64,
    /// The maximum distance of any part of it from the point during this step.
    pub(crate) reach: f64,
}

impl Guest {
    /// Creates a guest from a shape and its place. `None` if the shape has no points.
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

/// What is remembered about a collider near a surface.
#[derive(Default)]
struct Known {
    /// The last step in which it was near, and where it was.
    step: u32,
    center: DVec3,
    reach: f64,
    /// Where it was when it was last compared with the surface, and how far the surface had travelled by then.
    looked_at: DVec3,
    travelled: f64,
    /// The distance between the two at that time; 0 inside.
    room: f64,
    /// The closest point of the surface when the collider was outside. It leaves there.
    door: Option<SurfacePoint>,
    /// The speed at which it was driven in the last step.
    driven: f64,
}

/// How a collider that is inside leaves.
pub(crate) struct Exit {
    /// Where on the surface.
    point: SurfacePoint,
    pub(crate) direction: DVec3,
    /// Its target speed in that direction, relative to the surface, and that of the last step; 0 if it was outside.
    speed: f64,
    driven: f64,
}

/// How bodies are driven out.
#[derive(Clone, Copy)]
pub(crate) struct Drive {
    /// The maximum speed.
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
    /// Begins a step. All values are in world space, or in the space of the surface's collider if the transform from mesh to
    /// collider is given.
    pub(crate) fn begin(&mut self, in_collider: Option<&WorldFromModel>) {
        self.step += 1;
        if self.in_collider.as_ref() == in_collider {
            return;
        }
        if self.in_collider.is_some() == in_collider.is_some() {
            // The scale changed, so everything may be nearer than before.
            self.known.values_mut().for_each(|known| known.room = 0.0);
        } else {
            self.known.clear();
        }
        self.in_collider = in_collider.copied();
    }

    /// Keeps a collider that is at rest, as is the surface.
    pub(crate) fn keep(&mut self, collider: C) {
        if let Some(known) = self.known.get_mut(&collider) {
            known.step = self.step;
        }
    }

    /// Ends the step: forgets colliders that went away.
    pub(crate) fn forget(&mut self) {
        let step = self.step;
        self.known.retain(|_, known| known.step == step);
    }

    /// Forgets everything.
    pub(crate) fn stop(&mut self) {
        self.known.clear();
    }

    /// Where a collider leaves, if its middle is inside.
    ///
    /// All values are in the space to which `place` maps, in which the surface has `travelled` so far. `outward` says whether
    /// normals point outward (1) or inward (-1). Costs almost nothing if the collider is farther from the surface than both have
    /// moved since they were last compared.
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
            // It cannot have moved here from there, so somebody placed it here.
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
        // It leaves the way it came, unless that way is much longer: what is pushed into a wall must not leave on the other side.
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
    /// How much the speed in the exit direction, relative to the surface, has to change.
    pub(crate) fn change(&self, speed: f64) -> f64 {
        if speed < self.speed {
            self.speed - speed
        } else {
            // It slows down, but at most by as much as it was driven before.
            -(speed.min(self.driven) - self.speed).max(0.0)
        }
    }

    /// How much a velocity has to change for the body to leave a surface that pushes with parts.
    pub(crate) fn change_of(&self, velocity: Vec3, following: &mut Following) -> Vec3 {
        let surface = following.velocity_at(self.point).unwrap_or_default();
        let speed = self.direction.dot(velocity.as_dvec3() - surface);
        (self.change(speed) * self.direction).as_vec3()
    }
}

impl Drive {
    /// The speed of something whose middle is this deep inside.
    ///
    /// It is slower if the middle may be outside after the step: from then on contacts push, and they do not reduce the velocity.
    /// In that step they may move it as far as it is driven.
    fn speed(&self, depth: f64, size: f64) -> f64 {
        let step = 2.0 * f64::from(self.limit * self.dt);
        let share = ((depth - step) / size).clamp(AT_THE_DOOR, 1.0);
        let at_once = (depth + size) / f64::from(self.dt);
        (share * f64::from(self.limit)).min(at_once)
    }
}
