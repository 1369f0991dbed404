//! Parts of surfaces as Rapier bodies: kinematic bodies, or links if the surface is on a dynamic body.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use bevy::prelude::Entity;
use bevy_rapier3d::parry::math::Pose as Isometry;
use bevy_rapier3d::parry::shape::{SharedShape, Triangle, TrianglePseudoNormals};
use bevy_rapier3d::rapier::dynamics::{RigidBodyBuilder, RigidBodyHandle, RigidBodyType};
use bevy_rapier3d::rapier::geometry::{ActiveCollisionTypes, ColliderBuilder, ColliderHandle};

use super::link::{Carrier, Link};
use super::material::ContactMaterial;
use super::world::World;
use bevy_morph_physics::push::{Bodies, PartMotion};
use bevy_morph_physics::shape::{LookAhead, Patch, Triangles};

/// The handles of a part in Rapier.
pub(crate) struct PartHandles {
    pub(crate) body: RigidBodyHandle,
    pub(crate) collider: ColliderHandle,
}

impl Default for PartHandles {
    fn default() -> Self {
        Self {
            body: RigidBodyHandle::invalid(),
            collider: ColliderHandle::invalid(),
        }
    }
}

/// A physics world, and the properties of one surface's parts in it.
pub(crate) struct PartBodies<'a, 'w> {
    pub(crate) entity: Entity,
    pub(crate) material: ContactMaterial,
    pub(crate) stepping: &'a Arc<AtomicBool>,
    /// The dynamic body on which the surface is, if any.
    pub(crate) carrier: Option<&'a mut Carrier>,
    pub(crate) world: &'a mut World<'w>,
}

impl Bodies<PartHandles> for PartBodies<'_, '_> {
    fn set(
        &mut self,
        part: &mut PartHandles,
        motion: &PartMotion,
        triangles: impl ExactSizeIterator<Item = (Triangle, Option<TrianglePseudoNormals>)>,
    ) {
        let PartMotion {
            linear,
            angular,
            // Includes contacts with what the part will reach during the step.
            reach,
            ..
        } = *motion;
        let place = Isometry::from_translation(motion.origin);
        let world = &mut *self.world;
        let (mut body_type, mut types) = (
            RigidBodyType::KinematicVelocityBased,
            ActiveCollisionTypes::DYNAMIC_KINEMATIC,
        );
        let (mut linear, mut angular, mut reach) = (linear, angular, reach);
        if let Some(carrier) = &self.carrier {
            (body_type, types) = (RigidBodyType::Dynamic, carrier.types);
            // Decides how far away contacts are prepared.
            linear += carrier.velocity.linvel + carrier.velocity.angvel.cross(motion.origin - carrier.center);
            angular += carrier.velocity.angvel;
            reach = reach.max(carrier.soft_ccd_prediction);
        }
        if let Some(body) = world.bodies.get_mut(part.body) {
            body.set_position(place, false);
            body.set_linvel(linear, false);
            body.set_angvel(angular, false);
            body.set_soft_ccd_prediction(reach);
        } else {
            let body = RigidBodyBuilder::new(body_type)
                .pose(place)
                .can_sleep(body_type != RigidBodyType::Dynamic)
                .linvel(linear)
                .angvel(angular)
                .soft_ccd_prediction(reach)
                .user_data(u128::from(self.entity.to_bits()));
            part.body = world.bodies.insert(body);
        }
        if let Some(carrier) = &mut self.carrier {
            carrier.links.push(Link::new(part.body, motion, carrier));
        }
        let patch = |(corners, normals): (Vec<_>, Vec<_>)| Patch {
            triangles: Triangles::new(Vec::new(), corners, normals),
            stepping: self.stepping.clone(),
            reach: 0.0,
            look_ahead: LookAhead::default(),
            velocity: [linear, angular],
        };
        let Some(collider) = world.colliders.get_mut(part.collider) else {
            let mut collider = ColliderBuilder::new(SharedShape::new(patch(triangles.unzip())))
                .density(0.0)
                .active_collision_types(types)
                .user_data(u128::from(self.entity.to_bits()))
                .build();
            self.material.apply_to(&mut collider);
            part.collider = world.colliders.insert_with_parent(collider, part.body, world.bodies);
            return;
        };
        let count = triangles.len();
        let shape = collider.shape_mut().as_shape_mut::<Patch>();
        match shape.filter(|patch| !motion.reshaped && patch.triangles.len() == count) {
            Some(patch) => {
                patch.velocity = [linear, angular];
                patch.triangles.move_to(triangles);
            }
            None => collider.set_shape(SharedShape::new(patch(triangles.unzip()))),
        }
    }

    fn remove(&mut self, part: PartHandles) {
        self.world.remove(part.body);
    }
}
