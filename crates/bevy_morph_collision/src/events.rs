//! What started and what ended.

use bevy::platform::time::Instant;

use bevy::prelude::*;

use crate::detect::{MorphCollisions, MorphContact};
use crate::diagnostics::MorphCollisionDiagnostics;

/// Two colliders touch that did not in the frame before.
///
/// As a [`Message`] it is sent once per pair, `collider1 < collider2`. As an [`EntityEvent`] it is triggered for each of the
/// two that has [`MorphCollisionEventsEnabled`], which is then `collider1`.
#[derive(Message, EntityEvent, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct MorphCollisionStart {
    /// A collider; the target of the entity event.
    #[event_target]
    pub collider1: Entity,
    /// The other one.
    pub collider2: Entity,
    /// The body of `collider1`: its [`MorphBody`](crate::MorphBody), or itself.
    pub body1: Entity,
    /// The body of `collider2`.
    pub body2: Entity,
}

/// Two colliders touch no more that did in the frame before.
///
/// Sent as [`MorphCollisionStart`] is. Also sent when a collider was despawned, so the entities need not exist any more, or
/// when it was left out because its mesh or transform became unusable.
#[derive(Message, EntityEvent, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Debug, Clone, PartialEq)]
pub struct MorphCollisionEnd {
    /// A collider; the target of the entity event.
    #[event_target]
    pub collider1: Entity,
    /// The other one.
    pub collider2: Entity,
    /// The body of `collider1` while they touched.
    pub body1: Entity,
    /// The body of `collider2` while they touched.
    pub body2: Entity,
}

/// On a collider: trigger [`MorphCollisionStart`] and [`MorphCollisionEnd`] as entity events for it, too.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
pub struct MorphCollisionEventsEnabled;

/// Compares this frame's contacts with the last frame's: first what ended, then what started, both in ascending order.
pub(crate) fn report_changes(
    collisions: Res<MorphCollisions>,
    enabled: Query<(), With<MorphCollisionEventsEnabled>>,
    mut starts: MessageWriter<MorphCollisionStart>,
    mut ends: MessageWriter<MorphCollisionEnd>,
    mut commands: Commands,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
) {
    let start = Instant::now();
    for contact in collisions.ended() {
        let [first, second] = both_ways(contact).map(|[collider1, collider2, body1, body2]| MorphCollisionEnd {
            collider1,
            collider2,
            body1,
            body2,
        });
        ends.write(first);
        for event in [first, second] {
            if enabled.contains(event.collider1) {
                commands.trigger(event);
            }
        }
    }
    for contact in collisions.started() {
        let [first, second] = both_ways(contact).map(|[collider1, collider2, body1, body2]| MorphCollisionStart {
            collider1,
            collider2,
            body1,
            body2,
        });
        starts.write(first);
        for event in [first, second] {
            if enabled.contains(event.collider1) {
                commands.trigger(event);
            }
        }
    }
    diagnostics.duration += start.elapsed();
}

/// Colliders and bodies as seen from either side.
fn both_ways(contact: &MorphContact) -> [[Entity; 4]; 2] {
    let &MorphContact {
        collider1,
        collider2,
        body1,
        body2,
        ..
    } = contact;
    [
        [collider1, collider2, body1, body2],
        [collider2, collider1, body2, body1],
    ]
}
