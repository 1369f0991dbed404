//! Events of bodies: touches that started or ended.

use bevy::platform::time::Instant;
use bevy::prelude::*;
use tracing::debug_span;

use crate::app::MorphCollisionSystems;
use crate::contacts::{MorphCollisions, MorphContact, MorphImpact};
use crate::state::{MorphCollisionDiagnostics, Runs};

/// Two bodies started touching: a collider of one touches a collider of the other, and none did in the previous run. With
/// [continuous](crate::components::MorphCollider::continuous) colliders, they may have touched only on the way from the previous run.
///
/// As a [`Message`] it is sent once per pair, with `body1 < body2`. As an [`EntityEvent`] it is triggered for each of the two, as
/// `body1`. You only need an observer on the body, which for a [`MorphColliderScene`](crate::components::MorphColliderScene) is the scene's
/// root:
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
/// While two bodies touch, other pairs of their colliders may start and stop touching;
/// [`MorphCollisionStart`](crate::events::MorphCollisionStart) reports those. If a collider changes its
/// [`MorphColliderOf`](crate::components::MorphColliderOf) while it touches something, the touch of its old body ends and that of its new
/// body starts, unless other colliders of these bodies touch.
#[derive(Message, EntityEvent, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Event, Message, Debug, Clone, PartialEq)]
pub struct MorphBodyCollisionStart {
    /// A body; the target of the entity event. See [`MorphColliderOf`](crate::components::MorphColliderOf).
    #[event_target]
    pub body1: Entity,
    /// The other body.
    pub body2: Entity,
    /// The collider of `body1` that touches. If several pairs started in the same run, this is the one with the earliest impact, or
    /// else the first in ascending order.
    pub collider1: Entity,
    /// The collider of `body2`.
    pub collider2: Entity,
    /// Where they touch, in world space; see [`MorphCollisionStart::point`](crate::events::MorphCollisionStart::point).
    pub point: Vec3,
    /// The unit vector along which `body1` moves out of `body2`; see
    /// [`MorphCollisionStart::normal`](crate::events::MorphCollisionStart::normal).
    pub normal: Vec3,
    /// When and where the contact of these two colliders began; see [`MorphContact::impact`](crate::contacts::MorphContact::impact).
    pub impact: Option<MorphImpact>,
}

/// Two bodies stopped touching: none of their colliders touch any more.
///
/// It is sent in the same way as [`MorphBodyCollisionStart`]. If bodies with [continuous](crate::components::MorphCollider::continuous)
/// colliders touch only between two runs, both are sent in the same run, the start first. It is also sent when colliders were
/// despawned, were disabled or left the body. The bodies may no longer exist; the entity event is triggered only for bodies that do.
#[derive(Message, EntityEvent, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Event, Message, Debug, Clone, PartialEq)]
pub struct MorphBodyCollisionEnd {
    /// A body; the target of the entity event.
    #[event_target]
    pub body1: Entity,
    /// The other body.
    pub body2: Entity,
}

/// Reports the changes of this run: first the touches that ended, then those that started, then the ends of those that both
/// started and ended. Each in ascending order.
pub(crate) fn report_body_changes(
    collisions: Res<MorphCollisions>,
    runs: Res<Runs>,
    mut starts: MessageWriter<MorphBodyCollisionStart>,
    mut ends: MessageWriter<MorphBodyCollisionEnd>,
    mut commands: Commands,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
) {
    if !runs.compared() {
        return;
    }
    let start = Instant::now();
    let _span = debug_span!("morph_collision::body_events").entered();
    let both_ends = |(body1, body2)| {
        let reversed = MorphBodyCollisionEnd {
            body1: body2,
            body2: body1,
        };
        [MorphBodyCollisionEnd { body1, body2 }, reversed]
    };
    let ended: Vec<_> = collisions.bodies.ended().flat_map(both_ends).collect();
    let passed: Vec<_> = collisions.bodies.passed().flat_map(both_ends).collect();
    let mut started = Vec::new();
    for contacts in collisions.bodies.started() {
        let (body1, _) = contacts[0].0;
        let contacts = contacts
            .iter()
            .filter_map(|&(_, colliders)| collisions.in_run(colliders));
        let time = |contact: &MorphContact| contact.impact.map_or(f64::INFINITY, |impact| impact.earliest);
        let Some(contact) = contacts.min_by(|a, b| time(a).total_cmp(&time(b))) else {
            continue;
        };
        let (point, normal) = contact.begins_at();
        let event = MorphBodyCollisionStart {
            body1: contact.body1,
            body2: contact.body2,
            collider1: contact.collider1,
            collider2: contact.collider2,
            point,
            normal,
            impact: contact.impact,
        };
        let event = if contact.body1 == body1 {
            event
        } else {
            event.reversed()
        };
        started.extend([event, event.reversed()]);
    }
    ends.write_batch(ended.iter().step_by(2).copied());
    starts.write_batch(started.iter().step_by(2).copied());
    ends.write_batch(passed.iter().step_by(2).copied());
    if !ended.is_empty() || !started.is_empty() {
        // One command: without observers, this is the only cost.
        commands.queue(move |world: &mut World| {
            trigger_all(world, ended);
            trigger_all(world, started);
            trigger_all(world, passed);
        });
    }
    diagnostics.spend(MorphCollisionSystems::Events, start.elapsed());
}

impl MorphBodyCollisionStart {
    /// The same start from the view of the other body.
    fn reversed(self) -> Self {
        Self {
            body1: self.body2,
            body2: self.body1,
            collider1: self.collider2,
            collider2: self.collider1,
            normal: -self.normal,
            impact: self.impact.map(MorphImpact::reversed),
            ..self
        }
    }
}

/// Triggers events whose targets exist, if anybody observes events of this kind.
fn trigger_all<'a, E: EntityEvent<Trigger<'a>: Default>>(world: &mut World, events: Vec<E>) {
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
