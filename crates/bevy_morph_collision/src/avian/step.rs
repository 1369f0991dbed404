//! Moves surfaces to their pose at the end of Avian's step, and creates parts near bodies.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use avian3d::dynamics::joints::joint_graph::JointGraph;
use avian3d::dynamics::solver::SolverConfig;
use avian3d::prelude::{
    ActiveCollisionHooks, AngularVelocity, Collider, ColliderDisabled, ColliderOf, ColliderTransform,
    CollidingEntities, CollisionEventsEnabled, CollisionLayers, CollisionMargin, ComputedCenterOfMass, Friction,
    LinearVelocity, LockedAxes, NarrowPhaseConfig, PhysicsLengthUnit, Position, Restitution, RigidBody,
    RigidBodyDisabled, Rotation, Sensor, Sleeping, SpatialQuery, SpatialQueryFilter, WakeBody,
};
use bevy::ecs::entity::hash_map::EntityHashMap;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::mesh::skinning::SkinnedMesh;
use bevy::platform::collections::HashSet;
use bevy::platform::time::Instant;
use bevy::prelude::*;
use parry3d::math::Pose as Place;
use parry3d::shape::SharedShape;

use super::ahead::{Joints, Motion, ahead};
use super::attach::AvianSurface;
use super::movers::Movers;
use super::part::{Manners, PartBodies, Parts};
use super::push::{Around, Sleep};
use super::shape::WholeSurface;
use super::{MorphAvianCollider, MorphAvianPart};
use crate::components::MorphColliderDisabled;
use crate::physics::begin::{Sides, advance, set_sides};
use crate::physics::clock::{StepTime, Timing};
use crate::physics::part::Pace;
use crate::physics::passage::{Budget, middle};
use crate::physics::schedule::InFixedLoop;
use crate::physics::sources::Sources;

/// Counts of [`MorphAvianCollider`]s in the last physics step.
#[derive(Resource, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Resource, Debug, Default, Clone, PartialEq)]
pub struct MorphAvianDiagnostics {
    /// Surfaces in physics, except those that are switched off, too large, or not at a finite position.
    pub surfaces: u32,
    /// Surfaces that moved or morphed.
    pub moving: u32,
    /// Parts of surfaces near bodies. Each part is a kinematic body in the physics world.
    pub parts: u32,
    /// Parts whose vertices were blended for the step.
    pub blended: u32,
    /// Fast bodies whose way was compared with the motion of triangles, so that they do not pass through.
    pub compared_bodies: u32,
    /// Fast bodies that were not compared, because others were already compared with 200,000 triangles. They may pass through.
    pub limited_bodies: u32,
    /// Time spent before the step and after the solver.
    pub duration: Duration,
}

/// State shared by all surfaces.
#[derive(Resource, Default)]
pub(crate) struct Stepping {
    /// Whether contacts are being computed.
    pub(super) now: Arc<AtomicBool>,
    pub(super) movers: Movers,
    /// Colliders that were too large in the last step. They have been logged.
    pub(super) too_large: HashSet<Entity>,
    /// Colliders that changed since the last step, and how far they reach in this one.
    pub(super) changed: Vec<(Entity, f32)>,
    /// Bodies inside solid surfaces, with the velocity changes that drive them out.
    driven: EntityHashMap<Vec3>,
    /// Whether there was a step since physics was last due.
    pub(super) has_stepped: bool,
    pub(super) timing: Timing,
}

impl Stepping {
    pub(super) fn new(timing: Timing) -> Self {
        Self { timing, ..default() }
    }
}

/// Avian's components on a surface's collider.
type Knows<'w> = (
    &'w GlobalTransform,
    Option<&'w Position>,
    Option<&'w Rotation>,
    Option<&'w ColliderOf>,
    Option<&'w ColliderTransform>,
);

/// The properties of a collider that matter for contacts.
type Mannered<'w> = (
    Option<&'w Friction>,
    Option<&'w Restitution>,
    Option<&'w CollisionMargin>,
    Option<&'w CollisionLayers>,
    Option<&'w ActiveCollisionHooks>,
    Has<Sensor>,
    Has<CollisionEventsEnabled>,
    Has<CollidingEntities>,
);

/// Bodies that surfaces are on.
type Bodies<'w, 's> = Query<
    'w,
    's,
    (
        &'static RigidBody,
        (&'static Position, &'static Rotation),
        (&'static LinearVelocity, &'static AngularVelocity),
        &'static ComputedCenterOfMass,
        (Option<&'static Friction>, Option<&'static CollisionMargin>),
        (Has<RigidBodyDisabled>, Has<Sleeping>),
    ),
    Without<MorphAvianPart>,
>;

/// Moves surfaces to where they will be at the end of the step, and creates parts for nearby bodies.
pub(super) fn before_step(
    mut commands: Commands,
    mut surfaces: Query<
        (
            Entity,
            &MorphAvianCollider,
            &mut AvianSurface,
            Option<&mut Collider>,
            Knows,
            Mannered,
            (Option<&MeshMorphWeights>, Option<&SkinnedMesh>),
            (Has<MorphColliderDisabled>, Has<ColliderDisabled>),
        ),
        Without<MorphAvianPart>,
    >,
    bodies: Bodies,
    mut parts: Parts,
    mut sleep: Sleep,
    joint_graph: Res<JointGraph>,
    mut sources: Sources,
    (config, solver, length_unit): (Res<NarrowPhaseConfig>, Res<SolverConfig>, Res<PhysicsLengthUnit>),
    (time, fixed, inside): (Res<Time>, Option<Res<Time<Fixed>>>, Res<InFixedLoop>),
    mut stepping: ResMut<Stepping>,
    mut diagnostics: ResMut<MorphAvianDiagnostics>,
) {
    let start = Instant::now();
    *diagnostics = MorphAvianDiagnostics::default();
    stepping.has_stepped = true;
    stepping.timing.learn(&inside);
    if surfaces.is_empty() {
        return;
    }
    let dt = time.delta_secs();
    let Sources {
        shared,
        globals,
        bind_poses,
        skeletons,
        names,
    } = &mut sources;
    let (shared, globals, bind_poses) = (&*shared, &*globals, bind_poses.as_deref());
    let global_of = |joint: Entity| Some(globals.get(joint).ok()?.affine());
    let name_of = |entity| names.get(entity).map(|name| name.to_string()).unwrap_or_default();
    let Stepping {
        now,
        movers,
        changed,
        driven,
        timing,
        ..
    } = &mut *stepping;
    let span = fixed
        .filter(|_| timing.is_fixed)
        .and_then(|fixed| timing.lag.span(fixed.elapsed_secs_f64(), fixed.delta_secs_f64()));
    let time = StepTime { dt, span, share: 1.0 };
    skeletons.begin();
    for (entity, settings, mut surface, collider, knows, mannered, shows, disabled) in &mut surfaces {
        let AvianSurface {
            following,
            pushing,
            bad_place,
            meets,
            told_open,
            ..
        } = &mut *surface;
        let (morph_disabled, collider_disabled) = disabled;
        following.max_acceleration = settings.max_acceleration * length_unit.0;
        let (global, position, rotation, of, in_body) = knows;
        let body = of.and_then(|of| Some((of.body, bodies.get(of.body).ok()?)));
        let mut off = morph_disabled;
        if !morph_disabled {
            let (weights, skin) = shows;
            let is_skinned = following.is_skinned();
            // The collider reports bad joints. The last good ones are used.
            let skin = skin.filter(|_| is_skinned);
            let drawn = &mut following.drawn;
            // Avian determines where the entity is.
            drawn.stands_alone = false;
            drawn.on_body = body.is_some();
            let live = drawn.live(global, skin, skeletons, bind_poses, globals);
            drawn.at_step(&live);
            let between_frames = span.and_then(|span| drawn.joints.at(span.end));
            let joints = skin.and_then(|skin| {
                let skeleton = skeletons.of(skin, bind_poses, global_of);
                skeleton.world_from_mesh()
            });
            let joints = match (&between_frames, joints) {
                (Some(joints), Some(_)) => Some(Joints::InCollider(&joints.matrices)),
                (_, joints) => joints.map(Joints::InWorld),
            };
            let own = position
                .zip(rotation)
                .map(|(at, turned)| Place::from_parts(at.0, turned.0));
            let motion = body.map(|(body, (kind, place, velocity, center_of_mass, _, (_, asleep)))| {
                let motion = Motion {
                    kind: *kind,
                    asleep,
                    position: place.0,
                    rotation: place.1,
                    linear: velocity.0,
                    angular: velocity.1,
                    center_of_mass,
                };
                let in_body = in_body.filter(|_| body != entity);
                let in_body = in_body.map_or(Place::IDENTITY, |it| Place::from_parts(it.translation, it.rotation));
                (motion, in_body)
            });
            // An entity whose collider is still to come is at its own transform.
            let own = own.filter(|_| collider.is_some());
            let ahead = ahead(global, own, motion, (is_skinned, joints), dt);
            let at = global.translation();
            let name = || name_of(entity);
            off = !advance(following, (ahead, at), (weights, shared), time, bad_place, name);
        }
        if off {
            // Movement of the surface while it is off does not count as motion.
            following.restart();
            if collider.is_some() {
                commands.entity(entity).try_remove::<Collider>();
            }
            pushing.stop(&mut commands);
            continue;
        }
        let (friction, restitution, margin, layers, hooks, is_sensor, events, colliding) = mannered;
        let on_dynamic = body.is_some_and(|(_, state)| *state.0 == RigidBody::Dynamic);
        let Sides { turned, .. } = set_sides(following, (settings.solid, on_dynamic), told_open, || name_of(entity));
        let meets_as_whole = on_dynamic || is_sensor;
        let shape = || {
            let whole = WholeSurface::new(following.surface.clone(), meets_as_whole, now.clone());
            Collider::from(SharedShape::new(whole))
        };
        match collider {
            // The first step, or the first one after it was switched off.
            None => {
                commands.entity(entity).try_insert(shape());
            }
            Some(mut collider) => {
                if following.reshaped || turned || *meets != meets_as_whole {
                    *collider = shape();
                    changed.push((entity, 0.0));
                }
            }
        }
        *meets = meets_as_whole;
        if collider_disabled {
            following.restart();
            pushing.stop(&mut commands);
            continue;
        }
        diagnostics.surfaces += 1;
        diagnostics.moving += u32::from(following.moves);
        let pushes = !meets_as_whole && body.is_none_or(|(_, (.., (disabled, _)))| !disabled);
        if !pushes {
            if following.moves
                && on_dynamic
                && let Some((body, _)) = body
            {
                commands.queue_silenced(WakeBody(body));
            }
            pushing.stop(&mut commands);
            continue;
        }
        let of_body = body.map(|(_, (.., manners, _))| manners).unwrap_or_default();
        let manners = Manners {
            friction: friction.or(of_body.0).copied(),
            restitution: restitution.copied(),
            margin: margin.or(of_body.1).copied(),
            layers: layers.copied().unwrap_or_default(),
            hooks: hooks.copied(),
        };
        let pace = Pace {
            dt,
            prediction: length_unit.0 * config.contact_tolerance
                + manners.margin.map_or(0.0, |margin| margin.0.max(0.0)),
        };
        let mut around = Around {
            movers,
            body: body.map(|(body, _)| body),
            listens: events || colliding,
            joints: &joint_graph,
            sleep: &mut sleep,
            // The speed at which Avian separates overlapping bodies.
            leaving: solver.max_overlap_solve_speed.min(10.0) * length_unit.0,
            driven,
        };
        let mut part_bodies = PartBodies {
            surface: entity,
            manners,
            stepping: now,
            commands: &mut commands,
            parts: &mut parts,
            changed,
        };
        diagnostics.blended += pushing.prepare(following, &pace, &mut around, &mut part_bodies);
        diagnostics.parts += pushing.parts().count() as u32;
    }
    diagnostics.duration = start.elapsed();
}

/// Drives bodies out of solid surfaces.
pub(super) fn drive_out(
    mut stepping: ResMut<Stepping>,
    mut bodies: Query<(&mut LinearVelocity, Option<&LockedAxes>)>,
    mut commands: Commands,
) {
    for (body, change) in stepping.driven.drain().filter(|(_, change)| *change != Vec3::ZERO) {
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
pub(super) fn after_step(
    mut surfaces: Query<(Entity, &mut AvianSurface)>,
    colliders: Query<(&Collider, &ColliderOf, Option<&ColliderTransform>, &CollisionLayers)>,
    sensors: Query<(), With<Sensor>>,
    mut world: ParamSet<(
        (Query<(&Position, &Rotation, &RigidBody)>, SpatialQuery),
        Query<(&mut Position, Option<&LockedAxes>), Movable>,
    )>,
    stepping: Res<Stepping>,
    mut diagnostics: ResMut<MorphAvianDiagnostics>,
) {
    let start = Instant::now();
    stepping.now.store(false, Ordering::Release);
    let mut budget = Budget::default();
    for (entity, mut surface) in &mut surfaces {
        let AvianSurface { following, pushing, .. } = &mut *surface;
        let (bodies, spatial) = world.p0();
        let end = |entity| {
            let (collider, of, in_body, _) = colliders.get(entity).ok()?;
            let (position, rotation, _) = bodies.get(of.body).ok()?;
            let in_body = in_body.filter(|_| of.body != entity);
            let in_body = in_body.map_or(Place::IDENTITY, |it| Place::from_parts(it.translation, it.rotation));
            let place = Place::from_parts(position.0, rotation.0) * in_body;
            Some(place.transform_point(middle(collider.shape_scaled().0.as_ref())?))
        };
        let is_blocked = |mover, from: Vec3, to: Vec3| {
            let (Ok((.., layers)), Ok(direction)) = (colliders.get(mover), Dir3::new(to - from)) else {
                return false;
            };
            let sight = SpatialQueryFilter::from_excluded_entities([entity]).with_mask(layers.filters);
            let kind = |collider| Some(bodies.get(colliders.get(collider).ok()?.1.body).ok()?.2);
            let is_solid = |other| !sensors.contains(other) && kind(other) != Some(&RigidBody::Dynamic);
            let hit = spatial.cast_ray_predicate(from, direction, from.distance(to), true, &sight, &is_solid);
            hit.is_some()
        };
        let shifts = pushing.hold_back(following, &mut budget, end, is_blocked);
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
