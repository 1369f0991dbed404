//! Finds the colliders that may touch a surface during a step.

use avian3d::prelude::{
    ActiveCollisionHooks, AngularVelocity, Collider, ColliderDisabled, ColliderOf, ColliderTransform,
    CollidingEntities, CollisionEventsEnabled, CollisionLayers, CollisionMargin, ComputedCenterOfMass, Gravity,
    GravityScale, LinearVelocity, Position, RigidBody, RigidBodyDisabled, Rotation, Sensor, Sleeping,
};
use bevy::ecs::query::QueryData;
use bevy::platform::collections::HashSet;
use bevy::prelude::*;
use bevy_morph_physics::MorphPhysicsCollider;
use bevy_morph_physics::push::{EnclosedCollider, Flight, NearbyCollider};
use bevy_morph_physics::shape::{MAX_COORDINATE, box_in_range, in_range};
use parry3d::bounding_volume::{Aabb, BoundingVolume};
use parry3d::math::Pose as Isometry;
use parry3d::shape::{HalfSpace, SharedShape};
use tracing::error;

use super::stepping::Stepping;
use crate::isometry::{isometry, isometry_in_body};
use crate::push::{MorphAvianPart, Mover};
use crate::surface::AvianSurface;

/// A collider.
#[derive(QueryData)]
pub(crate) struct MoverCollider {
    entity: Entity,
    collider: &'static Collider,
    position: &'static Position,
    rotation: &'static Rotation,
    of: Option<&'static ColliderOf>,
    in_body: Option<&'static ColliderTransform>,
    layers: &'static CollisionLayers,
    margin: Option<&'static CollisionMargin>,
    is_sensor: Has<Sensor>,
    is_surface: Has<AvianSurface>,
    wants_events: Has<CollisionEventsEnabled>,
    wants_colliding: Has<CollidingEntities>,
    has_hooks: Has<ActiveCollisionHooks>,
}

/// The body of a collider.
#[derive(QueryData)]
pub(crate) struct MoverBody {
    entity: Entity,
    kind: &'static RigidBody,
    position: &'static Position,
    rotation: &'static Rotation,
    linear: &'static LinearVelocity,
    angular: &'static AngularVelocity,
    center_of_mass: &'static ComputedCenterOfMass,
    gravity: Option<&'static GravityScale>,
    is_asleep: Has<Sleeping>,
    is_disabled: Has<RigidBodyDisabled>,
}

impl MoverBodyItem<'_, '_> {
    fn is_dynamic(&self) -> bool {
        *self.kind == RigidBody::Dynamic
    }
}

/// How a collider moves in a step.
struct Motion {
    flight: Flight,
    /// The box in which it stays.
    bounds: Aabb,
}

impl Motion {
    fn of(collider: &MoverColliderItem, body: Option<&MoverBodyItem>, gravity: Vec3, dt: f32) -> Self {
        let shape = collider.collider.shape_scaled();
        let Some(body) = body else {
            return Self::rest(shape, isometry(collider.position, collider.rotation));
        };
        let in_body = isometry_in_body(collider.in_body.filter(|_| body.entity != collider.entity));
        let now = isometry(body.position, body.rotation) * in_body;
        if body.is_asleep || *body.kind == RigidBody::Static {
            return Self::rest(shape, now);
        }
        let falls = if body.is_dynamic() {
            gravity * body.gravity.map_or(1.0, |scale| scale.0) * dt
        } else {
            Vec3::ZERO
        };
        let (position, rotation, center) = (body.position.0, body.rotation, body.center_of_mass.0);
        let way = (body.linear.0 + falls) * dt;
        let turn = body.angular.0 * dt;
        let turned = Quat::from_scaled_axis(turn) * rotation.0;
        // It rotates about its centre of mass.
        let aside = *rotation * center - turned * center;
        let next = Isometry::from_parts(position + way + aside, turned) * in_body;
        let bounds = shape.compute_aabb(&now);
        Self {
            flight: Flight {
                isometry: now,
                way,
                turn,
                radius: bounds.center().distance(position + *rotation * center) + bounds.half_extents().length(),
            },
            bounds: bounds.merged(&shape.compute_aabb(&next)),
        }
    }

    fn rest(shape: &SharedShape, isometry: Isometry) -> Self {
        Self {
            flight: Flight {
                isometry,
                way: Vec3::ZERO,
                turn: Vec3::ZERO,
                radius: 0.0,
            },
            bounds: shape.compute_aabb(&isometry),
        }
    }

    /// Whether it is where a surface may be. If not, nothing has to be said of it.
    fn is_near(&self) -> bool {
        let way = self.flight.way;
        in_range(self.bounds.center() - 0.5 * way) || !in_range(way)
    }
}

/// Collects the colliders that surfaces may push or whose contacts with surfaces something listens for, and where they may be
/// during the step.
///
/// Skips colliders that are too large for Parry, or too fast, and logs this once.
pub(crate) fn find_movers(
    colliders: Query<MoverCollider, (Without<ColliderDisabled>, Without<MorphAvianPart>)>,
    bodies: Query<MoverBody, Without<MorphAvianPart>>,
    surfaces: Query<&MorphPhysicsCollider, With<AvianSurface>>,
    names: Query<NameOrEntity>,
    gravity: Res<Gravity>,
    time: Res<Time>,
    mut stepping: ResMut<Stepping>,
) {
    let Stepping { movers, too_large, .. } = &mut *stepping;
    if surfaces.is_empty() {
        movers.set(Vec::new(), 0);
        too_large.clear();
        return;
    }
    let dt = time.delta_secs();
    let any_solid = surfaces.iter().any(|surface| surface.solid);
    let (mut found, mut refused) = (movers.take(), HashSet::default());
    for collider in &colliders {
        let body = collider.of.and_then(|of| bodies.get(of.body).ok());
        let is_dynamic = body.as_ref().is_some_and(MoverBodyItem::is_dynamic);
        let is_disabled = body.as_ref().is_some_and(|body| body.is_disabled);
        let pushed = is_dynamic && !collider.is_sensor && !is_disabled;
        let moves = body.as_ref().is_some_and(|body| *body.kind != RigidBody::Static);
        // Nothing else is pushed or needs contacts: walls, ground, and surfaces whose parts touch bodies.
        if !pushed && ((!collider.is_sensor && !moves) || (collider.is_surface && !is_dynamic)) {
            continue;
        }
        let motion = Motion::of(&collider, body.as_ref(), gravity.0, dt);
        let shape = collider.collider.shape_scaled();
        if !box_in_range(&motion.bounds) {
            if pushed && motion.is_near() && shape.as_shape::<HalfSpace>().is_none() {
                if !too_large.contains(&collider.entity) {
                    let name = names.get(collider.entity).map(|name| name.to_string());
                    log_too_large(&name.unwrap_or_default());
                }
                refused.insert(collider.entity);
            }
            continue;
        }
        let bounds = motion.bounds;
        let enclosed = (any_solid && pushed)
            .then(|| EnclosedCollider::of(shape.0.as_ref(), &motion.flight.isometry, bounds.extents().length()));
        found.push(Mover {
            nearby: NearbyCollider {
                collider: collider.entity,
                body: body.as_ref().map_or(collider.entity, |body| body.entity),
                bounds: bounds.loosened(collider.margin.map_or(0.0, |margin| margin.0.max(0.0))),
                asleep: body.as_ref().is_some_and(|body| body.is_asleep),
            },
            layers: *collider.layers,
            pushed,
            listens: collider.wants_events || collider.wants_colliding,
            velocity: body.as_ref().map_or(Vec3::ZERO, |body| body.linear.0),
            flight: (pushed && !collider.has_hooks).then(|| (shape.clone(), motion.flight)),
            enclosed: enclosed.flatten(),
        });
    }
    movers.set(found, surfaces.iter().len());
    *too_large = refused;
}

fn log_too_large(name: &str) {
    error!(
        "the collider of entity `{name}` is more than {MAX_COORDINATE:e} units large, or moves that far in a step: no deforming \
         surface pushes it; make it smaller"
    );
}
