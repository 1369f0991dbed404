//! Finds what is inside a solid surface, and where it should leave.
//!
//! Contacts push out bodies that reach into a surface by less than half their size. They ignore deeper bodies, because the middle
//! of such a body is behind every triangle. Those are driven out by their velocity instead, at the speed at which the engine
//! separates bodies.

use std::hash::Hash;

use bevy::math::DVec3;
use bevy::platform::collections::HashMap;
use morph_collision::{Body, Pose, RayQuery, ShapeQuery, WorldFromModel};
use parry3d::math::Pose as Isometry;
use parry3d::shape::Shape;

use super::exit::{Drive, Exit};
use crate::math::into_query;
use crate::moving::SurfacePoint;
use crate::shape::Probe;

/// How deep a point on the outside of a shape may be inside, relative to half the shape's smallest extent, while it still counts
/// as on the surface.
const SLACK: f64 = 0.5;

/// The colliders inside a solid surface. `C` identifies a collider in the physics engine.
pub struct Expelling<C> {
    known: HashMap<C, KnownCollider>,
    /// The transform from mesh to collider, if all values are in the collider's space and not in world space.
    in_collider: Option<WorldFromModel>,
    step: u32,
    shapes: ShapeQuery,
    rays: RayQuery,
}

/// A surface with an inside.
pub struct SolidSurface<'a> {
    /// Its pose at the start of the step.
    pub pose: &'a mut Pose,
    /// Maps the pose.
    pub world_from_model: &'a WorldFromModel,
    /// How far it has travelled so far.
    pub travelled: f64,
    /// Whether normals, by the triangles' winding, point outward (1) or inward (-1).
    pub outward: f64,
}

/// A collider near a solid surface, which may be inside.
pub struct EnclosedCollider {
    /// Its middle, or at least one of its points, at the start of the step.
    pub center: DVec3,
    /// How deep the point may be inside before it counts.
    pub slack: f64,
    /// Half its smallest extent.
    pub size: f64,
    /// The maximum distance of any part of it from the point during this step.
    pub reach: f64,
}

impl EnclosedCollider {
    /// From a shape and where it is. `None` if the shape has no points.
    pub fn of(shape: &dyn Shape, isometry: &Isometry, reach: f32) -> Option<Self> {
        let probe = Probe::of(shape)?;
        let size = 0.5 * f64::from(shape.compute_local_aabb().extents().min_element());
        Some(Self {
            center: isometry.transform_point(probe.point).as_dvec3(),
            slack: if probe.is_outside { SLACK * size } else { 0.0 },
            size,
            reach: f64::from(reach),
        })
    }
}

/// What is remembered about a collider near a surface.
#[derive(Default)]
struct KnownCollider {
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
    exit_point: Option<SurfacePoint>,
    /// The speed at which it was driven in the last step.
    expelled: f64,
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
    pub fn begin(&mut self, in_collider: Option<&WorldFromModel>) {
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
    pub fn keep(&mut self, collider: C) {
        if let Some(known) = self.known.get_mut(&collider) {
            known.step = self.step;
        }
    }

    /// Ends the step: forgets colliders that went away.
    pub fn forget(&mut self) {
        let step = self.step;
        self.known.retain(|_, known| known.step == step);
    }

    /// Forgets everything.
    pub fn stop(&mut self) {
        self.known.clear();
    }

    /// Where a collider leaves, if its middle is inside.
    ///
    /// All values are in the space to which the surface's pose is mapped. Costs almost nothing if the collider is farther from the surface than both have
    /// moved since they were last compared.
    pub fn exit(
        &mut self,
        collider: C,
        enclosed: &EnclosedCollider,
        surface: SolidSurface,
        drive: Drive,
    ) -> Option<Exit> {
        let SolidSurface {
            pose,
            world_from_model,
            travelled,
            outward,
        } = surface;
        let known = self.known.entry(collider).or_default();
        let &EnclosedCollider {
            center,
            slack,
            size,
            reach,
        } = enclosed;
        if known.center.distance(center) > known.reach {
            // It cannot have moved here from there, so somebody placed it here.
            known.exit_point = None;
        }
        (known.step, known.center, known.reach) = (self.step, center, reach);
        let moved = center.distance(known.looked_at) + travelled - known.travelled;
        if moved < known.room {
            return None;
        }
        (known.looked_at, known.travelled, known.room) = (center, travelled, 0.0);
        let query_point = into_query(center, pose, world_from_model);
        let is_inside = self
            .rays
            .encloses(Body::new(pose, world_from_model), query_point)
            .ok()?;
        let within = if is_inside { f64::INFINITY } else { reach };
        let closest = self
            .shapes
            .closest_point(Body::new(pose, world_from_model), query_point, within)
            .ok()?;
        let depth = closest.as_ref().filter(|_| is_inside).map(|closest| closest.distance);
        let Some(nearest) = depth.filter(|&depth| depth >= slack) else {
            if !is_inside {
                known.room = closest.as_ref().map_or(reach, |closest| closest.distance);
            }
            known.exit_point = closest.map(SurfacePoint::from);
            known.expelled = 0.0;
            return None;
        };
        let closest = closest?;
        // It leaves the way it came, unless that way is much longer: what is pushed into a wall must not leave on the other side.
        let mut exit_point = known
            .exit_point
            .and_then(|exit_point| Some((exit_point, exit_point.locate(pose, world_from_model)?)));
        if exit_point.is_none_or(|(_, (at, _))| at.distance(center) > 4.0 * nearest + reach) {
            let nearest = SurfacePoint::from(closest);
            exit_point = nearest.locate(pose, world_from_model).map(|at| (nearest, at));
        }
        let (point, (at, normal)) = exit_point?;
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
            expelled: std::mem::replace(&mut known.expelled, speed),
        })
    }
}
