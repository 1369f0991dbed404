//! The colliders that may touch a surface during a step.

use avian3d::prelude::{
    ActiveCollisionHooks, AngularVelocity, Collider, ColliderDisabled, ColliderOf, ColliderTransform,
    CollidingEntities, CollisionEventsEnabled, CollisionLayers, CollisionMargin, ComputedCenterOfMass, Gravity,
    GravityScale, LinearVelocity, Position, RigidBody, RigidBodyDisabled, Rotation, Sensor, Sleeping,
};
use bevy::platform::collections::HashSet;
use bevy::prelude::*;
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use parry3d::math::Pose as Place;
use parry3d::shape::{HalfSpace, SharedShape};
use tracing::error;

use super::attach::AvianSurface;
use super::step::Stepping;
use super::{MorphAvianCollider, MorphAvianPart};
use crate::physics::expel::Guest;
use crate::physics::near::Visitor;
use crate::physics::passage::Flight;
use crate::physics::range::{MAX_COORDINATE, box_in_range, in_range};
use crate::physics::sorted_boxes::SortedBoxes;

/// A collider that may touch a surface.
pub(super) struct Mover {
    /// A collider without a body counts as its own body.
    pub(super) visitor: Visitor<Entity, Entity>,
    pub(super) layers: CollisionLayers,
    /// Whether surfaces push it. If not, it is a sensor or on a body that nothing pushes, and matters only if something listens
    /// for its contacts.
    pub(super) pushed: bool,
    /// Whether it needs to know what it touches.
    pub(super) listens: bool,
    pub(super) velocity: Vec3,
    /// Its shape and how it moves, if surfaces push it and collision hooks do not decide what it touches.
    pub(super) flight: Option<(SharedShape, Flight)>,
    /// Set if surfaces push it and one of them is solid: the collider as a solid surface sees it.
    pub(super) guest: Option<Guest>,
}

/// All colliders that may touch a surface.
#[derive(Default)]
pub(super) struct Movers {
    all: Vec<Mover>,
    boxes: SortedBoxes,
}

impl Movers {
    pub(super) fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Returns the movers that may be in a box during the step. `places` is scratch memory.
    pub(super) fn meeting<'a>(&'a self, bounds: &Aabb, places: &'a mut Vec<u32>) -> impl Iterator<Item = &'a Mover> {
        self.boxes.meeting(bounds, places);
        places.iter().map(|&place| &self.all[place as usize])
    }
}

/// Collects the colliders that surfaces may push or whose contacts with surfaces something listens for, and where they may be
/// during the step.
///
/// Skips colliders that are too large for Parry, or too fast, and logs this once.
pub(super) fn find_movers(
    colliders: Query<
        (
            Entity,
            &Collider,
            (&Position, &Rotation),
            (Option<&ColliderOf>, Option<&ColliderTransform>),
            &CollisionLayers,
            Option<&CollisionMargin>,
            (Has<Sensor>, Has<AvianSurface>),
            (Has<CollisionEventsEnabled>, Has<CollidingEntities>),
            Has<ActiveCollisionHooks>,
        ),
        (Without<ColliderDisabled>, Without<MorphAvianPart>),
    >,
    bodies: Query<
        (
            &RigidBody,
            &Position,
            &Rotation,
            &LinearVelocity,
            &AngularVelocity,
            &ComputedCenterOfMass,
            Option<&GravityScale>,
            Has<Sleeping>,
            Has<RigidBodyDisabled>,
        ),
        Without<MorphAvianPart>,
    >,
    surfaces: Query<&MorphAvianCollider, With<AvianSurface>>,
    names: Query<NameOrEntity>,
    gravity: Res<Gravity>,
    time: Res<Time>,
    mut stepping: ResMut<Stepping>,
) {
    let Stepping { movers, too_large, .. } = &mut *stepping;
    let Movers { all: movers, boxes } = movers;
    movers.clear();
    if surfaces.is_empty() {
        boxes.take(std::iter::empty(), 0);
        too_large.clear();
        return;
    }
    let dt = time.delta_secs();
    let any_solid = surfaces.iter().any(|surface| surface.solid);
    let mut refused = HashSet::default();
    for (entity, collider, own_place, (of, in_body), layers, margin, (sensor, surface), listens, hooked) in &colliders {
        let body = of.and_then(|of| bodies.get(of.body).ok().map(|state| (of.body, state)));
        let is_dynamic = body.is_some_and(|(_, state)| *state.0 == RigidBody::Dynamic);
        let disabled = body.is_some_and(|(_, state)| state.8);
        let pushed = is_dynamic && !sensor && !disabled;
        let moves = body.is_some_and(|(_, state)| *state.0 != RigidBody::Static);
        // Nothing else is pushed or needs contacts: walls, ground, and surfaces whose parts touch bodies.
        if !pushed && ((!sensor && !moves) || (surface && !is_dynamic)) {
            continue;
        }
        let shape = collider.shape_scaled();
        let place = |position: &Position, rotation: &Rotation| Place::from_parts(position.0, rotation.0);
        let mut asleep = false;
        let (mut way, mut velocity, mut turn, mut radius) = (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, 0.0);
        let mut stands = place(own_place.0, own_place.1);
        let bounds = match body {
            None => shape.compute_aabb(&stands),
            Some((body, (kind, position, rotation, linear, angular, center_of_mass, scale, sleeps, _))) => {
                asleep = sleeps;
                let in_body = in_body.filter(|_| body != entity);
                let in_body = in_body.map_or(Place::IDENTITY, |it| Place::from_parts(it.translation, it.rotation));
                stands = place(position, rotation) * in_body;
                velocity = linear.0;
                let now = shape.compute_aabb(&stands);
                if asleep || *kind == RigidBody::Static {
                    now
                } else {
                    let falls = if is_dynamic {
                        gravity.0 * scale.map_or(1.0, |scale| scale.0) * dt
                    } else {
                        Vec3::ZERO
                    };
                    way = (linear.0 + falls) * dt;
                    turn = angular.0 * dt;
                    radius =
                        now.center().distance(position.0 + rotation.0 * center_of_mass.0) + now.half_extents().length();
                    let turned = Quat::from_scaled_axis(turn) * rotation.0;
                    // It rotates about its centre of mass.
                    let aside = rotation.0 * center_of_mass.0 - turned * center_of_mass.0;
                    let next = Place::from_parts(position.0 + way + aside, turned);
                    now.merged(&shape.compute_aabb(&(next * in_body)))
                }
            }
        };
        if !box_in_range(&bounds) {
            // Movers that are merely far away, or not at a finite position, are not reported: no surface is there.
            let is_near = in_range(bounds.center() - 0.5 * way) || !in_range(way);
            if pushed && is_near && shape.as_shape::<HalfSpace>().is_none() {
                if !too_large.contains(&entity) {
                    let name = names.get(entity).map(|name| name.to_string()).unwrap_or_default();
                    error!(
                        "the collider of entity `{name}` is more than {MAX_COORDINATE:e} units large, or moves that far in a step: no \
                         deforming surface pushes it; make it smaller"
                    );
                }
                refused.insert(entity);
            }
            continue;
        }
        let flight = (pushed && !hooked).then(|| {
            let flight = Flight {
                place: stands,
                way,
                turn,
                radius,
            };
            (shape.clone(), flight)
        });
        let guest = (any_solid && pushed).then(|| Guest::of(shape.0.as_ref(), &stands, bounds.extents().length()));
        movers.push(Mover {
            visitor: Visitor {
                collider: entity,
                body: body.map_or(entity, |(body, _)| body),
                bounds: bounds.loosened(margin.map_or(0.0, |margin| margin.0.max(0.0))),
                asleep,
            },
            layers: *layers,
            pushed,
            listens: listens.0 || listens.1,
            velocity,
            flight,
            guest: guest.flatten(),
        });
    }
    boxes.take(movers.iter().map(|mover| mover.visitor.bounds), surfaces.iter().len());
    *too_large = refused;
}
