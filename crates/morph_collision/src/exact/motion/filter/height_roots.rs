//! The most frequent case after separation: the height has few roots, so there are few times to look at.

use super::relative::{COARSEST, Relative, level};
use crate::exact::motion::answer::Answer;
use crate::exact::motion::bernstein::halves;
use crate::exact::motion::moving::TimeOfImpact;
use crate::exact::number::{UNIT_ROUNDOFF, power_of_two};

/// The height on the interval of length `2^-depth` that starts at `start / 2^depth`.
#[derive(Clone, Copy)]
struct Part {
    height: [f64; 4],
    start: u64,
    depth: u32,
}

/// Decides at the roots of the height, earlier ones first. `None` if one of the needed signs is not certain.
///
/// The interval is halved until each part has no root or one. By Descartes' rule, the Bernstein coefficients of a part with one change
/// of sign show one root.
#[inline]
pub(in crate::exact::motion) fn decide_at_roots(relative: &Relative, tolerance: Option<f64>) -> Option<Answer> {
    // Three roots that are not very close are apart by then.
    const DEEPEST_PART: usize = 8;
    let level = level(tolerance.unwrap_or(COARSEST))?;
    let whole = Part {
        height: relative.height,
        start: 0,
        depth: 0,
    };
    let (mut waiting, mut count) = ([whole; DEEPEST_PART + 1], 1);
    while count > 0 {
        count -= 1;
        let part = waiting[count];
        let limit = relative.errors.height(part.depth);
        let signs = part.height.map(|c| i32::from(c > limit) - i32::from(c < -limit));
        let changes = signs.windows(2).filter(|pair| pair[0] != pair[1]).count();
        let is_certain = !signs.contains(&0);
        if is_certain && changes == 0 {
            continue;
        }
        if is_certain && changes == 1 {
            match part.decide_at_root(relative, level)? {
                Answer::Contact(time) => return Some(Answer::Contact(time)),
                _ => continue,
            }
        }
        if signs == [0; 4] || part.depth as usize == DEEPEST_PART {
            return None;
        }
        let [left, right] = halves(&part.height.map(|c| [c])).map(|half| half.map(|[c]| c));
        let (start, depth) = (2 * part.start, part.depth + 1);
        waiting[count] = Part {
            height: right,
            start: start + 1,
            depth,
        };
        waiting[count + 1] = Part {
            height: left,
            start,
            depth,
        };
        count += 2;
    }
    Some(Answer::Apart)
}

impl Part {
    /// Decides at the only root of this part.
    ///
    /// It is bracketed between two neighbouring multiples of `2^-level`. On this short interval the sides differ from their values at
    /// its start by a bounded amount.
    #[inline]
    fn decide_at_root(&self, relative: &Relative, level: u32) -> Option<Answer> {
        let start = self.bracket(relative, level)?;
        let unit = power_of_two(-i64::from(level));
        let time = start as f64 * unit;
        // Sides are sums of at most 36 products of four vectors, each of which changes by at most twice its size.
        let change = 288.0 * unit / UNIT_ROUNDOFF;
        let error = relative.errors.side * (SIDES_AT + change);
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

    /// The start of the interval of length `2^-level` that holds the root, in units of its length.
    #[inline]
    fn bracket(&self, relative: &Relative, level: u32) -> Option<u64> {
        let count = 1_u64 << (level - self.depth);
        let guess = (estimate(&self.height) * count as f64) as u64;
        let first = guess.min(count - 1);
        // The error of the coefficients, and of three steps of de Casteljau's algorithm with three roundings each, of values below 6.
        let limit = relative.errors.height(self.depth + 3);
        let is_before = |multiple: u64| {
            let value = at(&self.height, multiple as f64 / count as f64);
            let is_certain = value.abs() > limit;
            is_certain.then_some((value > 0.0) == (self.height[0] > 0.0))
        };
        (is_before(first)? && !is_before(first + 1)?).then_some(self.start * count + first)
    }
}

/// The error bound of [`sides_at`], in units of [`Errors::side`](super::relative::Errors::side).
pub(super) const SIDES_AT: f64 = 800.0;

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
pub(super) fn sides_at(relative: &Relative, time: f64) -> [f64; 4] {
    let rest = 1.0 - time;
    let [u, v, w] = [&relative.u, &relative.v, &relative.w].map(|linear| linear[0] * rest + linear[1] * time);
    let n = u.cross(v);
    relative.kind.sides(n.dot(n), w.cross(v).dot(n), u.cross(w).dot(n))
}
