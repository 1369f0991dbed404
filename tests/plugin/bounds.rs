//! The `Aabb` that Bevy uses for culling.

use bevy::camera::primitives::Aabb;
use bevy::camera::visibility::{NoAutoAabb, NoCpuCulling, NoFrustumCulling, VisibilityPlugin};
use bevy::ecs::entity_disabling::Disabled;
use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::prelude::*;
use bevy_morph_collision::import::MorphTrees;
use bevy_morph_collision::prelude::*;
use morph_collision_workspace::app::headless;

use crate::log::{Errors, start};
use crate::support::{Edits, add_mesh, assets, bevy_mesh, plain_app, set_weight, settle, stretching_cube};

fn app() -> App {
    let mut app = headless(&assets());
    app.add_plugins((VisibilityPlugin, MorphBoundsPlugin));
    start(&mut app);
    app
}

fn spawn(app: &mut App, bundle: impl Bundle) -> Entity {
    let mesh = add_mesh(app, &stretching_cube());
    let weights = MeshMorphWeights::Value { weights: vec![0.0] };
    app.spawn((Mesh3d(mesh), weights, bundle))
}

fn reach(app: &App, entity: Entity) -> f32 {
    app.world().get::<Aabb>(entity).unwrap().max().x
}

#[test]
fn the_box_follows_the_morph_without_any_collider() {
    let mut app = app();
    let cube = spawn(&mut app, ());
    settle(&mut app);
    assert!(app.world().get::<MorphCollider>(cube).is_none());
    for weight in [0.0, 1.0, 3.0, -0.5, 0.25] {
        set_weight(&mut app, cube, weight);
        app.update();
        let reach = reach(&app, cube);
        let expected = 0.5 + weight;
        // For negative weights a box is conservative.
        let slack = if weight < 0.0 { -weight } else { 0.0 };
        assert!(
            (expected..expected + slack + 1e-4).contains(&reach),
            "{reach} at {weight}"
        );
    }
}

/// An app in which nothing collides.
fn bounds_alone() -> App {
    let mut app = plain_app();
    app.add_plugins((VisibilityPlugin, MorphBoundsPlugin));
    start(&mut app);
    app
}

#[test]
fn bounds_work_alone() {
    let mut app = bounds_alone();
    let cube = spawn(&mut app, ());
    settle(&mut app);
    set_weight(&mut app, cube, 2.0);
    app.update();
    assert!((reach(&app, cube) - 2.5).abs() < 1e-4);
}

#[test]
fn who_opted_out_keeps_the_box_it_has() {
    let mut app = app();
    let own = Aabb::from_min_max(Vec3::splat(-9.0), Vec3::splat(9.0));
    let cubes = [
        spawn(&mut app, (NoAutoAabb, own)),
        spawn(&mut app, (NoFrustumCulling, own)),
    ];
    settle(&mut app);
    for cube in cubes {
        set_weight(&mut app, cube, 2.0);
        app.update();
        assert_eq!(app.world().get::<Aabb>(cube), Some(&own));
    }
}

#[test]
fn boxes_that_stay_are_not_written_and_bad_weights_change_nothing() {
    let mut app = app();
    let cube = spawn(&mut app, ());
    settle(&mut app);
    set_weight(&mut app, cube, 1.0);
    app.update();
    app.update();
    let changed = |app: &App| app.world().entity(cube).get_ref::<Aabb>().unwrap().last_changed();
    let before = changed(&app);
    for _ in 0..4 {
        app.update();
    }
    assert_eq!(changed(&app), before);
    set_weight(&mut app, cube, f32::NAN);
    app.update();
    assert!((reach(&app, cube) - 1.5).abs() < 1e-4);
}

#[test]
fn whatever_changes_after_a_rest_is_noticed() {
    let mut app = app();
    let cube = spawn(&mut app, ());
    let mut other = stretching_cube();
    for position in &mut other.positions {
        *position *= 3.0;
    }
    let (other, source) = (
        add_mesh(&mut app, &other),
        app.spawn(MorphWeights::new(vec![2.0], None).unwrap()),
    );
    settle(&mut app);
    let mut check = |expected: f32, change: &dyn Fn(&mut App)| {
        change(&mut app);
        settle(&mut app);
        assert!(
            (reach(&app, cube) - expected).abs() < 1e-4,
            "{} {expected}",
            reach(&app, cube)
        );
        for _ in 0..3 {
            app.update();
        }
    };
    check(0.5, &|_| {});
    check(1.5, &|app| set_weight(app, cube, 1.0));
    // Somebody else writes the box.
    check(1.5, &|app| {
        *app.world_mut().get_mut::<Aabb>(cube).unwrap() = Aabb::default();
    });
    check(2.5, &|app| app.insert(cube, MeshMorphWeights::Reference(source)));
    check(3.5, &|app| {
        app.world_mut().get_mut::<MorphWeights>(source).unwrap().weights_mut()[0] = 3.0;
    });
    check(4.5, &|app| app.insert(cube, Mesh3d(other.clone())));
    check(2.5, &|app| set_weight(app, cube, 1.0));
}

#[test]
fn two_entities_with_one_mesh_have_boxes_of_their_own() {
    let mut app = app();
    let mesh = add_mesh(&mut app, &stretching_cube());
    let mut spawn = |weight: f32| {
        let weights = MeshMorphWeights::Value { weights: vec![weight] };
        app.spawn((Mesh3d(mesh.clone()), weights))
    };
    let cubes = [spawn(1.0), spawn(2.0), spawn(0.25)];
    settle(&mut app);
    assert_eq!(app.world().resource::<MorphTrees>().iter().count(), 1);
    for (cube, expected) in cubes.into_iter().zip([1.5, 2.5, 0.75]) {
        assert!((reach(&app, cube) - expected).abs() < 1e-4);
    }
}

#[test]
fn what_comes_into_view_is_flagged_for_two_frames_more() {
    let mut app = app();
    let cube = spawn(&mut app, (NoCpuCulling, Visibility::Hidden));
    settle(&mut app);
    app.update();
    let changed = |app: &App| app.world().entity(cube).get_ref::<Aabb>().unwrap().last_changed();
    let hidden = changed(&app);
    app.update();
    assert_eq!(changed(&app), hidden);
    app.insert(cube, Visibility::Visible);
    let mut flagged = Vec::new();
    let mut before = hidden;
    for _ in 0..5 {
        app.update();
        flagged.push(changed(&app) != before);
        before = changed(&app);
    }
    assert_eq!(flagged, [true, true, false, false, false]);
}

#[test]
fn without_weights_the_box_is_that_of_the_mesh_at_rest() {
    let mut app = app();
    let cube = spawn(&mut app, ());
    settle(&mut app);
    set_weight(&mut app, cube, 2.0);
    app.update();
    assert!((reach(&app, cube) - 2.5).abs() < 1e-4);
    app.remove::<MeshMorphWeights>(cube);
    app.update();
    app.update();
    assert!((reach(&app, cube) - 0.5).abs() < 1e-6);
}

#[test]
fn who_comes_back_later_has_a_box_that_follows() {
    fn check<Out: Component>(out: Out) {
        let mut app = app();
        let cube = spawn(&mut app, out);
        settle(&mut app);
        set_weight(&mut app, cube, 2.0);
        settle(&mut app);
        assert_eq!(
            app.world().resource::<MorphTrees>().iter().count(),
            0,
            "nobody needs it yet"
        );
        app.remove::<Out>(cube);
        settle(&mut app);
        assert!(
            (reach(&app, cube) - 2.5).abs() < 1e-4,
            "without {}",
            std::any::type_name::<Out>()
        );
        set_weight(&mut app, cube, 1.0);
        app.update();
        assert!((reach(&app, cube) - 1.5).abs() < 1e-4);
    }
    check(Disabled);
    check(NoAutoAabb);
    check(NoFrustumCulling);
}

#[test]
fn a_mesh_that_cannot_be_bounded_is_logged_as_such() {
    // With and without the collision plugin. The last one is also a collider.
    for (mut app, collides) in [(bounds_alone(), false), (app(), false), (app(), true)] {
        Errors::collect(|errors| {
            let cube = spawn(&mut app, Name::new("jelly"));
            let mut broken = bevy_mesh(&stretching_cube());
            let vertices = broken.count_vertices();
            broken.insert_attribute(Mesh::ATTRIBUTE_POSITION, vec![Vec3::NAN; vertices]);
            let broken = app.world_mut().resource_mut::<Assets<Mesh>>().add(broken);
            app.insert(cube, Mesh3d(broken));
            if collides {
                app.insert(cube, MorphCollider::default());
            }
            settle(&mut app);
            settle(&mut app);
            let logged = errors.take();
            assert_eq!(logged.len(), 1, "{logged:?}");
            assert!(logged[0].contains("jelly"), "{logged:?}");
            let about_colliders = logged[0].contains("collide");
            let about_bounds = logged[0].contains("cannot be culled by its morphed bounds");
            assert_eq!((about_colliders, about_bounds), (collides, !collides), "{logged:?}");
        });
    }
}
