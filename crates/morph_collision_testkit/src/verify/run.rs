use super::{AnswerSource, Counts, Draw, Meshes, Reproduction, judge, shrink};
use crate::rivals::PoseError;

/// How many wrong answers of a source are made small; the smallest is shown.
const MOST_SHRUNK: usize = 4;

/// What became of a comparison.
#[derive(Clone, Debug, Default)]
pub struct Verification {
    /// One per source.
    pub counts: Vec<Counts>,
    /// The smallest wrong answer, if there was any.
    pub smallest: Option<Finding>,
}

/// A wrong answer and whose it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// The index of the source.
    pub source: usize,
    /// The wrong answer.
    pub reproduction: Reproduction,
}

/// Compares each of some sources with brute force over `frames` situations of two meshes; `progress` is called after each.
///
/// The truth is found once per situation for all sources. The same seed gives the same situations for the same sources.
///
/// # Errors
/// A situation that a source refuses.
pub fn verify<S: AnswerSource>(
    meshes: Meshes<'_>,
    sources: &mut [S],
    frames: u64,
    seed: u64,
    mut progress: impl FnMut(),
) -> Result<Verification, PoseError> {
    let mut verification = Verification {
        counts: vec![Counts::default(); sources.len()],
        smallest: None,
    };
    let mut shrunk = vec![0; sources.len()];
    let (mut frame, mut round) = (0, 0);
    while frame < frames && !sources.is_empty() {
        // The sources take turns in the search for what nearly touches.
        let searcher = (round / 5 % sources.len() as u64) as usize;
        let situations = Draw::new(meshes, seed, round).situations(round, &mut sources[searcher])?;
        round += 1;
        for situation in situations.into_iter().take((frames - frame) as usize) {
            let truth = situation.truth(meshes);
            for (index, source) in sources.iter_mut().enumerate() {
                source.set(&situation)?;
                let (counts, trouble) = judge(&truth, source);
                verification.counts[index] += counts;
                if let Some(trouble) = trouble
                    && shrunk[index] < MOST_SHRUNK
                {
                    shrunk[index] += 1;
                    let reproduction = shrink(meshes, source, &situation, trouble);
                    let smallest = verification.smallest.as_ref();
                    if smallest.is_none_or(|finding| reproduction.size() < finding.reproduction.size()) {
                        verification.smallest = Some(Finding {
                            source: index,
                            reproduction,
                        });
                    }
                }
            }
            frame += 1;
            progress();
        }
    }
    Ok(verification)
}
