//! Events of colliders: contacts that started or ended.

use bevy::platform::time::Instant;

use bevy::ecs::entity::{EntityHashMap, EntityMapper, MapEntities};
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::prelude::*;
use tracing::debug_span;

use crate::app::MorphCollisionSystems;
use crate::components::{MorphColliders, MorphCollisionEventsEnabled};
use crate::contacts::{MorphCollisions, MorphContact, MorphImpact};
use crate::state::{MorphCollisionDiagnostics, Runs};

/// Two colliders started touching.
///
/// As a [`Message`] it is sent once per pair, with `collider1 < collider2`. As an [`EntityEvent`] it is triggered for each of the
/// two colliders that has [`MorphCollisionEventsEnabled`]; that collider is then `collider1`.
#[derive(Message, EntityEvent, Reflect, Clone, Copy, Debug, PartialEq)]
#[reflect(Event, Message, Debug, Clone, PartialEq)]
pub struct MorphCollisionStart {
    /// A collider; the target of the entity event.
    #[event_target]
    pub collider1: Entity,
    /// The other collider.
    pub collider2: Entity,
    /// The body of `collider1`, named by its [`MorphColliderOf`](crate::components::MorphColliderOf), or `collider1` itself.
    pub body1: Entity,
    /// The body of `collider2`.
    pub body2: Entity,
    /// Where they touch, in world space; see [`MorphContact::point`]. With an impact, where they first touched.
    pub point: Vec3,
    /// The unit vector along which `collider1` moves out of `collider2`; see [`MorphContact::normal`]. With an impact, when they
    /// first touched.
    pub normal: Vec3,
    /// When and where the contact began, if one of the colliders is [continuous](crate::components::MorphCollider::continuous); see
    /// [`MorphContact::impact`].
    pub impact: Option<MorphImpact>,
}

/// Two colliders stopped touching.
///
/// It is sent in the same way as [`MorphCollisionStart`]. If a contact of a [continuous](crate::components::MorphCollider::continuous) collider
/// begins and ends between two runs, both are sent in the same run, the start first. It is also sent when a collider
///
/// - was despawned, so the entities may no longer exist;
/// - was left out because its mesh or transform became unusable;
/// - got [`MorphColliderDisabled`](crate::components::MorphColliderDisabled) or Bevy's [`Disabled`].
///
/// Observers run for a disabled entity as for any other, but their `Query` parameters skip it without `Allow<Disabled>`.
#[derive(Message, EntityEvent, Reflect, Clone, Copy, Debug, PartialEq, Eq)]
#[reflect(Event, Message, Debug, Clone, PartialEq)]
pub struct MorphCollisionEnd {
    /// A collider; the target of the entity event.
    #[event_target]
    pub collider1: Entity,
    /// The other collider.
    pub collider2: Entity,
    /// The body of `collider1` while they touched.
    pub body1: Entity,
    /// The body of `collider2` while they touched.
    pub body2: Entity,
}

/// Lists what an entity touches, in ascending order. The plugin updates it in every run.
///
/// - On a body with [`MorphColliders`](crate::components::MorphColliders), such as the root of a
///   [`MorphColliderScene`](crate::components::MorphColliderScene): the bodies that any of its colliders touch.
/// - On any other collider: the colliders that it touches.
///
/// The list of a disabled collider is empty.
#[derive(Component, Reflect, Clone, Debug, Default, PartialEq, Eq)]
#[reflect(Component, Debug, Default, Clone, PartialEq)]
pub struct MorphCollidingEntities(Vec<Entity>);

impl MorphCollidingEntities {
    /// Whether an entity is in the list.
    #[must_use]
    pub fn contains(&self, entity: Entity) -> bool {
        self.0.binary_search(&entity).is_ok()
    }
}

impl MapEntities for MorphCollidingEntities {
    fn map_entities<M: EntityMapper>(&mut self, mapper: &mut M) {
        self.0.map_entities(mapper);
        self.0.sort_unstable();
    }
}

impl std::ops::Deref for MorphCollidingEntities {
    type Target = [Entity];

    fn deref(&self) -> &[Entity] {
        &self.0
    }
}

/// Reports the changes of this run: first the contacts that ended, then those that started, then the ends of those that both
/// started and ended. Each in ascending order.
pub(crate) fn report_changes(
    collisions: Res<MorphCollisions>,
    enabled: Query<(), (With<MorphCollisionEventsEnabled>, Allow<Disabled>)>,
    mut starts: MessageWriter<MorphCollisionStart>,
    mut ends: MessageWriter<MorphCollisionEnd>,
    mut commands: Commands,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
) {
    let start = Instant::now();
    let _span = debug_span!("morph_collision::events").entered();
    let mut end_all = |contacts: &[MorphContact], commands: &mut Commands| {
        for contact in contacts {
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
    };
    end_all(collisions.changes.ended_in_run(), &mut commands);
    for contact in collisions.started_in_run() {
        let (point, normal) = contact.begins_at();
        let [[collider1, collider2, body1, body2], _] = both_ways(contact);
        let first = MorphCollisionStart {
            collider1,
            collider2,
            body1,
            body2,
            point,
            normal,
            impact: contact.impact,
        };
        starts.write(first);
        for event in [first, first.reversed()] {
            if enabled.contains(event.collider1) {
                commands.trigger(event);
            }
        }
    }
    end_all(collisions.changes.passed_in_run(), &mut commands);
    diagnostics.spend(MorphCollisionSystems::Events, start.elapsed());
}

impl MorphCollisionStart {
    /// The same start from the view of the other collider.
    fn reversed(self) -> Self {
        Self {
            collider1: self.collider2,
            collider2: self.collider1,
            body1: self.body2,
            body2: self.body1,
            normal: -self.normal,
            impact: self.impact.map(MorphImpact::reversed),
            ..self
        }
    }
}

/// The colliders and bodies from the view of either collider.
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

/// Updates [`MorphCollidingEntities`] if anything was compared, if the component is new, or if an entity became a body or stopped
/// being one.
pub(crate) fn list_colliding_entities(
    collisions: Res<MorphCollisions>,
    runs: Res<Runs>,
    mut lists: Query<(Entity, &mut MorphCollidingEntities, Option<Ref<MorphColliders>>), Allow<Disabled>>,
    mut no_bodies: RemovedComponents<MorphColliders>,
    mut diagnostics: ResMut<MorphCollisionDiagnostics>,
) {
    let is_body_no_more = no_bodies.read().count() > 0;
    let mut is_new = lists
        .iter_mut()
        .map(|(_, list, colliders)| list.is_changed() || colliders.is_some_and(|colliders| colliders.is_added()));
    if !runs.compared() && !is_body_no_more && !is_new.any(|is_new| is_new) {
        return;
    }
    let start = Instant::now();
    let empty = |(entity, _, colliders): (Entity, _, Option<_>)| (entity, (colliders.is_some(), Vec::new()));
    let mut touching: EntityHashMap<(bool, Vec<Entity>)> = lists.iter().map(empty).collect();
    for contact in collisions.iter() {
        for [collider, other, body, other_body] in both_ways(contact) {
            if let Some((false, list)) = touching.get_mut(&collider) {
                list.push(other);
            }
            if let Some((true, list)) = touching.get_mut(&body) {
                list.push(other_body);
            }
        }
    }
    for (entity, mut list, _) in &mut lists {
        let (_, mut now) = touching.remove(&entity).unwrap_or_default();
        now.sort_unstable();
        now.dedup();
        if list.0 != now {
            list.0 = now;
        }
    }
    diagnostics.spend(MorphCollisionSystems::Events, start.elapsed());
}
