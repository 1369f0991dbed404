mod best;
mod within;

use std::ops::ControlFlow;

use glam::DVec3;

use self::best::Best;
pub(super) use self::best::MARGIN;
use super::body::Body;
use super::collapsed::Collapsed;
use super::leaves::Leaves;
use super::pairs::TrianglePair;
use super::placements::Placements;
use super::stats::QueryStats;
use crate::bounds::{Aabb, Box64, Extent, GapFrame};
use crate::exact::{ClosestPoints, Triangle, closest_of_triangles, largest};
use crate::input_error::{InputError, check_length};
use crate::pose::{Posed, Standing};
use crate::traverse::{NearestStack, walk_nearest};
use crate::tree::Leaf;

/// The closest points of two bodies' surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPair {
    /// The two triangles.
    pub triangles: TrianglePair,
    /// The point on the first body's triangle, in world space.
    pub point_a: DVec3,
    /// The point on the second body's triangle, in world space.
    pub point_b: DVec3,
    /// The distance, in world units. It is 0 if and only if the triangles share a point. Otherwise its error is a few `f64` roundings of
    /// the triangles' sizes and the distance.
    pub distance: f64,
}

/// Finds the closest points of two bodies. Keep the query and use it again: it reuses its memory.
///
/// The distance is measured between surfaces: a body inside another one is not at distance 0. It does not depend on the trees, and
/// neither do the triangles and points if it is above 0. If triangles intersect, any intersecting pair may be returned.
///
/// There are two exceptions, in which the returned triangles may depend on the trees and the distance may be too long by a relative
/// 1e-9:
///
/// - bodies smaller than a millionth of their distance;
/// - bodies with more than 16,384 triangle pairs at the same distance up to rounding, such as two bodies flattened to parallel lines.
///
/// ```
/// # use std::sync::Arc;
/// # use glam::{Affine3A, Vec3};
/// # use morph_collision::*;
/// # let model = MorphModel::from_displacements(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[[Vec3::Z; 3]])?;
/// # let bvh = Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()));
/// let (mut a, mut b) = (Pose::new(bvh.clone()), Pose::new(bvh));
/// a.set_weights(&[0.5])?; // lifts the triangle to z = 0.5
/// let above = WorldFromModel::new(Affine3A::from_translation(Vec3::new(0.0, 0.0, 2.0)))?;
/// let bodies = (Body::new(&mut a, &WorldFromModel::IDENTITY), Body::new(&mut b, &above));
/// let closest = DistanceQuery::new().closest(bodies.0, bodies.1, f64::INFINITY)?;
/// assert_eq!(closest.map(|pair| pair.distance), Some(1.5));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct DistanceQuery {
    stack: NearestStack,
    leaves_a: Leaves,
    leaves_b: Leaves,
    collapsed: Collapsed,
    stats: QueryStats,
}

query_basics!(DistanceQuery, |query| query.stats);

impl DistanceQuery {
    /// Returns the closest points of two bodies; `None` if they are farther apart than `max_distance`, which may be infinite.
    ///
    /// A smaller `max_distance` means less work.
    ///
    /// # Errors
    /// [`InputError`] if `max_distance` is negative or NaN.
    pub fn closest(
        &mut self,
        mut a: Body<'_>,
        mut b: Body<'_>,
        max_distance: f64,
    ) -> Result<Option<ClosestPair>, InputError> {
        check_length("max_distance", max_distance)?;
        let (a, b) = (&mut a.posed(), &mut b.posed());
        let before = [a.blended(), b.blended()];
        let placements = Placements {
            a: a.stand(),
            b: b.stand(),
        };
        let (scale, are_collapsed) = (placements.a_from_b_scale(), placements.are_collapsed());
        let (placed_a, placed_b) = (&placements.a.placed, &placements.b.placed);
        let mut frames = GapFrame::list(placed_a, placed_b);
        let are_far = are_far(&frames, &placements);
        if are_far {
            // An `f32` rotation is not quite orthogonal: at this distance, the error of lengths in the bodies' own spaces is larger
            // than the bodies.
            frames.push(GapFrame::world(placed_a, placed_b));
        }
        let mut best = Best::within(max_distance, !are_far && !are_collapsed);
        let limit = best.limit;
        let Self {
            stack,
            leaves_a,
            leaves_b,
            collapsed,
            stats,
        } = self;
        *stats = QueryStats::default();
        if are_collapsed {
            collapsed.place(a, b);
            let look = |pair, corners_a: &Triangle, corners_b: &Triangle| best.look(pair, corners_a, corners_b);
            let _stopped_early = collapsed.nearest(limit, stats, look);
        } else {
            leaves_a.begin();
            leaves_b.begin();
            let bound = |a: &Aabb, b: &Aabb| squared_gap(&frames, &Box64::of(a), &Box64::of(b));
            let mut repeats = [Repeats::default(); 2];
            let at_leaves = |a: &mut Posed<'_>, b: &mut Posed<'_>, of_a, of_b| {
                let block_a = leaves_a.read(a, of_a);
                let block_b = leaves_b.read(b, of_b);
                let [repeats_a, repeats_b] = &mut repeats;
                let distinct_b = || leaves_b.triangles(block_b.clone()).iter();
                let are_new = distinct_b().filter(|(number, corners)| repeats_b.is_new(of_a, *number, corners));
                if are_new.count() == 0 {
                    return ControlFlow::Continue(best.limit);
                }
                for &(triangle_a, ref corners_a) in leaves_a.triangles(block_a) {
                    if !repeats_a.is_new(of_b, triangle_a, corners_a) {
                        continue;
                    }
                    let extent_a = Extent::of_triangle(corners_a);
                    for &(triangle_b, ref corners_b) in distinct_b() {
                        // The limit has a margin for rounding.
                        let is_farther = extent_a.squared_distance(&Extent::of_triangle(corners_b)) > best.limit;
                        if is_farther || best.is_tied_enough(corners_a, corners_b) {
                            continue;
                        }
                        stats.triangle_tests += 1;
                        best.look(TrianglePair { triangle_a, triangle_b }, corners_a, corners_b)?;
                    }
                }
                ControlFlow::Continue(best.limit)
            };
            stats.node_tests = walk_nearest((&mut *a, &mut *b), scale, stack, limit, bound, at_leaves);
        }
        *stats += QueryStats::blending(before, [a.blended(), b.blended()]);
        Ok(best.pair)
    }
}

impl ClosestPair {
    /// The closest points of two triangles.
    pub(super) fn of(triangles: TrianglePair, corners_a: &Triangle, corners_b: &Triangle) -> Self {
        let ClosestPoints { on_a, on_b, squared } = closest_of_triangles(corners_a, corners_b);
        Self {
            triangles,
            point_a: on_a,
            point_b: on_b,
            distance: squared.sqrt(),
        }
    }
}

/// Recognises triangles of a body that is a point. All its leaves would be compared with every leaf of the other body that is about as
/// close.
#[derive(Clone, Copy, Debug, Default)]
struct Repeats(Option<(Leaf, u32, Triangle)>);

impl Repeats {
    /// Whether a triangle differs from the last one that was compared with a leaf, or has a smaller number.
    fn is_new(&mut self, leaf: Leaf, number: u32, corners: &Triangle) -> bool {
        let is_repeated = self.0.as_ref().is_some_and(|(last_leaf, last_number, last)| {
            *last_leaf == leaf && *last_number < number && last == corners
        });
        if !is_repeated {
            self.0 = Some((leaf, number, *corners));
        }
        !is_repeated
    }
}

/// A lower bound for the squared distance between the contents of two boxes.
fn squared_gap(frames: &[GapFrame], a: &Box64, b: &Box64) -> f64 {
    let squared = |frame: &GapFrame| frame.squared(&frame.image_of_a(a), &frame.image_of_b(b));
    largest(frames.iter().map(squared))
}

/// Whether two bodies are so small compared with their distance that all their triangles are about equally close.
fn are_far(frames: &[GapFrame], placements: &Placements<'_>) -> bool {
    const FAR: f64 = 1e6;
    let boxes = [placements.a, placements.b].map(|standing| Box64::of(&standing.bounds));
    let size = |standing: &Standing, of: &Box64| of.half.element_sum() * standing.placed.world_from_model().scale();
    let far = 2.0 * FAR * (size(placements.a, &boxes[0]) + size(placements.b, &boxes[1]));
    far * far <= squared_gap(frames, &boxes[0], &boxes[1])
}
