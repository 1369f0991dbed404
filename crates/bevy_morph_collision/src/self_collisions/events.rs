//! Reports where meshes started or stopped intersecting themselves.

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::prelude::*;
use morph_collision::TrianglePair;

use super::list::{MorphSelfCollisions, MorphSelfContact};
use super::state::SelfState;
use crate::components::MorphCollisionEventsEnabled;
use crate::contacts::no_triangles;

/// A region of a mesh started to intersect itself.
///
/// Sent for colliders with [`MorphSelfCollisions`]. It is also triggered as an entity event if the collider has
/// [`MorphCollisionEventsEnabled`](crate::components::MorphCollisionEventsEnabled).
#[derive(Message, EntityEvent, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Event, Message, Debug, Clone, PartialEq)]
pub struct MorphSelfCollisionStart {
    /// The target of the entity event.
    #[event_target]
    pub collider: Entity,
    /// The number of the region; see [`MorphSelfContact::region`]. [`MorphSelfCollisions::regions`] lists its triangles.
    pub region: u32,
    /// See [`MorphSelfContact::point`].
    pub point: Vec3,
    /// The first pair of the region.
    #[reflect(ignore, default = "no_triangles")]
    pub triangles: TrianglePair,
}

/// A region of a mesh no longer intersects itself, became part of another region, or its collider takes no part any more.
///
/// Sent in the same way as [`MorphSelfCollisionStart`], and in the same run before the starts.
#[derive(Message, EntityEvent, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Event, Message, Debug, Clone, PartialEq)]
pub struct MorphSelfCollisionEnd {
    /// The target of the entity event. It may no longer exist.
    #[event_target]
    pub collider: Entity,
    /// The number of the region.
    pub region: u32,
}

/// Reports what started and ended, in ascending order of colliders: first all ends, then all starts.
pub(crate) fn report_self_collisions(
    mut colliders: Query<
        (
            Entity,
            &MorphSelfCollisions,
            &mut SelfState,
            Has<MorphCollisionEventsEnabled>,
        ),
        Allow<Disabled>,
    >,
    mut starts: MessageWriter<MorphSelfCollisionStart>,
    mut ends: MessageWriter<MorphSelfCollisionEnd>,
    mut commands: Commands,
) {
    let news = colliders
        .iter_mut()
        .filter(|(_, _, state, _)| !state.changes.is_empty());
    // The order of the query depends on what the entities were before.
    let mut news: Vec<_> = news.collect();
    news.sort_unstable_by_key(|(collider, ..)| *collider);
    for &(collider, _, ref state, is_observed) in &news {
        for &region in &state.changes.ended {
            let end = MorphSelfCollisionEnd { collider, region };
            ends.write(end);
            if is_observed {
                commands.trigger(end);
            }
        }
    }
    for (collider, list, mut state, is_observed) in news {
        let changes = std::mem::take(&mut state.changes);
        let started = |region: &&MorphSelfContact| changes.started.contains(&region.region);
        for contact in list.regions().iter().filter(started) {
            let Some(&triangles) = contact.triangles.first() else {
                continue;
            };
            let start = MorphSelfCollisionStart {
                collider,
                region: contact.region,
                point: contact.point,
                triangles,
            };
            starts.write(start);
            if is_observed {
                commands.trigger(start);
            }
        }
    }
}

/// Ends the regions of a component that is removed, also by despawning its entity.
pub(crate) fn end_with_component(
    removed: On<Remove<MorphSelfCollisions>>,
    states: Query<&SelfState, Allow<Disabled>>,
    observed: Query<(), (With<MorphCollisionEventsEnabled>, Allow<Disabled>)>,
    mut ends: MessageWriter<MorphSelfCollisionEnd>,
    mut commands: Commands,
) {
    let collider = removed.entity;
    let Ok(state) = states.get(collider) else { return };
    // Within a run, what has just ended or started has not been reported yet; afterwards, both lists are empty.
    let told = |region: &&u32| !state.changes.started.contains(region);
    for &region in state.changes.ended.iter().chain(state.listed.iter().filter(told)) {
        let end = MorphSelfCollisionEnd { collider, region };
        ends.write(end);
        if observed.contains(collider) {
            commands.trigger(end);
        }
    }
    commands.entity(collider).try_remove::<SelfState>();
}
