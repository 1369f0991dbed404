//! Gathers the triangles of surfaces that matter for a query about two shapes.

use bevy_rapier3d::parry::bounding_volume::{Aabb, BoundingVolume};
use bevy_rapier3d::parry::math::{Pose, Real, Vector};
use bevy_rapier3d::parry::query::{NonlinearRigidMotion, Unsupported};
use bevy_rapier3d::parry::shape::{Shape, SubShapeId};

use super::ground::Ground;
use bevy_morph_physics::shape::{MorphSurface, Patch, Triangles};

/// The triangles of two surfaces near each other. Shapes that are not surfaces stay as they are.
pub(crate) struct Gathered {
    first: Option<Triangles>,
    second: Option<Triangles>,
}

impl Gathered {
    /// For two shapes of which at least one is a surface: gathers its triangles within `reach` of the other shape. `None` for two
    /// other shapes.
    pub(crate) fn near(pos12: &Pose, g1: &dyn Shape, g2: &dyn Shape, reach: Real) -> Option<Self> {
        Self::along(pos12, Vector::ZERO, g1, g2, reach, false)
    }

    /// The same while the second shape moves by `motion`, in the space of the first.
    pub(crate) fn along(
        pos12: &Pose,
        motion: Vector,
        g1: &dyn Shape,
        g2: &dyn Shape,
        reach: Real,
        for_contacts: bool,
    ) -> Option<Self> {
        let (surface1, surface2) = (g1.as_shape::<MorphSurface>(), g2.as_shape::<MorphSurface>());
        if surface1.is_none() && surface2.is_none() {
            return None;
        }
        let in_first = |shape: &dyn Shape| {
            let end = Pose::from_parts(pos12.translation + motion, pos12.rotation);
            shape.compute_swept_aabb(pos12, &end).loosened(reach)
        };
        // Boxes first: the other shape may be a surface, even the same one, and its own box needs its lock.
        let first = surface1.map(|surface| {
            let region = in_first(g2);
            surface.lock().triangles_in(&region, for_contacts)
        });
        let second = surface2.map(|surface| {
            // From the second shape, the first moves the opposite way.
            let pos21 = pos12.inverse();
            let end = Pose::from_parts(pos21.translation - pos21.rotation * motion, pos21.rotation);
            let g1: &dyn Shape = first.as_ref().map_or(g1, |triangles| triangles);
            if first.as_ref().is_some_and(Triangles::is_empty) {
                return Triangles::new(Vec::new(), Vec::new(), Vec::new());
            }
            let region = g1.compute_swept_aabb(&pos21, &end).loosened(reach);
            surface.lock().triangles_in(&region, for_contacts)
        });
        Some(Self { first, second })
    }

    /// For one surface that stands still while another shape moves and rotates: gathers the triangles on its way.
    pub(crate) fn in_motion(
        motion1: &NonlinearRigidMotion,
        g1: &dyn Shape,
        motion2: &NonlinearRigidMotion,
        g2: &dyn Shape,
        start_time: Real,
        end_time: Real,
    ) -> Option<Self> {
        let on_the_way = |still: &NonlinearRigidMotion, surface: &dyn Shape, motion: &NonlinearRigidMotion, other| {
            let surface = surface.as_shape::<MorphSurface>()?;
            let stands = still.linvel == Vector::ZERO && still.angvel == Vector::ZERO;
            if !stands || is_surface(other) {
                return None;
            }
            // However the shape rotates about its centre, it stays in a ball around it.
            let ball = other.compute_local_bounding_sphere();
            let radius = ball.center().distance(motion.local_center) + ball.radius();
            let center = |time: Real| {
                let center = motion.start.transform_point(motion.local_center) + motion.linvel * time;
                still.start.inverse_transform_point(center)
            };
            let way = Aabb::from_points([center(start_time), center(end_time)]).loosened(radius);
            Some(surface.lock().triangles_in(&way, false))
        };
        let first = on_the_way(motion1, g1, motion2, g2);
        let second = on_the_way(motion2, g2, motion1, g1);
        (first.is_some() || second.is_some()).then_some(Self { first, second })
    }

    /// No triangles of either shape. Also works for parts.
    pub(crate) fn none(g1: &dyn Shape, g2: &dyn Shape) -> Self {
        let is_ours = |shape: &dyn Shape| is_surface(shape) || is_ground(shape) || shape.as_shape::<Patch>().is_some();
        let none = |shape: &dyn Shape| is_ours(shape).then(|| Triangles::new(Vec::new(), Vec::new(), Vec::new()));
        Self {
            first: none(g1),
            second: none(g2),
        }
    }

    /// All triangles of both shapes.
    pub(crate) fn whole(g1: &dyn Shape, g2: &dyn Shape) -> Option<Self> {
        let whole = |shape: &dyn Shape| {
            shape
                .as_shape::<MorphSurface>()
                .map(|surface| surface.lock().all_triangles(false))
        };
        let (first, second) = (whole(g1), whole(g2));
        (first.is_some() || second.is_some()).then_some(Self { first, second })
    }

    pub(crate) fn nothing(&self) -> bool {
        let empty = |triangles: &Option<Triangles>| triangles.as_ref().is_some_and(Triangles::is_empty);
        empty(&self.first) || empty(&self.second)
    }

    /// Replaces the sub-shapes of an answer by the triangle numbers of the meshes.
    pub(crate) fn name(&self, subshape1: &mut SubShapeId, subshape2: &mut SubShapeId) {
        for (triangles, subshape) in [(&self.first, subshape1), (&self.second, subshape2)] {
            if let Some(triangles) = triangles {
                *subshape = triangles.number(*subshape);
            }
        }
    }

    pub(crate) fn shapes<'a>(&'a self, g1: &'a dyn Shape, g2: &'a dyn Shape) -> (&'a dyn Shape, &'a dyn Shape) {
        (
            self.first.as_ref().map_or(g1, |triangles| triangles),
            self.second.as_ref().map_or(g2, |triangles| triangles),
        )
    }
}

/// Whether a shape is the ground of controllers.
pub(crate) fn is_ground(shape: &dyn Shape) -> bool {
    shape.as_shape::<Ground>().is_some()
}

fn is_surface(shape: &dyn Shape) -> bool {
    shape.as_shape::<MorphSurface>().is_some()
}

/// Whether a shape is a surface whose contacts nobody needs.
pub(crate) fn is_quiet(shape: &dyn Shape) -> bool {
    shape.as_shape::<MorphSurface>().is_some_and(MorphSurface::is_quiet)
}

/// Repeats a query within a growing reach until the answer is certain or everything has been looked at.
pub(crate) fn widening<T>(
    pos12: &Pose,
    g1: &dyn Shape,
    g2: &dyn Shape,
    query: impl Fn(&Gathered, &dyn Shape, &dyn Shape) -> Result<T, Unsupported>,
    distance: impl Fn(&T) -> Real,
) -> Option<Result<T, Unsupported>> {
    let all: Aabb = g1.compute_local_aabb().merged(&g2.compute_aabb(pos12));
    let size = all.extents().length();
    let mut reach = size / 64.0;
    while reach > 0.0 && reach.is_finite() && reach < size {
        let near = Gathered::near(pos12, g1, g2, reach)?;
        if !near.nothing() {
            let (near1, near2) = near.shapes(g1, g2);
            match query(&near, near1, near2) {
                // Everything left out is farther away than this.
                Ok(answer) if distance(&answer) <= reach => return Some(Ok(answer)),
                Ok(_) => {}
                unsupported => return Some(unsupported),
            }
        }
        reach *= 4.0;
    }
    let whole = Gathered::whole(g1, g2)?;
    let (whole1, whole2) = whole.shapes(g1, g2);
    Some(query(&whole, whole1, whole2))
}

/// The motion of the second shape within a time, cut off once the shape has certainly passed the first.
pub(crate) fn until_past(pos12: &Pose, velocity: Vector, g1: &dyn Shape, g2: &dyn Shape, time: Real) -> Vector {
    let (b1, b2) = (g1.compute_local_bounding_sphere(), g2.compute_bounding_sphere(pos12));
    let far = b1.center().distance(b2.center()) + b1.radius() + b2.radius();
    let speed = velocity.length();
    if speed > 0.0 && far.is_finite() {
        velocity * time.min(2.0 * far / speed)
    } else {
        Vector::ZERO
    }
}
