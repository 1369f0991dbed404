//! Finds placements that nearly touch, by bisection.

use glam::{Affine3A, Vec3A};

use super::{AnswerSource, Situation};
use crate::rivals::PoseError;

/// More halvings than needed to reach neighbouring floats in three coordinates.
const MOST_HALVINGS: usize = 1000;

/// Moves the second body from a situation that touches towards `apart`, where it does not. Returns two neighbouring
/// situations of which, according to `source`, only the first touches. Returns `None` if the start does not touch or the end
/// does.
///
/// The translations differ by at most one `f32` per coordinate, and no `f32` lies between.
///
/// # Errors
/// The source refuses a situation.
pub fn nearly_touching(
    start: &Situation,
    apart: Vec3A,
    source: &mut impl AnswerSource,
) -> Result<Option<[Situation; 2]>, PoseError> {
    let at = |translation: Vec3A| {
        let mut moved = start.clone();
        moved.places[1] = Affine3A {
            translation,
            ..start.places[1]
        };
        moved
    };
    let mut touches = |translation: Vec3A| {
        source.set(&at(translation))?;
        Ok::<_, PoseError>(source.touches())
    };
    let (mut inside, mut outside) = (start.places[1].translation, apart);
    if !touches(inside)? || touches(outside)? {
        return Ok(None);
    }
    for _ in 0..MOST_HALVINGS {
        let middle = inside * 0.5 + outside * 0.5;
        if middle == inside || middle == outside {
            break;
        }
        if touches(middle)? {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    Ok(Some([at(inside), at(outside)]))
}
