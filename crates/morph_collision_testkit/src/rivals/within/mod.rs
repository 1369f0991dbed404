//! Methods that find the triangles of one mesh that intersect each other.
//!
//! | [`SelfMethodKind`] | cost of a frame | from |
//! |---|---|---|
//! | `certified` | our query; pairs that are proved free for all weights from 0 to 1 are left out | this project |
//! | `morph` | our query | this project |
//! | `bottom-up` | our query, after all boxes were fitted to the posed vertices | van den Bergen 1997 |
//! | `bottom-up-scalar` | the same as usually written: blends every vertex, refits an eight-wide tree, and walks over it and itself | |
//! | `binary` | the same with a binary tree, split in the middle, ten triangles in a leaf, and one box at a time | the library three-mesh-bvh, as it is used for morphing meshes |
//! | `brute-force` | blends every vertex, and compares the boxes of all pairs of triangles | |
//!
//! The last three methods reject triangles whose boxes do not overlap before anything else. All of them decide triangles by [`morph_collision::triangles_intersect`] or with the same answer, and leave out triangles that share a
//! vertex.

mod posed;
mod refitted;

use std::fmt;
use std::sync::Arc;

use morph_collision::proof::{Effort, SelfProof, WeightBox};
use morph_collision::{InputError, MorphBvh, Pose, QueryStats, SelfQuery, TrianglePair};

use self::posed::AllPairs;
use self::refitted::Refitted;
use super::blended::WeldedMesh;
use super::build::{Cut, Limits};
use super::{MethodOptions, PoseError, SetUpError};
use morph_collision_models::mesh::MorphMesh;

/// A method, by name. The [module's table](self) describes each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SelfMethodKind {
    /// Our query, with certificates.
    Certified,
    /// Our query.
    Morph,
    /// Our query over a refitted tree.
    BottomUp,
    /// An eight-wide tree, refitted, in plain code.
    BottomUpScalar,
    /// A binary tree, refitted.
    Binary,
    /// All pairs.
    BruteForce,
}

/// Finds the pairs of intersecting triangles of one mesh.
pub trait SelfMethod: fmt::Debug {
    /// Appends all pairs for some weights, the smaller index first, in any order.
    ///
    /// # Errors
    /// The weights do not fit the mesh.
    fn find(&mut self, weights: &[f32], pairs: &mut Vec<TrianglePair>) -> Result<(), PoseError>;

    /// The work done since set-up.
    fn work(&self) -> QueryStats;
}

impl SelfMethodKind {
    /// All methods, ours first.
    pub const ALL: [Self; 6] = [
        Self::Certified,
        Self::Morph,
        Self::BottomUp,
        Self::BottomUpScalar,
        Self::Binary,
        Self::BruteForce,
    ];

    /// Prepares the method for a mesh without joints.
    ///
    /// # Errors
    /// The mesh is invalid or skinned.
    pub fn set_up(self, mesh: &MorphMesh) -> Result<Box<dyn SelfMethod>, SetUpError> {
        let told = |reason| SetUpError::Model { mesh: 0, reason };
        let ours = |is_certified: bool, is_refitted: bool| -> Result<Box<dyn SelfMethod>, SetUpError> {
            let model = Arc::new(mesh.to_model().map_err(told)?);
            let bvh = Arc::new(MorphBvh::build(model, &MethodOptions::default().tree));
            if is_certified {
                certify(&bvh)?;
            }
            Ok(Box::new(Ours {
                pose: Pose::new(bvh),
                query: SelfQuery::new(),
                is_refitted,
                work: QueryStats::default(),
            }))
        };
        let welded = || WeldedMesh::new(mesh).map(Arc::new).map_err(told);
        let leaf_size = MethodOptions::default().tree.leaf_size();
        Ok(match self {
            Self::Certified => ours(true, false)?,
            Self::Morph => ours(false, false)?,
            Self::BottomUp => ours(false, true)?,
            Self::BottomUpScalar => Box::new(Refitted::new(&welded()?, Cut::Sah, Limits { arity: 8, leaf_size })),
            Self::Binary => Box::new(Refitted::new(
                &welded()?,
                Cut::Middle,
                Limits {
                    arity: 2,
                    leaf_size: 10,
                },
            )),
            Self::BruteForce => Box::new(AllPairs::new(&welded()?)),
        })
    }
}

impl fmt::Display for SelfMethodKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Certified => "certified",
            Self::Morph => "morph",
            Self::BottomUp => "bottom-up",
            Self::BottomUpScalar => "bottom-up-scalar",
            Self::Binary => "binary",
            Self::BruteForce => "brute-force",
        })
    }
}

/// Gives a tree certificates for all weights from 0 to 1, if it has none.
///
/// # Errors
/// The mesh is skinned.
pub fn certify(bvh: &Arc<MorphBvh>) -> Result<(), InputError> {
    let proof = SelfProof::new(bvh, &WeightBox::unit(bvh.model().target_count()), Effort::light())?;
    bvh.set_certificates(proof.certificates(&proof.run())?).map(|_| ())
}

#[derive(Debug)]
struct Ours {
    pose: Pose,
    query: SelfQuery,
    is_refitted: bool,
    work: QueryStats,
}

impl SelfMethod for Ours {
    fn find(&mut self, weights: &[f32], pairs: &mut Vec<TrianglePair>) -> Result<(), PoseError> {
        if self.pose.set_weights(weights)? && self.is_refitted {
            self.pose.refit();
            self.work.nodes_blended += self.pose.bvh().node_count() as u64;
            self.work.vertices_blended += self.pose.bvh().model().vertex_count() as u64;
        }
        self.query.all(&mut self.pose, pairs);
        self.work += self.query.stats();
        Ok(())
    }

    fn work(&self) -> QueryStats {
        self.work
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use morph_collision_models::generated::random::{random_blob, triangle_soup};

    #[test]
    fn all_methods_find_the_same_pairs() -> Result<(), Box<dyn std::error::Error>> {
        for mesh in [random_blob(3, 3, 3, 0.8), triangle_soup(4, 150, 3)] {
            let mut methods = Vec::new();
            for kind in SelfMethodKind::ALL {
                methods.push((kind, kind.set_up(&mesh)?));
            }
            let mut found = 0;
            for step in 0..6 {
                let weights = [0.3 * step as f32, 0.9 - 0.1 * step as f32, 0.5];
                let mut expected: Option<Vec<TrianglePair>> = None;
                for (kind, method) in &mut methods {
                    let mut pairs = Vec::new();
                    method.find(&weights, &mut pairs)?;
                    pairs.sort_unstable();
                    found += pairs.len();
                    assert_eq!(
                        *expected.get_or_insert_with(|| pairs.clone()),
                        pairs,
                        "{kind} of {}",
                        mesh.name
                    );
                }
            }
            assert!(found > 0);
        }
        Ok(())
    }
}
