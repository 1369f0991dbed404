use std::cmp::Ordering;
use std::ops::AddAssign;

use super::AnswerSource;

/// The counts of a comparison.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Situations compared.
    pub frames: u64,
    /// Pairs of triangles that intersect.
    pub pairs_truth: u64,
    /// Intersecting pairs that are missing from the answer.
    pub missed: u64,
    /// Pairs in the answer that do not intersect or are repeated.
    pub spurious: u64,
    /// Pairs of triangles that the core's own filters could not decide, so that it needed exact arithmetic.
    pub undecided_by_filter: u64,
    /// Number of checks of a vertex against a box that should contain it.
    pub containment_checks: u64,
    /// Number of these checks in which the vertex was outside.
    pub containment_violations: u64,
}

impl Counts {
    /// Number of wrong answers; it should be 0.
    #[must_use]
    pub fn differences(&self) -> u64 {
        self.missed + self.spurious + self.containment_violations
    }
}

impl AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        self.frames += other.frames;
        self.pairs_truth += other.pairs_truth;
        self.missed += other.missed;
        self.spurious += other.spurious;
        self.undecided_by_filter += other.undecided_by_filter;
        self.containment_checks += other.containment_checks;
        self.containment_violations += other.containment_violations;
    }
}

/// One error in an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trouble {
    /// A pair of triangles that intersect and is missing from the answer.
    Missed(u32, u32),
    /// A pair of triangles in the answer that does not intersect, or is repeated.
    Spurious(u32, u32),
    /// A vertex of a body, 0 or 1, is outside a box above it.
    Outside {
        /// The body.
        body: usize,
        /// The vertex of its mesh.
        vertex: u32,
    },
}

/// Compares a source's answer about its current situation with the truth, which is ascending. Returns the counts and the
/// first error.
pub fn judge(truth: &[(u32, u32)], source: &mut impl AnswerSource) -> (Counts, Option<Trouble>) {
    let answer = source.answer();
    let (missed, spurious) = differences(truth, &answer.pairs);
    let mut counts = Counts {
        frames: 1,
        pairs_truth: truth.len() as u64,
        missed: missed.len() as u64,
        spurious: spurious.len() as u64,
        undecided_by_filter: answer.stats.undecided_by_filter,
        ..Counts::default()
    };
    let missed = missed.first().map(|&(a, b)| Trouble::Missed(a, b));
    let spurious = spurious.first().map(|&(a, b)| Trouble::Spurious(a, b));
    let mut trouble = missed.or(spurious);
    for body in 0..2 {
        let report = source.containment(body);
        counts.containment_checks += report.checks;
        counts.containment_violations += report.violations;
        let outside = report.first.map(|violation| Trouble::Outside {
            body,
            vertex: violation.vertex,
        });
        trouble = trouble.or(outside);
    }
    (counts, trouble)
}

pub(super) type Pairs = Vec<(u32, u32)>;

/// The elements that are only in the first of two ascending lists, and those that are only in the second.
pub(super) fn differences(truth: &[(u32, u32)], answer: &[(u32, u32)]) -> (Pairs, Pairs) {
    let (mut missed, mut spurious) = (Vec::new(), Vec::new());
    let (mut truth, mut answer) = (truth.iter().copied().peekable(), answer.iter().copied().peekable());
    loop {
        let order = match (truth.peek(), answer.peek()) {
            (Some(of_truth), Some(of_answer)) => of_truth.cmp(of_answer),
            (Some(_), None) => Ordering::Less,
            (None, Some(_)) => Ordering::Greater,
            (None, None) => return (missed, spurious),
        };
        match order {
            Ordering::Less => missed.extend(truth.next()),
            Ordering::Greater => spurious.extend(answer.next()),
            Ordering::Equal => {
                truth.next();
                answer.next();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_are_compared_pair_for_pair() {
        let truth = [(0, 1), (0, 2), (3, 0), (5, 5)];
        assert_eq!(differences(&truth, &truth), (vec![], vec![]));
        let answer = [(0, 0), (0, 2), (0, 2), (3, 0), (9, 9)];
        assert_eq!(
            differences(&truth, &answer),
            (vec![(0, 1), (5, 5)], vec![(0, 0), (0, 2), (9, 9)])
        );
        assert_eq!(differences(&[], &answer[..1]), (vec![], vec![(0, 0)]));
        assert_eq!(differences(&truth[..1], &[]), (vec![(0, 1)], vec![]));
    }
}
