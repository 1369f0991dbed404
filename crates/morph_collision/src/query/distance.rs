mod best;

use std::cell::Cell;
use std::ops::ControlFlow;

use glam::DVec3;

use self::best::Best;
use super::body::Body;
use super::collapsed::{Collapsed, CollapsedTests};
use super::leaves::Leaves;
use super::one::magnitude;
use super::pairs::TrianglePair;
use super::places::Places;
use super::stats::QueryStats;
use crate::bounds::{Aabb, Box64, GapFrame, LANES};
use crate::exact::Triangle;
use crate::pose::{NodeRef, Posed};
use crate::traverse::{Opened, PairRule, PairWalk, Side, Stack};

/// Closest points of two bodies' surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosestPair {
    /// A triangle of the first body.
    pub triangle_a: u32,
    /// A triangle of the second body.
    pub triangle_b: u32,
    /// The point on the first body's triangle, in world space.
    pub point_a: DVec3,
    /// The point on the second body's triangle, in world space.
    pub point_b: DVec3,
    /// The distance, in world units: 0 if and only if the triangles share a point, which is exact; otherwise off by a few
    /// `f64` roundings of the triangles' sizes and the distance.
    pub distance: f64,
}

/// Measures how far two bodies are apart; holds the memory that queries reuse.
///
/// The distance is that of the surfaces, so a body inside another one is not at distance 0. It does not depend on the
/// trees, nor do the triangles and points while it is above 0; of intersecting triangles the walk takes the first pair. There are
/// two exceptions, where the triangles that are named may depend on the trees, and the distance may be a billionth too long: bodies
/// smaller than a millionth of their distance, all of whose triangles are about as close; and bodies with more than 16,384 pairs of
/// triangles at the same distance but for rounding, such as two that are flattened to parallel lines.
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
/// let (closest, _) = DistanceQuery::new().closest(bodies.0, bodies.1, f64::INFINITY);
/// assert_eq!(closest.map(|pair| pair.distance), Some(1.5));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct DistanceQuery {
    stack: Stack<f64>,
    leaves_a: Leaves,
    leaves_b: Leaves,
    collapsed: Collapsed,
}

impl DistanceQuery {
    /// A query with nothing allocated yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Closest points of two bodies at most `max_distance` apart; `None` if they are farther apart, or it is negative or NaN.
    ///
    /// `max_distance` may be infinite; the smaller it is, the less is looked at.
    pub fn closest(&mut self, a: Body<'_>, b: Body<'_>, max_distance: f64) -> (Option<ClosestPair>, QueryStats) {
        if max_distance.is_nan() || max_distance < 0.0 {
            return (None, QueryStats::default());
        }
        let (world_from_a, world_from_b) = (a.world_from_model, b.world_from_model);
        let (mut a, mut b) = (a.pose.posed(), b.pose.posed());
        let before = [a.blended(), b.blended()];
        let places = Places {
            world_from_a,
            world_from_b,
        };
        if places.are_collapsed(&mut a, &mut b) {
            let mut best = Best::within(max_distance, false);
            let mut tests = CollapsedTests::default();
            self.collapsed.place(&mut a, &mut b, &places);
            let limit = best.limit;
            let _stopped_early = self.collapsed.nearer(limit, &mut tests, |pair, corners_a, corners_b| {
                best.look(pair, corners_a, corners_b)
            });
            let stats = QueryStats {
                node_tests: tests.nodes,
                triangle_tests: tests.triangles,
                ..QueryStats::blending(before, [a.blended(), b.blended()])
            };
            return (best.pair, stats);
        }
        let (magnitude_a, magnitude_b) = (magnitude(&mut a), magnitude(&mut b));
        let mut frames = GapFrame::list(world_from_a, magnitude_a, world_from_b, magnitude_b);
        let are_far = are_far(&frames, &places, &mut a, &mut b);
        if are_far {
            // A rotation in `f32` is not quite one, and lengths in the bodies' spaces are off by more than the bodies' sizes.
            frames.push(GapFrame::world(world_from_a, magnitude_a, world_from_b, magnitude_b));
        }
        let mut best = Best::within(max_distance, !are_far);
        let rule = Closer {
            frames: &frames,
            limit: Cell::new(best.limit),
        };
        let mut walk = PairWalk {
            a: &mut a,
            b: &mut b,
            rule: &rule,
            roots_meet: false,
            a_from_b_scale: (world_from_b.scale() / world_from_a.scale()) as f32,
            node_tests: 0,
            deepest_first: false,
        };
        let mut triangle_tests = 0;
        let Self {
            stack,
            leaves_a,
            leaves_b,
            ..
        } = self;
        leaves_a.begin(walk.a.topology.leaf_count());
        leaves_b.begin(walk.b.topology.leaf_count());
        let _stopped_early = walk.run(stack, &[], |a, b, of_a, of_b| {
            let block_a = leaves_a.read(a, world_from_a, of_a);
            let block_b = leaves_b.read(b, world_from_b, of_b);
            for &(triangle_a, ref corners_a) in leaves_a.triangles(block_a) {
                for &(triangle_b, ref corners_b) in leaves_b.triangles(block_b.clone()) {
                    if boxes_apart(corners_a, corners_b) > rule.limit.get() || best.is_tied_enough(corners_a, corners_b)
                    {
                        continue;
                    }
                    triangle_tests += 1;
                    let pair = TrianglePair { triangle_a, triangle_b };
                    rule.limit.set(best.look(pair, corners_a, corners_b)?);
                }
            }
            ControlFlow::Continue(())
        });
        let after = [walk.a.blended(), walk.b.blended()];
        let stats = QueryStats {
            node_tests: walk.node_tests,
            triangle_tests,
            ..QueryStats::blending(before, after)
        };
        (best.pair, stats)
    }
}

/// The squared distance of two triangles' boxes, from below up to a rounding that the margin covers.
fn boxes_apart(a: &Triangle, b: &Triangle) -> f64 {
    let span = |t: &Triangle| (t[0].min(t[1]).min(t[2]), t[0].max(t[1]).max(t[2]));
    let ((min_a, max_a), (min_b, max_b)) = (span(a), span(b));
    (min_a - max_b).max(min_b - max_a).max(DVec3::ZERO).length_squared()
}

/// The rule of node pairs that may be closer than a limit, the closest first.
struct Closer<'a> {
    frames: &'a [GapFrame],
    /// A squared world distance.
    limit: Cell<f64>,
}

impl Closer<'_> {
    fn squared(&self, a: &Box64, b: &Box64) -> f64 {
        squared_gap(self.frames, a, b)
    }
}

/// A lower bound of the squared distance of what two boxes hold.
fn squared_gap(frames: &[GapFrame], a: &Box64, b: &Box64) -> f64 {
    frames
        .iter()
        .map(|frame| frame.squared(&frame.image_of_a(a), &frame.image_of_b(b)))
        .fold(0.0, f64::max)
}

/// Whether two bodies are so much smaller than the distance between them that all their triangles are about as close.
fn are_far(frames: &[GapFrame], places: &Places<'_>, a: &mut Posed<'_>, b: &mut Posed<'_>) -> bool {
    const FAR: f64 = 1e6;
    let boxes = [Box64::of(&a.bounds()), Box64::of(&b.bounds())];
    let size_a = boxes[0].half.element_sum() * places.world_from_a.scale();
    let size_b = boxes[1].half.element_sum() * places.world_from_b.scale();
    let far = 2.0 * FAR * (size_a + size_b);
    far * far <= squared_gap(frames, &boxes[0], &boxes[1])
}

impl PairRule for Closer<'_> {
    type Key = f64;

    fn start(&self, a: &Aabb, b: &Aabb) -> Option<f64> {
        let squared = self.squared(&Box64::of(a), &Box64::of(b));
        self.still_wanted(squared).then_some(squared)
    }

    fn children(
        &self,
        side: Side,
        (tree, opened): (&Posed<'_>, Opened),
        (other, node): (&Posed<'_>, NodeRef),
        keys: &mut [f64; LANES],
    ) -> u8 {
        let other = Box64::of(&other.node_box(node));
        let mut wanted = 0;
        for (lane, key) in keys.iter_mut().enumerate() {
            if opened.mask >> lane & 1 == 0 {
                continue;
            }
            let child = Box64::of(&tree.boxes(opened.slot).get(lane));
            *key = match side {
                Side::A => self.squared(&child, &other),
                Side::B => self.squared(&other, &child),
            };
            wanted |= u8::from(self.still_wanted(*key)) << lane;
        }
        wanted
    }

    fn still_wanted(&self, squared: f64) -> bool {
        squared <= self.limit.get()
    }
}
