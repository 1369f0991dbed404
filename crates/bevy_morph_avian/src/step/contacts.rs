//! Turns contacts with parts into contacts of their surface: recomputes them where it changed, and reports them in its name.

use std::sync::atomic::Ordering;

use avian3d::collision::contact_types::{ContactEdge, ContactEdgeFlags, ContactId};
use avian3d::prelude::{
    ColliderOf, CollidingEntities, CollisionEnd, CollisionEventsEnabled, CollisionStart, ContactGraph,
};
use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::query::Allow;
use bevy::ecs::system::SystemParam;
use bevy::platform::collections::HashMap;
use bevy::prelude::*;

use super::stepping::Stepping;
use crate::push::MorphAvianPart;
use crate::surface::{AvianSurface, Touch};

/// Before contacts are updated: prevents Avian from reusing contacts of colliders that changed, from sending events for parts, and
/// from computing contacts between parts.
pub(crate) fn refresh_contacts(
    mut graph: ResMut<ContactGraph>,
    mut stepping: ResMut<Stepping>,
    surfaces: Query<&AvianSurface>,
    parts: Query<(), With<MorphAvianPart>>,
    mut contacts: Local<Vec<ContactId>>,
    mut unneeded: Local<Vec<Entity>>,
) {
    stepping.now.store(true, Ordering::Release);
    for (collider, reach) in stepping.changed.drain(..) {
        contacts.clear();
        contacts.extend(graph.contact_edges_with(collider).map(|contact| contact.id));
        for &contact in &*contacts {
            if let Some((_, pair)) = graph.get_mut_by_id(contact) {
                // Avian reuses contacts while bodies have hardly moved, even if their shapes changed.
                pair.recycling_cache = None;
                // Includes what the collider will reach during the step.
                pair.speculative_distance = pair.speculative_distance.max(reach);
            }
        }
    }
    for part in surfaces.iter().flat_map(|surface| surface.state.pushing.parts()) {
        for contact in graph.contact_edges_with_mut(part) {
            contact.flags.remove(ContactEdgeFlags::CONTACT_EVENTS);
            let (other, _) = other_side(contact, part);
            if parts.contains(other) {
                unneeded.push(other);
            }
        }
        // Avian would compute contacts between parts, although its solver skips them. These pairs are always new, so the solver has
        // no constraints for them.
        for other in unneeded.drain(..) {
            graph.remove_edge(part, other);
        }
    }
}

/// The other collider of a contact, and its body.
fn other_side(contact: &ContactEdge, collider: Entity) -> (Entity, Option<Entity>) {
    if contact.collider1 == collider {
        (contact.collider2, contact.body2)
    } else {
        (contact.collider1, contact.body1)
    }
}

/// Who receives contacts, and how.
#[derive(SystemParam)]
pub(crate) struct ContactReport<'w, 's> {
    wants_events: Query<'w, 's, (), (With<CollisionEventsEnabled>, Allow<Disabled>)>,
    colliding: Query<'w, 's, &'static mut CollidingEntities, Allow<Disabled>>,
    bodies: Query<'w, 's, &'static ColliderOf, Allow<Disabled>>,
    starts: MessageWriter<'w, CollisionStart>,
    ends: MessageWriter<'w, CollisionEnd>,
}

impl ContactReport<'_, '_> {
    fn wants(&self, surface: Entity, other: Entity) -> bool {
        self.wants_events.contains(surface) || self.wants_events.contains(other)
    }

    fn body(&self, collider: Entity) -> Option<Entity> {
        self.bodies.get(collider).ok().map(|of| of.body)
    }

    fn started(&mut self, surface: Entity, other: Entity, body: Option<Entity>) {
        if self.wants(surface, other) {
            self.starts.write(CollisionStart {
                collider1: surface,
                collider2: other,
                body1: self.body(surface),
                body2: body,
            });
        }
        for (one, met) in [(surface, other), (other, surface)] {
            if let Ok(mut colliding) = self.colliding.get_mut(one) {
                colliding.insert(met);
            }
        }
    }

    fn ended(&mut self, surface: Entity, other: Entity, body: Option<Entity>) {
        if self.wants(surface, other) {
            self.ends.write(CollisionEnd {
                collider1: surface,
                collider2: other,
                body1: self.body(surface),
                body2: body,
            });
        }
        for (one, met) in [(surface, other), (other, surface)] {
            if let Ok(mut colliding) = self.colliding.get_mut(one) {
                colliding.remove(&met);
            }
        }
    }
}

/// After contacts were updated: what touches a part touches its surface.
pub(crate) fn report_contacts(
    graph: Res<ContactGraph>,
    mut surfaces: Query<(Entity, &mut AvianSurface), Allow<Disabled>>,
    mut report: ContactReport,
    mut touching: Local<HashMap<Entity, Touch>>,
) {
    for (entity, mut surface) in &mut surfaces {
        if surface.state.pushing.is_idle() && surface.state.touching.is_empty() {
            continue;
        }
        touching.clear();
        for part in surface.state.pushing.parts() {
            for contact in graph.contact_edges_with(part).filter(|contact| contact.is_touching()) {
                let (other, body) = other_side(contact, part);
                // Parts also touch things that the surface itself never does, such as walls.
                if surface.state.pushing.is_near(other) {
                    let contact = contact.id;
                    touching.insert(other, Touch { body, contact });
                }
                if let Ok(mut colliding) = report.colliding.get_mut(other)
                    && colliding.contains(&part)
                {
                    colliding.remove(&part);
                }
            }
        }
        let before = &mut surface.state.touching;
        for (&other, touch) in before.iter().filter(|(other, _)| !touching.contains_key(*other)) {
            report.ended(entity, other, touch.body);
        }
        for (&other, touch) in touching.iter().filter(|(other, _)| !before.contains_key(*other)) {
            report.started(entity, other, touch.body);
        }
        std::mem::swap(before, &mut touching);
    }
}

/// Removes the parts of a surface that is being removed.
pub(crate) fn remove_parts(
    removed: On<Remove<AvianSurface>>,
    mut surfaces: Query<&mut AvianSurface, Allow<Disabled>>,
    mut commands: Commands,
    mut report: ContactReport,
) {
    if let Ok(mut surface) = surfaces.get_mut(removed.entity) {
        surface.state.pushing.stop(&mut commands);
        for (other, touch) in surface.state.touching.drain() {
            report.ended(removed.entity, other, touch.body);
        }
    }
}

/// Removes the parts of disabled entities.
pub(crate) fn stop_disabled(mut surfaces: Query<&mut AvianSurface, With<Disabled>>, mut commands: Commands) {
    for mut surface in &mut surfaces {
        surface.moving.restart();
        if !surface.state.pushing.is_idle() {
            surface.state.pushing.stop(&mut commands);
        }
    }
}
