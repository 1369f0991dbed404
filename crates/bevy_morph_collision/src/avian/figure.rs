//! The colliders of a character, and the body that moves with them.

use avian3d::prelude::{
    Collider, ColliderDisabled, ColliderOf, ColliderTransform, CollisionLayers, Position, RigidBodyColliders, Rotation,
    Sensor, SpatialQueryFilter,
};
use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use parry3d::math::Pose as Place;

/// The colliders of characters.
#[derive(SystemParam)]
pub(super) struct Figures<'w, 's> {
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
pub(super) struct Figure<'a> {
    /// The body that moves, or the collider itself if it has none.
    pub(super) root: Entity,
    /// Shapes, and their places relative to the root.
    shapes: Vec<(&'a Collider, Place)>,
    layers: Option<CollisionLayers>,
    own: Vec<Entity>,
}

impl Figures<'_, '_> {
    /// The collider of a character, or all colliders of its body if it has none itself. `None` if there are none at all.
    pub(super) fn of(&self, character: Entity) -> Option<Figure<'_>> {
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
            let in_body = in_body.filter(|_| entity != root);
            let in_body = in_body.map_or(Place::IDENTITY, |it| Place::from_parts(it.translation, it.rotation));
            Some((shape, in_body))
        });
        let shapes: Vec<_> = shapes.collect();
        (!shapes.is_empty()).then(|| Figure {
            root,
            shapes,
            layers,
            own: of_body().chain([root, character]).collect(),
        })
    }
}

impl Figure<'_> {
    /// What the character does not collide with while it looks for ground or is carried.
    pub(super) fn sight(&self) -> SpatialQueryFilter {
        let filter = SpatialQueryFilter::from_excluded_entities(self.own.iter().copied());
        match self.layers {
            Some(layers) => filter.with_mask(layers.filters),
            None => filter,
        }
    }

    /// Its shapes, and where they are if the root is at this place.
    pub(super) fn shapes_at(
        &self,
        position: Vec3,
        rotation: Rotation,
    ) -> impl Iterator<Item = (&Collider, Position, Rotation)> {
        let root = Place::from_parts(position, rotation.0);
        self.shapes.iter().map(move |(shape, in_body)| {
            let place = root * *in_body;
            (*shape, Position(place.translation), Rotation(place.rotation))
        })
    }
}
