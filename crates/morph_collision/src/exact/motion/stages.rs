//! Counts of which stage decided.

/// How many queries each stage decided. Add up as many queries as you like in one value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StageCounts {
    /// Queries without contact, because an axis of space separates the features at all times.
    pub separated: u64,
    /// Other queries that `f64` with error bounds decided.
    pub filtered: u64,
    /// Queries that neither decided, because the features touch at the start, or are degenerate at the start or at the end.
    pub at_ends: u64,
    /// Queries that needed exact polynomials.
    pub exact: u64,
    /// The sum of the bits that the coordinates of these queries take as whole numbers, roughly. The time grows with it: about half a
    /// microsecond per bit.
    pub exact_bits: u64,
}

impl StageCounts {
    /// The number of queries.
    #[must_use]
    pub const fn total(&self) -> u64 {
        self.separated + self.filtered + self.at_ends + self.exact
    }
}
