//! Random joint matrices for generated and real skeletons.

use glam::{Affine3A, DAffine3, DMat3, DMat4, DQuat, DVec3};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use crate::generated::random::point;
use crate::skeleton::Skeleton;

/// A way to draw the joint matrices of a skeleton.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PoseKind {
    /// All joints at rest.
    Rest,
    /// Every joint rotated by up to 30 degrees about its place; its descendants follow.
    Gentle,
    /// Every joint rotated by up to 120 degrees.
    Turned,
    /// Rotated, and scaled by 0 to 2 per axis.
    Scaled,
    /// Rotated and sheared.
    Sheared,
    /// Rotated, and about half of the joints mirrored.
    Mirrored,
    /// Rotated, and about a third of the joints scaled to 0.
    Collapsed,
    /// All joints take everything to one point.
    OnePoint,
    /// Rotated, at 1e3 units from the origin.
    Far,
    /// Rotated, at 1e5 units from the origin.
    VeryFar,
    /// A bit of everything, drawn for every joint.
    Mixed,
}

/// Grid points per unit: entries are multiples of 2^-20.
const GRID: f64 = (1 << 20) as f64;

impl PoseKind {
    /// All kinds.
    pub const ALL: [Self; 11] = [
        Self::Rest,
        Self::Gentle,
        Self::Turned,
        Self::Scaled,
        Self::Sheared,
        Self::Mirrored,
        Self::Collapsed,
        Self::OnePoint,
        Self::Far,
        Self::VeryFar,
        Self::Mixed,
    ];

    /// The kind for body 0 or 1 of two. If both bodies were points, either all or none of their triangles would touch, so only
    /// the first one is a point.
    #[must_use]
    pub fn of_body(self, body: usize) -> Self {
        if self == Self::OnePoint && body == 1 {
            Self::Turned
        } else {
            self
        }
    }

    /// The matrix of every joint, from the mesh's space to world space; the same seed gives the same matrices.
    ///
    /// Rotations accumulate along the hierarchy. Scales, shears and mirrors apply only to what a joint moves itself, so they do
    /// not accumulate.
    #[must_use]
    pub fn draw(self, skeleton: &Skeleton, seed: u64) -> Vec<Affine3A> {
        if self == Self::Rest {
            return skeleton.at_rest();
        }
        let mut rng = Pcg64Mcg::seed_from_u64(seed ^ (self as u64) << 56);
        let root = self.root(&mut rng);
        if self == Self::OnePoint {
            let place = (point(&mut rng, 1.0) * GRID).round() / GRID;
            let collapsed = Affine3A {
                matrix3: glam::Mat3A::ZERO,
                translation: place.as_vec3().into(),
            };
            return vec![collapsed; skeleton.joints.len()];
        }
        let mut globals: Vec<DAffine3> = Vec::with_capacity(skeleton.nodes.len());
        for node in &skeleton.nodes {
            let rest = &node.rest;
            let local = DAffine3::from_scale_rotation_translation(
                rest.scale.as_dvec3(),
                rest.rotation.as_dquat(),
                rest.translation.as_dvec3(),
            );
            let parent = node.parent.map_or(root, |parent| globals[parent as usize]);
            globals.push(parent * local * DAffine3::from_quat(self.turn(&mut rng)));
        }
        let matrices = skeleton.joints.iter().map(|joint| {
            let own = DAffine3::from_mat3(self.own(&mut rng));
            let inverse_bind: DMat4 = joint.inverse_bind.as_dmat4();
            rounded(globals[joint.node as usize] * own * DAffine3::from_mat4(inverse_bind))
        });
        matrices.collect()
    }

    /// The placement of the whole skeleton.
    fn root(self, rng: &mut Pcg64Mcg) -> DAffine3 {
        let far = match self {
            Self::Far => 1e3,
            Self::VeryFar => 1e5,
            _ => 0.0,
        };
        DAffine3::from_translation(point(rng, 1.0).normalize_or(DVec3::X) * far)
    }

    /// A rotation of up to 30 or 120 degrees about any axis.
    fn turn(self, rng: &mut Pcg64Mcg) -> DQuat {
        // The tangent of half the angle.
        let largest = if self == Self::Gentle { 0.268 } else { 1.732 };
        let axis = point(rng, 1.0).normalize_or(DVec3::X) * rng.random_range(0.0..largest);
        DQuat::from_xyzw(axis.x, axis.y, axis.z, 1.0).normalize()
    }

    /// A joint's own deformation besides its rotation, in its own frame.
    fn own(self, rng: &mut Pcg64Mcg) -> DMat3 {
        let mut axes =
            |range: std::ops::Range<f64>| DVec3::from_array(std::array::from_fn(|_| rng.random_range(range.clone())));
        match self {
            Self::Scaled => DMat3::from_diagonal(axes(0.0..2.0)),
            Self::Sheared => {
                let [x, y, z] = axes(-1.5..1.5).to_array();
                DMat3::from_cols(DVec3::X, DVec3::new(x, 1.0, 0.0), DVec3::new(y, z, 1.0))
            }
            Self::Mirrored if rng.random_bool(0.5) => DMat3::from_diagonal(DVec3::new(1.0, -1.0, 1.0)),
            Self::Collapsed if rng.random_bool(0.33) => DMat3::ZERO,
            Self::Mixed => {
                let kinds = [
                    Self::Turned,
                    Self::Scaled,
                    Self::Sheared,
                    Self::Mirrored,
                    Self::Collapsed,
                ];
                kinds[rng.random_range(0..kinds.len())].own(rng)
            }
            _ => DMat3::IDENTITY,
        }
    }
}

/// Rounded to a grid that absorbs rounding differences between compilers and libraries.
fn rounded(matrix: DAffine3) -> Affine3A {
    Affine3A::from_cols_array(
        &matrix
            .to_cols_array()
            .map(|entry| ((entry * GRID).round() / GRID + 0.0) as f32),
    )
}
