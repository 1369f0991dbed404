//! The most frequent case after separation: the height changes its sign once, so there is one time to look at.

use super::filter::{Answer, Relative};
use super::moving::TimeOfImpact;
use crate::exact::number::{UNIT_ROUNDOFF, power_of_two};

/// Decides if the height has exactly one root, all of whose signs are certain. Otherwise `None`.
///
/// By Descartes' rule, one change of sign in the Bernstein coefficients means one root. It is bracketed between two neighbouring
/// multiples of `2^-level`. On this short interval the sides differ from their values at its start by a bounded amount.
#[inline]
pub(super) fn single_root(relative: &Relative, tolerance: Option<f64>) -> Option<Answer> {
    let (start, level) = bracket(relative, tolerance)?;
    let unit = power_of_two(-i64::from(level));
    let time = start as f64 * unit;
    // Sides are sums of at most 36 products of four vectors, each of which changes by at most twice its size.
    let change = 288.0 * unit / UNIT_ROUNDOFF;
    let error = relative.errors.side * (800.0 + change);
    let sides = sides_at(relative, time);
    if sides.iter().any(|side| *side < -error) {
        return Some(Answer::Apart);
    }
    let touches = sides.iter().all(|side| *side > error);
    touches.then_some(Answer::Contact(TimeOfImpact {
        earliest: time,
        latest: (start + 1) as f64 * unit,
    }))
}

/// The interval of length `2^-level` that holds the only root of the height, as its start in units of its length, and the level.
#[inline]
fn bracket(relative: &Relative, tolerance: Option<f64>) -> Option<(u64, u32)> {
    let height = &relative.height;
    let limit = relative.errors.height(0);
    let signs = height.map(|c| {
        if c > limit {
            1
        } else if c < -limit {
            -1
        } else {
            0
        }
    });
    let changes = signs.windows(2).filter(|pair| pair[0] != pair[1]).count();
    if signs.contains(&0) || changes != 1 {
        return None;
    }
    let level = match tolerance {
        None => LEVEL,
        Some(tolerance) => (LEVEL..=DEEPEST).find(|level| power_of_two(-i64::from(*level)) <= tolerance)?,
    };
    let count = 1_u64 << level;
    let guess = (estimate(height) * count as f64) as u64;
    let start = guess.min(count - 1);
    // The error of the coefficients, and of three steps of de Casteljau's algorithm with three roundings each, of values below 6.
    let limit = relative.errors.height(3);
    let is_before = |multiple: u64| {
        let value = at(height, multiple as f64 / count as f64);
        let is_certain = value.abs() > limit;
        is_certain.then_some((value > 0.0) == (signs[0] > 0))
    };
    (is_before(start)? && !is_before(start + 1)?).then_some((start, level))
}

/// Brackets are of length `2^-30`, unless the tolerance is shorter. Few contacts are that close to the boundary of a feature.
const LEVEL: u32 = 30;
const DEEPEST: u32 = 40;

/// Roughly where a cubic with one change of sign is zero, in [0, 1]. Newton's method, kept in a shrinking interval.
#[inline]
fn estimate(&[a, b, c, d]: &[f64; 4]) -> f64 {
    // The cubic in powers of the time.
    let (first, second, third) = (3.0 * (b - a), 3.0 * (a - 2.0 * b + c), d - a + 3.0 * (b - c));
    let (mut low, mut high) = (0.0_f64, 1.0_f64);
    let mut time = a / (a - d);
    for _ in 0..STEPS {
        let value = ((third * time + second) * time + first) * time + a;
        if (value > 0.0) == (a > 0.0) {
            low = time;
        } else {
            high = time;
        }
        let slope = (3.0 * third * time + 2.0 * second) * time + first;
        let next = time - value / slope;
        let next = if next >= low && next <= high {
            next
        } else {
            low.midpoint(high)
        };
        let is_close = (next - time).abs() < CLOSE;
        time = next;
        if is_close {
            break;
        }
    }
    time
}

const STEPS: usize = 12;
/// After a step this short, Newton's next one is below the accuracy of `f64`.
const CLOSE: f64 = power_of_two(-26);

/// The value of the height (de Casteljau). `time` has few enough bits that `1 - time` is exact.
#[inline]
fn at(&[a, b, c, d]: &[f64; 4], time: f64) -> f64 {
    let rest = 1.0 - time;
    let mix = |a: f64, b: f64| rest * a + time * b;
    let (a, b, c) = (mix(a, b), mix(b, c), mix(c, d));
    let (a, b) = (mix(a, b), mix(b, c));
    mix(a, b)
}

/// The four sides at a time.
#[inline]
fn sides_at(relative: &Relative, time: f64) -> [f64; 4] {
    let rest = 1.0 - time;
    let [u, v, w] = [&relative.u, &relative.v, &relative.w].map(|linear| linear[0] * rest + linear[1] * time);
    let n = u.cross(v);
    relative.kind.sides(n.dot(n), w.cross(v).dot(n), u.cross(w).dot(n))
}
