//! Proofs in the background: what can never touch is left out of later runs.

use std::sync::Arc;
use std::thread;

use bevy::platform::collections::HashMap;
use bevy::tasks::futures_lite::future::{block_on, poll_once, yield_now};
use bevy::tasks::{AsyncComputeTaskPool, Task};
use morph_collision::MorphBvh;
use morph_collision::proof::{Effort, ProofOutcome, SelfCertificates, SelfProof, WeightBox};

/// How many owners a tree has that only its proof still needs: the entry here, the task and its proof.
const OWN_COUNT: usize = 3;

/// The proofs of trees.
#[derive(Default)]
pub(crate) struct Proofs(HashMap<usize, (Arc<MorphBvh>, Proof)>);

enum Proof {
    Running(Task<Option<SelfCertificates>>),
    /// There is none. This stays, so that it is not tried again.
    Impossible,
}

impl Proofs {
    /// Starts the proof for a tree, unless it is running, done, or impossible.
    pub(super) fn request(&mut self, tree: &Arc<MorphBvh>) {
        if tree.certificates().is_some() || tree.model().joint_count().is_some() {
            return;
        }
        // The tree is kept, so no other one gets its address.
        self.0.entry(Arc::as_ptr(tree).addr()).or_insert_with(|| {
            let frames_thread = thread::current().id();
            let (pool, proved) = (AsyncComputeTaskPool::get_or_init(Default::default), tree.clone());
            let task = pool.spawn(async move {
                // A part can take a second, which would stop the game.
                let has_own_thread = thread::current().id() != frames_thread;
                if has_own_thread { prove(&proved).await } else { None }
            });
            (tree.clone(), Proof::Running(task))
        });
    }

    /// Gives trees the certificates of proofs that are complete, and ends the proofs of trees that nothing else uses.
    pub(super) fn take_finished(&mut self) {
        self.0.retain(|_, (tree, proof)| {
            let Proof::Running(task) = proof else {
                return Arc::strong_count(tree) > 1;
            };
            let Some(proved) = block_on(poll_once(task)) else {
                return Arc::strong_count(tree) > OWN_COUNT;
            };
            // They are of this tree, and nothing else gives it any.
            let is_proved = proved.is_some_and(|certificates| tree.set_certificates(certificates).is_ok());
            *proof = Proof::Impossible;
            !is_proved && Arc::strong_count(tree) > 1
        });
    }
}

/// Proves for all weights from 0 to 1, one part after the other.
async fn prove(tree: &Arc<MorphBvh>) -> Option<SelfCertificates> {
    let proof = SelfProof::new(tree, &WeightBox::unit(tree.model().target_count()), Effort::light()).ok()?;
    let mut outcome = ProofOutcome::default();
    for part in 0..proof.parts() {
        outcome.join(proof.run_part(part));
        yield_now().await;
    }
    proof.certificates(&outcome).ok()
}

#[cfg(test)]
mod tests {
    use bevy::math::Vec3;
    use morph_collision::{BuildOptions, MorphModel};

    use super::*;

    #[test]
    fn what_cannot_be_proved_is_tried_once_while_its_tree_is_used() {
        let corners = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let model = MorphModel::from_displacements(&corners, &[[0, 1, 2]], &[] as &[Vec<Vec3>]).unwrap();
        let tree = Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default()));
        let key = Arc::as_ptr(&tree).addr();
        // More than a proof has.
        let users = vec![tree.clone(); OWN_COUNT];
        let task = AsyncComputeTaskPool::get_or_init(Default::default).spawn(async { None });
        let mut proofs = Proofs::default();
        proofs.0.insert(key, (tree.clone(), Proof::Running(task)));
        while matches!(proofs.0[&key].1, Proof::Running(_)) {
            proofs.take_finished();
            thread::yield_now();
        }
        for _ in 0..3 {
            proofs.take_finished();
            proofs.request(&tree);
            assert!(matches!(proofs.0[&key].1, Proof::Impossible));
        }
        drop((tree, users));
        proofs.take_finished();
        assert!(proofs.0.is_empty());
    }
}
