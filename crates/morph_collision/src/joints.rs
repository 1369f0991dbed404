//! The joint matrices of a skeleton in one pose.

use std::fmt;
use std::sync::Arc;

use fearless_simd::f64x4;
use fearless_simd::prelude::*;
use glam::{Affine3A, BVec3A, DVec3, Mat3A, Vec3A};

use crate::exact::largest;
use crate::input_error::{InputError, check_vector};

/// The columns of a matrix, with a fourth coordinate of 0.
pub(crate) type Columns = [[f64; 4]; 4];

/// The matrices of a skeleton's joints. Each one takes points from the mesh's space to world space.
///
/// In glTF's terms, each matrix is the global transform of a joint times its inverse bind matrix. Meshes with the same skeleton can share
/// one `JointMatrices`: it is checked once, and cloning is cheap. Any finite affine map is allowed, including scale, shear, mirroring and
/// scale 0.
///
/// ```
/// # use std::sync::Arc;
/// # use glam::{Affine3A, Vec3};
/// # use morph_collision::{BuildOptions, Influences, JointMatrices, MorphBvh, MorphModel, Pose};
/// // A triangle without targets, moved by one joint.
/// let base = [Vec3::ZERO, Vec3::X, Vec3::Y];
/// let influences = Influences { joints: &[[0; 4]; 3], weights: &[[1.0, 0.0, 0.0, 0.0]; 3] };
/// let model = MorphModel::skinned::<[Vec3; 3]>(&base, &[[0, 1, 2]], &[], 1, &[influences])?;
/// let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
/// pose.set_joints(&JointMatrices::new(&[Affine3A::from_translation(Vec3::Z)])?)?;
/// assert_eq!(pose.source_vertex(1), Some(Vec3::new(1.0, 0.0, 1.0)));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct JointMatrices {
    /// The columns of each matrix: `x`, `y`, `z` and the translation. No entry is -0.
    columns: Arc<[Columns]>,
    /// A bound on the sum of absolute values in a row of any linear part.
    linear_reach: f64,
    /// The largest absolute coordinate of any translation.
    translation_reach: f64,
}

impl JointMatrices {
    /// The largest absolute entry allowed in a matrix.
    const LARGEST: f64 = 1e34;

    /// Checks the matrices, one per joint.
    ///
    /// # Errors
    /// [`InputError`] names the joint and its first entry that is NaN, infinite or larger than 1e34 in absolute value.
    pub fn new(world_from_mesh: &[Affine3A]) -> Result<Self, InputError> {
        Self::from_matrices(world_from_mesh.iter().copied())
    }

    /// Like [`JointMatrices::new`], for matrices that are not in memory yet.
    ///
    /// # Errors
    /// As for [`JointMatrices::new`].
    pub fn from_matrices(world_from_mesh: impl IntoIterator<Item = Affine3A>) -> Result<Self, InputError> {
        let (mut row_sums, mut translations) = (Vec3A::ZERO, Vec3A::ZERO);
        let mut are_small = BVec3A::TRUE;
        let matrices = world_from_mesh.into_iter().map(|matrix| {
            let Affine3A { matrix3, translation } = matrix;
            let [x, y, z] = [matrix3.x_axis, matrix3.y_axis, matrix3.z_axis].map(Vec3A::abs);
            let translation = translation.abs();
            // False for NaN.
            for size in [x, y, z, translation] {
                are_small &= size.cmple(Vec3A::splat(Self::LARGEST as f32));
            }
            row_sums = row_sums.max((x + y) + z);
            translations = translations.max(translation);
            columns(&matrix)
        });
        let columns: Arc<[Columns]> = matrices.collect();
        if !are_small.all() {
            for (joint, columns) in columns.iter().enumerate() {
                check(joint, columns.map(vector))?;
            }
        }
        Ok(Self {
            columns,
            // The factor covers the roundings of two sums.
            linear_reach: f64::from(row_sums.max_element()) * (1.0 + 2.0 * f64::from(f32::EPSILON)),
            translation_reach: f64::from(translations.max_element()),
        })
    }

    /// A skeleton at rest: every matrix is the identity.
    pub(crate) fn at_rest(count: usize) -> Self {
        Self {
            columns: vec![[DVec3::X, DVec3::Y, DVec3::Z, DVec3::ZERO].map(pad); count].into(),
            linear_reach: 1.0,
            translation_reach: 0.0,
        }
    }

    /// The number of joints.
    #[must_use]
    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// Whether there are no joints.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// The matrices, one per joint.
    ///
    /// ```
    /// # use glam::{Affine3A, Vec3};
    /// # use morph_collision::JointMatrices;
    /// let matrices = [Affine3A::IDENTITY, Affine3A::from_rotation_y(0.3), Affine3A::from_scale(Vec3::new(1.0, -2.0, 0.1))];
    /// let joints = JointMatrices::new(&matrices)?;
    /// assert!(joints.iter().eq(matrices));
    /// # Ok::<(), morph_collision::InputError>(())
    /// ```
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Affine3A> + Clone {
        self.columns.iter().map(|columns| {
            // They were `f32`.
            let [x, y, z, translation] = columns.map(|column| vector(column).as_vec3a());
            Affine3A {
                matrix3: Mat3A::from_cols(x, y, z),
                translation,
            }
        })
    }

    /// The columns of a joint's matrix.
    #[inline(always)]
    pub(crate) fn padded(&self, joint: u16) -> &Columns {
        &self.columns[usize::from(joint)]
    }

    /// The columns of a joint's matrix, as vectors.
    #[inline(always)]
    pub(crate) fn loaded<S: Simd>(&self, simd: S, joint: u16) -> [f64x4<S>; 4] {
        let [x, y, z, translation] = self.padded(joint);
        [
            f64x4::from_slice(simd, x),
            f64x4::from_slice(simd, y),
            f64x4::from_slice(simd, z),
            f64x4::from_slice(simd, translation),
        ]
    }

    /// The columns of a joint's matrix without the fourth coordinates.
    pub(crate) fn columns(&self, joint: u16) -> [DVec3; 4] {
        self.padded(joint).map(vector)
    }

    /// Whether a joint turns outward windings inward.
    pub(crate) fn mirrors(&self, joint: u16) -> bool {
        let [x, y, z, _] = self.columns(joint);
        x.cross(y).dot(z) < 0.0
    }

    /// The largest absolute coordinate of a translation relative to `origin`.
    pub(crate) fn spread(&self, origin: DVec3) -> f64 {
        // Coordinate by coordinate, which the compiler turns into vector instructions.
        let (origin, mut most) = (pad(origin), [0.0; 4]);
        for [.., translation] in &*self.columns {
            for axis in 0..4 {
                let distance = (translation[axis] - origin[axis]).abs();
                most[axis] = if distance > most[axis] { distance } else { most[axis] };
            }
        }
        largest(most)
    }

    pub(crate) fn linear_reach(&self) -> f64 {
        self.linear_reach
    }

    /// A bound on the world coordinates to which any joint takes points with coordinates up to `reach`.
    #[must_use]
    pub fn world_reach(&self, reach: f64) -> f64 {
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

/// The columns of a matrix.
#[inline(always)]
fn columns(matrix: &Affine3A) -> Columns {
    let Affine3A { matrix3, translation } = matrix;
    let column = |column: Vec3A| {
        let [x, y, z] = column.to_array();
        // The sums turn -0 into 0.
        [f64::from(x) + 0.0, f64::from(y) + 0.0, f64::from(z) + 0.0, 0.0]
    };
    [
        column(matrix3.x_axis),
        column(matrix3.y_axis),
        column(matrix3.z_axis),
        column(*translation),
    ]
}

fn vector([x, y, z, _]: [f64; 4]) -> DVec3 {
    DVec3::new(x, y, z)
}

fn pad(DVec3 { x, y, z }: DVec3) -> [f64; 4] {
    [x, y, z, 0.0]
}

/// Returns an error for the first entry of a matrix that is not allowed.
#[cold]
fn check(joint: usize, matrix: [DVec3; 4]) -> Result<(), InputError> {
    for (what, column) in ["x axis", "y axis", "z axis", "translation"].into_iter().zip(matrix) {
        check_vector(what, column, JointMatrices::LARGEST).map_err(|error| error.of(&format!("joint {joint}")))?;
    }
    Ok(())
}
