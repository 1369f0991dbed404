//! Hashes of the entity events of a frame.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use super::banks::Banks;
use super::digest::{Counts, Digest, cast_hits};

#[derive(Resource)]
struct Observed(Digest, usize);

#[derive(SystemParam)]
struct Observer<'w> {
    observed: ResMut<'w, Observed>,
    banks: Res<'w, Banks>,
}

impl Observer<'_> {
    fn add(&mut self, kind: u64, entities: impl IntoIterator<Item = Entity>) -> &mut Digest {
        self.observed.1 += 1;
        let digest = &mut self.observed.0;
        digest.add(kind);
        digest.entities(&self.banks, entities);
        digest
    }
}

/// Observes all events of entities.
pub(super) fn observe(app: &mut App) {
    app.insert_resource(Observed(Digest::new(), 0));
    app.add_observer(|e: On<MorphCollisionStart>, mut observer: Observer| {
        let digest = observer.add(1, [e.collider1, e.collider2, e.body1, e.body2]);
        digest.floats(e.point.to_array());
        digest.floats(e.normal.to_array());
        digest.impact(e.impact);
    });
    app.add_observer(|e: On<MorphCollisionEnd>, mut observer: Observer| {
        observer.add(2, [e.collider1, e.collider2, e.body1, e.body2]);
    });
    app.add_observer(|e: On<MorphBodyCollisionStart>, mut observer: Observer| {
        let digest = observer.add(3, [e.body1, e.body2, e.collider1, e.collider2]);
        digest.floats(e.point.to_array());
        digest.floats(e.normal.to_array());
        digest.impact(e.impact);
    });
    app.add_observer(|e: On<MorphBodyCollisionEnd>, mut observer: Observer| {
        observer.add(4, [e.body1, e.body2]);
    });
    app.add_observer(|e: On<MorphSelfCollisionStart>, mut observer: Observer| {
        let digest = observer.add(5, [e.collider]);
        digest.add(e.region.into());
        digest.floats(e.point.to_array());
    });
    app.add_observer(|e: On<MorphSelfCollisionEnd>, mut observer: Observer| {
        observer.add(6, [e.collider]).add(e.region.into());
    });
}

/// The events since the last call.
pub(super) fn take(world: &mut World, counts: &mut Counts) -> Digest {
    counts.cast_hits += cast_hits(world);
    let Observed(digest, count) = std::mem::replace(&mut *world.resource_mut(), Observed(Digest::new(), 0));
    counts.observed += count;
    digest
}
