//! Answers Rapier's queries about two shapes, one of which is a morphing surface.

use bevy_rapier3d::parry::math::{Pose, Real, Vector};
use bevy_rapier3d::parry::query::details::{NormalConstraints, ShapeCastOptions};
use bevy_rapier3d::parry::query::{
    ClosestPoints, Contact, ContactManifold, ContactManifoldsWorkspace, DefaultQueryDispatcher, NonlinearRigidMotion,
    PersistentQueryDispatcher, QueryDispatcher, ShapeCastHit, ShapeDistance, ShapeIntersection, Unsupported,
};
use bevy_rapier3d::parry::shape::Shape;

use super::gathered::{Gathered, is_ground, is_quiet, until_past, widening};
use super::landing::keep_outermost;
use super::side::{keep_plausible, keep_side};
use super::sweep::sweep_part;
use bevy_morph_physics::shape::{MorphSurface, Patch, Range, check, in_range, one_encloses_other};

/// Answers Rapier's queries about a [`MorphSurface`](crate::MorphSurface) and another shape, or about two surfaces: contacts,
/// intersections, distances and shape casts. For all other shapes it answers like Parry's default dispatcher.
///
/// For each query, the surface's tree finds the triangles near the other shape at the current weights, and Parry's own algorithms
/// work on those. The cost depends on their number and not on the size of the mesh.
///
/// If coordinates, sizes or speeds are beyond 1e8 units or not finite, Parry's algorithms overflow, and its EPA panics. This
/// dispatcher treats such pairs as far apart: no contact, no hit. That is logged once per surface.
///
/// [`MorphRapierPlugin`](crate::MorphRapierPlugin) sets it in every context. If your game has its own dispatcher, put this one in
/// front: `context.set_query_dispatcher(MorphQueryDispatcher.chain(mine))`. It returns [`Unsupported`] only if Parry's dispatcher
/// does, so that `mine` can answer.
#[derive(Clone, Copy, Debug, Default)]
pub struct MorphQueryDispatcher;

/// Whether a query about a surface and another shape contains numbers with which Parry cannot compute. Logs it once per surface.
fn refuses(pos12: &Pose, g1: &dyn Shape, g2: &dyn Shape) -> bool {
    refuses_moving(pos12, &[], g1, g2)
}

/// The same for shapes that move with these velocities.
fn refuses_moving(pos12: &Pose, velocities: &[Vector], g1: &dyn Shape, g2: &dyn Shape) -> bool {
    if is_ground(g1) || is_ground(g2) {
        // It stands for a surface, which answers itself.
        return true;
    }
    let range = check(pos12, g1, g2);
    let refused = match range {
        Range::Foreign => false,
        Range::Inside => !velocities.iter().all(|&velocity| in_range(velocity)),
        Range::Outside => true,
    };
    if refused {
        let surfaces = [g1, g2]
            .into_iter()
            .filter_map(|shape| shape.as_shape::<MorphSurface>());
        surfaces.for_each(MorphSurface::refuse);
    }
    refused
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
        // Sensors detect the surface itself.
        if g1.as_shape::<Patch>().is_some() || g2.as_shape::<Patch>().is_some() {
            return Ok(apart);
        }
        if refuses(pos12, g1, g2) {
            return Ok(apart);
        }
        let Some(near) = Gathered::near(pos12, g1, g2, 0.0) else {
            return DefaultQueryDispatcher.intersection_test(pos12, g1, g2);
        };
        if !near.nothing() {
            let (near1, near2) = near.shapes(g1, g2);
            let mut answer = DefaultQueryDispatcher.intersection_test(pos12, near1, near2)?;
            near.name(&mut answer.subshape1, &mut answer.subshape2);
            if answer.intersecting {
                return Ok(answer);
            }
        }
        Ok(ShapeIntersection {
            intersecting: one_encloses_other(pos12, g1, g2),
            ..apart
        })
    }

    fn distance(&self, pos12: &Pose, g1: &dyn Shape, g2: &dyn Shape) -> Result<ShapeDistance, Unsupported> {
        if refuses(pos12, g1, g2) {
            return Ok(ShapeDistance {
                distance: Real::MAX,
                subshape1: 0,
                subshape2: 0,
            });
        }
        if one_encloses_other(pos12, g1, g2) {
            return Ok(ShapeDistance {
                distance: 0.0,
                subshape1: 0,
                subshape2: 0,
            });
        }
        let query = |near: &Gathered, g1: &dyn Shape, g2: &dyn Shape| {
            let mut answer = DefaultQueryDispatcher.distance(pos12, g1, g2)?;
            near.name(&mut answer.subshape1, &mut answer.subshape2);
            Ok(answer)
        };
        let answer = widening(pos12, g1, g2, query, |answer| answer.distance);
        answer.unwrap_or_else(|| DefaultQueryDispatcher.distance(pos12, g1, g2))
    }

    fn contact(
        &self,
        pos12: &Pose,
        g1: &dyn Shape,
        g2: &dyn Shape,
        prediction: Real,
    ) -> Result<Option<Contact>, Unsupported> {
        if refuses(pos12, g1, g2) {
            return Ok(None);
        }
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
        if refuses(pos12, g1, g2) {
            return Ok(ClosestPoints::Disjoint);
        }
        if one_encloses_other(pos12, g1, g2) {
            return Ok(ClosestPoints::Intersecting);
        }
        let query = |_: &Gathered, g1: &dyn Shape, g2: &dyn Shape| {
            DefaultQueryDispatcher.closest_points(pos12, g1, g2, max_dist)
        };
        let distance = |answer: &ClosestPoints| match answer {
            ClosestPoints::Intersecting => 0.0,
            ClosestPoints::WithinMargin(p1, p2) => p1.distance(pos12.transform_point(*p2)),
            ClosestPoints::Disjoint => Real::MAX,
        };
        let answer = widening(pos12, g1, g2, query, distance);
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
        if refuses_moving(pos12, &[local_vel12], g1, g2) {
            return Ok(None);
        }
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
        let query = |g1: &dyn Shape, g2: &dyn Shape| {
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
        let pos12 = motion1.start.inverse() * motion2.start;
        let velocities = [motion1, motion2].map(|motion| [motion.linvel, motion.angvel, motion.local_center]);
        if refuses_moving(&pos12, velocities.as_flattened(), g1, g2) {
            return Ok(None);
        }
        if !stop_at_penetration && let Some(hit) = sweep_part(motion1, g1, motion2, g2, start_time, end_time) {
            return Ok(hit);
        }
        let on_the_way = Gathered::in_motion(motion1, g1, motion2, g2, start_time, end_time);
        let Some(near) = on_the_way.or_else(|| Gathered::whole(g1, g2)) else {
            return query(g1, g2);
        };
        if near.nothing() {
            return Ok(None);
        }
        let (g1, g2) = near.shapes(g1, g2);
        let mut hit = query(g1, g2)?;
        if let Some(hit) = &mut hit {
            near.name(&mut hit.subshape1, &mut hit.subshape2);
        }
        Ok(hit)
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
        let near = if is_quiet(g1) || is_quiet(g2) {
            if workspace.is_none() && manifolds.is_empty() {
                return Ok(());
            }
            // Parry drops the previous state. Its workspace must be removed together with its manifolds.
            Some(Gathered::none(g1, g2))
        } else if refuses(pos12, g1, g2) {
            Some(Gathered::none(g1, g2))
        } else {
            Gathered::along(pos12, Vector::ZERO, g1, g2, prediction, true)
        };
        let look_ahead = |shape: &dyn Shape| shape.as_shape::<Patch>().map_or(0.0, |patch| patch.look_ahead.get());
        // Rapier's distance includes the motion of the part.
        let look_ahead = look_ahead(g1) + look_ahead(g2);
        let (g1, g2) = near.as_ref().map_or((g1, g2), |near| near.shapes(g1, g2));
        DefaultQueryDispatcher.contact_manifolds(pos12, g1, g2, prediction + look_ahead, manifolds, workspace)?;
        keep_side(pos12, g1, g2, manifolds);
        keep_plausible(pos12, g1, g2, prediction, manifolds);
        if look_ahead > 0.0 {
            keep_outermost(prediction, manifolds);
        }
        Ok(())
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
