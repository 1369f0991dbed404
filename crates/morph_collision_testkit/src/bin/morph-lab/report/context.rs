//! How much is measured, and where the rows come from.

use morph_collision_testkit::report::Store;

/// The input of every topic.
pub(crate) struct Context {
    /// Use every Nth step of an experiment.
    pub(crate) every: usize,
    pub(crate) rounds: usize,
    /// Whether rough numbers are enough.
    pub(crate) quick: bool,
    /// The day, the commit and the machine.
    pub(crate) origin: String,
    pub(crate) store: Store,
}

impl Context {
    /// What a row of times says about its origin.
    pub(crate) fn timed(&self, every: usize, rounds: usize) -> String {
        let steps = match every {
            1 => "every step".to_owned(),
            every => format!("every {every}th step"),
        };
        let rounds = match rounds {
            1 => "one round".to_owned(),
            rounds => format!("medians of {rounds} rounds"),
        };
        format!("{}: {steps}, {rounds}", self.origin)
    }
}
