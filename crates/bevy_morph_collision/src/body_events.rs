//! Which bodies started and stopped touching.

use bevy::platform::time::Instant;
use bevy::prelude::*;
use tracing::debug_span;

use crate::contacts::MorphCollisions;
use crate::diagnostics::MorphCollisionDiagnostics;

/// Two bodies started touching: one of their colliders touches one of the other's, and none did in the run before.
///
/// As a [`Message`] it is sent once per pair, `body1 < body2`. As an [`EntityEvent`] it is triggered for each of the two, which is then
/// `body1`. An observer of the body, which for a [`MorphColliderScene`](crate::MorphColliderScene) is the scene's root, needs
/// nothing else:
///
/// ```
/// # use bevy::prelude::*;
/// # use bevy_morph_collision::prelude::*;
/// # fn spawn(mut commands: Commands, head: Handle<bevy::world_serialization::WorldAsset>) {
/// commands
///     .spawn((WorldAssetRoot(head), MorphColliderScene::default()))
///     .observe(|start: On<MorphBodyCollisionStart>| println!("hit by {}", start.body2));
/// # }
/// ```
///
/// While bodies touch, other colliders of theirs may start and stop; [`MorphCollisionStart`](crate::MorphCollisionStart) tells of
/// those. A collider that changes its [`MorphColliderOf`](crate::MorphColliderOf) while it touches something ends the touch of
/// one body and starts that of another, unless other colliders of these bodies touch.
#[derive(Message, EntityEvent, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Event, Message, Debug, Clone, PartialEq)]
pub struct MorphBodyCollisionStart {
    /// A body; the target of the entity event. See [`MorphColliderOf`](crate::MorphColliderOf).
    #[event_target]
    pub body1: Entity,
    /// The other one.
    pub body2: Entity,
    /// The collider of `body1` that touches. If several started in the same run, the first pair in ascending order.
    pub collider1: Entity,
    /// The collider of `body2`.
    pub collider2: Entity,
    /// Where they touch, in world space; see [`MorphContact::point`](crate::MorphContact::point).
    pub point: Vec3,
    /// The direction in which `body1` leaves `body2` there; see [`MorphContact::normal`](crate::MorphContact::normal).
    pub normal: Vec3,
}

/// Two bodies stopped touching: their colliders no longer touch.
///
/// It is sent as [`MorphBodyCollisionStart`] is, also when colliders were despawned or disabled or left the body. The bodies may no
/// longer exist; the entity event is triggered only for those that do.
#[derive(Message, EntityEvent, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Event, Message, Debug, Clone, PartialEq)]
pub struct MorphBodyCollisionEnd {
    /// A body; the target of the entity event.
    #[event_target]
    pub body1: Entity,
    /// The other one.
    pub body2: Entity,
}

/// Reports this run's changes: first what ended, then what started, both in ascending order.
pub(crate) fn report_body_changes(
    collisions: Res<MorphCollisions>,
    mut starts: MessageWriter<MorphBodyCollisionStart>,
    mut ends: MessageWriter<MorphBodyCollisionEnd>,
    mut commands: Commands,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
) {
    let start = Instant::now();
    let _span = debug_span!("morph_collision::body_events").entered();
    let mut ended = Vec::new();
    for (body1, body2) in collisions.bodies.ended() {
        ended.push(MorphBodyCollisionEnd { body1, body2 });
        ended.push(MorphBodyCollisionEnd {
            body1: body2,
            body2: body1,
        });
    }
    let mut started = Vec::new();
    for ((body1, body2), colliders) in collisions.bodies.started() {
        let Some(contact) = collisions.current.get(&colliders) else {
            continue;
        };
        let (collider1, collider2, normal) = if contact.body1 == body1 {
            (contact.collider1, contact.collider2, contact.normal)
        } else {
            (contact.collider2, contact.collider1, -contact.normal)
        };
        let event = MorphBodyCollisionStart {
            body1,
            body2,
            collider1,
            collider2,
            point: contact.point,
            normal,
        };
        started.push(event);
        started.push(MorphBodyCollisionStart {
            body1: body2,
            body2: body1,
            collider1: collider2,
            collider2: collider1,
            normal: -normal,
            ..event
        });
    }
    ends.write_batch(ended.iter().step_by(2).copied());
    starts.write_batch(started.iter().step_by(2).copied());
    if !ended.is_empty() || !started.is_empty() {
        // One command: where nobody observes, that is all it costs.
        commands.queue(move |world: &mut World| {
            tell(world, ended);
            tell(world, started);
        });
    }
    diagnostics.duration += start.elapsed();
}

/// Triggers events whose targets exist, if anybody observes events of this kind.
fn tell<'a, E: EntityEvent<Trigger<'a>: Default>>(world: &mut World, events: Vec<E>) {
    let kind = world.event_key::<E>();
    if kind.is_none_or(|kind| world.observers().try_get_observers(kind).is_none()) {
        return;
    }
    for event in events {
        if world.entities().contains(event.event_target()) {
            world.trigger(event);
        }
    }
}
