//! Meshes that intersect themselves.

use std::thread::sleep;
use std::time::{Duration, Instant};

use bevy::ecs::entity_disabling::Disabled;
use bevy::ecs::message::MessageCursor;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;
use morph_collision_models::mesh::MorphMesh;

use crate::support::{Edits, add_mesh, app, cube, set_weight, settle, spawn};

/// How long a proof in the background may take.
const PATIENCE: Duration = Duration::from_mins(1);

/// Cubes along the x axis in one mesh. The target moves the last one by -2.
fn cubes(places: &[f32]) -> MorphMesh {
    let one = cube();
    let mut mesh = cube();
    (mesh.positions, mesh.triangles) = (Vec::new(), Vec::new());
    let mut target = Vec::new();
    for (i, &x) in places.iter().enumerate() {
        let first = mesh.positions.len() as u32;
        // Not in line, so that only few triangles meet.
        let at = Vec3::new(x, 0.1 * i as f32, 0.07 * i as f32);
        mesh.positions.extend(one.positions.iter().map(|&p| p + at));
        mesh.triangles
            .extend(one.triangles.iter().map(|corners| corners.map(|corner| first + corner)));
        let way = if i + 1 == places.len() { -2.0 } else { 0.0 };
        target.resize(mesh.positions.len(), Vec3::X * way);
    }
    mesh.targets = vec![target];
    mesh.target_names = vec!["in".into()];
    mesh
}

#[derive(Default)]
struct Messages {
    starts: MessageCursor<MorphSelfCollisionStart>,
    ends: MessageCursor<MorphSelfCollisionEnd>,
}

impl Messages {
    /// Runs a frame. Returns the numbers of the regions that started and ended.
    fn run(&mut self, app: &mut App) -> (Vec<u32>, Vec<u32>) {
        app.update();
        let (starts, ends) = (app.world().resource(), app.world().resource());
        (
            self.starts.read(starts).map(|start| start.region).collect(),
            self.ends.read(ends).map(|end| end.region).collect(),
        )
    }
}

/// An app with such a mesh, and its collider.
fn stage(places: &[f32], list: MorphSelfCollisions) -> (App, Entity) {
    let mut app = app();
    let mesh = add_mesh(&mut app, &cubes(places));
    let collider = spawn(&mut app, &mesh, 10.0);
    app.insert(collider, list);
    set_weight(&mut app, collider, 0.0);
    settle(&mut app);
    (app, collider)
}

fn list(app: &App, collider: Entity) -> &MorphSelfCollisions {
    app.world().get(collider).expect("it lists its self-collisions")
}

#[test]
fn a_mesh_that_morphs_into_itself_is_reported() {
    let (mut app, collider) = stage(&[0.0, 2.0], MorphSelfCollisions::default());
    let mut messages = Messages::default();
    assert_eq!(messages.run(&mut app), (vec![], vec![]));
    set_weight(&mut app, collider, 0.6);
    assert_eq!(messages.run(&mut app), (vec![0], vec![]));
    let regions = list(&app, collider).regions().to_vec();
    assert_eq!(regions.len(), 1);
    assert!(
        regions[0].point.distance(Vec3::new(10.4, 0.05, 0.035)) < 0.3,
        "{}",
        regions[0].point
    );
    for pair in &regions[0].triangles {
        assert!(pair.triangle_a < 12 && (12..24).contains(&pair.triangle_b), "{pair:?}");
    }
    // Deeper, it is still the same region.
    set_weight(&mut app, collider, 0.7);
    assert_eq!(messages.run(&mut app), (vec![], vec![]));
    assert_ne!(list(&app, collider).regions()[0].triangles, []);
    set_weight(&mut app, collider, 0.4);
    assert_eq!(messages.run(&mut app), (vec![], vec![0]));
    assert_eq!(list(&app, collider).regions(), []);
    set_weight(&mut app, collider, 0.6);
    assert_eq!(messages.run(&mut app), (vec![1], vec![]));
    assert_eq!(list(&app, collider).regions()[0].triangles, regions[0].triangles);
}

#[test]
fn the_points_follow_the_entity_and_nothing_starts() {
    let (mut app, collider) = stage(&[0.0, 2.0], MorphSelfCollisions::default());
    set_weight(&mut app, collider, 0.6);
    app.update();
    let before = list(&app, collider).regions()[0].point;
    let mut messages = Messages::default();
    messages.run(&mut app);
    app.insert(collider, Transform::from_xyz(10.0, 3.0, 0.0));
    assert_eq!(messages.run(&mut app), (vec![], vec![]));
    let after = list(&app, collider).regions()[0].point;
    assert!(after.distance(before + 3.0 * Vec3::Y) < 1e-5, "{before} {after}");
}

#[test]
fn what_intersects_at_rest_is_left_out_unless_asked_for() {
    let (mut app, collider) = stage(&[0.0, 0.6, 4.0], MorphSelfCollisions::default());
    assert_eq!(list(&app, collider).regions(), []);
    app.world_mut()
        .get_mut::<MorphSelfCollisions>(collider)
        .expect("it has one")
        .include_rest = true;
    let mut messages = Messages::default();
    assert_eq!(messages.run(&mut app), (vec![0], vec![]));
    let at_rest = list(&app, collider).regions()[0].triangles.clone();
    // The third cube comes close to the second one.
    set_weight(&mut app, collider, 1.3);
    assert_eq!(messages.run(&mut app), (vec![], vec![]));
    let all = list(&app, collider).regions()[0].triangles.clone();
    assert!(all.len() > at_rest.len(), "{} and {}", all.len(), at_rest.len());
    app.world_mut()
        .get_mut::<MorphSelfCollisions>(collider)
        .expect("it has one")
        .include_rest = false;
    app.update();
    let new: Vec<_> = all.into_iter().filter(|pair| !at_rest.contains(pair)).collect();
    let regions = list(&app, collider).regions();
    let listed: Vec<_> = regions.iter().flat_map(|region| region.triangles.clone()).collect();
    assert_eq!(listed, new);
}

#[test]
fn regions_end_when_the_collider_takes_no_part() {
    let (mut app, collider) = stage(&[0.0, 2.0], MorphSelfCollisions::default());
    set_weight(&mut app, collider, 0.6);
    let mut messages = Messages::default();
    assert_eq!(messages.run(&mut app), (vec![0], vec![]));
    app.insert(collider, MorphColliderDisabled);
    assert_eq!(messages.run(&mut app), (vec![], vec![0]));
    assert_eq!(list(&app, collider).regions(), []);
    app.remove::<MorphColliderDisabled>(collider);
    assert_eq!(messages.run(&mut app), (vec![1], vec![]));
    let other = add_mesh(&mut app, &cubes(&[0.0, 1.9]));
    app.insert(collider, Mesh3d(other));
    let (mut started, mut ended) = (vec![], vec![]);
    for _ in 0..200 {
        let (starts, ends) = messages.run(&mut app);
        started.extend(starts);
        ended.extend(ends);
        sleep(Duration::from_millis(1));
        if !started.is_empty() {
            break;
        }
    }
    assert_eq!((started, ended), (vec![2], vec![1]));
    app.world_mut().entity_mut(collider).despawn();
    assert_eq!(messages.run(&mut app), (vec![], vec![2]));
}

#[test]
fn the_limit_of_a_list_counts_and_says_so() {
    let (mut app, collider) = stage(&[0.0, 2.0], MorphSelfCollisions::default());
    app.settings().max_triangle_pairs = 1;
    set_weight(&mut app, collider, 0.6);
    app.update();
    assert!(list(&app, collider).is_truncated());
    assert_eq!(list(&app, collider).regions()[0].triangles.len(), 1);
}

#[test]
fn observers_of_the_collider_are_called() {
    #[derive(Resource, Default)]
    struct Seen(Vec<u32>, Vec<u32>);
    let (mut app, collider) = stage(&[0.0, 2.0], MorphSelfCollisions::default());
    app.init_resource::<Seen>();
    app.world_mut()
        .entity_mut(collider)
        .insert(MorphCollisionEventsEnabled)
        .observe(|start: On<MorphSelfCollisionStart>, mut seen: ResMut<Seen>| seen.0.push(start.region))
        .observe(|end: On<MorphSelfCollisionEnd>, mut seen: ResMut<Seen>| seen.1.push(end.region));
    for weight in [0.6, 0.0, 0.6] {
        set_weight(&mut app, collider, weight);
        app.update();
    }
    let Seen(started, ended) = app.world().resource();
    assert_eq!((&started[..], &ended[..]), (&[0, 1][..], &[0][..]));
}

#[test]
fn several_meshes_are_compared_at_once() {
    let mut app = app();
    let mesh = add_mesh(&mut app, &cubes(&[0.0, 2.0]));
    let colliders: Vec<Entity> = (0..8)
        .map(|i| {
            let collider = spawn(&mut app, &mesh, 10.0 * i as f32);
            app.insert(collider, MorphSelfCollisions::default());
            set_weight(&mut app, collider, 0.1 * i as f32);
            collider
        })
        .collect();
    settle(&mut app);
    let touching = colliders
        .iter()
        .map(|&collider| !list(&app, collider).regions().is_empty());
    let touching: Vec<bool> = touching.collect();
    assert_eq!(touching, [false, false, false, false, false, true, true, true]);
}

#[test]
fn disabled_entities_and_replaced_lists_end_their_regions() {
    let (mut app, collider) = stage(&[0.0, 2.0], MorphSelfCollisions::default());
    set_weight(&mut app, collider, 0.6);
    let mut messages = Messages::default();
    assert_eq!(messages.run(&mut app), (vec![0], vec![]));
    app.insert(collider, Disabled);
    assert_eq!(messages.run(&mut app), (vec![], vec![0]));
    app.remove::<Disabled>(collider);
    assert_eq!(messages.run(&mut app), (vec![1], vec![]));
    app.insert(collider, MorphSelfCollisions::default());
    assert_eq!(messages.run(&mut app), (vec![2], vec![1]));
    // A copy starts its own regions.
    let copy = app.world_mut().entity_mut(collider).clone_and_spawn();
    for _ in 0..3 {
        app.update();
    }
    assert_eq!(list(&app, copy).regions().len(), 1);
    messages = Messages::default();
    messages.run(&mut app);
    set_weight(&mut app, copy, 0.0);
    assert_eq!(messages.run(&mut app).1.len(), 1);
    app.remove::<MorphSelfCollisions>(collider);
    assert_eq!(messages.run(&mut app), (vec![], vec![2]));
}

#[test]
fn a_proof_in_the_background_changes_no_report() {
    let (mut app, collider) = stage(&[0.0, 2.0, 6.0], MorphSelfCollisions::default().with_proof(true));
    let mesh = app.world().get::<Mesh3d>(collider).expect("it has one").0.id();
    let tree = app.world().resource::<MorphTrees>().get(mesh).cloned();
    let tree = tree.expect("it is built");
    // The machine may be busy.
    let start = Instant::now();
    while tree.certificates().is_none() && start.elapsed() < PATIENCE {
        app.update();
        sleep(Duration::from_millis(1));
    }
    let proved = tree
        .certificates()
        .map(|certificates| certificates.weights().interval(0));
    assert_eq!(proved, Some(Some([0.0, 1.0])));
    // The last cube comes down to 4, far from the others; beyond the proof, at 2.3, it goes through the second one.
    let mut messages = Messages::default();
    for (weight, expected) in [
        (0.5, (vec![], vec![])),
        (1.0, (vec![], vec![])),
        (1.9, (vec![0], vec![])),
        (1.0, (vec![], vec![0])),
    ] {
        set_weight(&mut app, collider, weight);
        assert_eq!(messages.run(&mut app), expected, "{weight}");
    }
}

#[test]
fn the_proof_of_a_mesh_that_disappears_ends() {
    let (mut app, collider) = stage(&[0.0, 2.0], MorphSelfCollisions::default().with_proof(true));
    let mesh = app.world().get::<Mesh3d>(collider).expect("it has one").0.id();
    let tree = app.world().resource::<MorphTrees>().get(mesh).cloned();
    let tree = std::sync::Arc::downgrade(&tree.expect("it is built"));
    app.world_mut().entity_mut(collider).despawn();
    let start = Instant::now();
    while start.elapsed() < PATIENCE {
        app.update();
        if tree.strong_count() == 0 {
            return;
        }
        sleep(Duration::from_millis(1));
    }
    panic!("{} things still need the tree", tree.strong_count());
}
