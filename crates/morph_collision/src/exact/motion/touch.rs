//! The public questions, answered by one stage after the other.

use super::answer::Answer;
use super::ends::decide_at_ends;
use super::features::{FeaturePair, Kind};
use super::filter::{COARSEST, filtered, separated};
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
/// within rounding, takes exact arithmetic: tens of microseconds. It takes longer, up to a millisecond, the more the magnitudes of
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
/// The times of the result differ by at most `tolerance`, or they are equal or neighbouring `f64`s. They never differ by more than
/// `2^-30`. They depend only on the exact time and on the tolerance. A tolerance that is negative or NaN counts as 0. Features that touch
/// at the start have the time 0. Exactness and costs are those of [`vertex_face_touch`], but a tolerance below about `1e-12` always takes
/// the exact path if there is contact.
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
    vertex_face(vertex, face).touch(stages)
}

/// Like [`edge_edge_touch`]. Adds 1 to the count of the stage that decides.
#[must_use]
#[inline]
pub fn edge_edge_touch_counting(a: [MovingPoint; 2], b: [MovingPoint; 2], stages: &mut StageCounts) -> bool {
    edge_edge(a, b).touch(stages)
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
    vertex_face(vertex, face).impact(tolerance, stages)
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
    edge_edge(a, b).impact(tolerance, stages)
}

#[inline]
pub(super) fn vertex_face(vertex: MovingPoint, [a, b, c]: [MovingPoint; 3]) -> FeaturePair {
    FeaturePair {
        kind: Kind::VertexFace,
        corners: [vertex, a, b, c],
    }
}

#[inline]
pub(super) fn edge_edge([a, b]: [MovingPoint; 2], [c, d]: [MovingPoint; 2]) -> FeaturePair {
    FeaturePair {
        kind: Kind::EdgeEdge,
        corners: [a, b, c, d],
    }
}

impl FeaturePair {
    /// Whether the features touch at any time.
    #[inline]
    pub(crate) fn touch(&self, stages: &mut StageCounts) -> bool {
        match self.decided(None, stages) {
            Answer::Open => solve::touch(self),
            answer => answer != Answer::Apart,
        }
    }

    /// When the features first touch. See [`vertex_face_impact`].
    ///
    /// All times of one tolerance are points of one grid or cells between them: [0, 1] is halved until its parts are short enough. A time
    /// that is not a point of the grid is inside its cell. So if a contact is later than the end of another's time, its own time does not
    /// start before that end.
    #[inline]
    pub(crate) fn impact(&self, tolerance: f64, stages: &mut StageCounts) -> Option<TimeOfImpact> {
        // NaN counts as 0, too.
        let tolerance = if tolerance > 0.0 { tolerance.min(COARSEST) } else { 0.0 };
        match self.decided(Some(tolerance), stages) {
            Answer::Open => solve::impact(self, tolerance),
            Answer::Apart => None,
            Answer::Contact(time) => Some(time),
        }
    }

    /// The answer of the first stage that has one; open if only exact polynomials are left. With a tolerance, searches for the first
    /// contact; otherwise any contact will do.
    #[inline]
    fn decided(&self, tolerance: Option<f64>, stages: &mut StageCounts) -> Answer {
        if separated(self) {
            stages.separated += 1;
            return Answer::Apart;
        }
        let answer = filtered(self, tolerance);
        if answer != Answer::Open {
            stages.filtered += 1;
            return answer;
        }
        let answer = decide_at_ends(self, tolerance);
        if answer == Answer::Open {
            stages.exact += 1;
            stages.exact_bits += self.bits();
        } else {
            stages.at_ends += 1;
        }
        answer
    }

    /// Roughly how many bits the coordinates take as multiples of one power of two.
    fn bits(&self) -> u64 {
        let ends = self.corners.iter().flat_map(|corner| [corner.start, corner.end]);
        let coordinates = ends.flat_map(|point| point.to_array()).filter(|c| *c != 0.0);
        let exponents = coordinates.map(|c| (c.abs().to_bits() >> 52) as i64);
        let (least, most) = exponents.fold((i64::MAX, 0), |(least, most), e| (least.min(e), most.max(e)));
        most.saturating_sub(least).max(0) as u64 + u64::from(f64::MANTISSA_DIGITS)
    }
}
