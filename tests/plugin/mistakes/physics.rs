//! Components for physics without a physics engine. With one, see the tests of the crates for engines.

use bevy::mesh::morph::MeshMorphWeights;
use bevy::prelude::*;
use bevy_morph_physics::prelude::*;

use super::{says, warning_about};
use crate::support::{Edits, add_mesh, cube};

#[test]
fn components_for_physics_without_an_engine_are_told_once() {
    let warning = warning_about(|app| {
        let mesh = add_mesh(app, &cube());
        for _ in 0..5 {
            app.spawn((Mesh3d(mesh.clone()), MorphPhysicsCollider::default()));
        }
    });
    says(
        &warning,
        &["`MorphPhysicsCollider`", "MorphRapierPlugin", "MorphAvianPlugin"],
    );
    let warning = warning_about(|app| {
        let mesh = add_mesh(app, &cube());
        let scene = app.spawn((Name::new("Scene"), MorphPhysicsScene::default()));
        app.spawn((
            Mesh3d(mesh),
            MeshMorphWeights::Value { weights: Vec::new() },
            ChildOf(scene),
        ));
    });
    says(&warning, &["`MorphPhysicsScene`", "`Scene`", "MorphRapierPlugin"]);
}
