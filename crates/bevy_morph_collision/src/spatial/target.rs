//! A collider, as a query sees it.

use bevy::prelude::*;
use morph_collision::{Body, PlacedShape};

use crate::state::{ColliderState, Form, Runs};

/// What a query asks about: a mesh or a shape.
pub(super) enum Target<'a> {
    Mesh(Body<'a>),
    Shape(&'a PlacedShape),
}

/// A collider's state after the last run; `None` if it took no part.
pub(super) fn state_of<'a>(
    colliders: &'a Query<'_, '_, &'static ColliderState>,
    runs: &Runs,
    collider: Entity,
) -> Option<&'a ColliderState> {
    let state = colliders.get(collider).ok()?;
    state.freshness.is_seen(runs).then_some(state)
}

/// Calls `ask` with a collider in its current state.
pub(super) fn with_target<T>(state: &ColliderState, ask: impl FnOnce(Target<'_>) -> T) -> Option<T> {
    Some(match &state.placed.as_ref()?.form {
        Form::Mesh(world_from_model) => {
            let mut pose = state.pose.as_ref()?.lock();
            ask(Target::Mesh(Body::new(&mut pose, world_from_model)))
        }
        Form::Shape(shape) => ask(Target::Shape(shape)),
    })
}
