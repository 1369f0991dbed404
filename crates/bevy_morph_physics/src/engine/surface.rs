//! A surface in the physics of one engine, and what it does at the beginning of a step.

use std::sync::Arc;

use bevy::prelude::*;
use morph_collision::{InputError, MorphBvh};
use thiserror::Error;
use tracing::{error, warn};

use super::interface::Engine;
use crate::components::{ACCELERATIONS, MorphPhysicsCollider};
use crate::moving::{MovingSurface, Prediction};
use crate::shape::{MAX_COORDINATE, MassBudget, box_in_range, in_range, not_closed};
use crate::time::{StepTime, WeightSource};

/// A surface in the physics of one engine.
#[derive(Component)]
pub struct PhysicsSurface<E: Engine> {
    /// Where it is and was.
    pub moving: MovingSurface,
    /// What the engine's crate keeps.
    pub state: E::State,
    pub(super) bvh: Arc<MorphBvh>,
    /// Why it is out of physics, which is logged once.
    exclusion: Option<Exclusion>,
    /// The highest plausible acceleration of the last good settings, in length units per second squared.
    max_acceleration: f32,
    /// Whether the log already says that the one of the settings is bad.
    logged_acceleration: bool,
    /// Whether the log already says that it should be closed but is not.
    logged_open: bool,
}

/// Why a surface is out of physics.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum Exclusion {
    /// Its transform is invalid.
    #[error(transparent)]
    Invalid(#[from] InputError),
    /// Engines cannot compute with such numbers.
    #[error("it is larger than {MAX_COORDINATE:e} units or as far from the origin")]
    OutOfRange,
}

/// The sides of a surface in a step.
#[derive(Clone, Copy, Debug)]
pub struct Sides {
    /// Whether they are others than in the last step, or the mass has become known.
    pub turned: bool,
    /// Whether the mesh is closed.
    pub is_closed: bool,
}

impl<E: Engine> PhysicsSurface<E> {
    pub(super) fn new(moving: MovingSurface, state: E::State, bvh: Arc<MorphBvh>) -> Self {
        Self {
            moving,
            state,
            bvh,
            exclusion: None,
            max_acceleration: MorphPhysicsCollider::default().max_acceleration,
            logged_acceleration: false,
            logged_open: false,
        }
    }

    /// Takes the highest plausible acceleration from the settings. If it is bad, this is logged once, and the last good one stays.
    pub fn set_max_acceleration(
        &mut self,
        settings: &MorphPhysicsCollider,
        length_unit: f32,
        name: impl Fn() -> String,
    ) {
        let wanted = settings.max_acceleration;
        let is_bad = !ACCELERATIONS.contains(&wanted);
        if !is_bad {
            self.max_acceleration = wanted;
        }
        if is_bad && !self.logged_acceleration {
            error!(
                "the surface of entity `{}` keeps the `max_acceleration` {}: {wanted} is negative or no number",
                name(),
                self.max_acceleration
            );
        }
        self.logged_acceleration = is_bad;
        self.moving.max_acceleration = self.max_acceleration * length_unit;
    }

    /// Moves the surface, whose entity is at `at`, to its pose at the end of the step. Returns whether it takes part in the step. If not, the
    /// log says why.
    pub fn advance(
        &mut self,
        prediction: Result<Prediction, InputError>,
        at: Vec3,
        weights: &WeightSource,
        time: StepTime,
        name: impl Fn() -> String,
    ) -> bool {
        let exclusion = match prediction {
            Ok(prediction) => {
                if let Err(problem) = self.moving.advance(weights, prediction, time) {
                    error!("the surface of entity `{}` stays as it was: {problem}", name());
                }
                let fits = box_in_range(&self.moving.surface.lock().bounds()) && in_range(at);
                (!fits).then_some(Exclusion::OutOfRange)
            }
            Err(error) => Some(Exclusion::Invalid(error)),
        };
        let text = |exclusion: &Option<Exclusion>| exclusion.as_ref().map(ToString::to_string);
        // Compared as texts, because NaN differs from itself.
        if let Some(exclusion) = &exclusion
            && text(&self.exclusion).as_deref() != Some(exclusion.to_string().as_str())
        {
            error!(
                "the surface of entity `{}` is left out of physics until its transform is good again: {exclusion}",
                name()
            );
        }
        self.exclusion = exclusion;
        self.exclusion.is_none() && !self.moving.lacks_joints()
    }

    /// Decides from which sides the surface pushes, and continues to compute its mass within the budget of the step. The first time that a
    /// solid surface is not closed, this is logged.
    pub fn set_sides(
        &mut self,
        solid: bool,
        on_dynamic: bool,
        masses: &mut MassBudget,
        name: impl Fn() -> String,
    ) -> Sides {
        self.moving.on_dynamic = on_dynamic;
        let mut posed = self.moving.surface.lock();
        let turned = posed.set_sides(solid, on_dynamic, self.moving.reshaped);
        let sides = Sides {
            turned: posed.advance_mass(on_dynamic, masses) || turned,
            is_closed: posed.is_closed(),
        };
        drop(posed);
        if solid && !sides.is_closed && !std::mem::replace(&mut self.logged_open, true) {
            warn!("{}", not_closed(&name()));
        }
        sides
    }
}
