//! Runs the parts of a proof, and turns the outcome into certificates.

use super::outcome::ProofOutcome;
use super::self_proof::SelfProof;
use super::walk::Walk;
use crate::input_error::InputError;
use crate::tree::{Area, NodeId, OpenPairs, SelfCertificates};

impl SelfProof {
    /// Runs one part; nothing if there is no such part.
    #[must_use]
    pub fn run_part(&self, part: usize) -> ProofOutcome {
        let mut outcome = ProofOutcome::default();
        if let Some(&pair) = self.parts.get(part) {
            outcome.parts.push(part);
            outcome.proof = Some(self.key);
            let is_spent = Walk::new(self, &mut outcome).run(pair);
            if is_spent || outcome.open.patches.len() >= self.most_open {
                outcome.open = OpenPairs {
                    patches: Vec::new(),
                    areas: vec![self.area(pair)],
                };
            }
        }
        outcome
    }

    /// Runs all parts, one after the other.
    #[must_use]
    pub fn run(&self) -> ProofOutcome {
        let mut outcome = ProofOutcome::default();
        for part in 0..self.parts() {
            outcome.join(self.run_part(part));
        }
        outcome
    }

    /// What queries may leave out while the weights are in the box of this proof. `outcome` is that of all parts.
    ///
    /// ```
    /// # use std::sync::Arc;
    /// # use morph_collision::proof::{Effort, SelfProof, WeightBox};
    /// # use morph_collision::{BuildOptions, MorphBvh, MorphModel, Pose, SelfQuery};
    /// # use glam::Vec3;
    /// # let base = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z, Vec3::Z + Vec3::X, Vec3::Z + Vec3::Y];
    /// # let lower = [Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, Vec3::NEG_Z, Vec3::NEG_Z, Vec3::NEG_Z];
    /// # let model = MorphModel::from_displacements(&base, &[[0, 1, 2], [3, 4, 5]], &[lower])?;
    /// # let bvh = Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()));
    /// // Once per mesh; `bvh.layout()` stores them.
    /// let proof = SelfProof::new(&bvh, &WeightBox::new(&[0.0], &[0.9])?, Effort::light())?;
    /// bvh.set_certificates(proof.certificates(&proof.run())?)?;
    /// // All triangles are proved apart, so there is nothing to do.
    /// let mut pose = Pose::new(bvh);
    /// let mut query = SelfQuery::new();
    /// pose.set_weights(&[0.8])?;
    /// assert!(!query.any(&mut pose));
    /// assert_eq!(query.stats().nodes_blended, 0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// A part is missing or was joined twice, or the outcome is of another tree or box.
    pub fn certificates(&self, outcome: &ProofOutcome) -> Result<SelfCertificates, InputError> {
        if outcome.is_mixed || outcome.proof.is_some_and(|proof| proof != self.key) {
            return Err(InputError::DifferentTrees {
                what: "a proof and all parts of its outcome".to_owned(),
            });
        }
        let mut parts = outcome.parts.clone();
        parts.sort_unstable();
        parts.dedup();
        if parts.len() != self.parts() || parts.len() != outcome.parts.len() {
            return Err(InputError::WrongCount {
                what: format!("parts of the proof ({} different ones)", parts.len()),
                given: outcome.parts.len(),
                expected: self.parts(),
            });
        }
        Ok(self.bvh.self_certificates(self.weights.clone(), &outcome.open))
    }

    /// The leaves below two nodes.
    fn area(&self, nodes: [NodeId; 2]) -> Area {
        let topology = &self.bvh.topology;
        nodes.map(|node| topology.leaves_below(node.child(topology)).map(|leaf| leaf.0 as u32))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use morph_collision_models::generated::random::random_blob;

    use super::*;
    use crate::model::{MorphModel, WeightBox};
    use crate::pose::Pose;
    use crate::proof::Effort;
    use crate::query::SelfQuery;
    use crate::tree::{BuildOptions, MorphBvh};

    #[test]
    fn a_part_with_too_much_that_is_open_counts_as_open() {
        let blob = random_blob(7, 3, 3, 0.9);
        let model = MorphModel::from_displacements(&blob.positions, &blob.triangles, &blob.targets).unwrap();
        let model = Arc::new(model);
        let mut answers = Vec::new();
        for most_open in [usize::MAX, 4, 0] {
            let bvh = Arc::new(MorphBvh::build(model.clone(), &BuildOptions::default()));
            let mut proof = SelfProof::new(&bvh, &WeightBox::unit(3), Effort::default()).unwrap();
            proof.most_open = most_open;
            let outcome = proof.run();
            let has_areas = !outcome.open.areas.is_empty();
            assert_eq!(has_areas, most_open < usize::MAX);
            bvh.set_certificates(proof.certificates(&outcome).unwrap()).unwrap();
            let (mut pose, mut query, mut pairs) = (Pose::new(bvh), SelfQuery::new(), Vec::new());
            let mut work = Vec::new();
            for weights in [[0.1, 0.9, 0.5], [1.0, 1.0, 1.0], [0.7, 0.0, 0.8]] {
                pose.set_weights(&weights).unwrap();
                query.all(&mut pose, &mut pairs);
                work.push(query.stats().triangle_tests);
            }
            answers.push((pairs, work));
        }
        assert!(!answers[0].0.is_empty());
        assert!(answers.iter().all(|(pairs, _)| *pairs == answers[0].0));
        let (with, without) = (&answers[0].1, &answers[2].1);
        assert!(
            with.iter().zip(without).all(|(few, many)| few < many),
            "{with:?} {without:?}"
        );
    }
}
