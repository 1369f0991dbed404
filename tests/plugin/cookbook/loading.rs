//! The loading screen: a bar that only grows, and a game that starts once, when everything collides.

use bevy::prelude::*;
use bevy::world_serialization::WorldInstanceReady;
use bevy_morph_collision::import::MorphTreeProgress;
use bevy_morph_collision::prelude::*;

use super::programs::loading_screen::{Bar, Model, Playing, game};
use super::{play_until, program};
use crate::support::{Edits, add_mesh, cube};

/// The state at every start of the game.
#[derive(Resource, Default)]
struct Starts(Vec<(MorphTreeProgress, usize)>);

fn watched() -> App {
    let mut app = program(MorphPlugins, game);
    app.init_resource::<Starts>();
    app.world_mut().add_observer(
        |_: On<Insert<Playing>>,
         trees: Res<MorphTrees>,
         models: Query<&MorphColliders, With<Model>>,
         mut starts: ResMut<Starts>| {
            starts.0.push((trees.progress(), models.iter().count()));
        },
    );
    app
}

#[test]
fn the_game_starts_once_and_after_all_trees() {
    let mut app = watched();
    let mut bars = app.world_mut().query_filtered::<&Transform, With<Bar>>();
    let mut lengths: Vec<f32> = Vec::new();
    play_until(&mut app, |world| {
        let bar = bars.iter(world).next();
        lengths.extend(bar.map(|bar| bar.scale.x));
        assert_eq!(
            bar.is_none(),
            world.contains_resource::<Playing>() || lengths.is_empty()
        );
        world.contains_resource::<Playing>()
    });
    assert_eq!(lengths[0], 0.0);
    assert!(lengths.is_sorted(), "{lengths:?}");
    let mut steps = lengths.clone();
    steps.dedup();
    assert!(
        steps.len() >= 4 && steps.iter().all(|&length| length <= 1.0),
        "{steps:?}"
    );
    let turned = |app: &mut App| {
        let mut models = app.world_mut().query_filtered::<&Transform, With<Model>>();
        models.iter(app.world()).map(|place| place.rotation).collect::<Vec<_>>()
    };
    let before = turned(&mut app);
    for _ in 0..10 {
        app.update();
    }
    let after = turned(&mut app);
    assert!(
        before.iter().zip(&after).all(|(a, b)| a.angle_between(*b) > 0.1),
        "all turn"
    );
    // A model that becomes ready again does not start another game.
    let mut parts = app.world_mut().query_filtered::<Entity, With<MorphCollider>>();
    let part = parts.iter(app.world()).next().expect("there are parts");
    let other = add_mesh(&mut app, &cube());
    app.insert(part, Mesh3d(other));
    for _ in 0..30 {
        app.update();
    }
    let starts = &app.world().resource::<Starts>().0;
    assert_eq!(starts.len(), 1, "{starts:?}");
    let (trees, models) = starts[0];
    assert_eq!(models, 3);
    assert_eq!((trees.requested, trees.built, trees.failed), (3, 3, 0));
}

#[test]
fn a_file_that_is_missing_does_not_hold_the_game_up() {
    let mut app = watched();
    app.update();
    let mut models = app.world_mut().query_filtered::<Entity, With<Model>>();
    let model = models.iter(app.world()).next().expect("there are models");
    app.world_mut().entity_mut(model).despawn();
    let missing = app.world().resource::<AssetServer>().load("missing.glb#Scene0");
    let scene = (WorldAssetRoot(missing), MorphColliderScene::default());
    app.spawn((Model, scene, Visibility::Hidden));
    play_until(&mut app, |world| world.contains_resource::<Playing>());
    let starts = &app.world().resource::<Starts>().0;
    assert_eq!(starts.len(), 1);
    assert_eq!((starts[0].0.built, starts[0].1), (2, 2), "the others are there");
}

#[test]
fn a_mesh_that_cannot_be_used_does_not_hold_the_game_up() {
    let mut app = watched();
    let mesh = morph_collision_workspace::physics::bevy_mesh(&cube()).with_removed_attribute(Mesh::ATTRIBUTE_POSITION);
    let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh);
    // As if each file contained a mesh of this kind.
    app.world_mut()
        .add_observer(move |file: On<WorldInstanceReady>, mut commands: Commands| {
            commands.spawn((Mesh3d(mesh.clone()), MorphCollider::default(), ChildOf(file.entity)));
        });
    play_until(&mut app, |world| world.contains_resource::<Playing>());
    let starts = &app.world().resource::<Starts>().0;
    assert_eq!(starts.len(), 1);
    assert_eq!((starts[0].0.built, starts[0].0.failed), (3, 1));
}
