//! Components of physics engines without the engine. With it, see the tests `rapier` and `avian`.

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use super::{says, warning_about};
use crate::support::{add_mesh, cube};

#[test]
fn components_of_a_physics_engine_that_is_missing_are_told_once() {
    let warning = warning_about(|app| {
        let mesh = add_mesh(app, &cube());
        for _ in 0..5 {
            app.world_mut()
                .spawn((Mesh3d(mesh.clone()), MorphRapierCollider::default()));
        }
    });
    says(
        &warning,
        &["`MorphRapierCollider`", "the app lacks `RapierPhysicsPlugin`"],
    );
    let warning = warning_about(|app| {
        let mesh = add_mesh(app, &cube());
        app.world_mut().spawn((Mesh3d(mesh), MorphAvianCollider::default()));
    });
    says(&warning, &["`MorphAvianCollider`", "the app lacks `PhysicsPlugins`"]);
}
