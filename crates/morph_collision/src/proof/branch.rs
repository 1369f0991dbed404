//! Branch and bound: splits a box of weights until two triangles are proved free in every part, or touch in one.

use glam::DVec3;

use super::pair::{Gap, Pair};
use crate::exact::{Triangle, closest_of_triangles, closest_on_triangle, triangles_intersect};

/// At most this many directions are tried for a part of the box.
const DIRECTIONS: usize = 12;

/// What is known of two triangles.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Decision {
    /// They touch for no weights in the box. `boxes` parts of it were looked at.
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
}

impl Branches {
    /// Decides for all weights in a box, looking at no more than `most` parts of it. `start` are weights to try first.
    pub(super) fn decide(&mut self, pair: &Pair, whole: &[[f32; 2]], start: &[f32], most: u32) -> Decision {
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
            let Some(best) = best_gap(pair, &posed, &part) else {
                continue;
            };
            // The worst weights for this direction, where the triangles are most likely to touch.
            self.weights.clear();
            let ends = pair.slopes(&best).zip(&part);
            self.weights
                .extend(ends.map(|(slope, [low, high])| if slope > 0.0 { *low } else { *high }));
            if touches(pair, &self.weights) {
                return Decision::Touching(self.weights.clone());
            }
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

/// The best bound along several directions, or `None` if one of them proves the triangles free. `posed` are the triangles in the middle of
/// the box.
///
/// All differences of a point of the second triangle and one of the first, for all weights in the box, have a convex hull. A direction
/// proves the triangles free if the hull is beyond a plane across it. The best direction is that of the hull's point closest to the origin,
/// which is approached as by Frank and Wolfe (1956), with one earlier point kept.
fn best_gap(pair: &Pair, posed: &[Triangle; 2], part: &[[f32; 2]]) -> Option<Gap> {
    let [a, b] = posed;
    let closest = closest_of_triangles(a, b);
    let mut point = closest.on_b - closest.on_a;
    let mut earlier = point;
    let mut best: Option<Gap> = None;
    for _ in 0..DIRECTIONS {
        let direction = point.normalize_or_zero();
        if direction == DVec3::ZERO {
            break;
        }
        let gap = pair.gap(direction, part);
        if gap.bound > 0.0 {
            return None;
        }
        if best.is_none_or(|best| gap.bound > best.bound) {
            best = Some(gap);
        }
        let nearest = pair.difference(&gap, part);
        let next = closest_on_triangle(DVec3::ZERO, &[point, nearest, earlier]).point;
        if next.length_squared() >= point.length_squared() {
            break;
        }
        (earlier, point) = (nearest, next);
    }
    // Triangles that nearly touch in the middle of the box have no direction.
    best.or_else(|| Some(pair.gap(DVec3::X, part)))
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
