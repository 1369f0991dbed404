//! Finds the triangles that touch among posed bodies, within each body and between them.

pub(crate) mod blame;
pub(crate) mod depth;

use std::ops::ControlFlow;

use glam::Vec3;
use morph_collision::{
    Aabb, ClosestPair, DistanceQuery, InputError, PairQuery, SelfDistanceQuery, SelfQuery, TrianglePair,
    overlapping_pairs,
};

use crate::cast::posed::Posed;

/// Two triangles that touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Touch {
    /// The same body twice if it intersects itself.
    pub(crate) bodies: [usize; 2],
    pub(crate) pair: TrianglePair,
}

/// Which pairs of triangles to look at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Among {
    /// Of the same body and of different bodies.
    All,
    /// Of the same body.
    #[value(name = "self")]
    Itself,
    /// Of different bodies.
    Bodies,
}

/// Memory that searches reuse.
#[derive(Debug, Default)]
pub(crate) struct Search {
    of_one: SelfQuery,
    of_two: PairQuery,
    near_in_one: SelfDistanceQuery,
    near_of_two: DistanceQuery,
    /// Pairs that are at most this far apart count, too.
    gap: Option<f64>,
    pairs: Vec<TrianglePair>,
}

impl Search {
    /// A search that also finds pairs that do not touch but are at most `gap` apart, which must not be negative.
    pub(crate) fn within(gap: Option<f64>) -> Self {
        Self { gap, ..Self::default() }
    }

    /// Appends all pairs that touch, ascending. Returns false if there are more than `most`; then some are missing.
    pub(crate) fn touching(&mut self, bodies: &mut [Posed], among: Among, most: usize, found: &mut Vec<Touch>) -> bool {
        let gap = self.gap;
        let start = found.len();
        let mut complete = true;
        if among != Among::Bodies {
            for (index, body) in bodies.iter_mut().enumerate() {
                self.pairs.clear();
                let room = most.saturating_sub(found.len());
                let (pose, pairs) = (&mut body.pose, &mut self.pairs);
                complete &= match gap {
                    None => !self.of_one.up_to(pose, room, pairs),
                    Some(gap) => up_to(room, pairs, |visitor| self.near_in_one.within(pose, gap, visitor)),
                };
                found.extend(self.pairs.iter().map(|&pair| Touch {
                    bodies: [index; 2],
                    pair,
                }));
            }
        }
        if among != Among::Itself {
            let reach = gap.map_or(0.0, |gap| (gap as f32).next_up());
            let bounds: Vec<_> = bodies
                .iter_mut()
                .map(|body| Some(enlarged(body.bounds(), reach)))
                .collect();
            let mut candidates = Vec::new();
            overlapping_pairs(&bounds, &mut candidates);
            for (a, b) in candidates {
                let both = [a, b].map(|body| body as usize);
                let Ok([first, second]) = bodies.get_disjoint_mut(both) else {
                    continue;
                };
                self.pairs.clear();
                let room = most.saturating_sub(found.len());
                let (first, second, pairs) = (first.body(), second.body(), &mut self.pairs);
                complete &= match gap {
                    None => !self.of_two.up_to(first, second, room, pairs),
                    Some(gap) => up_to(room, pairs, |visitor| {
                        self.near_of_two.within(first, second, gap, visitor)
                    }),
                };
                found.extend(self.pairs.iter().map(|&pair| Touch { bodies: both, pair }));
            }
        }
        found[start..].sort_unstable();
        complete
    }
}

/// Appends the pairs that a query visits. Returns false if there are more than `room`, or if the query refuses its distance.
fn up_to(
    room: usize,
    pairs: &mut Vec<TrianglePair>,
    query: impl FnOnce(&mut dyn FnMut(ClosestPair) -> ControlFlow<()>) -> Result<(), InputError>,
) -> bool {
    let mut is_complete = true;
    let visited = query(&mut |found| {
        is_complete = pairs.len() < room;
        if !is_complete {
            return ControlFlow::Break(());
        }
        pairs.push(found.triangles);
        ControlFlow::Continue(())
    });
    visited.is_ok() && is_complete
}

/// A box enlarged to all sides, if `reach` is above 0.
fn enlarged(bounds: Aabb, reach: f32) -> Aabb {
    if reach <= 0.0 {
        return bounds;
    }
    // Outward, so that rounding makes no box smaller.
    Aabb {
        min: Vec3::from_array((bounds.min - reach).to_array().map(f32::next_down)),
        max: Vec3::from_array((bounds.max + reach).to_array().map(f32::next_up)),
    }
}
