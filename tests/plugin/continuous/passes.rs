//! Contacts that begin and end between two frames.

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use super::{HALF, Range, make_continuous};
use crate::support::{BodyMessages, Edits, add_mesh, cube, diagnostics, fixed_app, settle, spawn, touches};

#[test]
fn without_continuous_colliders_nothing_is_noticed() {
    let mut range = Range::with([false, false]);
    range.shoot(2.0);
    assert_eq!(range.counts(), (0, 0));
    assert_eq!(diagnostics(&range.app).swept_pairs, 0);
}

#[test]
fn either_of_two_colliders_is_enough() {
    for continuous in [[true, false], [false, true], [true, true]] {
        let mut range = Range::with(continuous);
        range.shoot(2.0);
        assert_eq!(range.counts(), (1, 1), "{continuous:?}");
        assert_eq!(diagnostics(&range.app).swept_pairs, 1);
        range.shoot(3.0);
        assert_eq!(range.counts(), (0, 0), "{continuous:?}");
    }
}

#[test]
fn a_pass_is_over_but_known_by_what_started_and_ended() {
    let mut range = Range::new();
    range.shoot(2.0);
    let (starts, ends) = range.news();
    let ([start], [end]) = (&starts[..], &ends[..]) else {
        panic!("{starts:?} {ends:?}")
    };
    let pair = [range.bullet.min(range.wall), range.bullet.max(range.wall)];
    assert_eq!([start.collider1, start.collider2], pair);
    assert_eq!([end.collider1, end.collider2], pair);
    let collisions = range.app.world().resource::<MorphCollisions>();
    assert!(collisions.is_empty() && !collisions.contains_bodies(range.bullet, range.wall));
    let [started, ended] = [
        collisions.started().collect::<Vec<_>>(),
        collisions.ended().collect::<Vec<_>>(),
    ];
    assert_eq!((started.len(), &started), (1, &ended));
    let impact = ended[0].impact.unwrap();
    assert_eq!(start.impact, Some(impact));
    assert_eq!((ended[0].point, ended[0].normal), (impact.point, impact.normal));
    assert_eq!((start.point, start.normal), (impact.point, impact.normal));
    assert_eq!(ended[0].triangles, [impact.triangles]);
    range.app.update();
    let collisions = range.app.world().resource::<MorphCollisions>();
    assert_eq!((collisions.started().count(), collisions.ended().count()), (0, 0));
}

#[test]
fn what_stops_in_the_wall_started_on_the_way() {
    let mut range = Range::new();
    range.shoot(0.2);
    assert!(touches(&range.app, range.bullet, range.wall));
    let (starts, ends) = range.news();
    let impact = starts[0].impact.unwrap();
    // The face at x = -1.5 moves by 2.2.
    let expected = f64::from((1.5 - HALF) / 2.2);
    assert!(
        impact.earliest <= expected + 1e-6 && impact.latest >= expected - 1e-6,
        "{impact:?}"
    );
    assert!(impact.latest - impact.earliest <= 1e-6, "{impact:?}");
    assert!(ends.is_empty() && (starts[0].point.x + HALF).abs() < 1e-5, "{starts:?}");
    // It stays as long as the contact lasts, although the pair is compared again.
    range.shoot(0.1);
    assert_eq!(range.counts(), (0, 0));
    let contact = |range: &Range| {
        let collisions = range.app.world().resource::<MorphCollisions>();
        collisions.get(range.bullet, range.wall).unwrap().clone()
    };
    assert_eq!(contact(&range).impact, Some(impact));
    assert_eq!(
        diagnostics(&range.app).swept_pairs,
        0,
        "a contact that lasts cannot begin"
    );
    // On its way out it cannot start again.
    range.shoot(2.0);
    assert_eq!(range.counts(), (0, 1));
    range.shoot(-2.0);
    assert_eq!(range.counts(), (1, 1));
}

/// Names of events in the order in which observers heard them.
#[derive(Resource, Default)]
struct Heard(Vec<(&'static str, Entity, Option<MorphImpact>)>);

fn listen(app: &mut App, entity: Entity) {
    app.init_resource::<Heard>();
    app.world_mut()
        .entity_mut(entity)
        .insert(MorphCollisionEventsEnabled)
        .observe(|start: On<MorphCollisionStart>, mut heard: ResMut<Heard>| {
            heard.0.push(("start", start.collider1, start.impact));
        })
        .observe(|end: On<MorphCollisionEnd>, mut heard: ResMut<Heard>| heard.0.push(("end", end.collider1, None)))
        .observe(|start: On<MorphBodyCollisionStart>, mut heard: ResMut<Heard>| {
            heard.0.push(("body start", start.body1, start.impact));
        })
        .observe(|end: On<MorphBodyCollisionEnd>, mut heard: ResMut<Heard>| {
            heard.0.push(("body end", end.body1, None));
        });
}

#[test]
fn observers_hear_the_start_before_the_end() {
    let mut range = Range::new();
    let (bullet, wall) = (range.bullet, range.wall);
    listen(&mut range.app, bullet);
    listen(&mut range.app, wall);
    range.shoot(2.0);
    let heard = std::mem::take(&mut range.app.world_mut().resource_mut::<Heard>().0);
    let (first, second) = (bullet.min(wall), bullet.max(wall));
    let order: Vec<_> = heard.iter().map(|&(name, entity, _)| (name, entity)).collect();
    let colliders: Vec<_> = order
        .iter()
        .filter(|(name, _)| !name.starts_with("body"))
        .copied()
        .collect();
    let bodies: Vec<_> = order
        .iter()
        .filter(|(name, _)| name.starts_with("body"))
        .copied()
        .collect();
    assert_eq!(
        colliders,
        [("start", first), ("start", second), ("end", first), ("end", second)]
    );
    assert_eq!(
        bodies,
        [
            ("body start", first),
            ("body start", second),
            ("body end", first),
            ("body end", second)
        ]
    );
    // Each hears the impact from its own side.
    for (name, entity, impact) in heard {
        let towards = if entity == bullet { -1.0 } else { 1.0 };
        if let Some(impact) = impact {
            assert!(impact.normal.distance(Vec3::X * towards) < 1e-5, "{name}: {impact:?}");
            assert!(impact.velocity.x * towards < -1.0, "{name}: {impact:?}");
        } else {
            assert!(name.ends_with("end"));
        }
    }
}

#[test]
fn an_old_contact_ends_before_a_new_one_passes() {
    let mut range = Range::new();
    let mesh = add_mesh(&mut range.app, &cube());
    // The cube touches this one at first.
    let other = spawn(&mut range.app, &mesh, -2.8);
    settle(&mut range.app);
    assert_eq!(range.counts(), (1, 0));
    let bullet = range.bullet;
    listen(&mut range.app, bullet);
    range.shoot(2.0);
    let heard = &range.app.world().resource::<Heard>().0;
    let names: Vec<_> = heard
        .iter()
        .map(|(name, ..)| *name)
        .filter(|name| !name.starts_with("body"))
        .collect();
    assert_eq!(names, ["end", "start", "end"]);
    assert!(!touches(&range.app, bullet, other));
}

#[test]
fn bodies_that_pass_touch_once_and_at_the_first_of_their_parts() {
    let mut range = Range::new();
    let root = range.app.world_mut().spawn_empty().id();
    let mesh = add_mesh(&mut range.app, &cube());
    // A part ahead of the first one, and one far to the side.
    let ahead = spawn(&mut range.app, &mesh, -1.0);
    let aside = spawn(&mut range.app, &mesh, -2.0);
    let away = Transform::from_xyz(-2.0, 50.0, 0.0);
    range.app.insert(aside, away);
    for part in [range.bullet, ahead, aside] {
        let body = MorphColliderOf { body: root };
        range.app.insert(part, body);
        make_continuous(&mut range.app, part, true);
    }
    settle(&mut range.app);
    range.news();
    let mut messages = BodyMessages::default();
    messages.read(&range.app);
    let by = |app: &mut App, x: f32| {
        for part in [ahead, aside] {
            app.world_mut().get_mut::<Transform>(part).unwrap().translation.x += x;
        }
    };
    by(&mut range.app, 5.0);
    range.shoot(3.0);
    assert_eq!(range.counts(), (2, 2), "both parts pass the wall");
    let (starts, ends) = messages.read(&range.app);
    let ([start], [end]) = (&starts[..], &ends[..]) else {
        panic!("{starts:?} {ends:?}")
    };
    let (first, second) = (root.min(range.wall), root.max(range.wall));
    assert_eq!(
        [start.body1, start.body2, end.body1, end.body2],
        [first, second, first, second]
    );
    let part = if start.body1 == root {
        start.collider1
    } else {
        start.collider2
    };
    assert_eq!(part, ahead, "the one in front touches first");
    let time = start.impact.unwrap().earliest;
    assert!((time - f64::from((0.5 - HALF) / 5.0)).abs() < 1e-5, "{time}");

    // While one part touches, another one that passes changes nothing for the bodies.
    by(&mut range.app, -5.0);
    range.shoot(-0.2);
    assert_eq!(range.counts(), (2, 1), "one stays, one passes");
    let mut counts = |range: &Range| {
        let (starts, ends) = messages.read(&range.app);
        (starts.len(), ends.len())
    };
    assert_eq!(counts(&range), (1, 0));
    by(&mut range.app, 5.0);
    range.app.update();
    assert_eq!(range.counts(), (1, 1));
    assert_eq!(counts(&range), (0, 0));
}

#[test]
fn every_tick_of_a_fixed_schedule_has_its_own_way() {
    let mut app = fixed_app(1, 3);
    let mesh = add_mesh(&mut app, &cube());
    let [bullet, wall] = [-3.0, 0.0].map(|x| spawn(&mut app, &mesh, x));
    make_continuous(&mut app, bullet, true);
    settle(&mut app);
    app.add_systems(FixedUpdate, move |mut places: Query<&mut Transform>| {
        let mut place = places.get_mut(bullet).unwrap();
        place.translation.x = -place.translation.x;
    });
    #[derive(Resource, Default)]
    struct InTicks(usize);
    app.init_resource::<InTicks>().add_systems(
        FixedLast,
        |collisions: Res<MorphCollisions>, mut ticks: ResMut<InTicks>| ticks.0 += collisions.started().count(),
    );
    let mut messages = crate::support::Messages::default();
    messages.read(&app);
    app.update();
    let (starts, ends) = messages.read(&app);
    assert_eq!((starts.len(), ends.len()), (3, 3));
    assert_eq!(app.world().resource::<InTicks>().0, 3, "one in each tick");
    let collisions = app.world().resource::<MorphCollisions>();
    assert_eq!((collisions.started().count(), collisions.ended().count()), (3, 3));
    assert!(!touches(&app, bullet, wall));
}

#[test]
fn modes_say_how_much_a_pass_lists() {
    use MorphCollisionMode as Mode;
    for (mode, listed) in [(Mode::First, 1), (Mode::All, 1), (Mode::Contacts, 1)] {
        let mut range = Range::new();
        for collider in [range.bullet, range.wall] {
            let mut collider = range.app.world_mut().get_mut::<MorphCollider>(collider).unwrap();
            *collider = MorphCollider::new(mode).with_continuous(true);
        }
        range.shoot(2.0);
        let collisions = range.app.world().resource::<MorphCollisions>();
        let contact = collisions.ended().next().unwrap();
        assert_eq!((contact.mode, contact.triangles.len()), (mode, listed));
        assert!(contact.points.is_empty() && contact.impact.is_some());
    }
    // Two passive colliders are not compared on their way, either.
    let mut range = Range::new();
    for collider in [range.bullet, range.wall] {
        let mut collider = range.app.world_mut().get_mut::<MorphCollider>(collider).unwrap();
        *collider = MorphCollider::new(Mode::Passive).with_continuous(true);
    }
    range.shoot(2.0);
    assert_eq!(range.counts(), (0, 0));
}
