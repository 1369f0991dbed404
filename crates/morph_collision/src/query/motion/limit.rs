//! A bound on the work of a query.

use std::cell::Cell;
use std::ops::ControlFlow;

use thiserror::Error;

use crate::query::QueryStats;

/// A query reached its limit ([`MotionQuery::with_limit`](super::MotionQuery::with_limit)) before it had an answer.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error(
    "the limit of work was reached; nothing touches before {not_before} of the motion, and whether anything does later is not known"
)]
pub struct LimitReached {
    /// Nothing touches before this time, as a share of the motion. Often 0, unless the query looks for the first contact.
    pub not_before: f64,
}

/// The limit of a query that was given none: minutes of work.
pub(super) const DEFAULT_LIMIT: u64 = 1 << 36;

/// The work of a query so far, in steps. A step is a test of two boxes of nodes or triangles, a few nanoseconds. The other numbers are
/// what tests of features take in comparison (docs/measurements/motion.md).
pub(super) fn steps(stats: &QueryStats) -> u64 {
    const FEATURES: u64 = 64;
    const AT_ENDS: u64 = 500 - FEATURES;
    const EXACT_BIT: u64 = 200;
    stats.node_tests
        + stats.triangle_tests
        + FEATURES * stats.feature_tests
        + AT_ENDS * stats.feature_tests_at_ends
        + EXACT_BIT * stats.exact_bits
}

/// The most work of a walk, in [`steps`].
#[derive(Debug)]
pub(super) struct Limit {
    pub(super) most: u64,
    is_cut: Cell<bool>,
}

impl Limit {
    pub(super) fn new(most: u64) -> Self {
        Self {
            most,
            is_cut: Cell::new(false),
        }
    }

    /// Breaks if there was more work than allowed.
    pub(super) fn check(&self, stats: &QueryStats) -> ControlFlow<()> {
        if steps(stats) > self.most {
            self.cut()
        } else {
            ControlFlow::Continue(())
        }
    }

    pub(super) fn cut(&self) -> ControlFlow<()> {
        self.is_cut.set(true);
        ControlFlow::Break(())
    }

    /// Whether a walk was broken.
    pub(super) fn is_cut(&self) -> bool {
        self.is_cut.get()
    }
}
