//! How much a pair of bodies is asked for.

/// How many of two bodies' intersecting triangle pairs to find.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wanted {
    /// All of them.
    #[default]
    All,
    /// At most this many: the pairs that [`PairQuery::up_to`](crate::PairQuery::up_to) finds. [`BatchAnswers::is_truncated`](super::BatchAnswers::is_truncated)
    /// says whether there are more.
    UpTo(usize),
    /// One: the pair that [`PairQuery::first`](crate::PairQuery::first) finds.
    First,
}

impl Wanted {
    /// The maximum length of the list.
    #[must_use]
    pub fn limit(self) -> usize {
        match self {
            Self::All => usize::MAX,
            Self::UpTo(limit) => limit,
            Self::First => 1,
        }
    }
}
