use super::{AnswerSource, Counts, Draw, Meshes, Reproduction, judge, shrink};
use crate::rivals::PoseError;

/// How many wrong answers of a source are shrunk; the smallest is shown.
const MOST_SHRUNK: usize = 4;

/// The result of a comparison.
#[derive(Clone, Debug, Default)]
pub struct Verification {
    /// One set of counts per source.
    pub counts: Vec<Counts>,
    /// The smallest wrong answer, if there was any.
    pub smallest: Option<Finding>,
}

/// A wrong answer and its source.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// The index of the source.
    pub source: usize,
    /// The wrong answer.
    pub reproduction: Reproduction,
}

/// Compares several sources with brute force over `frames` situations of two meshes. Calls `progress` after each.
///
/// The truth is computed once per situation for all sources. The same seed and sources give the same situations.
///
/// # Errors
/// A source refuses a situation.
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
        // The sources take turns in searching for situations that nearly touch.
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
