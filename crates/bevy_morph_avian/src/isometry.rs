//! Where Avian's colliders are.

use avian3d::prelude::{ColliderTransform, Position, Rotation};
use parry3d::math::Pose as Isometry;

/// Where an entity is.
pub(crate) fn isometry(position: &Position, rotation: &Rotation) -> Isometry {
    Isometry::from_parts(position.0, rotation.0)
}

/// Where a collider is in its body. `None` is a collider on the body itself.
pub(crate) fn isometry_in_body(transform: Option<&ColliderTransform>) -> Isometry {
    transform.map_or(Isometry::IDENTITY, |it| {
        Isometry::from_parts(it.translation, it.rotation)
    })
}
