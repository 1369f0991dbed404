//! How the plugin behaves among others: schedules, order, reflection.

use bevy::camera::visibility::VisibilityPlugin;
use bevy::ecs::reflect::{AppTypeRegistry, ReflectComponent};
use bevy::ecs::schedule::Schedules;
use bevy::prelude::*;
use bevy::reflect::serde::{ReflectDeserializer, ReflectSerializer};
use bevy_morph_collision::MorphCollisionDiagnosticsPlugin;
use bevy_morph_collision::prelude::*;
use serde::de::DeserializeSeed;

use morph_collision_workspace::app::ready;

use crate::support::{app, cube, move_to, settle, spawn, touches};

/// How many pairs of systems conflict without being ordered, in all schedules together.
fn ambiguities(app: &mut App) -> usize {
    ready(app);
    app.update();
    let schedules = app.world().resource::<Schedules>();
    let conflicts = schedules
        .iter()
        .map(|(_, schedule)| schedule.graph().conflicting_systems().len());
    conflicts.sum()
}

#[test]
fn the_plugins_add_no_ambiguous_order_of_systems() {
    let bevy = || {
        let mut app = App::new();
        app.add_plugins((
            MinimalPlugins,
            TransformPlugin,
            AssetPlugin::default(),
            bevy::mesh::MeshPlugin,
        ));
        app.add_plugins(VisibilityPlugin);
        app
    };
    let before = ambiguities(&mut bevy());
    let mut ours = bevy();
    ours.add_plugins((MorphCollisionPlugin, MorphBoundsPlugin, MorphCollisionDiagnosticsPlugin));
    assert_eq!(ambiguities(&mut ours), before);
    let mut fixed = bevy();
    fixed.add_plugins((MorphCollisionPlugin.in_schedule(FixedPostUpdate), MorphBoundsPlugin));
    assert_eq!(ambiguities(&mut fixed), before);

    // It would be noticed.
    let mut careless = bevy();
    careless
        .add_plugins(MorphCollisionPlugin)
        .add_systems(PostUpdate, |mut collisions: ResMut<MorphCollisions>| {
            collisions.set_changed();
        });
    assert!(ambiguities(&mut careless) > before);
}

#[test]
fn the_plugin_runs_in_the_fixed_schedule_too() {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        TransformPlugin,
        AssetPlugin::default(),
        bevy::mesh::MeshPlugin,
    ));
    app.add_plugins(MorphCollisionPlugin.in_schedule(FixedPostUpdate));
    // Two frames to a step.
    let step = Time::<Fixed>::default().timestep();
    app.insert_resource(bevy::time::TimeUpdateStrategy::ManualDuration(step / 2));
    ready(&mut app);
    let mesh = crate::support::add_mesh(&mut app, &cube());
    let [a, b] = [0.0, 3.0].map(|x| spawn(&mut app, &mesh, x));
    settle(&mut app);
    for _ in 0..4 {
        app.update();
    }
    assert!(!touches(&app, a, b));
    // What moves in the fixed schedule is found where it is in the same step.
    #[derive(Resource, Default)]
    struct Late(Vec<bool>);
    app.init_resource::<Late>();
    app.add_systems(FixedUpdate, move |mut moved: Query<&mut Transform>| {
        moved.get_mut(b).unwrap().translation.x = 0.8;
    });
    app.add_systems(FixedLast, move |now: Res<MorphCollisions>, mut late: ResMut<Late>| {
        late.0.push(now.contains(a, b));
    });
    for _ in 0..4 {
        app.update();
    }
    let late = &app.world().resource::<Late>().0;
    assert!(late.len() >= 2 && late.iter().all(|touching| *touching), "{late:?}");
}

#[test]
fn settings_survive_a_scene_file() {
    let app = app();
    let registry = app.world().resource::<AppTypeRegistry>().read();
    let scene = MorphColliderScene {
        collider: MorphCollider::new(CollisionMode::Contacts).with_margin(0.25),
        layers: MorphCollisionLayers::new(3, 5),
        only_named: vec!["jaw".into()],
        ..default()
    };
    let values: Vec<Box<dyn PartialReflect>> = vec![
        Box::new(scene),
        Box::new(MorphCollider::new(CollisionMode::First)),
        Box::new(MorphCollisionLayers::new(1, 2)),
        Box::new(MorphTreeSettings {
            leaf_size: 3,
            ..default()
        }),
        Box::new(MorphShape::Capsule {
            half_length: 1.0,
            radius: 0.5,
        }),
        Box::new(MorphColliderDisabled),
    ];
    for value in values {
        let text = serde_json::to_string(&ReflectSerializer::new(&*value, &registry)).unwrap();
        let mut reader = serde_json::Deserializer::from_str(&text);
        let read = ReflectDeserializer::new(&registry).deserialize(&mut reader).unwrap();
        assert_eq!(read.reflect_partial_eq(&*value), Some(true), "{text}");
        let path = value.reflect_type_path();
        let registration = registry.get_with_type_path(path).unwrap();
        assert!(
            registration.data::<ReflectComponent>().is_some(),
            "{path} is a component of scenes"
        );
    }
}

#[test]
fn a_mesh_that_is_swapped_and_one_that_goes_are_followed() {
    let (mut app, [a, b]) = crate::support::two_cubes(0.8);
    assert!(touches(&app, a, b));
    let mut small = cube();
    small.positions.iter_mut().for_each(|p| *p *= 0.1);
    let small = crate::support::add_mesh(&mut app, &small);
    app.world_mut().entity_mut(b).insert(Mesh3d(small));
    settle(&mut app);
    assert!(!touches(&app, a, b), "0.05 large, and 0.3 away");
    move_to(&mut app, b, 0.5);
    app.update();
    assert!(touches(&app, a, b));
    app.world_mut().entity_mut(b).remove::<Mesh3d>();
    app.update();
    assert!(!touches(&app, a, b));
}
