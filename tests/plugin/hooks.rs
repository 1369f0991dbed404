//! A game's own rules for pairs of colliders.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::generated::rigid;
use morph_collision_workspace::app::headless;

use crate::log::{Errors, start};
use crate::support::{
    BodyMessages, Edits, Messages, add_mesh, assets, cube, diagnostics, fixed_app, move_to, plain_app, settle, spawn,
    touches,
};

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

#[test]
fn a_pair_that_a_hook_refuses_ends_and_comes_back_although_nothing_moves() {
    let mut app = app_with_rules();
    let [a, b, c] = row(&mut app, MorphActiveCollisionHooks::FILTER_PAIRS);
    let mut messages = Messages::default();
    assert_eq!(messages.read(&app).0.len(), 2);
    asked(&mut app);

    rules(&mut app).refused = vec![b];
    app.update();
    // `b` and `c` do not ask.
    assert!(!touches(&app, a, b) && touches(&app, b, c));
    let run = diagnostics(&app);
    assert_eq!(
        (run.skipped_hooks, run.candidate_pairs, run.skipped_unchanged),
        (1, 1, 1)
    );
    assert_eq!(asked(&mut app).filter, [pair(a, b)]);
    let (starts, ends) = messages.read(&app);
    assert_eq!((starts.len(), ends.len()), (0, 1));

    // Asked in every run, and compared in none.
    app.update();
    assert_eq!(asked(&mut app).filter, [pair(a, b)]);
    assert_eq!(
        (
            diagnostics(&app).stats.triangle_tests,
            diagnostics(&app).skipped_unchanged
        ),
        (0, 1)
    );
    assert_eq!(messages.read(&app), (vec![], vec![]));

    rules(&mut app).refused.clear();
    app.update();
    assert!(touches(&app, a, b));
    let (starts, ends) = messages.read(&app);
    assert_eq!((starts.len(), ends.len()), (1, 0));
    assert_eq!(diagnostics(&app).skipped_unchanged, 1);

    // Without the component, nobody is asked.
    rules(&mut app).refused = vec![b];
    app.remove::<MorphActiveCollisionHooks>(a);
    asked(&mut app);
    app.update();
    assert!(touches(&app, a, b) && asked(&mut app).filter.is_empty());
}

#[test]
fn a_refused_pair_that_stops_asking_is_compared() {
    let mut app = app_with_rules();
    rules(&mut app).refused = vec![Entity::PLACEHOLDER];
    let [a, b, _] = row(&mut app, MorphActiveCollisionHooks::FILTER_PAIRS);
    rules(&mut app).refused = vec![b];
    app.update();
    assert!(!touches(&app, a, b));
    app.remove::<MorphActiveCollisionHooks>(a);
    app.update();
    assert!(touches(&app, a, b));
}

#[test]
fn a_body_asks_for_its_colliders() {
    let mut app = app_with_rules();
    let mesh = add_mesh(&mut app, &cube());
    let body = app.spawn(MorphActiveCollisionHooks::ALL);
    let part = spawn(&mut app, &mesh, 0.0);
    app.insert(part, MorphColliderOf { body });
    let other = spawn(&mut app, &mesh, 0.8);
    settle(&mut app);
    let mut messages = BodyMessages::default();
    assert_eq!(messages.read(&app).0.len(), 1);
    let asked = asked(&mut app);
    assert!(asked.filter.contains(&pair(part, other)) && asked.modify.contains(&pair(part, other)));
    // Refused by the body, which is no collider.
    rules(&mut app).refused = vec![body];
    app.update();
    assert!(!touches(&app, part, other));
    assert_eq!(messages.read(&app).1.len(), 1);
}

#[test]
fn contacts_are_changed_before_anybody_sees_them_and_always_from_what_was_found() {
    let mut app = app_with_rules();
    let [a, b, c] = row(&mut app, MorphActiveCollisionHooks::MODIFY_CONTACTS);
    let found = app.contact(a, b).unwrap();
    let other = app.contact(b, c).unwrap();
    assert!(asked(&mut app).filter.is_empty());
    rules(&mut app).lift = 5.0;
    for _ in 0..3 {
        app.update();
        let mut lifted = found.clone();
        lifted.point.y += 5.0;
        assert_eq!(app.contact(a, b).unwrap(), lifted);
        assert_eq!(app.contact(b, c).unwrap(), other);
        assert_eq!(asked(&mut app).modify, [pair(a, b)]);
        let bodies = app.world().resource::<MorphCollisions>();
        assert!(bodies.contains_bodies(a, b) && bodies.collisions_with(b).count() == 2);
    }
    // As found, once nobody asks any more.
    app.remove::<MorphActiveCollisionHooks>(a);
    app.update();
    assert_eq!(app.contact(a, b).unwrap(), found);
    app.update();
    assert_eq!(diagnostics(&app).skipped_unchanged, 2);
}

#[test]
fn a_contact_that_a_hook_drops_is_none_until_the_hook_changes_its_mind() {
    let mut app = app_with_rules();
    let [a, b, _] = row(&mut app, MorphActiveCollisionHooks::MODIFY_CONTACTS);
    let mut messages = Messages::default();
    messages.read(&app);
    rules(&mut app).ghosts = vec![b];
    app.update();
    assert!(!touches(&app, a, b));
    assert_eq!(messages.read(&app).1.len(), 1);
    app.update();
    assert_eq!(messages.read(&app), (vec![], vec![]));
    rules(&mut app).ghosts.clear();
    app.update();
    assert!(touches(&app, a, b));
    assert_eq!(messages.read(&app).0.len(), 1);
}

#[test]
fn a_continuous_collider_passes_what_it_may_not_hit() {
    for (asks, is_refused) in [
        (MorphActiveCollisionHooks::FILTER_PAIRS, false),
        (MorphActiveCollisionHooks::FILTER_PAIRS, true),
        (MorphActiveCollisionHooks::MODIFY_CONTACTS, true),
    ] {
        let mut app = app_with_rules();
        let (cube, wall) = (
            add_mesh(&mut app, &cube()),
            add_mesh(&mut app, &rigid::box_mesh(Vec3::new(0.01, 3.0, 3.0))),
        );
        let (bullet, wall) = (spawn(&mut app, &cube, -3.0), spawn(&mut app, &wall, 0.0));
        let continuous = MorphCollider::default().with_continuous(true);
        app.insert(bullet, (continuous, asks));
        settle(&mut app);
        if is_refused {
            let mut rules = rules(&mut app);
            rules.refused.push(wall);
            rules.ghosts.push(wall);
        }
        let mut messages = Messages::default();
        messages.read(&app);
        asked(&mut app);
        move_to(&mut app, bullet, 3.0);
        app.update();
        let expected = usize::from(!is_refused);
        let (starts, ends) = messages.read(&app);
        assert_eq!((starts.len(), ends.len()), (expected, expected), "{asks:?}");
        let asked = asked(&mut app);
        let calls = if asks.filter_pairs { asked.filter } else { asked.modify };
        assert_eq!(calls, [pair(bullet, wall)]);
    }
}

#[test]
fn all_hooks_have_to_agree_and_no_one_is_asked_about_what_another_refused() {
    for is_first in [true, false] {
        let mut app = headless(&assets());
        app.init_resource::<Rules>().init_resource::<Asked>();
        if is_first {
            app.add_plugins(MorphCollisionHooksPlugin::<ByRules>::default());
        }
        app.add_plugins(MorphCollisionHooksPlugin::<Indifferent>::default());
        if !is_first {
            app.add_plugins(MorphCollisionHooksPlugin::<ByRules>::default());
        }
        start(&mut app);
        let [a, b, _] = row(&mut app, MorphActiveCollisionHooks::ALL);
        assert!(touches(&app, a, b));
        asked(&mut app);
        app.update();
        let both = asked(&mut app);
        assert_eq!((both.filter.len(), both.modify.len()), (2, 2));
        rules(&mut app).ghosts = vec![a];
        app.update();
        assert!(!touches(&app, a, b));
        assert_eq!(asked(&mut app).modify, vec![pair(a, b); if is_first { 1 } else { 2 }]);
        rules(&mut app).refused = vec![a];
        app.update();
        assert!(!touches(&app, a, b));
        assert_eq!(diagnostics(&app).skipped_hooks, 1);
        let asked = asked(&mut app);
        assert_eq!(asked.filter, vec![pair(a, b); if is_first { 1 } else { 2 }]);
        assert!(asked.modify.is_empty());
        // Nothing is compared for a pair that is refused anyway.
        app.update();
        let run = diagnostics(&app);
        assert_eq!(
            (run.stats.triangle_tests, run.skipped_unchanged, run.candidate_pairs),
            (0, 1, 1)
        );
    }
}

#[test]
fn a_continuous_contact_that_a_hook_drops_does_not_begin_when_it_ends() {
    let mut app = app_with_rules();
    let (cube, wall) = (
        add_mesh(&mut app, &cube()),
        add_mesh(&mut app, &rigid::box_mesh(Vec3::new(0.01, 3.0, 3.0))),
    );
    let (mover, wall) = (spawn(&mut app, &cube, -3.0), spawn(&mut app, &wall, 0.0));
    let asks = MorphActiveCollisionHooks::MODIFY_CONTACTS;
    app.insert(mover, (MorphCollider::default().with_continuous(true), asks));
    settle(&mut app);
    rules(&mut app).ghosts = vec![wall];
    let mut messages = Messages::default();
    messages.read(&app);
    for x in [-0.4, 0.0, 0.3] {
        move_to(&mut app, mover, x);
        app.update();
        assert!(!touches(&app, mover, wall));
        let swept = diagnostics(&app).swept_pairs;
        assert_eq!(swept, u64::from(x < -0.3), "only when it came near: {x}");
    }
    // From now on it counts, but then it is apart already.
    rules(&mut app).ghosts.clear();
    move_to(&mut app, mover, 3.0);
    app.update();
    assert_eq!(messages.read(&app), (vec![], vec![]));
}

#[test]
fn how_a_continuous_contact_began_is_seen_in_all_its_runs() {
    #[derive(SystemParam)]
    struct OnlyFast;

    impl MorphCollisionHooks for OnlyFast {
        fn modify_contacts(&self, contact: &mut MorphContact, _: &mut Commands) -> bool {
            let is_fast = contact.impact.is_some_and(|impact| impact.velocity.length() > 1.0);
            contact.impact = None;
            is_fast
        }
    }

    let mut app = headless(&assets());
    app.add_plugins(MorphCollisionHooksPlugin::<OnlyFast>::default());
    let frame = std::time::Duration::from_secs_f32(0.1);
    app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(frame));
    start(&mut app);
    let cube = add_mesh(&mut app, &cube());
    let (mover, other) = (spawn(&mut app, &cube, -3.0), spawn(&mut app, &cube, 0.0));
    let asks = MorphActiveCollisionHooks::MODIFY_CONTACTS;
    app.insert(mover, (MorphCollider::default().with_continuous(true), asks));
    settle(&mut app);
    for x in [-0.9, -0.89, -0.88] {
        move_to(&mut app, mover, x);
        app.update();
        let contact = app.contact(mover, other).expect("it was fast when it began");
        assert!(contact.impact.is_some_and(|impact| impact.velocity.length() > 1.0));
    }
}

#[test]
fn a_collider_that_a_hook_despawns_touches_nothing() {
    #[derive(SystemParam)]
    struct Fragile<'w> {
        rules: Res<'w, Rules>,
    }

    impl MorphCollisionHooks for Fragile<'_> {
        fn filter_pairs(&self, pair: &MorphCandidatePair, commands: &mut Commands) -> bool {
            for entity in [pair.collider1, pair.collider2] {
                if self.rules.refused.contains(&entity) {
                    commands.entity(entity).despawn();
                }
            }
            true
        }
    }

    let mut app = headless(&assets());
    app.init_resource::<Rules>();
    app.add_plugins(MorphCollisionHooksPlugin::<Fragile>::default());
    start(&mut app);
    let [a, b, c] = row(&mut app, MorphActiveCollisionHooks::FILTER_PAIRS);
    let mut messages = Messages::default();
    messages.read(&app);
    rules(&mut app).refused = vec![a];
    move_to(&mut app, b, 0.81);
    app.update();
    assert!(!touches(&app, a, b) && touches(&app, b, c));
    assert_eq!(messages.read(&app).1.len(), 1);
}

#[test]
fn a_body_rises_through_a_one_way_surface_and_lands_on_it() {
    #[derive(SystemParam)]
    struct FromAbove<'w, 's> {
        places: Query<'w, 's, &'static GlobalTransform>,
        surfaces: Query<'w, 's, (), Without<MorphShape>>,
    }

    impl MorphCollisionHooks for FromAbove<'_, '_> {
        fn filter_pairs(&self, pair: &MorphCandidatePair, _: &mut Commands) -> bool {
            let height = |entity| self.places.get(entity).map_or(0.0, |place| place.translation().y);
            let comes_from_below = |surface, other| self.surfaces.contains(surface) && height(other) < height(surface);
            !comes_from_below(pair.body1, pair.body2) && !comes_from_below(pair.body2, pair.body1)
        }
    }

    let mut app = headless(&assets());
    app.add_plugins(MorphCollisionHooksPlugin::<FromAbove>::default());
    start(&mut app);
    let leaf = add_mesh(&mut app, &rigid::box_mesh(Vec3::new(3.0, 0.01, 3.0)));
    let leaf = spawn(&mut app, &leaf, 0.0);
    let ball = MorphShape::Ball { radius: 0.2 };
    let ball = app.spawn((
        ball,
        Transform::from_xyz(0.0, -1.0, 0.0),
        MorphActiveCollisionHooks::FILTER_PAIRS,
    ));
    settle(&mut app);
    let mut seen = Vec::new();
    for y in [-0.3, -0.15, 0.15, 0.3, 0.15, -0.05] {
        app.insert(ball, Transform::from_xyz(0.0, y, 0.0));
        app.update();
        seen.push(touches(&app, ball, leaf));
    }
    assert_eq!(seen, [false, false, true, false, true, false]);
}

#[test]
fn hooks_work_in_an_app_that_is_never_finished() {
    let mut app = plain_app();
    app.init_resource::<Rules>().init_resource::<Asked>();
    app.add_plugins((MorphCollisionPlugin, MorphCollisionHooksPlugin::<ByRules>::default()));
    let [a, b, _] = row(&mut app, MorphActiveCollisionHooks::default());
    assert!(touches(&app, a, b));
    let asked = asked(&mut app);
    assert!(asked.filter.contains(&pair(a, b)) && asked.modify.contains(&pair(a, b)));
}

#[test]
fn answers_that_change_while_collisions_are_paused_count_afterwards() {
    let mut app = app_with_rules();
    let [a, b, _] = row(&mut app, MorphActiveCollisionHooks::FILTER_PAIRS);
    for is_refused in [true, false] {
        app.settings().paused = true;
        app.update();
        rules(&mut app).refused = if is_refused { vec![a] } else { vec![] };
        app.update();
        assert_eq!(touches(&app, a, b), is_refused, "as before the pause");
        app.settings().paused = false;
        app.update();
        assert_eq!(touches(&app, a, b), !is_refused);
    }
}

#[test]
fn hooks_run_where_collisions_run_whichever_plugin_comes_first() {
    let mut app = plain_app();
    app.init_resource::<Rules>().init_resource::<Asked>();
    app.add_plugins(MorphCollisionHooksPlugin::<ByRules>::default());
    app.add_plugins(MorphCollisionPlugin.in_schedule(FixedPostUpdate));
    let frame = Time::<Fixed>::default().timestep();
    app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(frame));
    start(&mut app);
    let [a, b, _] = row(&mut app, MorphActiveCollisionHooks::ALL);
    app.update();
    assert!(touches(&app, a, b));
    asked(&mut app);
    app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(2 * frame));
    app.update();
    let asked = asked(&mut app);
    assert_eq!((asked.filter, asked.modify), (vec![pair(a, b); 2], vec![pair(a, b); 2]));
}

#[test]
fn hooks_without_effect_are_reported() {
    Errors::collect(|errors| {
        let mut app = plain_app();
        app.init_resource::<Rules>().init_resource::<Asked>();
        app.add_plugins(MorphCollisionHooksPlugin::<ByRules>::default());
        start(&mut app);
        let told = errors.take();
        assert!(
            told.len() == 1 && told[0].contains("`MorphCollisionPlugin`"),
            "{told:?}"
        );
    });
    Errors::collect(|errors| {
        let mut app = fixed_app(1, 1);
        app.spawn((
            Name::new("Arrow"),
            MorphShape::default(),
            MorphActiveCollisionHooks::ALL,
        ));
        let step = std::time::Duration::from_secs(1);
        app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(step));
        (0..20).for_each(|_| app.update());
        let told = errors.take_warnings();
        assert!(
            told.len() == 1 && told[0].contains("`Arrow`") && told[0].contains("`MorphCollisionHooksPlugin`"),
            "{told:?}"
        );
    });
    Errors::collect(|errors| {
        let mut app = app_with_rules();
        app.spawn((Name::new("Nobody"), MorphActiveCollisionHooks::ALL));
        let step = std::time::Duration::from_secs(1);
        app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(step));
        (0..20).for_each(|_| app.update());
        let told = errors.take_warnings();
        assert!(
            told.len() == 1 && told[0].contains("neither a collider nor a body"),
            "{told:?}"
        );
    });
}
