use std::cell::{Cell, RefCell};
use std::ops::ControlFlow;
use std::sync::Arc;

use super::super::body::with_walkable_pair;
use super::super::patches::{LeafTests, Patches, intersecting_pairs};
use super::super::places::Places;
use super::super::{Body, QueryStats, SeparatingAxes};
use super::answer::{ApproximatePairs, ApproximateTouch, MeshPart, PartPair};
use super::limits::Approximation;
use super::rule::{Approximating, Settled, Spans};
use crate::bounds::Volume;
use crate::traverse::{AnyCulls, Meeting, PairWalk, Stack, Walkable};
use crate::tree::{Child, MorphBvh};

/// Asks which triangles of two bodies intersect, within a tolerance or a budget; holds the memory that queries reuse.
///
/// With neither the answer is that of [`PairQuery`](crate::PairQuery), and says so ([`ApproximatePairs::is_exact`]).
///
/// ```
/// # use std::sync::Arc;
/// # use glam::{Affine3A, Vec3};
/// # use morph_collision::*;
/// # let model = MorphModel::from_displacements(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &[[Vec3::Z; 3]])?;
/// # let bvh = Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())?);
/// let (mut a, mut b) = (Pose::new(bvh.clone()), Pose::new(bvh));
/// let beside = WorldFromModel::new(Affine3A::from_translation(Vec3::new(0.6, 0.6, 0.0)))?;
/// let mut query = ApproximateQuery::new();
/// let mut ask = |limits| query.touch(
///     Body::new(&mut a, &WorldFromModel::IDENTITY),
///     Body::new(&mut b, &beside),
///     &limits,
/// );
/// assert!(matches!(ask(Approximation::new()).0, ApproximateTouch::Apart));
/// // Good enough for a trigger zone: no farther apart than 3, and no vertex was blended.
/// let (touch, stats) = ask(Approximation::new().with_tolerance(3.0)?);
/// assert!(matches!(touch, ApproximateTouch::Near(parts) if parts.distance <= 3.0));
/// assert_eq!(stats.triangle_tests, 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Default)]
pub struct ApproximateQuery {
    stack: Stack,
    culls: AnyCulls,
    leaves_a: Patches,
    leaves_b: Patches,
}

impl ApproximateQuery {
    /// A query with nothing allocated yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Every pair of intersecting triangles, as far as the limits let it be known.
    pub fn all(&mut self, a: Body<'_>, b: Body<'_>, limits: &Approximation) -> ApproximatePairs {
        self.run(a, b, limits, false)
    }

    /// Whether any triangles intersect, as far as the limits let it be known: the first thing found ends the work.
    pub fn touch(&mut self, a: Body<'_>, b: Body<'_>, limits: &Approximation) -> (ApproximateTouch, QueryStats) {
        let mut answer = self.run(a, b, limits, true);
        let touch = match (answer.touching.pop(), answer.near.pop()) {
            (Some(pair), _) => ApproximateTouch::Touching(pair),
            (None, Some(parts)) => ApproximateTouch::Near(parts),
            (None, None) if answer.undecided.is_empty() => ApproximateTouch::Apart,
            (None, None) => ApproximateTouch::Undecided(answer.undecided),
        };
        (touch, answer.stats)
    }

    fn run(&mut self, a: Body<'_>, b: Body<'_>, limits: &Approximation, first: bool) -> ApproximatePairs {
        let places = Places {
            world_from_a: a.world_from_model,
            world_from_b: b.world_from_model,
        };
        let trees = [a.pose.bvh().clone(), b.pose.bvh().clone()];
        let task = Task {
            places,
            trees,
            limits,
            first,
        };
        with_walkable_pair!(a.pose.posed(), b.pose.posed(), (a, b) => self.walk(&mut a, &mut b, &task))
    }

    fn walk<V: Volume, T: Walkable<Kind = V>>(&mut self, a: &mut T, b: &mut T, task: &Task<'_>) -> ApproximatePairs {
        let places = &task.places;
        let before = [a.blended(), b.blended()];
        let Self {
            stack,
            culls,
            leaves_a,
            leaves_b,
        } = self;
        let culls = culls.of::<V>();
        let (roots_meet, _) = places.begin_culls(a, b, SeparatingAxes::Lite, culls);
        places.begin_leaves(a, b, [leaves_a, leaves_b]);
        let rule = Approximating {
            meeting: Meeting {
                culls: culls.into(),
                cross: None,
            },
            limits: *task.limits,
            first: task.first,
            spans: Spans::of(places),
            triangle_tests: Cell::new(0),
            near: RefCell::default(),
        };
        let mut walk = PairWalk {
            a,
            b,
            rule: &rule,
            roots_meet,
            a_from_b_scale: places.a_from_b_scale(),
            node_tests: 0,
            deepest_first: false,
            trace: None,
        };
        let mut tests = LeafTests::default();
        let mut touching = Vec::new();
        let mut found = |pair| {
            touching.push(pair);
            if task.first {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        let level = walk.a.level();
        let stopped = walk.run(stack, &[], |a, b, of_a, of_b| {
            let (block_a, block_b) = (leaves_a.read(a, of_a), leaves_b.read(b, of_b));
            let flow = intersecting_pairs(level, (leaves_a, block_a), (leaves_b, block_b), &mut tests, &mut found);
            rule.triangle_tests.set(tests.triangles);
            flow
        });
        // A walk that a found pair ended has answered its question.
        let left = if stopped.is_break() { &[][..] } else { &stack[..] };
        let undecided = left
            .iter()
            .map(|(_, node_a, node_b)| {
                let distance = rule
                    .spans
                    .distance::<V>(&walk.a.volume(*node_a), &walk.b.volume(*node_b));
                task.parts((node_a.child, node_b.child, distance))
            })
            .collect();
        ApproximatePairs {
            touching,
            near: rule
                .near
                .take()
                .into_iter()
                .map(|settled| task.parts(settled))
                .collect(),
            undecided,
            stats: QueryStats {
                node_tests: walk.node_tests,
                triangle_tests: tests.triangles,
                undecided_by_filter: tests.undecided_by_filter,
                ..QueryStats::blending(before, [walk.a.blended(), walk.b.blended()])
            },
        }
    }
}

/// What is asked.
struct Task<'a> {
    places: Places<'a>,
    trees: [Arc<MorphBvh>; 2],
    limits: &'a Approximation,
    first: bool,
}

impl Task<'_> {
    fn parts(&self, (a, b, distance): Settled) -> PartPair {
        let part = |tree: &Arc<MorphBvh>, node: Child| MeshPart {
            range: tree.topology().range_below(node),
            bvh: tree.clone(),
        };
        PartPair {
            a: part(&self.trees[0], a),
            b: part(&self.trees[1], b),
            distance,
        }
    }
}
