//! What Rapier asks about two shapes, when one of them is a morphing surface.

use bevy_rapier3d::parry::bounding_volume::{Aabb, BoundingVolume};
use bevy_rapier3d::parry::math::{Pose, Real, Vector};
use bevy_rapier3d::parry::query::details::{NormalConstraints, ShapeCastOptions};
use bevy_rapier3d::parry::query::{
    ClosestPoints, Contact, ContactManifold, ContactManifoldsWorkspace, DefaultQueryDispatcher, NonlinearRigidMotion,
    PersistentQueryDispatcher, QueryDispatcher, ShapeCastHit, ShapeDistance, ShapeIntersection, Unsupported,
};
use bevy_rapier3d::parry::shape::{Shape, SubShapeId};

use super::surface::MorphSurface;
use super::triangles::{Patch, Triangles};

/// Answers what Rapier asks about a [`MorphSurface`] and another shape, or two of them: contacts, intersections, distances,
/// shape casts. About other shapes it answers as Parry's default dispatcher.
///
/// For each question the triangles of the surface near the other shape are gathered, by its tree, at its current weights,
/// and Parry's own algorithms work on them: their number counts, not the size of the mesh.
///
/// [`MorphRapierPlugin`](crate::MorphRapierPlugin) gives it to every context. A game with a dispatcher of its own puts this one
/// in front: `context.set_query_dispatcher(MorphQueryDispatcher.chain(mine))`; it says
/// [`Unsupported`] about what `mine` may know better only if Parry's says so.
#[derive(Clone, Copy, Debug, Default)]
pub struct MorphQueryDispatcher;

/// What the triangles of surfaces near each other are; shapes that are no surfaces stay what they are.
struct Gathered {
    first: Option<Triangles>,
    second: Option<Triangles>,
}

impl Gathered {
    /// For two shapes of which at least one is a surface: what is within `reach` of the other. None for two other shapes.
    fn near(pos12: &Pose, g1: &dyn Shape, g2: &dyn Shape, reach: Real) -> Option<Self> {
        Self::along(pos12, Vector::ZERO, g1, g2, reach, false)
    }

    /// The same while the second shape moves by `motion` as seen by the first.
    fn along(
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
        let first = surface1.map(|surface| surface.lock().triangles_in(&in_first(g2), for_contacts));
        let second = surface2.map(|surface| {
            // The first one seen by the second moves the other way.
            let pos21 = pos12.inverse();
            let end = Pose::from_parts(pos21.translation - pos21.rotation * motion, pos21.rotation);
            let g1: &dyn Shape = first.as_ref().map_or(g1, |triangles| triangles);
            if first.as_ref().is_some_and(Triangles::is_empty) {
                return Triangles::new(Vec::new(), Vec::new(), Vec::new());
            }
            surface
                .lock()
                .triangles_in(&g1.compute_swept_aabb(&pos21, &end).loosened(reach), for_contacts)
        });
        Some(Self { first, second })
    }

    /// For one surface that stands still while another shape moves and turns: what is on its way.
    fn in_motion(
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
            // However it turns about its centre, it stays in a ball around it.
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

    /// The whole of both.
    fn whole(g1: &dyn Shape, g2: &dyn Shape) -> Option<Self> {
        let whole = |shape: &dyn Shape| {
            shape
                .as_shape::<MorphSurface>()
                .map(|surface| surface.lock().all_triangles())
        };
        let (first, second) = (whole(g1), whole(g2));
        (first.is_some() || second.is_some()).then_some(Self { first, second })
    }

    fn nothing(&self) -> bool {
        let empty = |triangles: &Option<Triangles>| triangles.as_ref().is_some_and(Triangles::is_empty);
        empty(&self.first) || empty(&self.second)
    }

    /// The sub-shapes of an answer as meshes number their triangles.
    fn name(&self, subshape1: &mut SubShapeId, subshape2: &mut SubShapeId) {
        for (triangles, subshape) in [(&self.first, subshape1), (&self.second, subshape2)] {
            if let Some(triangles) = triangles {
                *subshape = triangles.number(*subshape);
            }
        }
    }

    fn shapes<'a>(&'a self, g1: &'a dyn Shape, g2: &'a dyn Shape) -> (&'a dyn Shape, &'a dyn Shape) {
        (
            self.first.as_ref().map_or(g1, |triangles| triangles),
            self.second.as_ref().map_or(g2, |triangles| triangles),
        )
    }
}

fn is_surface(shape: &dyn Shape) -> bool {
    shape.as_shape::<MorphSurface>().is_some()
}

/// Whether a shape is a surface whose contacts nobody wants.
fn is_quiet(shape: &dyn Shape) -> bool {
    shape.as_shape::<MorphSurface>().is_some_and(MorphSurface::is_quiet)
}

/// Asks about what is within a reach that grows until the answer is certain, or everything was looked at.
fn widening<T>(
    pos12: &Pose,
    g1: &dyn Shape,
    g2: &dyn Shape,
    ask: impl Fn(&Gathered, &dyn Shape, &dyn Shape) -> Result<T, Unsupported>,
    distance: impl Fn(&T) -> Real,
) -> Option<Result<T, Unsupported>> {
    let all: Aabb = g1.compute_local_aabb().merged(&g2.compute_aabb(pos12));
    let size = all.extents().length();
    let mut reach = size / 64.0;
    while reach > 0.0 && reach.is_finite() && reach < size {
        let near = Gathered::near(pos12, g1, g2, reach)?;
        if !near.nothing() {
            let (near1, near2) = near.shapes(g1, g2);
            match ask(&near, near1, near2) {
                // Whatever was left out is farther away than this.
                Ok(answer) if distance(&answer) <= reach => return Some(Ok(answer)),
                Ok(_) => {}
                unsupported => return Some(unsupported),
            }
        }
        reach *= 4.0;
    }
    let whole = Gathered::whole(g1, g2)?;
    let (whole1, whole2) = whole.shapes(g1, g2);
    Some(ask(&whole, whole1, whole2))
}

impl QueryDispatcher for MorphQueryDispatcher {
    fn intersection_test(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
    ) -> Result<ShapeIntersection, Unsupported> {
        let apart = ShapeIntersection {
            intersecting: false,
            subshape1: 0,
            subshape2: 0,
        };
        // Sensors meet the surface itself.
        if g1.as_shape::<Patch>().is_some() || g2.as_shape::<Patch>().is_some() {
            return Ok(apart);
        }
        let Some(near) = Gathered::near(pos12, g1, g2, 0.0) else {
            return DefaultQueryDispatcher.intersection_test(pos12, g1, g2);
        };
        if near.nothing() {
            return Ok(apart);
        }
        let (g1, g2) = near.shapes(g1, g2);
        let mut answer = DefaultQueryDispatcher.intersection_test(pos12, g1, g2)?;
        near.name(&mut answer.subshape1, &mut answer.subshape2);
        Ok(answer)
    }

    fn distance(&self, pos12: &Pose, g1: &dyn Shape, g2: &dyn Shape) -> Result<ShapeDistance, Unsupported> {
        let ask = |near: &Gathered, g1: &dyn Shape, g2: &dyn Shape| {
            let mut answer = DefaultQueryDispatcher.distance(pos12, g1, g2)?;
            near.name(&mut answer.subshape1, &mut answer.subshape2);
            Ok(answer)
        };
        let answer = widening(pos12, g1, g2, ask, |answer| answer.distance);
        answer.unwrap_or_else(|| DefaultQueryDispatcher.distance(pos12, g1, g2))
    }

    fn contact(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        prediction: Real,
    ) -> Result<Option<Contact>, Unsupported> {
        let Some(near) = Gathered::near(pos12, g1, g2, prediction) else {
            return DefaultQueryDispatcher.contact(pos12, g1, g2, prediction);
        };
        if near.nothing() {
            return Ok(None);
        }
        let (g1, g2) = near.shapes(g1, g2);
        DefaultQueryDispatcher.contact(pos12, g1, g2, prediction)
    }

    fn closest_points(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        max_dist: Real,
    ) -> Result<ClosestPoints, Unsupported> {
        let ask = |_: &Gathered, g1: &dyn Shape, g2: &dyn Shape| {
            DefaultQueryDispatcher.closest_points(pos12, g1, g2, max_dist)
        };
        let distance = |answer: &ClosestPoints| match answer {
            ClosestPoints::Intersecting => 0.0,
            ClosestPoints::WithinMargin(p1, p2) => p1.distance(pos12.transform_point(*p2)),
            ClosestPoints::Disjoint => Real::MAX,
        };
        let answer = widening(pos12, g1, g2, ask, distance);
        answer.unwrap_or_else(|| DefaultQueryDispatcher.closest_points(pos12, g1, g2, max_dist))
    }

    fn cast_shapes(
        &self,
        pos12: &Pose,
        local_vel12: Vector,
        g1: &dyn Shape,
        g2: &dyn Shape,
        options: ShapeCastOptions,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        let motion = until_past(pos12, local_vel12, g1, g2, options.max_time_of_impact);
        let Some(near) = Gathered::along(pos12, motion, g1, g2, options.target_distance, false) else {
            return DefaultQueryDispatcher.cast_shapes(pos12, local_vel12, g1, g2, options);
        };
        if near.nothing() {
            return Ok(None);
        }
        let (g1, g2) = near.shapes(g1, g2);
        let mut hit = DefaultQueryDispatcher.cast_shapes(pos12, local_vel12, g1, g2, options)?;
        if let Some(hit) = &mut hit {
            near.name(&mut hit.subshape1, &mut hit.subshape2);
        }
        Ok(hit)
    }

    fn cast_shapes_nonlinear(
        &self,
        motion1: &NonlinearRigidMotion,
        g1: &dyn Shape,
        motion2: &NonlinearRigidMotion,
        g2: &dyn Shape,
        start_time: Real,
        end_time: Real,
        stop_at_penetration: bool,
    ) -> Result<Option<ShapeCastHit>, Unsupported> {
        let ask = |g1: &dyn Shape, g2: &dyn Shape| {
            DefaultQueryDispatcher.cast_shapes_nonlinear(
                motion1,
                g1,
                motion2,
                g2,
                start_time,
                end_time,
                stop_at_penetration,
            )
        };
        if is_quiet(g1) || is_quiet(g2) {
            return Ok(None);
        }
        let on_the_way = Gathered::in_motion(motion1, g1, motion2, g2, start_time, end_time);
        let Some(near) = on_the_way.or_else(|| Gathered::whole(g1, g2)) else {
            return ask(g1, g2);
        };
        if near.nothing() {
            return Ok(None);
        }
        let (g1, g2) = near.shapes(g1, g2);
        let mut hit = ask(g1, g2)?;
        if let Some(hit) = &mut hit {
            near.name(&mut hit.subshape1, &mut hit.subshape2);
        }
        Ok(hit)
    }
}

/// How far the second shape moves within a time, but no farther than until it has certainly passed the first.
fn until_past(pos12: &Pose, velocity: Vector, g1: &dyn Shape, g2: &dyn Shape, time: Real) -> Vector {
    let (b1, b2) = (g1.compute_local_bounding_sphere(), g2.compute_bounding_sphere(pos12));
    let far = b1.center().distance(b2.center()) + b1.radius() + b2.radius();
    let speed = velocity.length();
    if speed > 0.0 && far.is_finite() {
        velocity * time.min(2.0 * far / speed)
    } else {
        Vector::ZERO
    }
}

impl<ManifoldData, ContactData> PersistentQueryDispatcher<ManifoldData, ContactData> for MorphQueryDispatcher
where
    ManifoldData: Default + Clone + Send + Sync,
    ContactData: Default + Copy + Send + Sync,
{
    fn contact_manifolds(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        prediction: Real,
        manifolds: &mut Vec<ContactManifold<ManifoldData, ContactData>>,
        workspace: &mut Option<ContactManifoldsWorkspace>,
    ) -> Result<(), Unsupported> {
        if is_quiet(g1) || is_quiet(g2) {
            manifolds.clear();
            return Ok(());
        }
        let near = Gathered::along(pos12, Vector::ZERO, g1, g2, prediction, true);
        let (g1, g2) = near.as_ref().map_or((g1, g2), |near| near.shapes(g1, g2));
        DefaultQueryDispatcher.contact_manifolds(pos12, g1, g2, prediction, manifolds, workspace)
    }

    fn contact_manifold_convex_convex(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        normal_constraints1: Option<&dyn NormalConstraints>,
        normal_constraints2: Option<&dyn NormalConstraints>,
        prediction: Real,
        manifold: &mut ContactManifold<ManifoldData, ContactData>,
    ) -> Result<(), Unsupported> {
        DefaultQueryDispatcher.contact_manifold_convex_convex(
            pos12,
            g1,
            g2,
            normal_constraints1,
            normal_constraints2,
            prediction,
            manifold,
        )
    }
}
