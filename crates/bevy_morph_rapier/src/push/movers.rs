//! The colliders of dynamic bodies, which may touch a surface during a step.

use bevy::math::Vec3;
use bevy_morph_physics::math::SortedBoxes;
use bevy_morph_physics::push::{FAST, Flight, Ground, NearbyCollider};
use bevy_morph_physics::shape::{Patch, box_in_range, in_range};
use bevy_rapier3d::parry::bounding_volume::{Aabb, BoundingVolume};
use bevy_rapier3d::parry::math::Pose as Isometry;
use bevy_rapier3d::parry::shape::HalfSpace;
use bevy_rapier3d::rapier::dynamics::{RigidBody, RigidBodyHandle, RigidBodySet};
use bevy_rapier3d::rapier::geometry::{Collider, ColliderHandle, ColliderSet, InteractionGroups};
use bevy_rapier3d::rapier::pipeline::ActiveEvents;

use crate::queries::MARGIN;

/// Whether a collider is a part of a surface.
pub(crate) fn is_part(collider: &Collider) -> bool {
    collider.shape().as_shape::<Patch>().is_some()
}

/// A collider of a dynamic body.
#[derive(Clone, Copy)]
pub(crate) struct Mover {
    pub(crate) nearby: NearbyCollider<ColliderHandle, RigidBodyHandle>,
    /// How far ahead of it contacts must be prepared, because it moves fast. 0 if the usual distance is enough.
    pub(crate) look_ahead: f32,
    /// Whether it moves so far in the step that it must be swept.
    pub(crate) fast: bool,
    /// How it moves, if contact hooks do not decide what it touches.
    pub(crate) flight: Option<Flight>,
    /// Whether the game made it a bullet.
    pub(crate) bullet: bool,
    pub(crate) groups: InteractionGroups,
    pub(crate) events: ActiveEvents,
}

/// All colliders of dynamic bodies that surfaces may push.
#[derive(Default)]
pub(crate) struct Movers {
    all: Vec<Mover>,
    boxes: SortedBoxes,
}

impl Movers {
    pub(crate) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Returns the movers that may be in a box during the step, in the order of their bodies. `indices` is scratch memory.
    pub(crate) fn meeting<'a>(&'a self, bounds: &Aabb, indices: &'a mut Vec<u32>) -> impl Iterator<Item = &'a Mover> {
        self.boxes.meeting(bounds, indices);
        indices.iter().map(|&index| &self.all[index as usize])
    }

    /// Collects all movers and where they may be during a step. `surfaces` is the number of searches that follow.
    ///
    /// Skips movers that are too large for Parry, or too fast, and reports them to `refuse` by their user data.
    pub(crate) fn find(
        &mut self,
        bodies: &RigidBodySet,
        colliders: &ColliderSet,
        dt: f32,
        surfaces: usize,
        refuse: &mut impl FnMut(u128),
    ) {
        find_movers(bodies, colliders, dt, &mut self.all, refuse);
        self.boxes
            .take(self.all.iter().map(|mover| mover.nearby.bounds), surfaces);
    }
}

/// How a collider of a body moves in a step that takes the body to `next`. `bounds` is around the collider.
fn flight(body: &RigidBody, next: &Isometry, in_body: &Isometry, bounds: &Aabb, dt: f32) -> Flight {
    let center = body.center_of_mass();
    Flight {
        isometry: *body.position() * *in_body,
        way: next.transform_point(body.local_center_of_mass()) - center,
        turn: body.angvel() * dt,
        radius: bounds.center().distance(center) + bounds.half_extents().length(),
    }
}

fn find_movers(
    bodies: &RigidBodySet,
    colliders: &ColliderSet,
    dt: f32,
    movers: &mut Vec<Mover>,
    refuse: &mut impl FnMut(u128),
) {
    movers.clear();
    for (handle, body) in bodies.iter() {
        if !body.is_dynamic() || !body.is_enabled() {
            continue;
        }
        let asleep = body.is_sleeping();
        let next = body.predict_position_using_velocity_and_forces(dt);
        for &collider in body.colliders() {
            let Some(shape) = colliders.get(collider) else { continue };
            if shape.is_sensor() || !shape.is_enabled() || is_part(shape) {
                continue;
            }
            let in_body = shape.position_wrt_parent().copied().unwrap_or_default();
            // If the game moved the body, its colliders follow only in the step.
            let mut bounds = shape.shape().compute_aabb(&(*body.position() * in_body));
            let thin = bounds.extents().min_element();
            let mut flight = flight(body, &next, &in_body, &bounds, dt);
            if asleep {
                flight.way = Vec3::ZERO;
                flight.turn = Vec3::ZERO;
            }
            if !asleep {
                bounds = bounds.merged(&shape.shape().compute_aabb(&(next * in_body)));
            }
            if !box_in_range(&bounds) {
                // Movers that are merely far away, or not at a finite position, are not reported: no surface is there.
                if in_range(body.translation()) && shape.shape().as_shape::<HalfSpace>().is_none() {
                    refuse(shape.user_data);
                }
                continue;
            }
            movers.push(Mover {
                nearby: NearbyCollider {
                    collider,
                    body: handle,
                    bounds: bounds.loosened(shape.contact_skin()),
                    asleep,
                },
                // Not less if it moves less far: then boxes would grow in small steps, and each change costs.
                look_ahead: if flight.relative_to(&Ground::Still) > FAST * thin {
                    MARGIN * shape.shape().ccd_thickness()
                } else {
                    0.0
                },
                fast: flight.way.length() > FAST * thin,
                flight: shape.active_hooks().is_empty().then_some(flight),
                bullet: body.is_ccd_enabled(),
                groups: shape.collision_groups(),
                events: shape.active_events(),
            });
        }
    }
}
