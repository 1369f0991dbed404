//! The joints of a surface at some moment.

use std::sync::{Arc, OnceLock};

use bevy::math::{Affine3A, Vec3};
use morph_collision::{InputError, JointMatrices, MorphBvh};
use parry3d::math::Pose as Isometry;

use super::placed_bounds::PlacedBounds;
use crate::math::{affine_between, collider_from_world, joint_in, largest, precise};

/// The joints of a skinned mesh at some moment. What remembers that moment shares them.
///
/// Physics needs them in the space of the collider, to which they are converted when somebody asks.
#[derive(Clone)]
pub struct SurfaceJoints(Arc<Moment>);

struct Moment {
    source: Source,
    /// The middle of the mesh in its bind pose.
    middle: Vec3,
    in_collider: OnceLock<JointMatrices>,
    middles: OnceLock<Vec<Vec3>>,
}

enum Source {
    /// As drawn, in world space, and where the collider was then.
    Drawn {
        world_from_mesh: JointMatrices,
        collider: Isometry,
    },
    /// Between two moments that were drawn.
    Between {
        before: SurfaceJoints,
        after: SurfaceJoints,
        share: f32,
    },
}

/// No conversion of such numbers leaves the range of joint matrices.
const SAFE: f64 = 1e30;
/// The same for the places of colliders.
const SAFE_DISTANCE: f32 = 1e15;

impl SurfaceJoints {
    /// Joints that are drawn at `world_from_mesh`, with a collider there. `middle` is that of the mesh in its bind pose.
    ///
    /// # Errors
    /// They are too large in the collider's space, or the collider is nowhere.
    pub fn drawn(world_from_mesh: JointMatrices, collider: Isometry, middle: Vec3) -> Result<Self, InputError> {
        // A bound on all entries. False for NaN.
        let is_safe = world_from_mesh.world_reach(1.0) <= SAFE
            && collider.translation.abs().cmple(Vec3::splat(SAFE_DISTANCE)).all();
        let in_collider = OnceLock::new();
        if !is_safe {
            let _is_new = in_collider.set(converted(&world_from_mesh, &collider)?);
        }
        let source = Source::Drawn {
            world_from_mesh,
            collider,
        };
        Ok(Self(Arc::new(Moment {
            source,
            middle,
            in_collider,
            middles: OnceLock::new(),
        })))
    }

    /// Between these joints and later ones of the same mesh: each matrix is interpolated linearly, in the collider's space.
    pub fn between(&self, after: &Self, share: f32) -> Self {
        if self.is_drawn_as(after) {
            return self.clone();
        }
        Self(Arc::new(Moment {
            source: Source::Between {
                before: self.clone(),
                after: after.clone(),
                share,
            },
            middle: self.0.middle,
            in_collider: OnceLock::new(),
            middles: OnceLock::new(),
        }))
    }

    /// The number of joints.
    pub fn count(&self) -> usize {
        match &self.0.source {
            Source::Drawn { world_from_mesh, .. } => world_from_mesh.len(),
            Source::Between { before, .. } => before.count(),
        }
    }

    /// The joints in the collider's space.
    pub fn in_collider(&self) -> &JointMatrices {
        self.0.in_collider.get_or_init(|| match &self.0.source {
            // They are safe, or were converted at once.
            Source::Drawn {
                world_from_mesh,
                collider,
            } => converted(world_from_mesh, collider).unwrap_or_else(|_| world_from_mesh.clone()),
            Source::Between { before, after, share } => {
                let [before, after] = [before, after].map(Self::in_collider);
                let pairs = before.iter().zip(after.iter());
                let between = JointMatrices::from_matrices(pairs.map(|(a, b)| affine_between(&a, &b, *share)));
                // Between numbers in range, all are.
                between.unwrap_or_else(|_| before.clone())
            }
        })
    }

    /// For each joint, where it takes the middle of the mesh, in the collider's space.
    pub fn middles(&self) -> &[Vec3] {
        self.0.middles.get_or_init(|| match &self.0.source {
            Source::Drawn {
                world_from_mesh,
                collider,
            } => {
                let to_collider = collider_from_world(collider);
                let middle = |joint: &Affine3A| precise(joint).transform_point3(self.0.middle.as_dvec3());
                let in_collider = |joint| to_collider.transform_point3(middle(&joint)).as_vec3();
                world_from_mesh.iter().map(in_collider).collect()
            }
            Source::Between { before, after, share } => {
                let pairs = before.middles().iter().zip(after.middles());
                pairs.map(|(a, b)| a + (b - a) * *share).collect()
            }
        })
    }

    /// Whether the majority of the joints mirror.
    pub fn is_mirrored(&self) -> bool {
        match &self.0.source {
            Source::Drawn { world_from_mesh, .. } => is_mirrored(world_from_mesh.iter()),
            Source::Between { before, after, .. } => {
                let is_mirrored_before = before.is_mirrored();
                if is_mirrored_before == after.is_mirrored() {
                    return is_mirrored_before;
                }
                is_mirrored(self.in_collider().iter())
            }
        }
    }

    /// A box around the mesh in which weights and joints are these; `None` if that needs a pose.
    pub fn bounds(&self, bvh: &MorphBvh, weights: &[f32]) -> Option<PlacedBounds> {
        match &self.0.source {
            Source::Drawn {
                world_from_mesh,
                collider,
            } => {
                let bounds = bvh.broad_phase_bounds(weights, world_from_mesh)?;
                // The weights move vertices by less than the mesh's size.
                let reach = 2.0 * f64::from(bvh.model().base_reach());
                let moved = world_from_mesh.world_reach(reach) - world_from_mesh.world_reach(0.0);
                PlacedBounds::new(&bounds, moved, bvh.model().joint_weight_error()?, *collider)
            }
            // Each vertex is between where the two moments, with these weights, have it.
            Source::Between { before, after, .. } => {
                Some(before.bounds(bvh, weights)?.hull(&after.bounds(bvh, weights)?))
            }
        }
    }

    /// Whether they are drawn at the same matrices, with the collider at the same place.
    pub fn is_drawn_as(&self, other: &Self) -> bool {
        if Arc::ptr_eq(&self.0, &other.0) {
            return true;
        }
        match (&self.0.source, &other.0.source) {
            (
                Source::Drawn {
                    world_from_mesh,
                    collider,
                },
                Source::Drawn {
                    world_from_mesh: other,
                    collider: elsewhere,
                },
            ) => collider == elsewhere && world_from_mesh == other,
            _ => false,
        }
    }

    /// Whether they are the same up to the rounding of a conversion.
    pub fn is_same(&self, other: &Self) -> bool {
        if self.is_drawn_as(other) {
            return true;
        }
        // Joints that move nearly always turn, which one of the first shows.
        let mut pairs = self.each_in_collider().zip(other.each_in_collider());
        if self.count() != other.count() || !pairs.all(|(a, b)| are_parallel(&a, &b)) {
            return false;
        }
        if self.0.middle == other.0.middle && self.in_collider() == other.in_collider() {
            return true;
        }
        let [points, others] = [self, other].map(Self::middles);
        let size = largest(others.iter().map(|p| f64::from(p.abs().max_element())));
        let mut pairs = points.iter().zip(others);
        pairs.all(|(a, b)| f64::from(a.distance(*b)) <= 1e-6 * size)
    }

    /// The joints in the collider's space. Unless they are known, only those that are asked for are converted.
    fn each_in_collider(&self) -> impl Iterator<Item = Affine3A> {
        let drawn = match (&self.0.source, self.0.in_collider.get()) {
            (
                Source::Drawn {
                    world_from_mesh,
                    collider,
                },
                None,
            ) => Some((world_from_mesh, collider_from_world(collider))),
            _ => None,
        };
        let known = drawn.is_none().then(|| self.in_collider().iter());
        let converted =
            drawn.map(|(joints, to_collider)| joints.iter().map(move |joint| joint_in(&to_collider, &joint)));
        converted.into_iter().flatten().chain(known.into_iter().flatten())
    }
}

fn converted(world_from_mesh: &JointMatrices, collider: &Isometry) -> Result<JointMatrices, InputError> {
    let to_collider = collider_from_world(collider);
    JointMatrices::from_matrices(world_from_mesh.iter().map(|joint| joint_in(&to_collider, &joint)))
}

/// Whether two matrices rotate and scale alike, up to rounding.
fn are_parallel(a: &Affine3A, b: &Affine3A) -> bool {
    let (a, b) = (&a.to_cols_array()[..9], &b.to_cols_array()[..9]);
    // Its scale may be that of another unit of length.
    let scale = largest(b.iter().map(|b| f64::from(b.abs())));
    a.iter().zip(b).all(|(a, b)| f64::from((a - b).abs()) <= 1e-6 * scale)
}

/// Whether the majority of transforms mirror.
fn is_mirrored(transforms: impl Iterator<Item = Affine3A>) -> bool {
    let sum: i32 = transforms
        .map(|transform| if transform.matrix3.determinant() < 0.0 { -1 } else { 1 })
        .sum();
    sum < 0
}
