//! Branch and bound: splits a box of weights until two triangles are proved free in every part, or touch in one.

use glam::DVec3;

use super::hull::ClosestOfHull;
use super::pair::{Gap, Pair};
use crate::exact::{Triangle, closest_of_triangles, triangles_intersect};

/// At most this many directions are tried for a part of the box.
const DIRECTIONS: usize = 12;

/// What is known of two triangles.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Decision {
    /// They never touch for any weights in the box. `boxes` parts of it were looked at.
    Free {
        boxes: u32,
    },
    /// They touch for these weights, one for each target of the pair.
    Touching(Vec<f32>),
    Undecided,
}

/// Memory that decisions reuse.
#[derive(Debug, Default)]
pub(super) struct Branches {
    stack: Vec<Vec<[f32; 2]>>,
    weights: Vec<f32>,
    /// The direction of the last proof. Often it also serves for the next triangles.
    direction: DVec3,
}

impl Branches {
    /// Decides for all weights in a box, looking at no more than `most` parts of it. `start` are weights to try first.
    pub(super) fn decide(&mut self, pair: &Pair, whole: &[[f32; 2]], start: &[f32], most: u32) -> Decision {
        if pair.gap(self.direction, whole).bound > 0.0 {
            return Decision::Free { boxes: 1 };
        }
        if touches(pair, start) {
            return Decision::Touching(start.to_vec());
        }
        self.stack.clear();
        self.stack.push(whole.to_vec());
        let mut boxes = 0;
        while let Some(part) = self.stack.pop() {
            if boxes == most {
                return Decision::Undecided;
            }
            boxes += 1;
            self.weights.clear();
            self.weights
                .extend(part.iter().map(|&[low, high]| f32::midpoint(low, high)));
            let posed = pair.posed(&self.weights);
            if triangles_intersect(&posed[0], &posed[1]) {
                return Decision::Touching(self.weights.clone());
            }
            let best = match best_gap(pair, &posed, &part, &mut self.weights) {
                Search::Free(direction) => {
                    self.direction = direction;
                    continue;
                }
                Search::Touching => return Decision::Touching(self.weights.clone()),
                Search::Open(best) => best,
            };
            let Some([one, other]) = split(pair, &best, part) else {
                return Decision::Undecided;
            };
            self.stack.extend([one, other]);
        }
        Decision::Free { boxes }
    }
}

fn touches(pair: &Pair, weights: &[f32]) -> bool {
    let [a, b] = pair.posed(weights);
    triangles_intersect(&a, &b)
}

/// What is known after several directions were tried.
enum Search {
    /// This direction proves the triangles free.
    Free(DVec3),
    /// They touch for the weights that were tried last.
    Touching,
    /// The best bound.
    Open(Gap),
}

/// Tries several directions, and for each one the worst weights. `posed` are the triangles in the middle of the box.
///
/// All differences of a point of the second triangle and one of the first, for all weights in the box, have a convex hull. A direction
/// proves the triangles free if the hull is beyond a plane across it. The best direction is that of the hull's point closest to the origin,
/// which [`ClosestOfHull`] approaches.
fn best_gap(pair: &Pair, posed: &[Triangle; 2], part: &[[f32; 2]], weights: &mut Vec<f32>) -> Search {
    let [a, b] = posed;
    let closest = closest_of_triangles(a, b);
    let mut hull = ClosestOfHull::new(closest.on_b - closest.on_a);
    let mut best: Option<Gap> = None;
    for _ in 0..DIRECTIONS {
        let direction = hull.point.normalize_or_zero();
        if direction == DVec3::ZERO {
            break;
        }
        let gap = pair.gap(direction, part);
        if gap.bound > 0.0 {
            return Search::Free(direction);
        }
        weights.clear();
        let ends = pair.slopes(&gap).zip(part);
        weights.extend(ends.map(|(slope, [low, high])| if slope > 0.0 { *low } else { *high }));
        if touches(pair, weights) {
            return Search::Touching;
        }
        if best.is_none_or(|best| gap.bound > best.bound) {
            best = Some(gap);
        }
        if !hull.add(pair.difference(&gap, part)) {
            break;
        }
    }
    // Triangles that nearly touch in the middle of the box have no direction.
    Search::Open(best.unwrap_or_else(|| pair.gap(DVec3::X, part)))
}

/// Halves the interval that changes the gap most, or if none does, the one that moves the triangles most against each other; `None` if no
/// interval can be halved that moves them.
fn split(pair: &Pair, gap: &Gap, part: Vec<[f32; 2]>) -> Option<[Vec<[f32; 2]>; 2]> {
    let changes: Vec<f64> = pair.slopes(gap).map(f64::abs).collect();
    let (index, middle) = widest(changes.into_iter(), &part).or_else(|| widest(pair.differences(), &part))?;
    let (mut one, mut other) = (part.clone(), part);
    one[index][1] = middle;
    other[index][0] = middle;
    Some([one, other])
}

/// The interval with the largest product of width and change, and its middle.
fn widest(changes: impl Iterator<Item = f64>, part: &[[f32; 2]]) -> Option<(usize, f32)> {
    let changes = changes.zip(part).enumerate();
    let changes = changes.filter_map(|(index, (change, &[low, high]))| {
        let middle = f32::midpoint(low, high);
        let change = change * (f64::from(high) - f64::from(low));
        (change > 0.0 && low < middle && middle < high).then_some((change, index, middle))
    });
    let (_, index, middle) = changes.max_by(|one, other| one.0.total_cmp(&other.0))?;
    Some((index, middle))
}
