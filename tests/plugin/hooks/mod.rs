//! A game's own rules for pairs of colliders.
//!
//! - `pairs`: which pairs are compared.
//! - `contacts`: what becomes of contacts.
//! - `apps`: hooks in apps of all kinds, and what is said about those without effect.

mod apps;
mod contacts;
mod pairs;

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_workspace::app::headless;

use crate::log::start;
use crate::support::{Edits, add_mesh, assets, cube, settle, spawn};

/// What the hooks of these tests read.
#[derive(Resource, Default)]
pub(crate) struct Rules {
    /// Pairs with one of these are refused.
    refused: Vec<Entity>,
    /// Contacts with one of these do not count.
    ghosts: Vec<Entity>,
    /// Added to the height of contacts' points.
    lift: f32,
}

/// The pairs about which each hook was asked.
#[derive(Resource, Default)]
struct Asked {
    filter: Vec<(Entity, Entity)>,
    modify: Vec<(Entity, Entity)>,
}

#[derive(SystemParam)]
pub(crate) struct ByRules<'w> {
    rules: Res<'w, Rules>,
}

fn note(commands: &mut Commands, list: fn(&mut Asked) -> &mut Vec<(Entity, Entity)>, pair: (Entity, Entity)) {
    commands.queue(move |world: &mut World| list(&mut world.resource_mut()).push(pair));
}

impl MorphCollisionHooks for ByRules<'_> {
    fn filter_pairs(&self, pair: &MorphCandidatePair, commands: &mut Commands) -> bool {
        let all = [pair.collider1, pair.collider2, pair.body1, pair.body2];
        note(commands, |asked| &mut asked.filter, (all[0], all[1]));
        !all.iter().any(|entity| self.rules.refused.contains(entity))
    }

    fn modify_contacts(&self, contact: &mut MorphContact, commands: &mut Commands) -> bool {
        let pair = (contact.collider1, contact.collider2);
        note(commands, |asked| &mut asked.modify, pair);
        contact.point.y += self.rules.lift;
        // Nobody but the plugin says who touches.
        contact.body1 = Entity::PLACEHOLDER;
        contact.collider2 = Entity::PLACEHOLDER;
        !self.rules.ghosts.contains(&pair.0) && !self.rules.ghosts.contains(&pair.1)
    }
}

/// Refuses nothing, and looks at what the plugin offers.
#[derive(SystemParam)]
pub(crate) struct Indifferent<'w, 's> {
    spatial: MorphSpatialQuery<'w, 's>,
    collisions: Res<'w, MorphCollisions>,
    diagnostics: Res<'w, MorphCollisionDiagnostics>,
}

impl Indifferent<'_, '_> {
    fn look(&self) {
        let filter = MorphQueryFilter::default();
        assert!(self.spatial.cast_ray(Vec3::X * -9.0, Dir3::X, 20.0, &filter).is_some());
        assert!(self.diagnostics.touching_pairs <= 2 && self.collisions.len() <= 2);
    }
}

impl MorphCollisionHooks for Indifferent<'_, '_> {
    fn filter_pairs(&self, pair: &MorphCandidatePair, commands: &mut Commands) -> bool {
        self.look();
        note(commands, |asked| &mut asked.filter, (pair.collider1, pair.collider2));
        true
    }

    fn modify_contacts(&self, contact: &mut MorphContact, commands: &mut Commands) -> bool {
        self.look();
        let pair = (contact.collider1, contact.collider2);
        note(commands, |asked| &mut asked.modify, pair);
        true
    }
}

/// An app with [`ByRules`].
fn app_with_rules() -> App {
    let mut app = headless(&assets());
    app.init_resource::<Rules>().init_resource::<Asked>();
    app.add_plugins(MorphCollisionHooksPlugin::<ByRules>::default());
    start(&mut app);
    app
}

/// Three cubes in a row, each of which touches its neighbours. The first one asks hooks.
fn row(app: &mut App, asks: MorphActiveCollisionHooks) -> [Entity; 3] {
    let mesh = add_mesh(app, &cube());
    let cubes = [0.0, 0.8, 1.6].map(|x| spawn(app, &mesh, x));
    app.insert(cubes[0], asks);
    settle(app);
    cubes
}

/// Two colliders in the order in which hooks see them.
fn pair(a: Entity, b: Entity) -> (Entity, Entity) {
    (a.min(b), a.max(b))
}

fn rules(app: &mut App) -> Mut<'_, Rules> {
    app.world_mut().resource_mut()
}

/// The pairs that hooks were asked about since the last call.
fn asked(app: &mut App) -> Asked {
    std::mem::take(&mut *app.world_mut().resource_mut::<Asked>())
}
