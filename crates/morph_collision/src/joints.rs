//! The joint matrices of a skeleton at one moment.

use std::fmt;
use std::sync::Arc;

use glam::{Affine3A, DVec3, Vec3};

use crate::input_error::{InputError, check_vector};

/// The matrices of a skeleton's joints: each takes points from the mesh's space to world space.
///
/// In glTF's words, each is the global transform of a joint times its inverse bind matrix. Meshes that share a skeleton share one of these:
/// it is checked once, and cloning is cheap. Any finite affine map is allowed: scale, shear, mirroring, and scale 0.
#[derive(Clone)]
pub struct JointMatrices {
    /// The columns of each, `x`, `y`, `z` and the translation. The last one is all zeros: what pulls vertices whose weights do not
    /// sum to 1 towards the world's origin.
    columns: Arc<[[DVec3; 4]]>,
    /// The largest sum of the absolute values in a row of a linear part.
    linear_reach: f64,
    /// The largest absolute coordinate of a translation.
    translation_reach: f64,
}

impl JointMatrices {
    /// The largest entry of a matrix.
    const LARGEST: f64 = 1e34;

    /// Checks matrices, one per joint.
    ///
    /// # Errors
    /// [`InputError`] names the joint and the first of its entries that is NaN, infinite or beyond 1e34.
    pub fn new(world_from_mesh: &[Affine3A]) -> Result<Self, InputError> {
        let mut columns = Vec::with_capacity(world_from_mesh.len() + 1);
        for (joint, matrix) in world_from_mesh.iter().enumerate() {
            let matrix = matrix
                .to_cols_array_2d()
                .map(|column| Vec3::from_array(column).as_dvec3());
            for (what, column) in ["x axis", "y axis", "z axis", "translation"].into_iter().zip(matrix) {
                check_vector(what, column, Self::LARGEST).map_err(|error| error.of(&format!("joint {joint}")))?;
            }
            columns.push(matrix);
        }
        let row_sums = |[x, y, z, _]: &[DVec3; 4]| (x.abs() + y.abs() + z.abs()).max_element();
        let linear_reach = columns.iter().map(row_sums).fold(0.0, f64::max);
        let translation_reach = columns.iter().map(|[.., t]| t.abs().max_element()).fold(0.0, f64::max);
        columns.push([DVec3::ZERO; 4]);
        Ok(Self {
            columns: columns.into(),
            linear_reach,
            translation_reach,
        })
    }

    /// A skeleton at rest: every joint leaves the mesh as it is.
    pub(crate) fn at_rest(count: usize) -> Self {
        let mut columns = vec![[DVec3::X, DVec3::Y, DVec3::Z, DVec3::ZERO]; count];
        columns.push([DVec3::ZERO; 4]);
        Self {
            columns: columns.into(),
            linear_reach: 1.0,
            translation_reach: 0.0,
        }
    }

    /// The number of joints.
    #[must_use]
    pub fn len(&self) -> usize {
        self.columns.len() - 1
    }

    /// Whether there are no joints.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The columns of a joint's matrix, or zeros for the number after the last joint's.
    #[inline(always)]
    pub(crate) fn columns(&self, joint: u16) -> &[DVec3; 4] {
        &self.columns[usize::from(joint)]
    }

    /// The largest absolute coordinate of a translation relative to `origin`.
    pub(crate) fn spread(&self, origin: DVec3) -> f64 {
        let joints = &self.columns[..self.len()];
        let distance = |[.., translation]: &[DVec3; 4]| (*translation - origin).abs().max_element();
        joints.iter().map(distance).fold(0.0, f64::max)
    }

    pub(crate) fn linear_reach(&self) -> f64 {
        self.linear_reach
    }

    /// A bound on the world coordinates that a joint gives to points with coordinates up to `reach`.
    pub(crate) fn world_reach(&self, reach: f64) -> f64 {
        self.linear_reach * reach + self.translation_reach
    }
}

impl PartialEq for JointMatrices {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.columns, &other.columns) || self.columns == other.columns
    }
}

impl fmt::Debug for JointMatrices {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("JointMatrices")
            .field("len", &self.len())
            .finish_non_exhaustive()
    }
}
