//! The earliest of the contacts found so far.

use super::TimeOfImpact;
use super::limit::{LimitReached, steps};
use crate::query::QueryStats;

/// The steps of work ([`steps`]) after the first contact was found in which contacts are compared that begin at about the same time.
const STEPS_FOR_TIES: u64 = 100_000;

/// The earliest contact so far, in a search for the first one.
pub(super) struct Earliest<T> {
    tolerance: f64,
    contact: Option<(TimeOfImpact, T)>,
    /// Nothing that was added touches before this time. Times of balls may be long intervals, so one that is later at its end may be
    /// earlier at its start.
    not_before: f64,
    /// The work until the first contact was found.
    steps: u64,
    /// Whether contacts are left out that begin less than the tolerance before this one.
    is_hurried: bool,
}

impl<T> Earliest<T> {
    /// NaN and negative tolerances count as 0.
    pub(super) fn new(tolerance: f64) -> Self {
        Self {
            tolerance: tolerance.max(0.0),
            contact: None,
            not_before: 1.0,
            steps: 0,
            is_hurried: false,
        }
    }

    /// Adds a contact; returns whether it is the earliest now. Among equals, the key decides, so that the answer depends on no tree.
    pub(super) fn add<K: PartialOrd>(
        &mut self,
        time: TimeOfImpact,
        contact: T,
        key: impl Fn(&T) -> K,
        stats: &QueryStats,
    ) -> bool {
        self.not_before = self.not_before.min(time.earliest);
        let order = |time: &TimeOfImpact, contact: &T| (time.latest, time.earliest, key(contact));
        match &self.contact {
            None => self.steps = steps(stats),
            Some((first_time, first)) if order(first_time, first) <= order(&time, &contact) => return false,
            Some(_) => {}
        }
        self.contact = Some((time, contact));
        true
    }

    /// Features that touch only later need not be looked at. `stats` is the work so far.
    pub(super) fn latest(&mut self, stats: &QueryStats) -> f64 {
        let Some((time, _)) = &self.contact else { return 1.0 };
        self.is_hurried |= steps(stats) - self.steps > STEPS_FOR_TIES;
        if self.is_hurried {
            self.before(time.latest)
        } else {
            time.latest
        }
    }

    /// The earliest time that differs from this one by at most the tolerance.
    fn before(&self, latest: f64) -> f64 {
        let earliest = latest - self.tolerance;
        if latest - earliest > self.tolerance {
            earliest.next_up()
        } else {
            earliest
        }
    }

    /// The contact, and an interval that contains the first time of contact.
    pub(super) fn found(self, walked: Result<(), LimitReached>) -> Result<Option<(TimeOfImpact, T)>, LimitReached> {
        let not_before = match (&self.contact, walked) {
            (None, walked) => return walked.map(|()| None),
            (Some(_), Err(LimitReached { not_before })) => not_before,
            (Some((time, _)), Ok(())) if self.is_hurried => self.before(time.latest).max(0.0),
            (Some((time, _)), Ok(())) => time.earliest,
        };
        Ok(self.contact.map(|(time, contact)| {
            let earliest = self.not_before.min(not_before);
            (TimeOfImpact { earliest, ..time }, contact)
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_interval_is_not_forgotten_for_a_short_one_that_ends_earlier() {
        let time = |earliest, latest| TimeOfImpact { earliest, latest };
        let (long, short) = (time(0.5, 1.0), time(0.84, 0.85));
        for order in [[long, short], [short, long]] {
            let mut earliest = Earliest::new(1e-6);
            for time in order {
                earliest.add(time, time.latest, |latest| *latest, &QueryStats::default());
            }
            let found = earliest.found(Ok(())).unwrap();
            assert_eq!(found, Some((time(0.5, 0.85), 0.85)));
        }
    }
}
