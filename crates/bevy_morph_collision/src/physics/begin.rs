//! What a surface does at the beginning of a step, with any engine.

use bevy::mesh::morph::{MeshMorphWeights, MorphWeights};
use bevy::prelude::*;
use morph_collision::InputError;
use tracing::{error, warn};

use super::ahead::Ahead;
use super::clock::Span;
use super::follow::Following;
use super::inside::not_closed;
use super::range::{MAX_COORDINATE, box_in_range, in_range};

/// Moves a surface, whose entity is at `at`, to its pose at the end of the step. Returns whether it takes part in the step.
///
/// If its place or size keeps it out, `problem` says why. That is logged when it is new.
pub(crate) fn advance(
    following: &mut Following,
    (ahead, at): (Result<Ahead, InputError>, Vec3),
    (weights, shared): (Option<&MeshMorphWeights>, &Query<&MorphWeights>),
    (span, dt): (Option<Span>, f32),
    problem: &mut Option<String>,
    name: impl Fn() -> String,
) -> bool {
    let found = match ahead {
        Ok(ahead) => {
            if let Err(complaint) = following.advance(weights, shared, ahead, span, dt) {
                error!("the surface of entity `{}` stays as it was: {complaint}", name());
            }
            let fits = box_in_range(&following.surface.lock().bounds()) && in_range(at);
            (!fits).then(|| format!("it is larger than {MAX_COORDINATE:e} units or as far from the origin"))
        }
        Err(error) => Some(error.to_string()),
    };
    if let Some(found) = &found
        && problem.as_ref() != Some(found)
    {
        error!(
            "the surface of entity `{}` is left out of physics until its transform is good again: {found}",
            name()
        );
    }
    *problem = found;
    problem.is_none() && !following.lacks_joints()
}

/// The sides of a surface in a step.
pub(crate) struct Sides {
    /// Whether they are others than in the last step, or the mass has become known.
    pub(crate) turned: bool,
    /// Whether the mesh is closed.
    pub(crate) is_closed: bool,
}

/// Decides from which sides a surface pushes, and continues to compute its mass. The first time that a solid surface is not closed, this is logged.
pub(crate) fn set_sides(
    following: &Following,
    (solid, on_dynamic): (bool, bool),
    told_open: &mut bool,
    name: impl Fn() -> String,
) -> Sides {
    let (turned, is_closed) = {
        let mut posed = following.surface.lock();
        let turned = posed.set_sides(solid, on_dynamic, following.reshaped);
        (posed.weigh(on_dynamic) || turned, posed.is_closed())
    };
    if solid && !is_closed && !std::mem::replace(told_open, true) {
        warn!("{}", not_closed(&name()));
    }
    Sides { turned, is_closed }
}
