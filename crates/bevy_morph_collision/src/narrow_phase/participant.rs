//! The colliders that take part in a run.

use std::sync::MutexGuard;

use bevy::prelude::*;
use morph_collision::{Body, Pose, PoseSnapshot, WorldFromModel};

use crate::state::{ColliderState, Form, LockedPose, Placement};

/// A collider that takes part.
pub(super) struct PlacedCollider<'a> {
    pub(super) entity: Entity,
    pub(super) changed: bool,
    pub(super) placement: &'a Placement,
    pub(super) pose: Option<&'a mut LockedPose>,
    /// The shape in which collisions saw a mesh in the last run, if it has changed since.
    pub(super) before: &'a PoseSnapshot,
}

/// A mesh that a query uses.
pub(super) struct UsedMesh<'p> {
    pub(super) pose: MutexGuard<'p, Pose>,
    pub(super) world_from_model: &'p WorldFromModel,
}

impl<'a> PlacedCollider<'a> {
    pub(super) fn new(entity: Entity, state: &'a mut ColliderState) -> Option<Self> {
        let changed = state.freshness.answers_are_old();
        let (placement, pose, before) = match &mut state.held {
            Some(held) => (&held.placed, &mut held.pose, &held.before),
            None => (state.placed.as_ref()?, &mut state.pose, &state.previous.shape),
        };
        Some(Self {
            entity,
            changed,
            placement,
            pose: pose.as_mut(),
            before,
        })
    }

    /// The mesh, for queries; `None` for a shape. Waits while another thread uses it. To use two meshes, take them in the order of their
    /// entities.
    pub(super) fn mesh(&self) -> Option<UsedMesh<'_>> {
        match (&self.placement.form, &self.pose) {
            (Form::Mesh(world_from_model), Some(pose)) => Some(UsedMesh {
                pose: pose.lock(),
                world_from_model,
            }),
            _ => None,
        }
    }
}

impl UsedMesh<'_> {
    pub(super) fn body(&mut self) -> Body<'_> {
        Body::new(&mut self.pose, self.world_from_model)
    }
}
