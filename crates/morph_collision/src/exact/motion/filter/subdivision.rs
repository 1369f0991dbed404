//! Subdivision of the time: polynomials on ever shorter intervals, until their signs are certain.

use super::relative::{DEEPEST, Errors, Relative, level};
use crate::exact::motion::answer::Answer;
use crate::exact::motion::bernstein::{cross, dot_quadratic, halves};
use crate::exact::motion::moving::TimeOfImpact;
use crate::exact::number::power_of_two;

/// The polynomials on an interval, as Bernstein coefficients.
#[derive(Clone, Copy)]
pub(super) struct Interval {
    /// `n . w`.
    pub(super) height: [[f64; 1]; 4],
    /// Four polynomials side by side. If they are positive, so is `n . n`, and the parameters are in range. If one is negative,
    /// `n` is not zero, and a parameter is out of range.
    pub(super) sides: [[f64; 4]; 5],
    /// The interval is of length `2^-depth` and starts at `start / 2^depth`.
    start: u64,
    depth: u32,
}

/// What the coefficients show about an interval.
enum Verdict {
    Apart,
    Contact,
    /// Halves may be clearer.
    Unclear,
    /// Halves cannot be clearer.
    Hopeless,
}

impl Interval {
    pub(super) fn whole(relative: &Relative) -> Self {
        let Relative { kind, u, v, w, n, .. } = relative;
        let normal = dot_quadratic(n, n);
        let p = dot_quadratic(&cross(w, v), n);
        let q = dot_quadratic(&cross(u, w), n);
        Self {
            height: relative.height.map(|c| [c]),
            sides: std::array::from_fn(|i| kind.sides(normal[i], p[i], q[i])),
            start: 0,
            depth: 0,
        }
    }

    #[inline(always)]
    fn verdict(&self, errors: &Errors) -> Verdict {
        let error = errors.height(self.depth);
        let above = self.height.iter().filter(|[c]| *c > error).count();
        let below = self.height.iter().filter(|[c]| *c < -error).count();
        if above == 4 || below == 4 {
            return Verdict::Apart;
        }
        let error = errors.side(self.depth);
        let (mut positive, mut negative, mut any_negative) = ([true; 4], [true; 4], false);
        for row in &self.sides {
            for lane in 0..4 {
                positive[lane] &= row[lane] > error;
                let is_below = row[lane] < -error;
                negative[lane] &= is_below;
                any_negative |= is_below;
            }
        }
        if negative.contains(&true) {
            return Verdict::Apart;
        }
        if above + below == 0 && !any_negative {
            return Verdict::Hopeless;
        }
        if positive == [true; 4] && self.crosses(errors) {
            Verdict::Contact
        } else {
            Verdict::Unclear
        }
    }

    /// Whether the height has opposite signs at the ends, for certain.
    #[inline(always)]
    fn crosses(&self, errors: &Errors) -> bool {
        let error = errors.height(self.depth);
        let [[first], .., [last]] = self.height;
        first.min(last) < -error && first.max(last) > error
    }

    #[inline(always)]
    pub(super) fn halves(&self) -> [Self; 2] {
        let [left_height, right_height] = halves(&self.height);
        let [left_sides, right_sides] = halves(&self.sides);
        let (start, depth) = (2 * self.start, self.depth + 1);
        [
            Self {
                height: left_height,
                sides: left_sides,
                start,
                depth,
            },
            Self {
                height: right_height,
                sides: right_sides,
                start: start + 1,
                depth,
            },
        ]
    }

    /// The interval of length `2^-level` that holds this one. `level` must be at most the depth.
    pub(super) fn time(&self, level: u32) -> TimeOfImpact {
        let start = self.start >> (self.depth - level);
        // Exact: the level is far below 52.
        let unit = power_of_two(-i64::from(level));
        TimeOfImpact {
            earliest: start as f64 * unit,
            latest: (start + 1) as f64 * unit,
        }
    }
}

/// Visits intervals, earlier ones first. With a tolerance, searches for the first contact and narrows its time; otherwise any contact
/// will do.
pub(super) fn search(relative: &Relative, tolerance: Option<f64>) -> Answer {
    // Intervals that the search may visit. It is cheaper than exact arithmetic up to here.
    const BUDGET: usize = 256;
    let mut later = Vec::new();
    let mut interval = Interval::whole(relative);
    let errors = &relative.errors;
    let wanted = tolerance.map(level);
    let mut is_open = false;
    for _ in 0..BUDGET {
        let is_deepest = interval.depth >= DEEPEST;
        let is_done = match interval.verdict(errors) {
            Verdict::Apart => true,
            Verdict::Contact => {
                match wanted {
                    None => return Answer::Contact(interval.time(interval.depth)),
                    Some(Some(level)) if interval.depth >= level => return Answer::Contact(interval.time(level)),
                    Some(_) => {}
                }
                if is_deepest {
                    return Answer::Open;
                }
                false
            }
            Verdict::Unclear if !is_deepest => false,
            // A later contact may still answer whether there is any.
            Verdict::Unclear | Verdict::Hopeless if tolerance.is_none() => {
                is_open = true;
                true
            }
            Verdict::Unclear | Verdict::Hopeless => return Answer::Open,
        };
        if is_done {
            match later.pop() {
                Some(next) => interval = next,
                None if is_open => return Answer::Open,
                None => return Answer::Apart,
            }
        } else {
            let [left, right] = interval.halves();
            later.push(right);
            interval = left;
        }
    }
    Answer::Open
}
