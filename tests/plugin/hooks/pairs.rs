//! Which pairs are compared.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_workspace::app::headless;

use super::{Asked, ByRules, Indifferent, Rules, app_with_rules, asked, pair, row, rules};
use crate::log::start;
use crate::support::{
    BodyMessages, Edits, Messages, add_mesh, assets, cube, diagnostics, move_to, settle, spawn, touches,
};

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
