use std::sync::Arc;

use glam::Affine3A;
use morph_collision::motion::{MotionContact, MotionQuery, MovingBody};
use morph_collision::{
    Body, BuildOptions, InputError, JointMatrices, MorphBvh, PairQuery, Pose, QueryStats, TrianglePair, WorldFromModel,
};

use super::{ContainmentReport, Meshes, Situation, check_containment, check_skinned_containment};
use crate::rivals::{PoseError, SetUpError};
use morph_collision_models::mesh::{MeshSkin, MorphMesh};

/// A source's list of all intersecting pairs of triangles.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Answer {
    /// `(triangle of the first body, triangle of the second)`, ascending. Pairs that were found twice appear twice.
    pub pairs: Vec<(u32, u32)>,
    /// The work that it took.
    pub stats: QueryStats,
}

/// Gives answers about two bodies; its answers are verified.
pub trait AnswerSource {
    /// Sets the shapes and placements of both bodies.
    ///
    /// # Errors
    /// Weights or placements are refused; the previous state stays.
    fn set(&mut self, situation: &Situation) -> Result<(), PoseError>;

    /// All intersecting pairs.
    fn answer(&mut self) -> Answer;

    /// Whether any triangles intersect.
    fn touches(&mut self) -> bool;

    /// Whether the boxes of body 0 or 1 contain its vertices.
    fn containment(&mut self, body: usize) -> ContainmentReport;
}

/// Gives answers about two bodies that move; its answers are verified.
pub trait MotionSource: AnswerSource + Sized {
    /// The same source with bodies at rest. It can be the end of a motion.
    fn resting(&self) -> Self;

    /// Appends what touches while both bodies move to their state in `end`. Lists at most `most` contacts; returns whether there are more.
    ///
    /// # Errors
    /// `end` has other trees.
    fn touching(
        &mut self,
        end: &mut Self,
        tolerance: f64,
        most: usize,
        contacts: &mut Vec<MotionContact>,
    ) -> Result<bool, InputError>;

    /// The welded vertex of each vertex of a body's mesh.
    fn welded_from_source(&self, body: usize) -> &[u32];
}

impl MotionSource for Trees {
    fn resting(&self) -> Self {
        self.at_rest()
    }

    fn touching(
        &mut self,
        end: &mut Self,
        tolerance: f64,
        most: usize,
        contacts: &mut Vec<MotionContact>,
    ) -> Result<bool, InputError> {
        let ([start_a, start_b], [end_a, end_b]) = (&mut self.poses, &mut end.poses);
        let a = MovingBody::new(Body::new(start_a, &self.places[0]), Body::new(end_a, &end.places[0]))?;
        let b = MovingBody::new(Body::new(start_b, &self.places[1]), Body::new(end_b, &end.places[1]))?;
        // At the limit of work, there may be more as well.
        Ok(MotionQuery::new()
            .up_to(a, b, tolerance, most, contacts)
            .unwrap_or(true))
    }

    fn welded_from_source(&self, body: usize) -> &[u32] {
        self.poses[body].bvh().model().welded_from_source()
    }
}

/// Leaf sizes of the trees that are compared: the library's default, one whose leaves are blended vertex by vertex, and one
/// whose leaves are longer than a patch.
pub const LEAF_SIZES: [usize; 3] = [8, 2, 20];

/// This project's trees.
#[derive(Debug)]
pub struct Trees {
    meshes: [Arc<MorphMesh>; 2],
    poses: [Pose; 2],
    places: [WorldFromModel; 2],
    /// The joint matrices of skinned meshes in world space.
    joints: [Vec<Affine3A>; 2],
    query: PairQuery,
    pairs: Vec<TrianglePair>,
}

impl Trees {
    /// Builds the trees of two meshes; two references to one mesh share a tree.
    ///
    /// # Errors
    /// [`SetUpError::Model`] for a mesh that is refused.
    pub fn build(meshes: Meshes<'_>, options: &BuildOptions) -> Result<Self, SetUpError> {
        let tree = |mesh: usize| {
            let model = meshes[mesh].to_model();
            let model = model.map_err(|reason| SetUpError::Model { mesh, reason })?;
            Ok::<_, SetUpError>(Arc::new(MorphBvh::build(Arc::new(model), options)))
        };
        let a = tree(0)?;
        let b = if std::ptr::eq(meshes[0], meshes[1]) {
            Arc::clone(&a)
        } else {
            tree(1)?
        };
        Ok(Self {
            meshes: meshes.map(|mesh| Arc::new(mesh.clone())),
            poses: [Pose::new(a), Pose::new(b)],
            places: [WorldFromModel::IDENTITY; 2],
            joints: meshes.map(at_rest),
            query: PairQuery::new(),
            pairs: Vec::new(),
        })
    }

    /// The same trees with poses at rest and without any blended data.
    #[must_use]
    pub fn at_rest(&self) -> Self {
        Self {
            meshes: self.meshes.clone(),
            poses: [0, 1].map(|body| Pose::new(Arc::clone(self.poses[body].bvh()))),
            places: [WorldFromModel::IDENTITY; 2],
            joints: [0, 1].map(|body| at_rest(&self.meshes[body])),
            query: PairQuery::new(),
            pairs: Vec::new(),
        }
    }

    /// The two poses.
    pub fn poses(&mut self) -> &mut [Pose; 2] {
        &mut self.poses
    }
}

impl AnswerSource for Trees {
    fn set(&mut self, situation: &Situation) -> Result<(), PoseError> {
        let [a, b] = situation.places;
        let places = [WorldFromModel::new(a)?, WorldFromModel::new(b)?];
        let joints = [0, 1].map(|body| match situation.joints[body].is_empty() {
            true => at_rest(&self.meshes[body]),
            false => situation.world_joints(body),
        });
        let matrices = [JointMatrices::new(&joints[0])?, JointMatrices::new(&joints[1])?];
        for (body, pose) in self.poses.iter_mut().enumerate() {
            pose.set_weights(&situation.weights[body])?;
            if pose.bvh().model().joint_count().is_some() {
                pose.set_joints(&matrices[body])?;
            }
        }
        (self.places, self.joints) = (places, joints);
        Ok(())
    }

    fn answer(&mut self) -> Answer {
        let [a, b] = &mut self.poses;
        self.pairs.clear();
        let [at_a, at_b] = &self.places;
        self.query.all(Body::new(a, at_a), Body::new(b, at_b), &mut self.pairs);
        let stats = self.query.stats();
        let mut pairs: Vec<_> = self
            .pairs
            .iter()
            .map(|pair| (pair.triangle_a, pair.triangle_b))
            .collect();
        pairs.sort_unstable();
        Answer { pairs, stats }
    }

    fn touches(&mut self) -> bool {
        let [a, b] = &mut self.poses;
        let [at_a, at_b] = &self.places;
        self.query.any(Body::new(a, at_a), Body::new(b, at_b))
    }

    fn containment(&mut self, body: usize) -> ContainmentReport {
        let (mesh, pose) = (&self.meshes[body], &mut self.poses[body]);
        match &mesh.skin {
            None => check_containment(mesh, pose),
            Some(_) => check_skinned_containment(mesh, &self.joints[body], pose),
        }
    }
}

/// Joint matrices that leave a mesh as it is; empty for a mesh without a skin.
fn at_rest(mesh: &MorphMesh) -> Vec<Affine3A> {
    vec![Affine3A::IDENTITY; mesh.skin.as_ref().map_or(0, MeshSkin::joint_count)]
}
