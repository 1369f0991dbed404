//! Likely mistakes are logged once.

use bevy::prelude::*;
use bevy::world_serialization::WorldAsset;
use bevy_morph_collision::prelude::*;
use bevy_morph_physics::prelude::*;
use morph_collision_workspace::physics::{settle, sheet};

use crate::log::Errors;
use crate::support::{app, run, spawn};

#[test]
fn a_collider_on_a_scene_names_the_component_for_scenes() {
    Errors::collect(|errors| {
        let mut app = app();
        let mut warning = |more: fn(&mut EntityWorldMut)| {
            let file = "assets/dolphin_564.glb#Scene0";
            let scene: Handle<WorldAsset> = app.world().resource::<AssetServer>().load(file);
            more(&mut app.world_mut().spawn((WorldAssetRoot(scene), Name::new("Dolphin"))));
            run(&mut app, 2);
            let warnings = errors.take_warnings();
            assert!(warnings.len() <= 1, "{warnings:?}");
            warnings.into_iter().next().unwrap_or_default()
        };
        let told = warning(|root| {
            root.insert(MorphPhysicsCollider::default());
        });
        for part in [
            "`MorphPhysicsCollider` has no effect",
            "`Dolphin`",
            "dolphin_564.glb#Scene0",
            "Use `MorphPhysicsScene` instead",
        ] {
            assert!(told.contains(part), "`{told}` does not say `{part}`");
        }
        // The file with this mistake has been told.
        let again = warning(|root| {
            root.insert((MorphPhysicsCollider::default(), MorphPhysicsScene::default()));
        });
        assert_eq!(again, "");
    });
    Errors::collect(|errors| {
        let mut app = app();
        let root = (
            Name::new("Root"),
            MorphPhysicsCollider::default(),
            MorphPhysicsScene::default(),
        );
        app.world_mut().spawn(root);
        run(&mut app, 2);
        let warnings = errors.take_warnings();
        assert_eq!(warnings.len(), 1, "{warnings:?}");
        assert!(
            warnings[0].contains("Remove it, and set `MorphPhysicsScene::collider`"),
            "{warnings:?}"
        );
    });
}

#[test]
fn a_collider_with_a_shape_is_told_and_one_with_a_mesh_is_not() {
    Errors::collect(|errors| {
        let mut app = app();
        spawn(&mut app, &sheet(4), ());
        run(&mut app, 400);
        assert_eq!((errors.take(), errors.take_warnings()), (vec![], vec![]));
        spawn(&mut app, &sheet(4), (MorphShape::default(), Name::new("Ball")));
        run(&mut app, 400);
        let warnings = errors.take_warnings();
        assert_eq!(warnings.len(), 1, "{warnings:?}");
        assert!(
            warnings[0].contains("`MorphPhysicsCollider`") && warnings[0].contains("`Ball`"),
            "{warnings:?}"
        );
    });
}

#[test]
fn a_bad_acceleration_is_told_once_and_the_last_good_one_stays() {
    Errors::collect(|errors| {
        let mut app = app();
        let surface = spawn(&mut app, &sheet(4), Name::new("Jelly"));
        settle(&mut app);
        let mut set = |acceleration: f32| {
            let mut settings = app.world_mut().get_mut::<MorphPhysicsCollider>(surface).unwrap();
            settings.max_acceleration = acceleration;
            run(&mut app, 3);
            errors.take()
        };
        for bad in [-1.0, f32::NAN, f32::NEG_INFINITY] {
            assert_eq!(set(5.0), Vec::<String>::new());
            let told = set(bad);
            assert_eq!(told.len(), 1, "{told:?}");
            assert!(told[0].contains("`Jelly` keeps the `max_acceleration` 5"), "{told:?}");
        }
        assert_eq!(set(f32::INFINITY), Vec::<String>::new());
    });
}
