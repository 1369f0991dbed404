//! Places one collider in the world.

use bevy::ecs::query::QueryData;
use bevy::prelude::*;
use morph_collision::{InputError, WorldFromModel};
use tracing::error;

use crate::app::Names;
use crate::components::{
    LENGTHS, MorphCollider, MorphColliderDisabled, MorphColliderOf, MorphCollisionLayers, MorphShape, body_of,
};
use crate::state::{ColliderState, Form, LockedPose, MorphCollisionDiagnostics, Placement, Runs};

/// The components that decide whether and where a collider takes part.
#[derive(QueryData)]
#[query_data(mutable)]
pub(crate) struct Participant {
    pub(super) entity: Entity,
    collider: &'static MorphCollider,
    layers: Option<&'static MorphCollisionLayers>,
    pub(super) state: &'static mut ColliderState,
    transform: Ref<'static, GlobalTransform>,
    body: Option<&'static MorphColliderOf>,
    shape: Option<Ref<'static, MorphShape>>,
    is_disabled: Has<MorphColliderDisabled>,
}

/// Whether anything about a collider changed.
#[derive(Default)]
pub(super) struct Visit {
    /// Something that affects answers.
    pub(super) changed: bool,
    /// Its placement, or whether it was read.
    pub(super) moved: bool,
}

impl ParticipantItem<'_, '_> {
    /// Places a collider, unless it rests.
    pub(super) fn visit(&mut self, runs: &Runs, names: &Names, diagnostics: &mut MorphCollisionDiagnostics) -> Visit {
        let was_absent = self.state.freshness.see(runs);
        if !was_absent && self.rests() {
            return Visit::default();
        }
        let reposed = self.state.freshness.bounds_are_old() && self.state.pose.is_some();
        diagnostics.stats.nodes_blended += u64::from(reposed);
        let placement = self.place(was_absent);
        let state = &mut *self.state;
        let bad_placement = placement.is_err();
        let placed = placement.unwrap_or_else(|error| {
            if !state.bad_placement {
                let name = names.with_file(self.entity);
                error!("entity {name} is left out of collisions: {error}");
            }
            None
        });
        state.bad_placement = bad_placement;
        if was_absent {
            // It has no state of the last run.
            state.previous.world_from_model = None;
        }
        let moved = was_absent || placed != state.placed;
        if moved {
            state.freshness.placement_changed();
        }
        let takes_part = placed.is_some();
        let took_part = std::mem::replace(&mut state.placed, placed).is_some();
        state.hold(was_absent, self.collider.tolerance);
        Visit {
            changed: state.freshness.answers_are_old() && (takes_part || took_part),
            moved,
        }
    }

    /// Whether nothing about a collider has changed since the last run: its place, its settings, and anything else it depends on.
    fn rests(&self) -> bool {
        let Some(placed) = &self.state.placed else { return false };
        let is_same_form = match (&placed.form, &self.shape) {
            (Form::Mesh(_), None) => self.state.pose.is_some(),
            (Form::Shape(_), Some(shape)) => !shape.is_changed(),
            _ => false,
        };
        let state = &self.state;
        let is_still = !state.freshness.bounds_are_old()
            && !state.freshness.answers_are_old()
            && state.held.is_none()
            && !self.transform.is_changed();
        is_same_form
            && is_still
            && !self.is_disabled
            && self.collider.tolerance == 0.0
            && self.collider.margin == placed.margin
            && self.collider.continuous == placed.continuous
            && self.collider.mode == placed.mode
            && self.layers.copied().unwrap_or_default() == placed.layers
            && body_of(self.entity, self.body) == placed.body
    }

    /// The collider's current placement; `None` if it takes no part.
    fn place(&mut self, was_absent: bool) -> Result<Option<Placement>, BadPlacement> {
        if self.is_disabled {
            return Ok(None);
        }
        let state = &mut *self.state;
        let settled = !was_absent && !state.freshness.bounds_are_old() && !self.transform.is_changed();
        let settled = settled && !self.shape.as_ref().is_some_and(Ref::is_changed);
        let before = state.placed.as_ref().filter(|_| settled);
        let kept = match before.map(|placed| &placed.form) {
            Some(Form::Mesh(_)) => state.pose.is_some() && self.shape.is_none(),
            Some(Form::Shape(_)) => self.shape.is_some(),
            None => false,
        };
        // A shape takes precedence over a mesh.
        let (form, bounds) = match (before, &self.shape, state.pose.as_mut().map(LockedPose::get_mut)) {
            (Some(Placement { form, bounds, .. }), ..) if kept => (form.clone(), *bounds),
            (_, Some(shape), _) => {
                let (shape, bounds) = shape.place(&self.transform).map_err(BadPlacement::Shape)?;
                (Form::Shape(shape), bounds)
            }
            (_, None, Some(pose)) if pose.joints().is_some() => {
                if !state.has_joints {
                    return Ok(None);
                }
                // Its joints place it.
                let world_from_model = WorldFromModel::IDENTITY;
                (Form::Mesh(world_from_model), pose.broad_phase_bounds(&world_from_model))
            }
            (_, None, Some(pose)) => {
                let world_from_model = WorldFromModel::new(self.transform.affine()).map_err(BadPlacement::Transform)?;
                (Form::Mesh(world_from_model), pose.world_bounds(&world_from_model))
            }
            (_, None, None) => return Ok(None),
        };
        let margin = self.collider.margin;
        if !LENGTHS.contains(&margin) {
            return Err(BadPlacement::Margin(margin));
        }
        let tolerance = self.collider.tolerance;
        if !LENGTHS.contains(&tolerance) {
            return Err(BadPlacement::Tolerance(tolerance));
        }
        // A pose keeps its root box as long as its weights and joints stay the same.
        state.freshness.bounds_computed();
        Ok(Some(Placement {
            form,
            body: body_of(self.entity, self.body),
            mode: self.collider.mode,
            // If the user removes the layers, the defaults apply.
            layers: self.layers.copied().unwrap_or_default(),
            margin,
            continuous: self.collider.continuous,
            bounds,
        }))
    }
}

/// Why a collider has no placement.
#[derive(Debug, thiserror::Error)]
enum BadPlacement {
    #[error(transparent)]
    Transform(InputError),
    #[error("its shape: {0}")]
    Shape(InputError),
    #[error("its margin is {0}, it must be a number from 0 to 1e30")]
    Margin(f32),
    #[error("its tolerance is {0}, it must be a number from 0 to 1e30")]
    Tolerance(f32),
}
