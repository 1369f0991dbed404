//! Contacts of convex shapes with triangles of a surface.
//!
//! Parry gives one manifold for each triangle. On a fine mesh, a body touches hundreds, and Rapier's solver takes most of its time to
//! reduce them to a few points. Here they are reduced as soon as they are found.

use bevy_rapier3d::parry::bounding_volume::BoundingVolume;
use bevy_rapier3d::parry::math::{Pose, Real, Vector};
use bevy_rapier3d::parry::query::details::NormalConstraints;
use bevy_rapier3d::parry::query::{
    ContactManifold, ContactManifoldsWorkspace, DefaultQueryDispatcher, PersistentQueryDispatcher, TrackedContact,
    TypedWorkspaceData, WorkspaceData,
};
use bevy_rapier3d::parry::shape::Shape;

use crate::physics::patch::Patch;
use crate::physics::triangles::Triangles;

/// The cosine of the angle between normals that count as one: the angle within which Rapier's solver merges manifolds.
const SAME_NORMAL: Real = 0.996;

/// Triangles and a convex shape that may touch them.
pub(super) struct Touching<'a> {
    triangles: &'a Triangles,
    shape: &'a dyn Shape,
    /// Places the second of the two in the space of the first.
    pos12: Pose,
    /// Whether the shape is the first.
    flipped: bool,
}

impl<'a> Touching<'a> {
    /// `None` for two other shapes.
    pub(super) fn of(pos12: &Pose, g1: &'a dyn Shape, g2: &'a dyn Shape) -> Option<Self> {
        let of = |triangles: &'a dyn Shape, shape: &'a dyn Shape, flipped| {
            let part = triangles.as_shape::<Patch>().and_then(Patch::present);
            // Convex shapes have a support map.
            shape.as_support_map()?;
            Some(Self {
                triangles: part.or_else(|| triangles.as_shape::<Triangles>())?,
                shape,
                pos12: *pos12,
                flipped,
            })
        };
        of(g1, g2, false).or_else(|| of(g2, g1, true))
    }

    /// Computes the manifolds, at most one for each direction, with at most four points.
    pub(super) fn manifolds<M, C>(
        &self,
        prediction: Real,
        manifolds: &mut Vec<ContactManifold<M, C>>,
        workspace: &mut Option<ContactManifoldsWorkspace>,
    ) where
        M: Default + Clone + Send + Sync,
        C: Default + Copy + Send + Sync,
    {
        let Self {
            triangles,
            shape,
            pos12,
            flipped,
        } = *self;
        let in_triangles = if flipped { pos12.inverse() } else { pos12 };
        let reached = shape.compute_aabb(&in_triangles).loosened(prediction);
        let mut used = 0;
        let mut found = ContactManifold::<M, C>::new();
        for (number, triangle, limits) in triangles.near(&reached) {
            found.clear();
            found.local_n1 = Vector::ZERO;
            let limits = limits.as_ref().map(|limits| limits as &dyn NormalConstraints);
            let (one, other, limits): (&dyn Shape, &dyn Shape, _) = match flipped {
                false => (&triangle, shape, (limits, None)),
                true => (shape, &triangle, (None, limits)),
            };
            let known = DefaultQueryDispatcher.contact_manifold_convex_convex(
                &pos12,
                one,
                other,
                limits.0,
                limits.1,
                prediction,
                &mut found,
            );
            if known.is_err() || found.points.is_empty() {
                continue;
            }
            let same = manifolds[..used]
                .iter()
                .position(|manifold| manifold.local_n1.dot(found.local_n1) >= SAME_NORMAL);
            let place = same.unwrap_or_else(|| {
                let fresh = begin(manifolds, used);
                fresh.local_n1 = found.local_n1;
                fresh.local_n2 = found.local_n2;
                (fresh.subshape1, fresh.subshape2) = if flipped { (0, number) } else { (number, 0) };
                used += 1;
                used - 1
            });
            manifolds[place].points.append(&mut found.points);
        }
        for manifold in &mut manifolds[..used] {
            let normal = manifold.local_n1;
            reduce(&mut manifold.points, normal, prediction);
        }
        if used == 1 {
            // Rapier finds the impulses of the last step by the positions of points, but only if there are several manifolds.
            begin(manifolds, used);
            used += 1;
        }
        manifolds.truncate(used);
        // Tells Rapier that the number of manifolds changes from step to step.
        *workspace = Some(Unsteady.into());
    }
}

/// An empty manifold at a place, or at the end.
fn begin<M: Default, C: Default + Copy>(
    manifolds: &mut Vec<ContactManifold<M, C>>,
    place: usize,
) -> &mut ContactManifold<M, C> {
    if place == manifolds.len() {
        manifolds.push(ContactManifold::new());
    }
    let manifold = &mut manifolds[place];
    manifold.clear();
    manifold
}

/// Reduces points to those that hold a body: the nearest one, the one farthest from that, and the outermost ones on both sides of the
/// line between them. All of them are at most `slack` farther away than the nearest.
fn reduce<C: Copy>(points: &mut Vec<TrackedContact<C>>, normal: Vector, slack: Real) {
    let Some(nearest) = points.iter().copied().min_by(|a, b| a.dist.total_cmp(&b.dist)) else {
        return;
    };
    points.retain(|point| point.dist <= nearest.dist + slack);
    let from_nearest = |point: &TrackedContact<C>| (point.local_p1 - nearest.local_p1).length_squared();
    let farthest = points.iter().copied().max_by(|a, b| from_nearest(a).total_cmp(&from_nearest(b)));
    let Some(farthest) = farthest.filter(|farthest| from_nearest(farthest) > 0.0) else {
        points.clear();
        points.push(nearest);
        return;
    };
    let across = (farthest.local_p1 - nearest.local_p1).cross(normal);
    let side = |point: &TrackedContact<C>| (point.local_p1 - nearest.local_p1).dot(across);
    let left = points.iter().copied().min_by(|a, b| side(a).total_cmp(&side(b)));
    let right = points.iter().copied().max_by(|a, b| side(a).total_cmp(&side(b)));
    points.clear();
    points.extend([nearest, farthest]);
    points.extend(left.filter(|left| side(left) < 0.0));
    points.extend(right.filter(|right| side(right) > 0.0));
}

/// A workspace without content.
#[derive(Clone)]
struct Unsteady;

impl WorkspaceData for Unsteady {
    fn as_typed_workspace_data(&self) -> TypedWorkspaceData<'_> {
        TypedWorkspaceData::Custom
    }

    fn clone_dyn(&self) -> Box<dyn WorkspaceData> {
        Box::new(Self)
    }
}
