//! The colliders of a character, and the body that moves with them.

use avian3d::prelude::{
    Collider, ColliderDisabled, ColliderOf, ColliderTransform, CollisionLayers, Position, RigidBodyColliders, Rotation,
    Sensor, SpatialQueryFilter,
};
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use parry3d::math::Pose as Isometry;

use crate::isometry::isometry_in_body;

/// The colliders of characters.
#[derive(SystemParam)]
pub(crate) struct CharacterShapes<'w, 's> {
    colliders: Query<
        'w,
        's,
        (
            &'static Collider,
            Option<&'static ColliderOf>,
            Option<&'static ColliderTransform>,
            Option<&'static CollisionLayers>,
            Has<Sensor>,
        ),
        Without<ColliderDisabled>,
    >,
    bodies: Query<'w, 's, &'static RigidBodyColliders>,
}

/// A character's colliders.
pub(crate) struct CharacterShape<'a> {
    /// The body that moves, or the collider itself if it has none.
    pub(crate) root: Entity,
    /// Shapes, and where they are relative to the root.
    shapes: Vec<(&'a Collider, Isometry)>,
    layers: Option<CollisionLayers>,
    own: Vec<Entity>,
}

impl CharacterShapes<'_, '_> {
    /// The collider of a character, or all colliders of its body if it has none itself. `None` if there are none at all.
    pub(crate) fn of(&self, character: Entity) -> Option<CharacterShape<'_>> {
        let collider = self.colliders.get(character).ok();
        let of = collider.as_ref().and_then(|(_, of, ..)| *of);
        let root = of.map_or(character, |of| of.body);
        let of_body = || self.bodies.get(root).into_iter().flat_map(RelationshipTarget::iter);
        let wanted: Vec<Entity> = match collider {
            Some(_) => vec![character],
            None => of_body().collect(),
        };
        let mut layers = None;
        let shapes = wanted.into_iter().filter_map(|entity| {
            let (shape, _, in_body, own_layers, is_sensor) = self.colliders.get(entity).ok()?;
            if is_sensor && entity != character {
                return None;
            }
            layers = layers.or(own_layers.copied());
            Some((shape, isometry_in_body(in_body.filter(|_| entity != root))))
        });
        let shapes: Vec<_> = shapes.collect();
        (!shapes.is_empty()).then(|| CharacterShape {
            root,
            shapes,
            layers,
            own: of_body().chain([root, character]).collect(),
        })
    }
}

impl CharacterShape<'_> {
    /// What the character does not collide with while it looks for ground or is carried.
    pub(crate) fn filter(&self) -> SpatialQueryFilter {
        let filter = SpatialQueryFilter::from_excluded_entities(self.own.iter().copied());
        match self.layers {
            Some(layers) => filter.with_mask(layers.filters),
            None => filter,
        }
    }

    /// Its shapes, and where they are if the root is there.
    pub(crate) fn shapes_at(
        &self,
        position: Vec3,
        rotation: Rotation,
    ) -> impl Iterator<Item = (&Collider, Position, Rotation)> {
        let root = Isometry::from_parts(position, rotation.0);
        self.shapes.iter().map(move |(shape, in_body)| {
            let isometry = root * *in_body;
            (*shape, Position(isometry.translation), Rotation(isometry.rotation))
        })
    }
}
