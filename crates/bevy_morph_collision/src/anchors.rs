//! Entities that stick to a posed surface.

use bevy::platform::time::Instant;

use bevy::prelude::*;
use morph_collision::{Body, SurfaceAnchor};

use crate::collider::{ColliderState, Form};
use crate::diagnostics::MorphCollisionDiagnostics;
use crate::spatial::MorphRayHit;

/// Keeps this entity on a place of a collider's surface as the shape morphs and moves: for decals, hats, particles.
///
/// The entity's [`Transform`] is written every run, relative to its parent if it has one, and the [`GlobalTransform`]s of the
/// entity and of what hangs on it with it, so that all are right in the same frame. Its scale stays. While there is no
/// such triangle, or no such collider, nothing is written.
#[derive(Component, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Component, Debug, Clone, PartialEq)]
#[require(Transform)]
pub struct MorphSurfaceAnchor {
    /// The collider to whose mesh it sticks.
    #[entities]
    pub collider: Entity,
    /// The triangle's number in the mesh.
    pub triangle: u32,
    /// The weights of the triangle's corners.
    pub barycentrics: Vec3,
    /// How far out of the surface, along its normal, in world units.
    pub offset: f32,
    /// Whether the entity turns with the surface: its +Y along the normal, its +X along the triangle's first edge.
    pub align: bool,
}

impl MorphSurfaceAnchor {
    /// On the surface, turning with it.
    #[must_use]
    pub fn new(collider: Entity, triangle: u32, barycentrics: Vec3) -> Self {
        Self {
            collider,
            triangle,
            barycentrics,
            offset: 0.0,
            align: true,
        }
    }

    /// Where a ray hit.
    #[must_use]
    pub fn at(hit: &MorphRayHit) -> Self {
        Self::new(hit.entity, hit.triangle, hit.barycentrics)
    }

    /// The same, out of the surface.
    #[must_use]
    pub fn with_offset(mut self, offset: f32) -> Self {
        self.offset = offset;
        self
    }
}

/// Brings every anchored entity to its place, those above others in the hierarchy first.
pub(crate) fn follow_surfaces(
    anchors: Query<(Entity, &MorphSurfaceAnchor, Option<&ChildOf>)>,
    mut colliders: Query<&mut ColliderState>,
    mut transforms: Query<(&mut Transform, &mut GlobalTransform)>,
    parents: Query<&ChildOf>,
    children: Query<&Children>,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
) {
    let start = Instant::now();
    let mut anchored: Vec<_> = anchors.iter().collect();
    anchored.sort_by_cached_key(|&(entity, ..)| (parents.iter_ancestors(entity).count(), entity));
    for (entity, anchor, parent) in anchored {
        let Some(world) = colliders
            .get_mut(anchor.collider)
            .ok()
            .and_then(|mut state| place(anchor, &mut state))
        else {
            continue;
        };
        let parent = parent.and_then(|parent| transforms.get(parent.parent()).ok());
        let world_from_parent = parent.map_or(GlobalTransform::IDENTITY, |(_, world)| *world);
        let Ok((mut local, mut global)) = transforms.get_mut(entity) else {
            continue;
        };
        let parent_from_world = world_from_parent.affine().inverse();
        let mut next = *local;
        next.translation = parent_from_world.transform_point3(world.point);
        if let Some([tangent, normal]) = world.axes {
            // The parent may be stretched or mirrored: what it makes of +Y is along the normal.
            let [x, y] = [tangent, normal].map(|axis| parent_from_world.transform_vector3(axis));
            let y = y.normalize_or_zero();
            let x = (x - y * y.dot(x)).normalize_or_zero();
            next.rotation = Quat::from_mat3(&Mat3::from_cols(x, y, x.cross(y))).normalize();
        }
        if next != *local && next.is_finite() {
            *local = next;
            *global = world_from_parent * next;
            let below = *global;
            spread(entity, below, &children, &mut transforms);
        }
    }
    diagnostics.duration += start.elapsed();
}

/// Where an anchor is, and the surface's tangent and normal if it turns with them.
struct Anchored {
    point: Vec3,
    axes: Option<[Vec3; 2]>,
}

fn place(anchor: &MorphSurfaceAnchor, state: &mut ColliderState) -> Option<Anchored> {
    let Form::Mesh(world_from_model) = state.placed?.form else {
        return None;
    };
    let pose = state.pose.as_mut()?;
    let on_surface = SurfaceAnchor {
        triangle: anchor.triangle,
        barycentrics: anchor.barycentrics.as_dvec3().to_array(),
    };
    let Some(frame) = on_surface.frame(Body::new(pose, &world_from_model)) else {
        // A triangle without area has a place still.
        let point = on_surface.point(Body::new(pose, &world_from_model))?.as_vec3();
        return Some(Anchored { point, axes: None });
    };
    Some(Anchored {
        point: (frame.point + frame.normal * f64::from(anchor.offset)).as_vec3(),
        axes: anchor.align.then(|| [frame.tangent.as_vec3(), frame.normal.as_vec3()]),
    })
}

/// Global transforms below an entity that moved after transforms were propagated.
fn spread(
    entity: Entity,
    world: GlobalTransform,
    children: &Query<&Children>,
    transforms: &mut Query<(&mut Transform, &mut GlobalTransform)>,
) {
    for child in children.get(entity).into_iter().flatten().copied() {
        if let Ok((local, mut global)) = transforms.get_mut(child) {
            *global = world * *local;
            let below = *global;
            spread(child, below, children, transforms);
        }
    }
}
