use glam::Vec3;

/// The displacement of one vertex by one target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Displacement {
    pub(crate) target: u16,
    pub(crate) delta: Vec3,
}

impl Displacement {
    /// The nonzero displacements of a vertex, ascending by target.
    pub(super) fn sparse<T: AsRef<[Vec3]>>(vertex: usize, targets: &[T]) -> Vec<Self> {
        let all = targets.iter().zip(0..).map(|(deltas, target)| Self {
            target,
            delta: deltas.as_ref()[vertex],
        });
        all.filter(|displacement| displacement.delta != Vec3::ZERO).collect()
    }
}
