//! Scenes that are edited after spawning, and the setting for every morphing mesh.

use bevy::ecs::entity_disabling::Disabled;
use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use crate::support::{Edits, add_mesh, app, cube, move_to, settle, spawn, stretching_cube, touches};

const FIRST: MorphCollider = MorphCollider {
    mode: MorphCollisionMode::First,
    margin: 0.25,
    tolerance: 0.125,
    continuous: true,
};

/// A scene with a morphing part, a rigid one, and a named morphing one whose name is on the entity above its mesh.
struct Scene {
    app: App,
    root: Entity,
    morphing: Entity,
    rigid: Entity,
    jaw: Entity,
}

impl Scene {
    fn new(scene: MorphColliderScene) -> Self {
        let mut app = app();
        let (rigid, morphing) = (add_mesh(&mut app, &cube()), add_mesh(&mut app, &stretching_cube()));
        let world = app.world_mut();
        let weights = || MeshMorphWeights::Value { weights: vec![0.0] };
        let root = world.spawn(scene).id();
        let rigid = world.spawn((Mesh3d(rigid), ChildOf(root))).id();
        let node = world.spawn((Name::new("jaw"), Transform::default(), ChildOf(root)));
        let node = node.id();
        let jaw = world.spawn((Mesh3d(morphing.clone()), weights(), ChildOf(node))).id();
        let morphing = world.spawn((Mesh3d(morphing), weights(), ChildOf(root))).id();
        settle(&mut app);
        Self {
            app,
            root,
            morphing,
            rigid,
            jaw,
        }
    }

    fn edit(&mut self, edit: impl FnOnce(&mut MorphColliderScene)) {
        edit(&mut self.app.world_mut().get_mut::<MorphColliderScene>(self.root).unwrap());
        self.app.update();
    }

    fn insert(&mut self, part: Entity, bundle: impl Bundle) {
        self.app.insert(part, bundle);
    }

    /// A component of a part.
    fn has<C: Component + Clone>(&self, part: Entity) -> Option<C> {
        self.app.world().get::<C>(part).cloned()
    }

    fn collider(&self, part: Entity) -> Option<MorphCollider> {
        self.has(part)
    }
}

#[test]
fn editing_a_scene_edits_its_parts() {
    let mut scene = Scene::new(MorphColliderScene::default());
    let layers = MorphCollisionLayers::new(1, 2);
    assert_eq!(scene.collider(scene.jaw), Some(MorphCollider::default()));
    scene.edit(|scene| (scene.collider, scene.layers, scene.events) = (FIRST, layers, true));
    for part in [scene.jaw, scene.morphing] {
        assert_eq!(scene.collider(part), Some(FIRST));
        assert_eq!(scene.has::<MorphCollisionLayers>(part), Some(layers));
        assert!(scene.has::<MorphCollisionEventsEnabled>(part).is_some());
    }
    scene.edit(|scene| scene.events = false);
    assert!(scene.has::<MorphCollisionEventsEnabled>(scene.jaw).is_none());
    // A bad margin can be corrected.
    scene.edit(|scene| scene.collider.margin = f32::NAN);
    scene.edit(|scene| scene.collider.margin = 0.5);
    assert_eq!(scene.collider(scene.jaw).map(|jaw| jaw.margin), Some(0.5));
}

#[test]
fn inserting_a_scene_again_edits_its_parts() {
    let mut scene = Scene::new(MorphColliderScene::default());
    let other = MorphColliderScene {
        collider: FIRST,
        only_deforming: false,
        only_named: vec!["jaw".into()],
        ..default()
    };
    scene.insert(scene.root, other);
    scene.app.update();
    assert_eq!(scene.collider(scene.jaw), Some(FIRST));
    assert_eq!(scene.collider(scene.morphing), None);
}

#[test]
fn parts_that_match_no_longer_are_meshes_again_and_others_become_parts() {
    let mut scene = Scene::new(MorphColliderScene {
        events: true,
        ..default()
    });
    let is_part = |scene: &Scene| {
        let is_part = |part| scene.collider(part).is_some();
        [scene.morphing, scene.rigid, scene.jaw].map(is_part)
    };
    assert_eq!(is_part(&scene), [true, false, true]);
    scene.edit(|scene| scene.only_deforming = false);
    assert_eq!(is_part(&scene), [true, true, true]);
    scene.edit(|scene| scene.only_named = vec!["jaw".into()]);
    assert_eq!(is_part(&scene), [false, false, true]);
    for part in [scene.morphing, scene.rigid] {
        assert!(scene.has::<MorphColliderOf>(part).is_none() && scene.has::<MorphCollisionLayers>(part).is_none());
        assert!(scene.has::<MorphCollisionEventsEnabled>(part).is_none());
    }
    // The name of a part, and whether it morphs, may change too.
    scene.insert(scene.rigid, Name::new("jaw"));
    scene.app.update();
    assert_eq!(is_part(&scene), [false, true, true]);
    scene.edit(|scene| scene.only_deforming = true);
    assert_eq!(is_part(&scene), [false, false, true]);
    scene.app.world_mut().entity_mut(scene.jaw).remove::<MeshMorphWeights>();
    scene.app.update();
    assert_eq!(is_part(&scene), [false, false, false]);
    scene.edit(|scene| (scene.only_deforming, scene.only_named) = (false, Vec::new()));
    assert_eq!(is_part(&scene), [true, true, true]);
}

#[test]
fn what_the_user_put_on_a_part_first_stays() {
    let mut app = app();
    let mesh = add_mesh(&mut app, &cube());
    let root = app.spawn(Transform::default());
    let (own_layers, own) = (
        MorphCollisionLayers::new(4, 4),
        MorphCollider::new(MorphCollisionMode::First),
    );
    let mut part = |bundle: &dyn Fn(&mut EntityWorldMut)| {
        let mut part = app.world_mut().spawn((Mesh3d(mesh.clone()), ChildOf(root)));
        bundle(&mut part);
        part.id()
    };
    let collider = part(&|part| {
        part.insert(own);
    });
    let others = part(&|part| {
        part.insert((own_layers, MorphCollisionEventsEnabled));
    });
    let scene = |collider: MorphCollider, events: bool| MorphColliderScene {
        collider,
        layers: MorphCollisionLayers::NONE,
        only_deforming: false,
        events,
        ..default()
    };
    for events in [true, false] {
        let collider_now = MorphCollider::default().with_margin(if events { 1.0 } else { 2.0 });
        app.insert(root, scene(collider_now, events));
        app.update();
        let world = app.world();
        assert_eq!(world.get::<MorphCollider>(collider), Some(&own));
        assert_eq!(world.get::<MorphCollisionLayers>(collider), Some(&default()));
        assert!(world.get::<MorphCollisionEventsEnabled>(collider).is_none());
        assert_eq!(world.get(collider), Some(&MorphColliderOf { body: root }));
        assert_eq!(world.get::<MorphCollider>(others), Some(&collider_now));
        assert_eq!(world.get::<MorphCollisionLayers>(others), Some(&own_layers));
        assert!(world.get::<MorphCollisionEventsEnabled>(others).is_some());
    }
    app.remove::<MorphColliderScene>(root);
    app.update();
    let world = app.world();
    assert_eq!(world.get::<MorphCollider>(collider), Some(&own));
    assert_eq!(world.get::<MorphCollider>(others), None);
    assert_eq!(world.get::<MorphCollisionLayers>(others), Some(&own_layers));
    assert!(world.get::<MorphCollisionEventsEnabled>(others).is_some());
}

#[test]
fn what_the_user_changes_on_a_part_stays_until_the_part_leaves_the_scene() {
    let mut scene = Scene::new(MorphColliderScene::default());
    let mine = MorphCollider::new(MorphCollisionMode::Contacts);
    scene.insert(scene.jaw, mine);
    scene
        .app
        .world_mut()
        .entity_mut(scene.morphing)
        .remove::<MorphCollider>();
    let layers = MorphCollisionLayers::new(1, 1);
    scene.edit(|scene| (scene.collider, scene.layers) = (FIRST, layers));
    assert_eq!(scene.collider(scene.jaw), Some(mine));
    assert_eq!(
        scene.has::<MorphCollisionLayers>(scene.jaw),
        Some(layers),
        "the rest follows"
    );
    assert_eq!(
        scene.collider(scene.morphing),
        None,
        "what was removed does not come back"
    );
    scene.edit(|scene| scene.collider.margin = 3.0);
    assert_eq!(
        (scene.collider(scene.jaw), scene.collider(scene.morphing)),
        (Some(mine), None)
    );

    scene
        .app
        .world_mut()
        .entity_mut(scene.root)
        .remove::<MorphColliderScene>();
    scene.app.update();
    assert_eq!(scene.collider(scene.jaw), None, "the scene made it a collider");
}

#[test]
fn a_part_that_is_disabled_while_the_scene_is_edited_is_right_when_it_comes_back() {
    let mut scene = Scene::new(MorphColliderScene::default());
    scene.insert(scene.jaw, Disabled);
    scene.edit(|scene| scene.collider = FIRST);
    scene.app.world_mut().entity_mut(scene.jaw).remove::<Disabled>();
    scene.app.update();
    assert_eq!(scene.collider(scene.jaw), Some(FIRST));
    // A root that is disabled on its own does not reset its parts.
    scene.insert(scene.root, Disabled);
    scene.insert(scene.jaw, Name::new("chin"));
    scene.app.update();
    assert_eq!(scene.collider(scene.jaw), Some(FIRST));
}

#[test]
fn a_scene_within_a_scene_comes_and_goes() {
    let mut scene = Scene::new(MorphColliderScene::default());
    let node = scene.has::<ChildOf>(scene.jaw).unwrap().parent();
    let inner = MorphColliderScene {
        collider: FIRST,
        ..default()
    };
    scene.insert(node, inner);
    scene.app.update();
    let jaw = |scene: &Scene| (scene.has(scene.jaw), scene.collider(scene.jaw));
    assert_eq!(jaw(&scene), (Some(MorphColliderOf { body: node }), Some(FIRST)));
    scene.app.world_mut().entity_mut(node).remove::<MorphColliderScene>();
    scene.app.update();
    let body = MorphColliderOf { body: scene.root };
    assert_eq!(jaw(&scene), (Some(body), Some(default())));
}

fn set_all(app: &mut App, collider: Option<MorphCollider>) {
    app.settings().every_deforming_mesh = collider;
    app.update();
}

/// Three morphing meshes: without a collider, with one of its own, and a part of a scene.
fn three_meshes() -> (App, [Entity; 3]) {
    let mut app = app();
    let mesh = add_mesh(&mut app, &stretching_cube());
    let weights = MeshMorphWeights::Value { weights: vec![0.0] };
    let own = spawn(&mut app, &mesh, 10.0);
    app.insert(own, weights.clone());
    let world = app.world_mut();
    let loose = world.spawn((Mesh3d(mesh.clone()), weights.clone())).id();
    let scene = world.spawn(MorphColliderScene::default()).id();
    let part = world.spawn((Mesh3d(mesh), weights, ChildOf(scene))).id();
    settle(&mut app);
    (app, [loose, own, part])
}

fn colliders(app: &App, meshes: [Entity; 3]) -> [Option<MorphCollider>; 3] {
    meshes.map(|mesh| app.world().get(mesh).copied())
}

#[test]
fn the_setting_for_every_mesh_can_be_changed_and_taken_back() {
    let (mut app, meshes @ [loose, own, _]) = three_meshes();
    let theirs = Some(MorphCollider::default());
    assert_eq!(colliders(&app, meshes), [None, theirs, theirs]);
    for collider in [FIRST, MorphCollider::new(MorphCollisionMode::First)] {
        set_all(&mut app, Some(collider));
        assert_eq!(colliders(&app, meshes), [Some(collider), theirs, theirs]);
        assert_eq!(app.world().get::<MorphColliderOf>(loose), None);
    }
    set_all(&mut app, None);
    assert_eq!(colliders(&app, meshes), [None, theirs, theirs]);
    let world = app.world();
    assert!(world.get::<MorphCollisionLayers>(loose).is_none());
    assert!(world.get::<MorphCollisionLayers>(own).is_some());
    set_all(&mut app, Some(FIRST));
    assert_eq!(colliders(&app, meshes), [Some(FIRST), theirs, theirs]);
}

#[test]
fn a_collider_that_the_user_removed_stays_away() {
    let (mut app, meshes @ [loose, own, _]) = three_meshes();
    set_all(&mut app, Some(FIRST));
    for mesh in [loose, own] {
        app.remove::<MorphCollider>(mesh);
    }
    app.settings().max_triangle_pairs = 100;
    app.update();
    assert_eq!(colliders(&app, meshes)[..2], [None, None]);
    set_all(&mut app, Some(MorphCollider::default()));
    assert_eq!(colliders(&app, meshes)[..2], [None, None]);
}

#[test]
fn a_collider_that_the_user_changed_goes_its_own_way() {
    let (mut app, meshes @ [loose, ..]) = three_meshes();
    set_all(&mut app, Some(FIRST));
    let mine = MorphCollider::new(MorphCollisionMode::Contacts);
    app.insert(loose, mine);
    set_all(&mut app, Some(MorphCollider::default()));
    assert_eq!(colliders(&app, meshes)[0], Some(mine));
    set_all(&mut app, None);
    assert_eq!(colliders(&app, meshes)[0], None, "it came from the setting");
}

#[test]
fn a_scene_decides_before_the_setting_for_every_mesh() {
    let (mut app, meshes @ [loose, ..]) = three_meshes();
    set_all(&mut app, Some(FIRST));
    let scene = MorphColliderScene {
        collider: MorphCollider::default().with_margin(1.0),
        ..default()
    };
    let root = app.spawn(scene.clone());
    app.insert(loose, ChildOf(root));
    app.update();
    assert_eq!(colliders(&app, meshes)[0], Some(scene.collider));
    assert_eq!(app.world().get(loose), Some(&MorphColliderOf { body: root }));
    app.remove::<MorphColliderScene>(root);
    app.update();
    assert_eq!(colliders(&app, meshes)[0], Some(FIRST));
}

#[test]
fn every_mesh_that_was_disabled_collides_when_it_comes_back() {
    let (mut app, _) = three_meshes();
    let mesh = add_mesh(&mut app, &stretching_cube());
    let weights = MeshMorphWeights::Value { weights: vec![0.0] };
    let pooled = (Mesh3d(mesh.clone()), weights, Disabled);
    let pooled = app.spawn(pooled);
    let other = spawn(&mut app, &mesh, 20.5);
    set_all(&mut app, Some(FIRST));
    app.remove::<Disabled>(pooled);
    // Bevy does not propagate transforms of disabled entities.
    move_to(&mut app, pooled, 20.0);
    settle(&mut app);
    assert!(touches(&app, pooled, other));
}
