use morph_collision::BuildOptions;
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

use super::panics::caught;
use super::work_rate::WorkRate;
use super::{Case, Family, knock};
use crate::rivals::SetUpError;
use crate::verify::{AnswerSource, Counts, LEAF_SIZES, Trees, judge};

/// The results of a family.
#[derive(Clone, Debug, PartialEq)]
pub struct FamilyReport {
    /// The family.
    pub family: Family,
    /// Cases tried.
    pub cases: u64,
    /// Answers compared with the truth, and boxes with vertices.
    pub counts: Counts,
    /// Bad input that was refused with an error that names it.
    pub errors_reported: u64,
    /// Bad input that was accepted or not named, and good input that was refused.
    pub unexpected: u64,
    /// Cases that ended in a panic.
    pub panics: u64,
    /// The slowest case, as a multiple of an ordinary one with as many intersecting pairs.
    pub worst_slowdown: f64,
    /// The first thing that went wrong.
    pub first: Option<String>,
}

impl FamilyReport {
    /// Whether nothing went wrong.
    #[must_use]
    pub fn is_clean(&self) -> bool {
        self.counts.differences() + self.unexpected + self.panics == 0
    }
}

/// Tries `cases` cases of every family, with trees of each of [`LEAF_SIZES`] in turn. Calls `progress` after
/// each.
///
/// The same seed gives the same cases; only times differ. Panics are caught. To silence their messages, hold a
/// [`Silence`](super::Silence).
pub fn stress(cases: u64, seed: u64, mut progress: impl FnMut()) -> Vec<FamilyReport> {
    let ordinary = LEAF_SIZES.map(|leaf_size| caught(|| WorkRate::ordinary(leaf_size, seed)).ok().flatten());
    let family = |family| {
        let mut report = FamilyReport::new(family);
        for index in 0..cases {
            report.take(index, seed, &ordinary);
            progress();
        }
        report
    };
    Family::ALL.map(family).to_vec()
}

/// The result of one case.
#[derive(Debug, Default)]
struct Outcome {
    counts: Counts,
    errors_reported: u64,
    unexpected: Option<String>,
    slowdown: f64,
    trouble: Option<String>,
}

impl FamilyReport {
    fn new(family: Family) -> Self {
        Self {
            family,
            cases: 0,
            counts: Counts::default(),
            errors_reported: 0,
            unexpected: 0,
            panics: 0,
            worst_slowdown: 0.0,
            first: None,
        }
    }

    fn take(&mut self, index: u64, seed: u64, ordinary: &[Option<WorkRate>; LEAF_SIZES.len()]) {
        let tree = (index % LEAF_SIZES.len() as u64) as usize;
        let family = self.family;
        let outcome = caught(|| tried(family, index, seed, LEAF_SIZES[tree], ordinary[tree].as_ref()));
        self.cases += 1;
        let trouble = match outcome {
            Ok(outcome) => {
                self.counts += outcome.counts;
                self.errors_reported += outcome.errors_reported;
                self.unexpected += u64::from(outcome.unexpected.is_some());
                self.worst_slowdown = self.worst_slowdown.max(outcome.slowdown);
                outcome.trouble.or(outcome.unexpected)
            }
            Err(message) => {
                self.panics += 1;
                Some(format!("panic: {message}"))
            }
        };
        if self.first.is_none() {
            let leaf = LEAF_SIZES[tree];
            let case = format!("{family}, case {index} of seed {seed}, leaves of {leaf}");
            self.first = trouble.map(|trouble| format!("{case}: {trouble}"));
        }
    }
}

fn tried(family: Family, index: u64, seed: u64, leaf_size: usize, ordinary: Option<&WorkRate>) -> Outcome {
    let case = Case::new(family, index, seed);
    let meshes = [&case.meshes[0], &case.meshes[1]];
    let mut outcome = Outcome::default();
    let options = BuildOptions::default()
        .with_leaf_size(leaf_size)
        .map_err(SetUpError::from);
    let mut trees = match options.and_then(|options| Trees::build(meshes, &options)) {
        Ok(trees) => trees,
        Err(error) => {
            outcome.unexpected = Some(format!("refused: {error}"));
            return outcome;
        }
    };
    if let Err(error) = trees.set(&case.situation) {
        outcome.unexpected = Some(format!("refused: {error}"));
        return outcome;
    }
    if family == Family::BadInput {
        // Fills the caches with part of the last good state before the bad input comes in.
        trees.touches();
        let rng = &mut Pcg64Mcg::seed_from_u64(seed ^ index << 32);
        match knock(index, rng, &case, &mut trees) {
            Ok(()) => outcome.errors_reported = 1,
            Err(complaint) => outcome.unexpected = Some(complaint),
        }
    }
    let (counts, trouble) = judge(&case.situation.truth(meshes), &mut trees);
    outcome.counts = counts;
    outcome.trouble = trouble.map(|trouble| format!("{trouble:?}"));
    if let (Some(pace), Some(ordinary)) = (WorkRate::of(&trees, &case.situation), ordinary) {
        outcome.slowdown = pace.slowdown(ordinary);
    }
    outcome
}
