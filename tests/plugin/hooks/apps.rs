//! Hooks in apps of all kinds, and what is said about those without effect.

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use super::{Asked, ByRules, Rules, app_with_rules, asked, pair, row, rules};
use crate::log::{Errors, start};
use crate::support::{Edits, fixed_app, plain_app, touches};

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
