//! The public questions, answered by one stage after the other.

use super::features::{Features, Kind};
use super::filter::{Answer, filtered, separated};
use super::moving::{MovingPoint, TimeOfImpact};
use super::solve;
use super::stages::StageCounts;

/// Whether a moving vertex touches a moving closed triangle at any time from 0 to 1.
///
/// The answer is exact for any finite coordinates. Contact in a single point at a single time counts, as do contact at the start and
/// at the end. The triangle may be degenerate at any time. The answer does not depend on the order or winding of the corners. With a
/// coordinate that is not finite, the answer is `false`.
///
/// Cost: a filter in `f64` decides nearly all queries, most of them by a few comparisons. What is left, which is contact or distance
/// within rounding, takes exact arithmetic: tens of microseconds. It takes longer, up to seconds, the more the magnitudes of
/// the coordinates differ. Coordinates with differences outside of about `1e-30` to `1e30` always take the exact path.
///
/// ```
/// use glam::DVec3;
/// use morph_collision::motion::{MovingPoint, vertex_face_touch};
///
/// let face = [DVec3::ZERO, DVec3::X, DVec3::Y].map(MovingPoint::resting);
/// let drop_at = |x, y| MovingPoint::new(DVec3::new(x, y, 1.0), DVec3::new(x, y, 0.0));
/// assert!(vertex_face_touch(drop_at(0.5, 0.5), face));
/// assert!(!vertex_face_touch(drop_at(0.5, 0.5_f64.next_up()), face));
/// ```
#[must_use]
pub fn vertex_face_touch(vertex: MovingPoint, face: [MovingPoint; 3]) -> bool {
    vertex_face_touch_counting(vertex, face, &mut StageCounts::default())
}

/// Whether two moving closed edges touch at any time from 0 to 1.
///
/// Edges may be points. Exactness and costs are those of [`vertex_face_touch`].
#[must_use]
pub fn edge_edge_touch(a: [MovingPoint; 2], b: [MovingPoint; 2]) -> bool {
    edge_edge_touch_counting(a, b, &mut StageCounts::default())
}

/// When a moving vertex first touches a moving closed triangle; `None` if it does not.
///
/// The times of the result differ by at most `tolerance`, or they are equal or neighbouring `f64`s. A tolerance that is negative or
/// NaN counts as 0. Features that touch at the start have the time 0. Exactness and costs are those of [`vertex_face_touch`], but a
/// tolerance below about `1e-12` always takes the exact path if there is contact.
#[must_use]
pub fn vertex_face_impact(vertex: MovingPoint, face: [MovingPoint; 3], tolerance: f64) -> Option<TimeOfImpact> {
    vertex_face_impact_counting(vertex, face, tolerance, &mut StageCounts::default())
}

/// When two moving closed edges first touch; `None` if they do not.
///
/// See [`vertex_face_impact`] for the tolerance, exactness and costs.
#[must_use]
pub fn edge_edge_impact(a: [MovingPoint; 2], b: [MovingPoint; 2], tolerance: f64) -> Option<TimeOfImpact> {
    edge_edge_impact_counting(a, b, tolerance, &mut StageCounts::default())
}

/// Like [`vertex_face_touch`]. Adds 1 to the count of the stage that decides.
#[must_use]
#[inline]
pub fn vertex_face_touch_counting(vertex: MovingPoint, face: [MovingPoint; 3], stages: &mut StageCounts) -> bool {
    touch(&vertex_face(vertex, face), stages)
}

/// Like [`edge_edge_touch`]. Adds 1 to the count of the stage that decides.
#[must_use]
#[inline]
pub fn edge_edge_touch_counting(a: [MovingPoint; 2], b: [MovingPoint; 2], stages: &mut StageCounts) -> bool {
    touch(&edge_edge(a, b), stages)
}

/// Like [`vertex_face_impact`]. Adds 1 to the count of the stage that decides.
#[must_use]
#[inline]
pub fn vertex_face_impact_counting(
    vertex: MovingPoint,
    face: [MovingPoint; 3],
    tolerance: f64,
    stages: &mut StageCounts,
) -> Option<TimeOfImpact> {
    impact(&vertex_face(vertex, face), tolerance, stages)
}

/// Like [`edge_edge_impact`]. Adds 1 to the count of the stage that decides.
#[must_use]
#[inline]
pub fn edge_edge_impact_counting(
    a: [MovingPoint; 2],
    b: [MovingPoint; 2],
    tolerance: f64,
    stages: &mut StageCounts,
) -> Option<TimeOfImpact> {
    impact(&edge_edge(a, b), tolerance, stages)
}

#[inline]
pub(super) fn vertex_face(vertex: MovingPoint, [a, b, c]: [MovingPoint; 3]) -> Features {
    Features {
        kind: Kind::VertexFace,
        corners: [vertex, a, b, c],
    }
}

#[inline]
pub(super) fn edge_edge([a, b]: [MovingPoint; 2], [c, d]: [MovingPoint; 2]) -> Features {
    Features {
        kind: Kind::EdgeEdge,
        corners: [a, b, c, d],
    }
}

#[inline]
fn touch(features: &Features, stages: &mut StageCounts) -> bool {
    if separated(features) {
        stages.separated += 1;
        return false;
    }
    match filtered(features, None) {
        Answer::Open => {
            stages.exact += 1;
            solve::touch(features)
        }
        answer => {
            stages.filtered += 1;
            answer != Answer::Apart
        }
    }
}

#[inline]
fn impact(features: &Features, tolerance: f64, stages: &mut StageCounts) -> Option<TimeOfImpact> {
    if separated(features) {
        stages.separated += 1;
        return None;
    }
    // NaN counts as 0, too.
    let tolerance = if tolerance > 0.0 { tolerance } else { 0.0 };
    match filtered(features, Some(tolerance)) {
        Answer::Open => {
            stages.exact += 1;
            solve::impact(features, tolerance)
        }
        Answer::Apart => {
            stages.filtered += 1;
            None
        }
        Answer::Contact(time) => {
            stages.filtered += 1;
            Some(time)
        }
    }
}
