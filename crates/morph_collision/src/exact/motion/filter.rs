//! The decision in `f64` with error bounds, by subdivision of the time. `docs/numerics.md` (Motion) derives the bounds.

use glam::DVec3;

use super::bernstein::{Linear, cross, dot_linear, dot_quadratic, halves};
use super::features::{Features, Kind};
use super::moving::TimeOfImpact;
use crate::exact::number::{UNIT_ROUNDOFF, power_of_two};

/// What the filter found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Answer {
    /// No contact at any time.
    Apart,
    /// Contact. The interval contains the first time, if that was asked for, otherwise any time of contact.
    Contact(TimeOfImpact),
    /// A sign is not certain.
    Open,
}

/// Whether a plane across a coordinate axis separates the features at all times: the differences between their corners, and so
/// between any of their points, all have the same sign along that axis. The sign of a rounded difference is exact.
#[inline]
pub(super) fn separated(features: &Features) -> bool {
    let mut least = DVec3::INFINITY;
    let mut most = DVec3::NEG_INFINITY;
    for &[a, b] in features.kind.opposite() {
        let (a, b) = (&features.corners[a], &features.corners[b]);
        for difference in [b.start - a.start, b.end - a.end] {
            least = least.min(difference);
            most = most.max(difference);
        }
    }
    least.cmpgt(DVec3::ZERO).any() || most.cmplt(DVec3::ZERO).any()
}

/// The polynomials on an interval, as Bernstein coefficients.
#[derive(Clone, Copy)]
struct Interval {
    /// `n . w`.
    height: [[f64; 1]; 4],
    /// Four polynomials side by side. If they are positive, so is `n . n`, and the parameters are in range. If one is negative,
    /// `n` is not zero, and a parameter is out of range.
    sides: [[f64; 4]; 5],
    /// The interval is of length `2^-depth` and starts at `start / 2^depth`.
    start: u64,
    depth: u32,
}

/// Searches for contact. With a tolerance, searches for the first one and narrows its time; otherwise any contact will do.
#[inline]
pub(super) fn subdivided(features: &Features, tolerance: Option<f64>) -> Answer {
    let kind = features.kind;
    let [u, v, w] = kind.spans().map(|[from, to]| -> Linear {
        let (from, to) = (&features.corners[from], &features.corners[to]);
        [to.start - from.start, to.end - from.end]
    });
    let [mu, mv, mw] = [&u, &v, &w].map(|linear| linear[0].abs().max(linear[1].abs()).max_element());
    // Within these limits nothing overflows, and underflow is far below the error.
    const IN_RANGE: std::ops::Range<f64> = power_of_two(-100)..power_of_two(100);
    if ![mu, mv, mw].iter().all(|size| IN_RANGE.contains(size)) {
        return Answer::Open;
    }
    let n = cross(&u, &v);
    let height = dot_linear(&n, &w);
    let scale = UNIT_ROUNDOFF * mu * mv;
    let errors = Errors {
        height: scale * mw,
        side: scale * (mu * mv).max(mv * mw).max(mu * mw),
    };
    let limit = errors.height(0);
    if height.iter().all(|c| *c > limit) || height.iter().all(|c| *c < -limit) {
        return Answer::Apart;
    }
    let normal = dot_quadratic(&n, &n);
    let p = dot_quadratic(&cross(&w, &v), &n);
    let q = dot_quadratic(&cross(&u, &w), &n);
    let sides = std::array::from_fn(|i| match kind {
        Kind::VertexFace => [p[i], q[i], normal[i] - p[i] - q[i], normal[i]],
        Kind::EdgeEdge => [p[i], normal[i] - p[i], -q[i], normal[i] + q[i]],
    });
    let height = height.map(|c| [c]);
    let whole = Interval {
        height,
        sides,
        start: 0,
        depth: 0,
    };
    search(whole, &errors, tolerance)
}

/// The errors of the coefficients, in units that depend on the size of the features.
struct Errors {
    height: f64,
    side: f64,
}

impl Errors {
    /// The error bound of the coefficients of the height after so many halvings.
    #[inline(always)]
    fn height(&self, depth: u32) -> f64 {
        self.height * f64::from(80 + 20 * depth)
    }

    #[inline(always)]
    fn side(&self, depth: u32) -> f64 {
        self.side * f64::from(700 + 150 * depth)
    }
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
    fn halves(&self) -> [Self; 2] {
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

    fn time(&self) -> TimeOfImpact {
        // Exact: the depth is far below 52.
        let unit = power_of_two(-i64::from(self.depth));
        TimeOfImpact {
            earliest: self.start as f64 * unit,
            latest: (self.start + 1) as f64 * unit,
        }
    }
}

/// Visits intervals, earlier ones first.
fn search(whole: Interval, errors: &Errors, tolerance: Option<f64>) -> Answer {
    // Intervals that the search may visit. It is cheaper than exact arithmetic up to here.
    const BUDGET: usize = 256;
    const DEEPEST: u32 = 40;
    let mut later = Vec::new();
    let mut interval = whole;
    let mut is_open = false;
    for _ in 0..BUDGET {
        let is_deepest = interval.depth >= DEEPEST;
        let is_done = match interval.verdict(errors) {
            Verdict::Apart => true,
            Verdict::Contact => {
                let time = interval.time();
                if tolerance.is_none_or(|tolerance| time.latest - time.earliest <= tolerance) {
                    return Answer::Contact(time);
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
