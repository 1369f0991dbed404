//! Parts of surfaces as kinematic bodies of Rapier's.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use bevy::prelude::Entity;
use bevy_rapier3d::parry::math::Pose as Place;
use bevy_rapier3d::parry::shape::{SharedShape, Triangle, TrianglePseudoNormals};
use bevy_rapier3d::rapier::dynamics::{RigidBodyBuilder, RigidBodyHandle};
use bevy_rapier3d::rapier::geometry::{ActiveCollisionTypes, ColliderBuilder, ColliderHandle};

use super::world::{Manners, World};
use crate::physics::part::{Bodies, Placed};
use crate::physics::triangles::{Patch, Triangles};

/// What Rapier knows a part by.
pub(super) struct PartHandles {
    pub(super) body: RigidBodyHandle,
    pub(super) collider: ColliderHandle,
}

impl Default for PartHandles {
    fn default() -> Self {
        Self {
            body: RigidBodyHandle::invalid(),
            collider: ColliderHandle::invalid(),
        }
    }
}

/// A physics world, and what the parts of one surface are like in it.
pub(super) struct PartBodies<'a, 'w> {
    pub(super) entity: Entity,
    pub(super) manners: Manners,
    pub(super) stepping: &'a Arc<AtomicBool>,
    pub(super) world: &'a mut World<'w>,
}

impl Bodies<PartHandles> for PartBodies<'_, '_> {
    fn put(
        &mut self,
        part: &mut PartHandles,
        placed: &Placed,
        triangles: impl ExactSizeIterator<Item = (Triangle, Option<TrianglePseudoNormals>)>,
    ) {
        let Placed {
            linear,
            angular,
            // Contacts with what it will reach during the step, too.
            reach,
            ..
        } = *placed;
        let place = Place::from_translation(placed.origin);
        let world = &mut *self.world;
        if let Some(body) = world.bodies.get_mut(part.body) {
            body.set_position(place, false);
            body.set_linvel(linear, false);
            body.set_angvel(angular, false);
            body.set_soft_ccd_prediction(reach);
        } else {
            let body = RigidBodyBuilder::kinematic_velocity_based()
                .pose(place)
                .linvel(linear)
                .angvel(angular)
                .soft_ccd_prediction(reach)
                .user_data(u128::from(self.entity.to_bits()));
            part.body = world.bodies.insert(body);
        }
        let patch = |(corners, normals): (Vec<_>, Vec<_>)| Patch {
            triangles: Triangles::new(Vec::new(), corners, normals),
            stepping: self.stepping.clone(),
            reach: 0.0,
            velocity: [linear, angular],
        };
        let Some(collider) = world.colliders.get_mut(part.collider) else {
            let mut collider = ColliderBuilder::new(SharedShape::new(patch(triangles.unzip())))
                .density(0.0)
                .active_collision_types(ActiveCollisionTypes::DYNAMIC_KINEMATIC)
                .user_data(u128::from(self.entity.to_bits()))
                .build();
            self.manners.teach(&mut collider);
            part.collider = world.colliders.insert_with_parent(collider, part.body, world.bodies);
            return;
        };
        let count = triangles.len();
        let shape = collider.shape_mut().as_shape_mut::<Patch>();
        match shape.filter(|patch| !placed.reshaped && patch.triangles.len() == count) {
            Some(patch) => {
                patch.velocity = [linear, angular];
                patch.triangles.move_to(triangles);
            }
            None => collider.set_shape(SharedShape::new(patch(triangles.unzip()))),
        }
    }

    fn rest(&mut self, part: &mut PartHandles) {
        let collider = self.world.colliders.get(part.collider);
        if let Some(patch) = collider.and_then(|collider| collider.shape().as_shape::<Patch>()) {
            patch.triangles.stand_still();
        }
    }

    fn remove(&mut self, part: PartHandles) {
        self.world.remove(part.body);
    }
}
