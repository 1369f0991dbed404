//! Anchors that follow nothing.

use bevy::prelude::*;
use bevy_morph_collision::prelude::*;

use super::{is_fine, says, warning_about};
use crate::support::{Edits, add_mesh, cube, settle, spawn};

/// The warning about a hat on an entity.
fn warning(target: impl FnOnce(&mut App) -> MorphSurfaceAnchor) -> String {
    let warning = warning_about(|app| {
        let anchor = target(app);
        app.spawn((anchor, Name::new("Hat")));
    });
    says(&warning, &["`MorphSurfaceAnchor` of entity `Hat` follows nothing"]);
    warning
}

fn on(collider: Entity) -> MorphSurfaceAnchor {
    MorphSurfaceAnchor::new(collider, 0, Vec3::splat(1.0 / 3.0))
}

#[test]
fn an_anchor_on_what_is_no_surface_is_told() {
    says(
        &warning(|_| MorphSurfaceAnchor::default()),
        &["does not exist", "`MorphRayHit::entity`"],
    );
    let no_collider = warning(|app| on(app.spawn(Name::new("Head"))));
    says(
        &no_collider,
        &["`Head`", "is no collider", "`MorphCollider` and `Mesh3d`"],
    );
    let body = warning(|app| {
        let mesh = add_mesh(app, &cube());
        let head = app.spawn(Name::new("Head"));
        let part = spawn(app, &mesh, 0.0);
        app.insert(part, MorphColliderOf { body: head });
        on(head)
    });
    says(&body, &["`Head`", "is a body", "Set it to one of them"]);
    let shape = warning(|app| on(app.spawn((MorphShape::default(), Name::new("Head")))));
    says(&shape, &["`Head`", "`MorphShape`"]);
}

#[test]
fn an_anchor_on_a_triangle_that_does_not_exist_is_told() {
    let anchor = |change: fn(&mut MorphSurfaceAnchor)| {
        warning(|app| {
            let mesh = add_mesh(app, &cube());
            let head = spawn(app, &mesh, 0.0);
            app.insert(head, Name::new("Head"));
            settle(app);
            let mut anchor = on(head);
            change(&mut anchor);
            anchor
        })
    };
    says(
        &anchor(|anchor| anchor.triangle = 12),
        &["`Head` has 12 triangles", "no number 12"],
    );
    says(&anchor(|anchor| anchor.offset = f32::NAN), &["not finite"]);
}

#[test]
fn an_anchor_that_follows_something_is_not_told() {
    is_fine(|app| {
        let mesh = add_mesh(app, &cube());
        let head = spawn(app, &mesh, 0.0);
        app.spawn(on(head));
    });
}
