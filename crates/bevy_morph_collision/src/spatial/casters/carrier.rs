//! Where casters are, and on which body.

use bevy::ecs::system::SystemParam;
use bevy::math::{DMat3, DQuat};
use bevy::prelude::*;

use crate::components::{MorphColliderOf, MorphColliders, body_of};
use crate::spatial::MorphQueryFilter;
use crate::state::ColliderState;

/// Finds the bodies on which casters are.
#[derive(SystemParam)]
pub(super) struct Carriers<'w, 's> {
    parents: Query<'w, 's, &'static ChildOf>,
    bodies: Query<
        'w,
        's,
        (Option<&'static MorphColliderOf>, Has<ColliderState>),
        Or<(With<ColliderState>, With<MorphColliders>)>,
    >,
}

impl Carriers<'_, '_> {
    /// A caster's filter, without the body that it is on if that is to be ignored.
    pub(super) fn filter(&self, caster: Entity, filter: &MorphQueryFilter, ignore_self: bool) -> MorphQueryFilter {
        let own = if ignore_self { self.body(caster) } else { None };
        filter.clone().with_excluded_entities(own)
    }

    /// The body that an entity is, belongs to, or is attached to.
    fn body(&self, caster: Entity) -> Option<Entity> {
        let mut path = std::iter::once(caster).chain(self.parents.iter_ancestors(caster));
        path.find_map(|entity| {
            let (of, is_collider) = self.bodies.get(entity).ok()?;
            Some(if is_collider { body_of(entity, of) } else { entity })
        })
    }
}

/// A point, a rotation and a direction in an entity's space, in world space.
pub(super) fn to_world(
    place: &GlobalTransform,
    origin: Vec3,
    rotation_inside: Quat,
    direction: Dir3,
) -> Result<(Vec3, Quat, Dir3), String> {
    let turned = rotation(place);
    let direction = Dir3::new((turned * direction.as_dvec3()).as_vec3())
        .map_err(|_| "its GlobalTransform has no rotation: a scale is 0 or a number is not finite".to_owned())?;
    let rotation = (turned * rotation_inside.as_dquat()).as_quat();
    Ok((place.transform_point(origin), rotation, direction))
}

/// The rotation as [`GlobalTransform::rotation`] defines it, with the same bits on every machine: vector instructions add in different orders.
fn rotation(place: &GlobalTransform) -> DQuat {
    let linear = place.affine().matrix3.as_dmat3();
    let mirrors = if linear.determinant() < 0.0 { -1.0 } else { 1.0 };
    let [x, y, z] = [linear.x_axis * mirrors, linear.y_axis, linear.z_axis].map(|axis| axis / axis.length());
    DQuat::from_mat3(&DMat3::from_cols(x, y, z))
}
