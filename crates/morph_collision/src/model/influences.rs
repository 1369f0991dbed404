//! The influences of joints on vertices, as they are passed in.

use super::ModelError;

/// Up to four joints per vertex and their weights, as glTF stores them (`JOINTS_0` and `WEIGHTS_0`). A mesh may have any number of such sets.
///
/// An influence with weight 0 is ignored, even if its joint does not exist.
#[derive(Clone, Copy, Debug)]
pub struct Influences<'a> {
    /// Joint indices, one entry per vertex.
    pub joints: &'a [[u16; 4]],
    /// Weights of the joints, one entry per vertex: not negative, at most 1000, and usually with a sum of 1. They are not normalised.
    pub weights: &'a [[f32; 4]],
}

/// The largest weight allowed.
const MAX_WEIGHT: f32 = 1000.0;
/// The largest sum of a vertex's weights allowed. Together with [`JointMatrices::LARGEST`] it keeps vertices in the range of the exact tests.
const MAX_SUM: f64 = 8000.0;

/// A joint that moves a vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Influence {
    pub(crate) joint: u16,
    /// More than 0.
    pub(crate) weight: f32,
}

/// Checked influences, as they were passed in.
pub(super) struct SlotInfluences<'a> {
    pub(super) joint_count: usize,
    sets: &'a [Influences<'a>],
}

impl<'a> SlotInfluences<'a> {
    pub(super) fn joint_count(&self) -> usize {
        self.joint_count
    }

    /// Influences of this many vertices, of which only the number is checked.
    pub(super) fn new(vertices: usize, joint_count: usize, sets: &'a [Influences<'a>]) -> Result<Self, ModelError> {
        super::check::count("joints", joint_count, usize::from(u16::MAX) - 1)?;
        for (set, Influences { joints, weights }) in sets.iter().enumerate() {
            for (what, length) in [("joints", joints.len()), ("weights", weights.len())] {
                if length != vertices {
                    return Err(ModelError::LengthMismatch {
                        shape: format!("{what} of influences {set}"),
                        length,
                        expected: vertices,
                    });
                }
            }
        }
        Ok(Self { joint_count, sets })
    }

    /// Checks influences of this many vertices.
    pub(super) fn checked(vertices: usize, joint_count: usize, sets: &'a [Influences<'a>]) -> Result<Self, ModelError> {
        let influences = Self::new(vertices, joint_count, sets)?;
        let mut count = 0;
        for vertex in 0..vertices {
            count += influences.check(vertex)?;
        }
        super::check::count("influences", count, u32::MAX as usize)?;
        Ok(influences)
    }

    /// Checks the influences of a vertex. Returns the number of those with a weight that is not 0.
    pub(super) fn check(&self, vertex: usize) -> Result<usize, ModelError> {
        let (mut count, mut sum) = (0, 0.0);
        for (slot, (joint, weight)) in self.slots(vertex).enumerate() {
            if !(0.0..=MAX_WEIGHT).contains(&weight) {
                return Err(ModelError::BadInfluence {
                    vertex,
                    slot,
                    joint,
                    weight,
                });
            }
            if weight > 0.0 && usize::from(joint) >= self.joint_count {
                return Err(ModelError::JointOutOfRange {
                    vertex,
                    slot,
                    joint,
                    joint_count: self.joint_count,
                });
            }
            count += usize::from(weight > 0.0);
            sum += f64::from(weight);
        }
        if sum > MAX_SUM {
            return Err(ModelError::WeightsTooLarge { vertex, sum });
        }
        Ok(count)
    }

    fn slots(&self, vertex: usize) -> impl Iterator<Item = (u16, f32)> + use<'a> {
        let of_set = move |set: &'a Influences<'a>| set.joints[vertex].into_iter().zip(set.weights[vertex]);
        self.sets.iter().flat_map(of_set)
    }

    /// The influences of a vertex, in slot order, without those of weight 0.
    pub(super) fn of(&self, vertex: usize) -> impl Iterator<Item = Influence> + use<'a> {
        let slots = self.slots(vertex).filter(|(_, weight)| *weight > 0.0);
        slots.map(|(joint, weight)| Influence { joint, weight })
    }
}
