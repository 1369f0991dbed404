//! Collision events of surfaces whose parts need names.

use bevy::platform::collections::HashMap;
use bevy::prelude::*;
use bevy_rapier3d::plugin::context::RapierContextColliders;
use bevy_rapier3d::prelude::CollisionEvent;
use bevy_rapier3d::rapier::geometry::{CollisionEventFlags, ContactPair, NarrowPhase};

/// Makes the events of a step correct for whole surfaces.
///
/// If hooks are nearby, Rapier also sends events for parts. It may report that one part is no longer touched while another still
/// is, and it reports nothing for parts that are removed. `surfaces` maps surfaces to their contexts. Events of a surface may be
/// sent several times, but the last one is always right.
pub(crate) fn report_whole_surfaces<'a>(
    surfaces: &HashMap<Entity, Entity>,
    events: &mut MessageMutator<CollisionEvent>,
    world: impl Fn(Entity) -> Option<(&'a NarrowPhase, &'a RapierContextColliders)>,
) {
    if surfaces.is_empty() {
        events.clear();
        return;
    }
    for event in events.read() {
        let (CollisionEvent::Started(one, other, flags) | CollisionEvent::Stopped(one, other, flags)) = *event;
        let context = surfaces.get(&one).or_else(|| surfaces.get(&other));
        let Some((narrow_phase, colliders)) = context.and_then(|&context| world(context)) else {
            continue;
        };
        if flags.contains(CollisionEventFlags::SENSOR) {
            continue;
        }
        let handles = [one, other].map(|entity| colliders.entity2collider().get(&entity).copied());
        let [Some(a), Some(b)] = handles else { continue };
        let touches = narrow_phase
            .contact_pair(a, b)
            .is_some_and(ContactPair::has_any_active_contact);
        *event = match touches {
            true => CollisionEvent::Started(one, other, flags),
            false => CollisionEvent::Stopped(one, other, flags),
        };
    }
}
