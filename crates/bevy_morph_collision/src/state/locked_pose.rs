//! A pose that several systems may query at the same time.

use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};

use morph_collision::{Pose, PoseSnapshot};

/// A pose that queries refit even though they only have read access. The lock serves systems that query at the same time.
pub(crate) struct LockedPose(Mutex<Pose>);

impl LockedPose {
    pub(crate) fn new(pose: Pose) -> Self {
        Self(Mutex::new(pose))
    }

    /// The weights and joints.
    pub(crate) fn snapshot(&self) -> PoseSnapshot {
        let mut snapshot = PoseSnapshot::default();
        snapshot.take(&self.lock());
        snapshot
    }

    /// Brings a pose to a state. One of the same tree keeps what is blended for the same weights and joints. If the tree of the state is
    /// gone, there is no pose.
    pub(crate) fn restore(pose: &mut Option<Self>, snapshot: Option<&PoseSnapshot>) {
        let is_restored = |pose: &mut Self| snapshot.is_some_and(|snapshot| snapshot.restore(pose.get_mut()));
        if !pose.as_mut().is_some_and(is_restored) {
            *pose = snapshot.and_then(PoseSnapshot::to_pose).map(Self::new);
        }
    }

    /// Accesses the pose without locking.
    pub(crate) fn get_mut(&mut self) -> &mut Pose {
        self.0.get_mut().unwrap_or_else(PoisonError::into_inner)
    }

    /// Locks the pose if that needs no waiting.
    pub(crate) fn try_lock(&self) -> Option<MutexGuard<'_, Pose>> {
        match self.0.try_lock() {
            Ok(pose) => Some(pose),
            Err(TryLockError::Poisoned(poisoned)) => Some(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => None,
        }
    }

    /// Locks the pose. While it is locked, lock other poses only in ascending order of entities.
    pub(crate) fn lock(&self) -> MutexGuard<'_, Pose> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
