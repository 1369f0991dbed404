//! What becomes of contacts.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::generated::rigid;
use morph_collision_workspace::app::headless;

use super::{app_with_rules, asked, pair, row, rules};
use crate::log::start;
use crate::support::{Edits, Messages, add_mesh, assets, cube, diagnostics, move_to, settle, spawn, touches};

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
