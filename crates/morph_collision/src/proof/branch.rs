//! Branch and bound: splits a box of weights until two triangles are proved free in every part, or touch in one.

use glam::DVec3;

use super::pair::{Gap, Pair};
use crate::exact::{Triangle, closest_of_triangles, triangles_intersect, unit_normal};

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
fn best_gap(pair: &Pair, posed: &[Triangle; 2], part: &[[f32; 2]]) -> Option<Gap> {
    let [a, b] = posed;
    let closest = closest_of_triangles(a, b);
    let between = closest.on_b - closest.on_a;
    let towards = |direction: DVec3| {
        if direction.dot(between) < 0.0 {
            -direction
        } else {
            direction
        }
    };
    let directions = [
        between.normalize_or_zero(),
        unit_normal(a),
        unit_normal(b),
        DVec3::X,
        DVec3::Y,
        DVec3::Z,
    ];
    let mut best: Option<Gap> = None;
    for direction in directions {
        let gap = pair.gap(towards(direction), part);
        if gap.bound > 0.0 {
            return None;
        }
        if best.is_none_or(|best| gap.bound > best.bound) && direction != DVec3::ZERO {
            best = Some(gap);
        }
    }
    best
}

/// Halves the interval that changes the gap most; `None` if no interval that changes it can be halved.
fn split(pair: &Pair, gap: &Gap, part: Vec<[f32; 2]>) -> Option<[Vec<[f32; 2]>; 2]> {
    let changes = pair.slopes(gap).zip(&part).enumerate();
    let changes = changes.filter_map(|(index, (slope, &[low, high]))| {
        let middle = f32::midpoint(low, high);
        let change = slope.abs() * (f64::from(high) - f64::from(low));
        (change > 0.0 && low < middle && middle < high).then_some((change, index, middle))
    });
    let (_, index, middle) = changes.max_by(|one, other| one.0.total_cmp(&other.0))?;
    let (mut one, mut other) = (part.clone(), part);
    one[index][1] = middle;
    other[index][0] = middle;
    Some([one, other])
}
