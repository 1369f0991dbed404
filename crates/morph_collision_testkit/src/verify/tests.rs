//! A checker must find errors, so here the answers are wrong.

use glam::Affine3A;
use morph_collision::BuildOptions;

use super::*;
use crate::rivals::PoseError;
use morph_collision_models::generated::{dolphin, rigs};
use morph_collision_models::mesh::MorphMesh;

/// How an answer is falsified.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fault {
    None,
    /// Omits the first pair while target 0 of the first body has some weight.
    LeavesOut,
    /// Adds a pair while the second body is not at the origin.
    MakesUp,
    /// Repeats a pair.
    Repeats,
    /// Reports a vertex as outside while target 1 of the second body has some weight.
    LetsOut,
}

struct Spoilt {
    trees: Trees,
    fault: Fault,
    situation: Option<Situation>,
}

impl Spoilt {
    fn new(mesh: &MorphMesh, fault: Fault) -> Result<Self, Box<dyn std::error::Error>> {
        let trees = Trees::build([mesh; 2], &BuildOptions::default())?;
        let situation = None;
        Ok(Self {
            trees,
            fault,
            situation,
        })
    }
}

impl AnswerSource for Spoilt {
    fn set(&mut self, situation: &Situation) -> Result<(), PoseError> {
        self.situation = Some(situation.clone());
        self.trees.set(situation)
    }

    fn answer(&mut self) -> Answer {
        let mut answer = self.trees.answer();
        let Some(situation) = &self.situation else {
            return answer;
        };
        match self.fault {
            Fault::LeavesOut if situation.weights[0][0] != 0.0 => {
                answer.pairs = answer.pairs.split_off(answer.pairs.len().min(1));
            }
            // No triangle of a dolphin's nose touches its own copy at the copy's placement.
            Fault::MakesUp if answer.pairs.first() != Some(&(0, 0)) => answer.pairs.insert(0, (0, 0)),
            Fault::Repeats => answer.pairs.extend(answer.pairs.last().copied()),
            _ => {}
        }
        answer
    }

    fn touches(&mut self) -> bool {
        self.trees.touches()
    }

    fn containment(&mut self, body: usize) -> ContainmentReport {
        let mut report = self.trees.containment(body);
        let moved = self.situation.as_ref().is_some_and(|s| s.weights[1][1] != 0.0);
        if self.fault == Fault::LetsOut && body == 1 && moved {
            report.violations += 1;
            report.first = Some(ContainmentViolation {
                vertex: 7,
                depth: 0,
                position: glam::DVec3::ZERO,
            });
        }
        report
    }
}

fn verified(fault: Fault) -> Result<(Counts, Option<Reproduction>), Box<dyn std::error::Error>> {
    verified_with(&dolphin(0), fault)
}

fn verified_with(mesh: &MorphMesh, fault: Fault) -> Result<(Counts, Option<Reproduction>), Box<dyn std::error::Error>> {
    let mut sources = [Spoilt::new(mesh, fault)?];
    let mut verification = verify([mesh; 2], &mut sources, 12, 3, || {})?;
    let counts = verification.counts.pop().ok_or("no counts")?;
    Ok((counts, verification.smallest.map(|finding| finding.reproduction)))
}

#[test]
fn right_answers_are_found_right() -> Result<(), Box<dyn std::error::Error>> {
    let (counts, smallest) = verified(Fault::None)?;
    assert_eq!((counts.frames, counts.differences()), (12, 0));
    assert!(
        counts.pairs_truth > 50 && counts.containment_checks > 10_000,
        "{counts:?}"
    );
    assert_eq!(smallest, None);
    Ok(())
}

#[test]
fn a_missed_pair_is_found_and_made_small() -> Result<(), Box<dyn std::error::Error>> {
    let (counts, smallest) = verified(Fault::LeavesOut)?;
    assert!(counts.missed > 0 && counts.spurious == 0, "{counts:?}");
    let smallest = smallest.ok_or("nothing to show")?;
    assert!(matches!(smallest.trouble, Trouble::Missed(..)), "{smallest:?}");
    let [of_a, of_b] = &smallest.situation.weights;
    // Everything that the fault needs has stayed, and nothing else.
    assert!(
        of_a[0] != 0.0 && of_b.iter().all(|weight| *weight == 0.0),
        "{smallest:?}"
    );
    let Some([a, b]) = smallest.world else {
        return Err("no triangles".into());
    };
    assert!(crate::oracle::triangles_intersect(&a, &b));
    Ok(())
}

#[test]
fn answers_about_skinned_meshes_are_found_right_or_made_small() -> Result<(), Box<dyn std::error::Error>> {
    let mesh = rigs::tube(3, 5, 4, 2);
    let (counts, smallest) = verified_with(&mesh, Fault::None)?;
    assert_eq!((counts.frames, counts.differences(), smallest), (12, 0, None));
    assert!(
        counts.pairs_truth > 50 && counts.containment_checks > 10_000,
        "{counts:?}"
    );

    let (_, smallest) = verified_with(&mesh, Fault::LeavesOut)?;
    let situation = smallest.ok_or("nothing to show")?.situation;
    // Joints that the fault does not need are back at rest, although two bodies in one place would touch
    // everywhere.
    let joints = situation.joints.iter().flatten();
    let (rest, all) = (
        joints.clone().filter(|joint| **joint == Affine3A::IDENTITY).count(),
        joints.count(),
    );
    assert!(all == 10 && rest >= 8, "{rest} of {all}");
    Ok(())
}

#[test]
fn pairs_made_up_or_told_twice_are_found() -> Result<(), Box<dyn std::error::Error>> {
    for fault in [Fault::MakesUp, Fault::Repeats] {
        let (counts, smallest) = verified(fault)?;
        assert!(counts.spurious > 0 && counts.missed == 0, "{fault:?}: {counts:?}");
        assert!(matches!(smallest.map(|s| s.trouble), Some(Trouble::Spurious(..))));
    }
    Ok(())
}

#[test]
fn a_vertex_outside_its_box_is_found() -> Result<(), Box<dyn std::error::Error>> {
    let (counts, smallest) = verified(Fault::LetsOut)?;
    assert!(counts.containment_violations > 0 && counts.missed + counts.spurious == 0);
    let smallest = smallest.ok_or("nothing to show")?;
    assert_eq!(smallest.trouble, Trouble::Outside { body: 1, vertex: 7 });
    // The fault needs only one weight.
    assert_eq!(smallest.size(), 1);
    Ok(())
}

#[test]
fn what_nearly_touches_has_no_number_in_between() -> Result<(), Box<dyn std::error::Error>> {
    let mesh = dolphin(0);
    let mut trees = Trees::build([&mesh; 2], &BuildOptions::default())?;
    let mut found = 0;
    for round in (1..40).step_by(5) {
        let situations = Draw::new([&mesh; 2], 5, round).situations(round, &mut trees)?;
        let [inside, outside] = situations.as_slice() else {
            continue;
        };
        assert_ne!(inside.truth([&mesh; 2]), []);
        assert_eq!(outside.truth([&mesh; 2]), []);
        let ends = inside.places[1]
            .translation
            .to_array()
            .into_iter()
            .zip(outside.places[1].translation.to_array());
        for (p, q) in ends {
            assert!(p == q || p.next_up() == q || p.next_down() == q, "{p} and {q}");
        }
        found += 1;
    }
    assert!(found > 5, "{found} found");
    Ok(())
}

#[test]
fn a_seed_draws_the_same_situations_always() -> Result<(), Box<dyn std::error::Error>> {
    let mesh = dolphin(0);
    let mut trees = Trees::build([&mesh; 2], &BuildOptions::default())?;
    let mut draw = |seed| {
        (0..6)
            .map(|round| Draw::new([&mesh; 2], seed, round).situations(round, &mut trees))
            .collect::<Result<Vec<_>, _>>()
    };
    assert_eq!(draw(1)?, draw(1)?);
    assert_ne!(draw(1)?, draw(2)?);
    Ok(())
}
