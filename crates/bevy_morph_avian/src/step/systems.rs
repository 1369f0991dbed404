//! Moves surfaces to their pose at the end of Avian's step, creates parts near bodies, and clears up after the solver.

use std::sync::atomic::Ordering;

use avian3d::prelude::{
    Collider, ColliderOf, ColliderTransform, CollisionLayers, LinearVelocity, LockedAxes, Position, RigidBody,
    Rotation, Sensor, SpatialQuery, SpatialQueryFilter, WakeBody,
};
use bevy::ecs::system::SystemParam;
use bevy::platform::time::Instant;
use bevy::prelude::*;
use bevy_morph_physics::MorphPhysicsDiagnostics;
use bevy_morph_physics::engine::Sources;
use bevy_morph_physics::push::{Budget, middle};
use bevy_morph_physics::shape::MassBudget;
use bevy_morph_physics::time::{InFixedLoop, StepTime};

use super::query::{Surface, World};
use super::stages::{Role, StepInput, advance, exclude, push, stop, update_collider};
use super::stepping::Stepping;
use crate::isometry::{isometry, isometry_in_body};
use crate::push::MorphAvianPart;
use crate::surface::AvianSurface;

/// The clocks of physics.
#[derive(SystemParam)]
pub(crate) struct Clocks<'w> {
    time: Res<'w, Time>,
    fixed: Option<Res<'w, Time<Fixed>>>,
    inside: Res<'w, InFixedLoop>,
}

/// Moves surfaces to where they will be at the end of the step, and creates parts for nearby bodies.
pub(crate) fn before_step(
    mut surfaces: Query<Surface, Without<MorphAvianPart>>,
    mut world: World,
    mut sources: Sources,
    clocks: Clocks,
    mut stepping: ResMut<Stepping>,
    mut diagnostics: ResMut<MorphPhysicsDiagnostics>,
) {
    let start = Instant::now();
    *diagnostics = MorphPhysicsDiagnostics::default();
    stepping.has_stepped = true;
    stepping.timing.learn(&clocks.inside);
    if surfaces.is_empty() {
        return;
    }
    let Stepping {
        now,
        movers,
        changed,
        expelled,
        timing,
        ..
    } = &mut *stepping;
    let dt = clocks.time.delta_secs();
    let span = clocks
        .fixed
        .filter(|_| timing.is_fixed)
        .and_then(|fixed| timing.lag.span(fixed.elapsed_secs_f64(), fixed.delta_secs_f64()));
    let time = StepTime { dt, span, share: 1.0 };
    let mut step = StepInput {
        dt,
        now,
        movers,
        changed,
        expelled,
        masses: MassBudget::default(),
    };
    sources.skeletons.notice();
    for mut surface in &mut surfaces {
        let name = || sources.name(surface.entity);
        surface
            .state
            .set_max_acceleration(surface.settings, world.length_unit.0, name);
        let body = surface.of.and_then(|of| world.bodies.get(of.body).ok());
        if !advance(&mut surface, body.as_ref(), time, &mut sources) {
            exclude(&mut surface, &mut world.commands);
            continue;
        }
        let role = Role::of(&surface, body.as_ref());
        update_collider(&mut surface, &role, &sources, &mut step, &mut world.commands);
        if surface.is_collider_disabled {
            stop(&mut surface, &mut world.commands);
            continue;
        }
        diagnostics.surfaces += 1;
        diagnostics.moving += u32::from(surface.state.moving.moves);
        diagnostics.blended += push(&mut surface, &role, &mut step, &mut world);
        diagnostics.awake += u32::from(surface.state.state.pushing.is_awake());
        diagnostics.parts += surface.state.state.pushing.parts().count() as u32;
    }
    diagnostics.duration = start.elapsed();
}

/// Drives bodies out of solid surfaces.
pub(crate) fn apply_expulsion(
    mut stepping: ResMut<Stepping>,
    mut bodies: Query<(&mut LinearVelocity, Option<&LockedAxes>)>,
    mut commands: Commands,
) {
    for (body, change) in stepping.expelled.drain().filter(|(_, change)| *change != Vec3::ZERO) {
        let Ok((mut velocity, locked)) = bodies.get_mut(body) else {
            continue;
        };
        velocity.0 += free_axes(locked) * change;
        commands.queue_silenced(WakeBody(body));
    }
}

/// Bodies that a surface may move back.
type Movable = (With<RigidBody>, Without<MorphAvianPart>);

/// After the solver, moves bodies back that have passed through a surface. From then on, whole surfaces answer queries again.
pub(crate) fn after_step(
    mut surfaces: Query<(Entity, &mut AvianSurface)>,
    colliders: Query<(&Collider, &ColliderOf, Option<&ColliderTransform>, &CollisionLayers)>,
    sensors: Query<(), With<Sensor>>,
    mut world: ParamSet<(
        (Query<(&Position, &Rotation, &RigidBody)>, SpatialQuery),
        Query<(&mut Position, Option<&LockedAxes>), Movable>,
    )>,
    stepping: Res<Stepping>,
    mut diagnostics: ResMut<MorphPhysicsDiagnostics>,
) {
    let start = Instant::now();
    stepping.now.store(false, Ordering::Release);
    let mut budget = Budget::default();
    for (entity, mut surface) in &mut surfaces {
        let AvianSurface { moving, state, .. } = &mut *surface;
        let (bodies, spatial) = world.p0();
        let end = |entity| {
            let (collider, of, in_body, _) = colliders.get(entity).ok()?;
            let (position, rotation, _) = bodies.get(of.body).ok()?;
            let in_body = isometry_in_body(in_body.filter(|_| of.body != entity));
            let collider_now = isometry(position, rotation) * in_body;
            Some(collider_now.transform_point(middle(collider.shape_scaled().0.as_ref())?))
        };
        let is_blocked = |mover, from: Vec3, to: Vec3| {
            let (Ok((.., layers)), Ok(direction)) = (colliders.get(mover), Dir3::new(to - from)) else {
                return false;
            };
            let filter = SpatialQueryFilter::from_excluded_entities([entity]).with_mask(layers.filters);
            let kind = |collider| Some(bodies.get(colliders.get(collider).ok()?.1.body).ok()?.2);
            let is_solid = |other| !sensors.contains(other) && kind(other) != Some(&RigidBody::Dynamic);
            let hit = spatial.cast_ray_predicate(from, direction, from.distance(to), true, &filter, &is_solid);
            hit.is_some()
        };
        let shifts = state.pushing.move_back(moving, &mut budget, end, is_blocked);
        let mut bodies = world.p1();
        for (body, shift) in shifts {
            if let Ok((mut position, locked)) = bodies.get_mut(body) {
                position.0 += free_axes(locked) * shift;
            }
        }
    }
    diagnostics.compared_bodies = budget.compared;
    diagnostics.limited_bodies = budget.limited;
    diagnostics.duration += start.elapsed();
}

/// 1 for each axis along which a body may move, and 0 for the others.
fn free_axes(locked: Option<&LockedAxes>) -> Vec3 {
    let locked = locked.copied().unwrap_or_default();
    Vec3::new(
        f32::from(!locked.is_translation_x_locked()),
        f32::from(!locked.is_translation_y_locked()),
        f32::from(!locked.is_translation_z_locked()),
    )
}
