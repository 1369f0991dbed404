//! Random mixtures of targets: sums that a face can have.

use rand::seq::IteratorRandom;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::poses::Stage;
use super::subject::Subject;

/// A mixture of a few targets has from two to this many.
const MOST_ACTIVE: usize = 5;
/// How far a weight near a frame may be from that of the frame.
const NEAR: f32 = 0.2;
/// Each mixture has this many random numbers of its own, far more than it needs.
const NUMBERS: u128 = 1_000_003;

/// Mixtures of a few targets and, if there are clips or captures, weights near those of random frames: half of each.
pub(super) struct Mixtures<'a> {
    pub(super) count: usize,
    pub(super) seed: u64,
    /// The targets that move anything.
    pub(super) moving: Vec<usize>,
    /// The stages with weights to be near to.
    near: Vec<&'a Stage<'a>>,
}

impl<'a> Mixtures<'a> {
    pub(super) fn new(count: usize, seed: u64, moving: Vec<usize>, tried: &'a [Stage<'a>]) -> Self {
        let near = tried.iter().filter(|stage| stage.has_weights() && stage.len() > 0);
        Self {
            count,
            seed,
            moving,
            near: near.collect(),
        }
    }

    /// Draws the weights of a mixture. Targets that are not drawn keep the weights at rest, or those of the frame.
    pub(super) fn draw(&self, subject: &Subject, index: usize) -> Vec<f32> {
        let mut rng = Pcg64Mcg::seed_from_u64(self.seed);
        rng.advance(index as u128 * NUMBERS);
        let frames: usize = self.near.iter().map(|stage| stage.len()).sum();
        if frames > 0 && rng.random_bool(0.5) {
            let mut frame = rng.random_range(0..frames);
            for stage in &self.near {
                if frame < stage.len() {
                    return near(&mut rng, stage.weights(subject, frame));
                }
                frame -= stage.len();
            }
        }
        let mut weights = subject.mesh.weights_at_rest();
        let mut active = [0; MOST_ACTIVE];
        let count = rng.random_range(2..=MOST_ACTIVE);
        let drawn = self.moving.iter().copied().sample_fill(&mut rng, &mut active[..count]);
        for &target in &active[..drawn] {
            // Above 0, and at most 1.
            subject.set(&mut weights, target, 1.0 - rng.random::<f32>());
        }
        weights
    }
}

/// Changes the weights that are not 0, but not across 0 and not beyond 1.
fn near(rng: &mut Pcg64Mcg, mut weights: Vec<f32>) -> Vec<f32> {
    for weight in weights.iter_mut().filter(|weight| **weight != 0.0) {
        let (least, most) = (weight.min(0.0), weight.max(1.0));
        *weight = (*weight + rng.random_range(-NEAR..=NEAR)).clamp(least, most);
    }
    weights
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use morph_collision_models::clip::WeightAnimation;

    use morph_collision_models::mesh::MorphMesh;

    use super::*;
    use crate::files::clips::ClipChoice;
    use crate::options::frame_times::FrameTimes;

    fn subject() -> Subject {
        let mesh = MorphMesh {
            positions: vec![Vec3::ZERO],
            targets: vec![vec![Vec3::X]; 60],
            animations: vec![WeightAnimation {
                times: vec![0.0, 1.0],
                weights: [0.2, 0.4]
                    .map(|weight| [vec![weight; 30], vec![0.0; 30]].concat())
                    .to_vec(),
                ..WeightAnimation::default()
            }],
            ..MorphMesh::default()
        };
        Subject {
            leaders: (0..60).collect(),
            clip_targets: vec![(0..60).collect()],
            mesh,
            ..Subject::default()
        }
    }

    #[test]
    fn mixtures_are_reproducible_and_have_a_few_targets() {
        let subject = subject();
        let mixtures = |seed| Mixtures::new(50, seed, (0..60).collect(), &[]);
        let draw = |index| mixtures(1).draw(&subject, index);
        assert_eq!(draw(7), draw(7));
        assert_ne!(draw(7), mixtures(2).draw(&subject, 7));
        let mut counts = [0; MOST_ACTIVE + 1];
        for index in 0..50 {
            let weights = draw(index);
            assert!(weights.iter().all(|weight| (0.0..=1.0).contains(weight)));
            let active: Vec<f32> = weights.into_iter().filter(|weight| *weight != 0.0).collect();
            counts[active.len()] += 1;
            let next = draw(index + 1);
            assert!(active.iter().all(|weight| !next.contains(weight)), "mixture {index}");
        }
        assert!(
            counts[..2] == [0; 2] && counts[2..].iter().all(|count| *count > 3),
            "{counts:?}"
        );
        let one = Mixtures::new(1, 1, vec![3], &[]).draw(&subject, 0);
        assert_eq!(
            one.iter().filter(|weight| **weight != 0.0).count(),
            1,
            "there is only one"
        );
        assert_eq!(Mixtures::new(1, 1, Vec::new(), &[]).draw(&subject, 0), [0.0; 60]);
    }

    #[test]
    fn half_of_the_mixtures_are_near_frames_if_there_are_any() {
        let subject = subject();
        let clip = [Stage::Clip {
            name: "clip".to_owned(),
            choice: ClipChoice {
                weights: Some(0),
                ..ClipChoice::default()
            },
            times: FrameTimes::of_clip(1.0, 10.0, false),
        }];
        let mixtures = Mixtures::new(100, 1, (0..60).collect(), &clip);
        let of_frames: Vec<Vec<f32>> = (0..100)
            .map(|index| mixtures.draw(&subject, index))
            .filter(|weights| weights.iter().filter(|weight| **weight != 0.0).count() > MOST_ACTIVE)
            .collect();
        assert!((30..70).contains(&of_frames.len()), "{}", of_frames.len());
        for weights in &of_frames {
            assert!(weights[..30].iter().all(|weight| (0.0..=0.6).contains(weight)));
            assert_eq!(weights[30..], [0.0; 30]);
        }
    }
}
