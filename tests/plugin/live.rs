//! All edits, insertions and removals take effect in the very next run.

use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy_morph_collision::import::MorphTrees;
use bevy_morph_collision::morph_collision::BuildOptions;
use bevy_morph_collision::prelude::*;

use crate::support::{Edits, add_mesh, app, cube, settle, spawn, stretching_cube, touches, two_cubes};

type Change = fn(&mut World, [Entity; 2]);
type Effect = fn(&App, [Entity; 2]) -> bool;

/// A change to two overlapping cubes, and an effect that must be visible after the next run and not
/// before.
struct Row(&'static str, Change, Effect);

fn insert(world: &mut World, entity: Entity, bundle: impl Bundle) {
    world.entity_mut(entity).insert(bundle);
}

fn edit<C: Component<Mutability = bevy::ecs::component::Mutable>>(
    world: &mut World,
    entity: Entity,
    edit: impl FnOnce(&mut C),
) {
    edit(&mut world.get_mut::<C>(entity).expect("it has the component"));
}

fn contact(app: &App, [a, b]: [Entity; 2]) -> Option<&MorphContact> {
    app.world().resource::<MorphCollisions>().get(a, b)
}

fn apart(app: &App, cubes: [Entity; 2]) -> bool {
    contact(app, cubes).is_none()
}

/// Changes in sequence. Each finds the cubes as the previous one left them.
const ROWS: &[Row] = &[
    Row(
        "lists get a limit",
        |world, _| world.resource_mut::<MorphCollisionSettings>().max_triangle_pairs = 2,
        |app, cubes| contact(app, cubes).is_some_and(|contact| contact.is_truncated && contact.triangles.len() == 2),
    ),
    Row(
        "the limit is raised",
        |world, _| world.resource_mut::<MorphCollisionSettings>().max_triangle_pairs = 100,
        |app, cubes| contact(app, cubes).is_some_and(|contact| !contact.is_truncated),
    ),
    Row(
        "collisions are paused and go on",
        |world, [a, _]| {
            world.resource_mut::<MorphCollisionSettings>().paused = true;
            insert(world, a, MorphColliderDisabled);
            world.run_schedule(PostUpdate);
            world.resource_mut::<MorphCollisionSettings>().paused = false;
        },
        apart,
    ),
    Row(
        "a collider that was disabled during a pause is enabled",
        |world, [a, _]| {
            world.entity_mut(a).remove::<MorphColliderDisabled>();
        },
        |app, [a, b]| touches(app, a, b),
    ),
    Row(
        "a mode is edited",
        |world, [a, b]| {
            for cube in [a, b] {
                edit::<MorphCollider>(world, cube, |collider| collider.mode = MorphCollisionMode::First);
            }
        },
        |app, cubes| contact(app, cubes).is_some_and(|contact| contact.triangles.len() == 1),
    ),
    Row(
        "a collider is inserted again",
        |world, [a, _]| insert(world, a, MorphCollider::new(MorphCollisionMode::Contacts)),
        |app, cubes| contact(app, cubes).is_some_and(|contact| !contact.points.is_empty()),
    ),
    Row(
        "layers are edited",
        |world, [a, _]| edit::<MorphCollisionLayers>(world, a, |layers| layers.filters = 0),
        apart,
    ),
    Row(
        "layers are removed",
        |world, [a, _]| {
            world.entity_mut(a).remove::<MorphCollisionLayers>();
        },
        |app, [a, b]| touches(app, a, b),
    ),
    Row(
        "layers are inserted",
        |world, [a, _]| insert(world, a, MorphCollisionLayers::NONE),
        apart,
    ),
    Row(
        "layers are inserted again",
        |world, [a, _]| insert(world, a, MorphCollisionLayers::ALL),
        |app, [a, b]| touches(app, a, b),
    ),
    Row(
        "a shape is inserted",
        |world, [a, _]| insert(world, a, MorphShape::Ball { radius: 0.1 }),
        apart,
    ),
    Row(
        "a shape is edited",
        |world, [a, _]| edit::<MorphShape>(world, a, |shape| *shape = MorphShape::Ball { radius: 0.4 }),
        |app, [a, b]| touches(app, a, b),
    ),
    Row(
        "a shape is inserted again",
        |world, [a, _]| insert(world, a, MorphShape::Ball { radius: 0.2 }),
        apart,
    ),
    Row(
        "a shape is removed",
        |world, [a, _]| {
            world.entity_mut(a).remove::<MorphShape>();
        },
        |app, [a, b]| touches(app, a, b),
    ),
    Row(
        "a collider is disabled",
        |world, [_, b]| insert(world, b, MorphColliderDisabled),
        apart,
    ),
    Row(
        "a collider is enabled",
        |world, [_, b]| {
            world.entity_mut(b).remove::<MorphColliderDisabled>();
        },
        |app, [a, b]| touches(app, a, b),
    ),
    Row(
        "a collider is removed",
        |world, [_, b]| {
            world.entity_mut(b).remove::<MorphCollider>();
        },
        apart,
    ),
    Row(
        "a collider is inserted",
        |world, [_, b]| insert(world, b, MorphCollider::default()),
        |app, [a, b]| touches(app, a, b),
    ),
    Row(
        "a list is inserted",
        |world, [_, b]| insert(world, b, MorphCollidingEntities::default()),
        |app, [a, b]| {
            let list = app.world().get::<MorphCollidingEntities>(b);
            list.is_some_and(|list| list.contains(a))
        },
    ),
    Row(
        "another mesh, whose tree is there, is shown",
        |world, [_, b]| {
            let mesh = world.resource::<OtherMesh>().0.clone();
            edit::<Mesh3d>(world, b, |shown| shown.0 = mesh);
        },
        apart,
    ),
    Row(
        "a margin is edited",
        |world, [a, _]| edit::<MorphCollider>(world, a, |collider| collider.margin = 0.75),
        |app, [a, b]| touches(app, a, b),
    ),
    Row(
        "a margin is bad",
        |world, [a, _]| edit::<MorphCollider>(world, a, |collider| collider.margin = -1.0),
        apart,
    ),
    Row(
        "a margin is good again",
        |world, [a, _]| edit::<MorphCollider>(world, a, |collider| collider.margin = 0.75),
        |app, [a, b]| touches(app, a, b),
    ),
];

/// A small cube whose tree is already built.
#[derive(Resource)]
struct OtherMesh(Handle<Mesh>);

#[test]
fn every_change_takes_effect_in_the_next_run() {
    let (mut app, cubes) = two_cubes(0.8);
    let mut small = cube();
    small.positions.iter_mut().for_each(|p| *p *= 0.1);
    let small = add_mesh(&mut app, &small);
    spawn(&mut app, &small, 90.0);
    app.insert_resource(OtherMesh(small));
    settle(&mut app);
    for Row(name, change, effect) in ROWS {
        assert!(!effect(&app, cubes), "{name}: the effect is there before");
        change(app.world_mut(), cubes);
        app.update();
        assert!(effect(&app, cubes), "{name}: no effect");
    }
}

#[test]
fn an_anchor_follows_its_component_in_the_same_frame() {
    let (mut app, [a, b]) = two_cubes(3.0);
    let hat = app.spawn(MorphSurfaceAnchor::new(a, 0, Vec3::X));
    let place = |app: &mut App| {
        app.update();
        app.world().get::<Transform>(hat).unwrap().translation
    };
    let first = place(&mut app);
    edit::<MorphSurfaceAnchor>(app.world_mut(), hat, |anchor| anchor.offset = 0.25);
    assert!((place(&mut app).distance(first) - 0.25).abs() < 1e-6);
    insert(app.world_mut(), hat, MorphSurfaceAnchor::new(b, 0, Vec3::X));
    assert_eq!(place(&mut app), first + Vec3::X * 3.0);
}

#[test]
fn events_are_heard_as_soon_as_they_are_enabled() {
    #[derive(Resource, Default)]
    struct Heard(u32);
    let (mut app, [a, b]) = two_cubes(0.8);
    app.init_resource::<Heard>();
    app.world_mut()
        .entity_mut(a)
        .observe(|_: On<MorphCollisionEnd>, mut heard: ResMut<Heard>| heard.0 += 1)
        .observe(|_: On<MorphCollisionStart>, mut heard: ResMut<Heard>| heard.0 += 1);
    let toggle = |app: &mut App| {
        let is_disabled = app.world().get::<MorphColliderDisabled>(b).is_some();
        let mut b = app.world_mut().entity_mut(b);
        if is_disabled {
            b.remove::<MorphColliderDisabled>();
        } else {
            b.insert(MorphColliderDisabled);
        }
        app.update();
        app.world().resource::<Heard>().0
    };
    assert_eq!(toggle(&mut app), 0);
    app.insert(a, MorphCollisionEventsEnabled);
    assert_eq!(toggle(&mut app), 1);
    assert_eq!(toggle(&mut app), 2);
    app.remove::<MorphCollisionEventsEnabled>(a);
    assert_eq!(toggle(&mut app), 2);
}

fn leaf_size(app: &App, cube: Entity) -> Option<usize> {
    let mesh = app.world().get::<Mesh3d>(cube).unwrap();
    let settings = app.world().get::<MorphTreeOptions>(cube);
    let tree = app.world().resource::<MorphTrees>().shown_with(mesh, settings, None);
    tree.map(|tree| tree.options().leaf_size())
}

/// Updates until a cube has a tree with this leaf size. The cubes touch in every frame until then.
fn touching_until(app: &mut App, [a, b]: [Entity; 2], size: usize) {
    let mut frames = 0;
    while leaf_size(app, a) != Some(size) {
        app.update();
        assert!(touches(app, a, b), "frame {frames}");
        frames += 1;
        assert!(frames < 100_000, "leaves are still of {:?}", leaf_size(app, a));
    }
}

#[test]
fn colliders_collide_on_while_a_tree_with_other_settings_is_built() {
    let (mut app, [a, b]) = two_cubes(0.8);
    for size in [1, 2, 3] {
        insert(app.world_mut(), a, MorphTreeOptions { leaf_size: size });
        touching_until(&mut app, [a, b], size.into());
    }
    edit::<MorphTreeOptions>(app.world_mut(), a, |settings| settings.leaf_size = 4);
    touching_until(&mut app, [a, b], 4);
    app.remove::<MorphTreeOptions>(a);
    touching_until(&mut app, [a, b], BuildOptions::default().leaf_size());
    // The default for all meshes, which the other cube follows too.
    let set_default = |app: &mut App, leaf_size: u8| {
        let mut settings = app.settings();
        settings.tree_options = MorphTreeOptions { leaf_size };
    };
    for size in [5, 6] {
        set_default(&mut app, size);
        touching_until(&mut app, [a, b], size.into());
        assert_eq!(leaf_size(&app, b), Some(size.into()));
    }
    // A bad one is reported once, and the last good one stays.
    crate::log::Errors::collect(|errors| {
        set_default(&mut app, 0);
        settle(&mut app);
        assert!(touches(&app, a, b));
        assert_eq!(leaf_size(&app, b), Some(6));
        assert_eq!(errors.take().len(), 1);
    });
    // A collider's own settings take precedence.
    insert(app.world_mut(), a, MorphTreeOptions { leaf_size: 9 });
    touching_until(&mut app, [a, b], 9);
    set_default(&mut app, 7);
    touching_until(&mut app, [b, a], 7);
    assert_eq!(leaf_size(&app, a), Some(9));
    // A mesh that cannot be built with these settings is left out.
    crate::log::Errors::collect(|errors| {
        insert(app.world_mut(), a, MorphTreeOptions { leaf_size: 0 });
        settle(&mut app);
        assert!(!touches(&app, a, b));
        assert_eq!(errors.take().len(), 1);
    });
    app.remove::<MorphTreeOptions>(a);
    app.update();
    assert!(touches(&app, a, b));
}

/// Sets the collider for all deforming meshes and runs a frame; returns which of these meshes have
/// one.
fn every<const N: usize>(app: &mut App, collider: Option<MorphCollider>, meshes: [Entity; N]) -> [bool; N] {
    let mut settings = app.settings();
    settings.every_deforming_mesh = collider;
    app.update();
    meshes.map(|mesh| app.world().get::<MorphCollider>(mesh).is_some())
}

#[test]
fn what_the_user_removed_never_comes_back_however_often_the_setting_does() {
    let mut app = app();
    let mesh = add_mesh(&mut app, &stretching_cube());
    let weights = MeshMorphWeights::Value { weights: vec![0.0] };
    let own = spawn(&mut app, &mesh, 0.0);
    let meshes = [own, app.spawn(Mesh3d(mesh.clone())), app.spawn(Mesh3d(mesh))];
    for mesh in meshes {
        app.insert(mesh, weights.clone());
    }
    let on = Some(MorphCollider::default());
    assert_eq!(every(&mut app, on, meshes), [true; 3]);
    for mesh in &meshes[..2] {
        app.remove::<MorphCollider>(*mesh);
    }
    for round in 0..4 {
        assert_eq!(every(&mut app, None, meshes), [false; 3], "round {round}");
        assert_eq!(every(&mut app, on, meshes), [false, false, true], "round {round}");
    }
    // A collider that the user inserts again is the user's own.
    app.insert(own, MorphCollider::default());
    assert_eq!(every(&mut app, None, meshes), [true, false, false]);
}
