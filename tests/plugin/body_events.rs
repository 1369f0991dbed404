//! Start and end events of bodies with several colliders.

use bevy::ecs::entity_disabling::Disabled;
use bevy::gltf::Gltf;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::gltf::write::{Appearance, write_glb};
use morph_collision_models::mesh::MorphMesh;
use morph_collision_workspace::app::{headless, load_gltf};

use crate::log::start;
use crate::support::{BodyMessages, Edits, Messages, add_mesh, app, cube, move_to, settle, spawn, stretching_cube};

/// The events heard on one body.
#[derive(Resource, Default, Debug)]
struct Heard {
    starts: Vec<MorphBodyCollisionStart>,
    ends: Vec<MorphBodyCollisionEnd>,
}

impl Heard {
    fn counts(app: &App) -> (usize, usize) {
        let heard = app.world().resource::<Self>();
        (heard.starts.len(), heard.ends.len())
    }
}

/// Listens on one entity.
fn observe(app: &mut App, body: Entity) {
    app.init_resource::<Heard>();
    app.world_mut()
        .entity_mut(body)
        .observe(|start: On<MorphBodyCollisionStart>, mut heard: ResMut<Heard>| heard.starts.push(*start.event()))
        .observe(|end: On<MorphBodyCollisionEnd>, mut heard: ResMut<Heard>| heard.ends.push(*end.event()));
}

/// The bodies in the messages since the last call.
fn read(messages: &mut BodyMessages, app: &App) -> (Vec<[Entity; 2]>, Vec<[Entity; 2]>) {
    let (starts, ends) = messages.read(app);
    (
        starts.iter().map(|start| [start.body1, start.body2]).collect(),
        ends.iter().map(|end| [end.body1, end.body2]).collect(),
    )
}

fn pair(a: Entity, b: Entity) -> [Entity; 2] {
    [a.min(b), a.max(b)]
}

/// Five cubes in a row along x, 1.2 apart, as the primitives of one mesh with one target.
fn head() -> MorphMesh {
    let part = stretching_cube();
    let mut head = MorphMesh {
        name: "head".into(),
        target_names: part.target_names.clone(),
        targets: vec![Vec::new()],
        ..default()
    };
    for i in 0..5 {
        let first = head.positions.len() as u32;
        let begin = head.triangles.len() as u32;
        let offset = Vec3::X * 1.2 * i as f32;
        head.positions.extend(part.positions.iter().map(|&p| p + offset));
        head.triangles
            .extend(part.triangles.iter().map(|triangle| triangle.map(|v| v + first)));
        head.targets[0].extend(&part.targets[0]);
        head.primitives.push(begin..head.triangles.len() as u32);
    }
    head
}

/// An app with the head from a glTF file, and the root of its scene.
fn app_with_head() -> (App, Entity) {
    let folder = tempfile::tempdir().expect("there is room for a small file");
    let file = folder.path().join("head.glb");
    write_glb(&file, &head(), &Appearance::default()).expect("the head can be written");
    let mut app = headless(folder.path());
    start(&mut app);
    let gltf = load_gltf(&mut app, &file).expect("the head can be loaded");
    let files = app.world().resource::<Assets<Gltf>>();
    let scene = files.get(&gltf).and_then(|gltf| gltf.default_scene.clone());
    let scene = WorldAssetRoot(scene.expect("the head's file has a scene"));
    let head = (scene, MorphColliderScene::default(), MorphCollidingEntities::default());
    let root = app.spawn(head);
    observe(&mut app, root);
    settle(&mut app);
    (app, root)
}

fn listed(app: &App, body: Entity) -> Vec<Entity> {
    let list = app.world().get::<MorphCollidingEntities>(body);
    list.map(|list| list.to_vec()).unwrap_or_default()
}

#[test]
fn a_head_of_five_parts_and_a_ball_have_one_start_and_one_end() {
    let (mut app, root) = app_with_head();
    let parts = app.world().get::<MorphColliders>(root).map(|parts| parts.to_vec());
    let parts = parts.expect("the parts are colliders of the root");
    assert_eq!(parts.len(), 5);
    let place = Transform::from_xyz(-2.0, 0.5, 0.0);
    let ball = app.spawn((MorphShape::from(Sphere::new(0.3)), place));
    app.update();
    let (mut of_colliders, mut of_bodies) = (Messages::default(), BodyMessages::default());
    let (mut starts, mut ends) = (0, 0);
    let (mut body_starts, mut body_ends) = (Vec::new(), Vec::new());
    // Along the top of the cubes. Between two of them the ball touches both.
    let is_there = |x: f32| x > -0.8 && x < 5.6;
    for step in 0..90 {
        let x = -2.05 + 0.1 * step as f32;
        app.insert(ball, place.with_translation(Vec3::new(x, 0.5, 0.0)));
        app.update();
        let (started, ended) = of_colliders.read(&app);
        (starts, ends) = (starts + started.len(), ends + ended.len());
        let (started, ended) = read(&mut of_bodies, &app);
        body_starts.extend(started);
        body_ends.extend(ended);
        let touching = if is_there(x) { vec![ball] } else { Vec::new() };
        assert_eq!(listed(&app, root), touching, "x = {x}");
        let collisions = app.world().resource::<MorphCollisions>();
        assert_eq!(collisions.contains_bodies(ball, root), is_there(x), "x = {x}");
        assert!(collisions.collisions_between_bodies(root, ball).count() <= 2);
    }
    assert_eq!((starts, ends), (5, 5), "one for each part");
    assert_eq!(
        (body_starts, body_ends),
        (vec![pair(root, ball)], vec![pair(root, ball)])
    );
    let heard = app.world().resource::<Heard>();
    let ([start], [end]) = (&heard.starts[..], &heard.ends[..]) else {
        panic!("{heard:?}");
    };
    assert_eq!([start.body1, start.body2, start.collider2], [root, ball, ball]);
    assert!(parts.contains(&start.collider1), "{start:?}");
    assert!(
        (start.point.x + 0.5).abs() < 0.06 && start.normal.length() > 0.99,
        "{start:?}"
    );
    assert!(start.normal.x > 0.5, "the head leaves the ball to the right: {start:?}");
    assert_eq!([end.body1, end.body2], [root, ball]);
}

#[test]
fn edits_of_a_scene_reach_its_parts() {
    let (mut app, root) = app_with_head();
    let ball = (MorphShape::from(Sphere::new(0.3)), Transform::from_xyz(-1.0, 0.5, 0.0));
    let ball = app.spawn(ball);
    app.update();
    let edit = |app: &mut App, edit: &dyn Fn(&mut MorphColliderScene)| {
        edit(
            &mut app
                .world_mut()
                .get_mut::<MorphColliderScene>(root)
                .expect("it is a scene"),
        );
        app.update();
        Heard::counts(app)
    };
    assert_eq!(Heard::counts(&app), (0, 0), "the ball is 0.2 away");
    assert_eq!(edit(&mut app, &|scene| scene.collider.margin = 0.25), (1, 0));
    assert_eq!(
        edit(&mut app, &|scene| scene.layers = MorphCollisionLayers::NONE),
        (1, 1)
    );
    assert_eq!(edit(&mut app, &|scene| scene.layers = default()), (2, 1));
    assert_eq!(edit(&mut app, &|scene| scene.only_named = vec!["tail".into()]), (2, 2));
    assert_eq!(edit(&mut app, &|scene| scene.only_named = vec!["head".into()]), (3, 2));
    assert_eq!(listed(&app, root), [ball]);
    app.remove::<MorphColliderScene>(root);
    app.update();
    assert_eq!((Heard::counts(&app), listed(&app, root)), ((3, 3), vec![]));
}

/// A body of two cubes at 0 and 1.5, and a cube that touches the first one.
fn body_and_cube() -> (App, Entity, [Entity; 2], Entity) {
    let mut app = app();
    let mesh = add_mesh(&mut app, &cube());
    let body = app.spawn(MorphCollidingEntities::default());
    let parts = [0.0, 1.5].map(|x| spawn(&mut app, &mesh, x));
    for part in parts {
        app.insert(part, MorphColliderOf { body });
    }
    let other = spawn(&mut app, &mesh, -0.8);
    observe(&mut app, body);
    settle(&mut app);
    assert_eq!(Heard::counts(&app), (1, 0));
    (app, body, parts, other)
}

#[test]
fn which_parts_touch_is_no_event() {
    let (mut app, body, parts, other) = body_and_cube();
    let mut messages = Messages::default();
    messages.read(&app);
    // From the first part to both, to the second one, and from one to the other within one run.
    for x in [0.75, 1.6, -0.8, 2.3] {
        move_to(&mut app, other, x);
        app.update();
    }
    let (starts, ends) = messages.read(&app);
    assert!(starts.len() >= 2 && ends.len() >= 2);
    assert_eq!((Heard::counts(&app), listed(&app, body)), ((1, 0), vec![other]));
    // There is no event either if the touching part is despawned.
    move_to(&mut app, other, 0.75);
    app.update();
    app.world_mut().despawn(parts[0]);
    app.update();
    assert_eq!(Heard::counts(&app), (1, 0));
    app.world_mut().despawn(parts[1]);
    app.update();
    assert_eq!((Heard::counts(&app), listed(&app, body)), ((1, 1), vec![]));
}

#[test]
fn disabled_parts_let_go() {
    let (mut app, _, [first, _], _) = body_and_cube();
    for round in 1..3 {
        app.insert(first, MorphColliderDisabled);
        app.update();
        assert_eq!(Heard::counts(&app), (2 * round - 1, 2 * round - 1));
        app.remove::<MorphColliderDisabled>(first);
        app.update();
        app.insert(first, Disabled);
        app.update();
        assert_eq!(Heard::counts(&app), (2 * round, 2 * round));
        app.remove::<Disabled>(first);
        app.update();
    }
}

#[test]
fn a_part_that_changes_its_body_ends_one_touch_and_starts_another() {
    let (mut app, body, [first, _], other) = body_and_cube();
    let mut messages = BodyMessages::default();
    read(&mut messages, &app);
    let new = app.world_mut().spawn_empty().id();
    app.insert(first, MorphColliderOf { body: new });
    app.update();
    assert_eq!(
        read(&mut messages, &app),
        (vec![pair(new, other)], vec![pair(body, other)])
    );
    assert_eq!((Heard::counts(&app), listed(&app, body)), ((1, 1), vec![]));
    app.remove::<MorphColliderOf>(first);
    app.update();
    assert_eq!(
        read(&mut messages, &app),
        (vec![pair(first, other)], vec![pair(new, other)])
    );
}

#[test]
fn colliders_of_a_body_that_is_despawned_are_bodies_of_their_own() {
    let (mut app, body, [first, second], other) = body_and_cube();
    let mut messages = BodyMessages::default();
    read(&mut messages, &app);
    // No event is triggered for a body that no longer exists.
    app.add_observer(|end: On<MorphBodyCollisionEnd>, entities: Query<()>| assert!(entities.contains(end.body1)));
    app.world_mut().despawn(body);
    app.update();
    assert_eq!(
        read(&mut messages, &app),
        (vec![pair(first, other)], vec![pair(body, other)])
    );
    assert!(app.world().get::<MorphColliderOf>(second).is_none());
    move_to(&mut app, second, 0.5);
    app.update();
    let between = pair(first, second);
    assert!(
        read(&mut messages, &app).0.contains(&between),
        "they touch each other now"
    );
}

#[test]
fn nothing_starts_or_ends_while_collisions_are_paused() {
    let (mut app, body, [first, _], other) = body_and_cube();
    let mut messages = BodyMessages::default();
    read(&mut messages, &app);
    let pause = |app: &mut App, paused: bool| {
        app.settings().paused = paused;
        app.update();
    };
    pause(&mut app, true);
    move_to(&mut app, other, -9.0);
    app.update();
    move_to(&mut app, other, -0.8);
    pause(&mut app, false);
    assert_eq!(read(&mut messages, &app), (vec![], vec![]), "nobody saw it");
    pause(&mut app, true);
    app.remove::<MorphColliderOf>(first);
    app.update();
    assert_eq!(read(&mut messages, &app), (vec![], vec![]));
    pause(&mut app, false);
    assert_eq!(
        read(&mut messages, &app),
        (vec![pair(first, other)], vec![pair(body, other)])
    );
}

#[test]
fn a_collider_without_a_body_is_told_as_a_body() {
    let mut app = app();
    let mesh = add_mesh(&mut app, &cube());
    let [a, b] = [0.0, 0.8].map(|x| spawn(&mut app, &mesh, x));
    observe(&mut app, b);
    settle(&mut app);
    let heard = &app.world().resource::<Heard>().starts;
    let who: Vec<_> = heard
        .iter()
        .map(|start| [start.body1, start.body2, start.collider1, start.collider2])
        .collect();
    assert_eq!(who, [[b, a, b, a]]);
    assert!(heard[0].normal.x > 0.0, "b leaves a to the right: {heard:?}");
}

#[test]
fn the_list_on_an_entity_follows_whether_it_is_a_body() {
    let (mut app, body, _, other) = body_and_cube();
    app.insert(other, MorphCollidingEntities::default());
    app.update();
    let [first, _] = [0, 1].map(|i| app.world().get::<MorphColliders>(body).expect("it has two")[i]);
    assert_eq!(
        listed(&app, other),
        [first],
        "no body of others: its list is of colliders"
    );
    // Nothing is compared for it either.
    let part = app.spawn(MorphColliderOf { body: other });
    app.update();
    assert_eq!(listed(&app, other), [body], "a body of others: its list is of bodies");
    app.world_mut().despawn(part);
    app.update();
    assert_eq!(listed(&app, other), [first]);
}
