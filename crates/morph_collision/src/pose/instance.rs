use std::fmt;
use std::sync::Arc;

use glam::{Vec3, Vec3A};

use super::cache::EpochCache;
use super::posed::{Blended, Posed, Scratch};
use super::skinning::{SkinTree, Skinning};
use super::standing::Standing;
use super::weights::{self, WeightsError};
use crate::bounds::{Aabb, BoxLanes, WorldFromModel};
use crate::input_error::InputError;
use crate::joints::JointMatrices;
use crate::model::Weights;
use crate::tree::MorphBvh;

/// One instance of a morphing mesh: its weights, and a cache of the boxes and vertices blended for them.
///
/// New weights cost a comparison and a copy. Boxes are blended when a query first looks at their node. Setting equal weights
/// keeps the cache. A pose is in the mesh's model space; each query takes the transform to world space.
///
/// Memory: 8 bytes per inner node and per vertex, plus what was visited.
#[derive(Clone)]
pub struct Pose {
    pub(super) bvh: Arc<MorphBvh>,
    pub(super) weights: Weights,
    /// Whether [`Pose::refit`] made the cached boxes.
    is_refitted: bool,
    boxes: EpochCache<BoxLanes>,
    vertices: EpochCache<Vec3A>,
    /// For a skinned mesh, with where the space of its boxes stands.
    pub(super) skinning: Option<(WorldFromModel, Skinning)>,
    standing: Standing,
    blended: Blended,
    scratch: Scratch,
}

impl Pose {
    /// An instance at rest: all weights are zero.
    #[must_use]
    pub fn new(bvh: Arc<MorphBvh>) -> Self {
        let skinning = bvh.model().joint_count().zip(bvh.skin.as_ref()).map(|(joints, skin)| {
            let joints = JointMatrices::at_rest(joints);
            let (groups, vertices) = (bvh.topology.group_count(), bvh.model().vertex_count());
            (WorldFromModel::IDENTITY, Skinning::new(skin, joints, groups, vertices))
        });
        let mut pose = Self {
            weights: Weights::new(&vec![0.0; bvh.model().target_count()]),
            is_refitted: false,
            boxes: EpochCache::new(bvh.topology.group_count()),
            // Those of a skinned mesh are kept where joints have placed them.
            vertices: EpochCache::new(if skinning.is_some() {
                0
            } else {
                bvh.model().vertex_count()
            }),
            standing: Standing::default(),
            blended: Blended::default(),
            scratch: Scratch::default(),
            skinning,
            bvh,
        };
        pose.forget(true);
        pose
    }

    /// Sets the joint matrices of a skinned mesh, one per joint; they are shared, not copied. Returns whether they differ from the previous ones.
    ///
    /// Joints place the mesh in the world by themselves: queries then ignore the `world_from_model` of a [`Body`](crate::Body), as glTF wants
    /// it. Until the first call, all joints leave the mesh as it is.
    ///
    /// Cost: one pass over the joints. Boxes of parts that move rigidly stay as they are.
    ///
    /// # Errors
    /// [`InputError`] for a wrong number of joints, or for any joints if the mesh has none. The pose then keeps its joints.
    pub fn set_joints(&mut self, joints: &JointMatrices) -> Result<bool, InputError> {
        let expected = self.bvh.model().joint_count();
        let given = joints.len();
        let (Some((_, skinning)), true) = (&mut self.skinning, expected == Some(given)) else {
            let (what, expected) = ("joints".to_owned(), expected.unwrap_or(0));
            return Err(InputError::WrongCount { what, given, expected });
        };
        let changed = skinning.joints != *joints;
        if changed {
            skinning.joints = joints.clone();
            self.forget(false);
        }
        Ok(changed)
    }

    /// The joint matrices of a skinned mesh.
    #[must_use]
    pub fn joints(&self) -> Option<&JointMatrices> {
        self.skinning.as_ref().map(|(_, skinning)| &skinning.joints)
    }

    /// Forgets what was made with other joints or weights.
    fn forget(&mut self, weights_changed: bool) {
        self.boxes.next_epoch();
        if weights_changed {
            self.vertices.next_epoch();
        }
        self.standing.forget();
        self.is_refitted = false;
        if let (Some((place, skinning)), Some(tables)) = (&mut self.skinning, &self.bvh.skin) {
            let tree = SkinTree {
                model: self.bvh.model(),
                skin: tables,
                weights: &self.weights,
                level: self.bvh.kernel().level,
            };
            *place = skinning.change(tree, weights_changed);
        }
    }

    /// Sets the weights, one per target, of any sign and sum. Returns whether they differ from the previous ones.
    ///
    /// Cost: one pass over the weights.
    ///
    /// # Errors
    /// [`WeightsError`] for a wrong number of weights, a weight that is not finite, or weights that could move a vertex out of
    /// the range of `f32`. The pose then keeps its weights.
    pub fn set_weights(&mut self, weights: &[f32]) -> Result<bool, WeightsError> {
        weights::check(self.bvh.model(), weights)?;
        let changed = self.weights.all() != weights;
        if changed {
            self.weights.set(weights);
            self.forget(true);
        }
        Ok(changed)
    }

    /// Fits all boxes tightly to the posed vertices now. They last until the weights or joints change.
    ///
    /// This pays for weights that rest, and where a query looks at most of the tree, such as all pairs of two bodies that
    /// overlap deeply. Otherwise let queries blend what they look at; `docs/performance.md` compares both. Cost: `O(n)`, every
    /// vertex is blended and every box fitted.
    pub fn refit(&mut self) {
        self.is_refitted = true;
        self.standing.forget();
        self.posed().refit();
    }

    /// The weights, one per target.
    #[must_use]
    pub fn weights(&self) -> &[f32] {
        self.weights.all()
    }

    /// The tree of the mesh.
    #[must_use]
    pub fn bvh(&self) -> &Arc<MorphBvh> {
        &self.bvh
    }

    /// A box around the posed mesh in model space: conservative, not always the smallest.
    ///
    /// The model space of a skinned mesh is world space here and in what follows, since joints lead there.
    /// Cost: the boxes of the root's children are blended from the active targets unless they are cached.
    pub fn bounds(&mut self) -> Aabb {
        if self.skinning.is_some() {
            return self.world_bounds(&WorldFromModel::IDENTITY);
        }
        self.posed().bounds()
    }

    /// A conservative box in world space around the posed mesh.
    ///
    /// It holds every posed vertex as [`WorldFromModel::transform_point`] places it. It is infinite where world coordinates
    /// exceed the range of `f32`. For a skinned mesh it is what the boxes of the root's children, which have the axes of a joint, and
    /// [`Pose::broad_phase_bounds`] have in common. Cost: that of [`Pose::bounds`].
    pub fn world_bounds(&mut self, world_from_model: &WorldFromModel) -> Aabb {
        let mut posed = self.posed_at(world_from_model);
        let of_nodes = posed.world_bounds();
        posed.hull_of_joints().map_or(of_nodes, |of_joints| Aabb {
            min: of_nodes.min.max(of_joints.min),
            max: of_nodes.max.min(of_joints.max),
        })
    }

    /// A conservative box in world space that costs as little as possible, to find out which bodies may meet at all.
    ///
    /// For a skinned mesh it is the hull of one box per joint, around the vertices that the joint moves. That is looser than [`Pose::world_bounds`]
    /// (on characters 1.0 to 2.1 times the area, on average), but no node is blended for it. For other meshes both are the same. Cost: linear in the number of joints; after
    /// new weights, also in the number of targets that move each joint's vertices.
    pub fn broad_phase_bounds(&mut self, world_from_model: &WorldFromModel) -> Aabb {
        let mut posed = self.posed_at(world_from_model);
        match posed.hull_of_joints() {
            Some(bounds) => bounds,
            None => posed.world_bounds(),
        }
    }

    /// The posed position of a source vertex in model space, or `None` if there is no such vertex.
    pub fn source_vertex(&mut self, source: u32) -> Option<Vec3> {
        let welded = *self.bvh.model().welded_from_source().get(source as usize)?;
        self.vertex(welded)
    }

    /// The posed position of a welded vertex in model space, or `None` if there is no such vertex.
    ///
    /// [`MorphModel::triangle`](crate::MorphModel::triangle) gives the welded vertices of a triangle.
    pub fn vertex(&mut self, vertex: u32) -> Option<Vec3> {
        let exists = (vertex as usize) < self.bvh.model().vertex_count();
        exists.then(|| self.posed().model_vertex(vertex))
    }

    /// The posed corners of a triangle in model space, or `None` if there is no such triangle.
    pub fn triangle(&mut self, triangle: u32) -> Option<[Vec3; 3]> {
        let exists = (triangle as usize) < self.bvh.model().triangle_count();
        let corners = |pose: &mut Self| pose.bvh.model().corners(triangle).map(|v| pose.posed().model_vertex(v));
        exists.then(|| corners(self))
    }

    /// Brings a copy of a pose, if there is one, to that pose's state. Keeps what the copy has blended if the state is the same.
    pub(crate) fn copied<'c>(copy: &'c mut Option<Self>, pose: &Self) -> &'c mut Self {
        let copy = copy.get_or_insert_with(|| pose.clone());
        let is_current = Arc::ptr_eq(&copy.bvh, &pose.bvh)
            && copy.is_refitted == pose.is_refitted
            // How large the boxes of a skinned mesh are depends on its joints before, too, and so does the order of pairs.
            && copy.joint_changes() == pose.joint_changes()
            && copy.joints() == pose.joints()
            // Refitted boxes are those of one vector of weights. Weights that a pose has accepted are never refused.
            && (copy.weights() == pose.weights()
                || !copy.is_refitted && copy.skinning.is_none() && copy.set_weights(pose.weights()).is_ok());
        if !is_current {
            copy.clone_from(pose);
        }
        copy
    }

    fn joint_changes(&self) -> Option<u32> {
        self.skinning.as_ref().map(|(_, skinning)| skinning.version())
    }

    /// Bytes on the heap, without the shared tree.
    #[must_use]
    pub fn bytes(&self) -> usize {
        let skinning = self.skinning.as_ref().map_or(0, |(_, skinning)| skinning.bytes());
        self.weights.bytes() + self.boxes.bytes() + self.vertices.bytes() + skinning
    }

    /// The pose in model space.
    pub(crate) fn posed(&mut self) -> Posed<'_> {
        self.posed_at(&WorldFromModel::IDENTITY)
    }

    pub(crate) fn posed_at<'p>(&'p mut self, world_from_model: &'p WorldFromModel) -> Posed<'p> {
        let (place, skin) = match (&mut self.skinning, &self.bvh.skin) {
            (Some((place, skinning)), Some(tables)) => (&*place, Some((&**tables, skinning))),
            _ => (world_from_model, None),
        };
        Posed {
            place,
            skin,
            is_refitted: self.is_refitted,
            model: self.bvh.model(),
            topology: &self.bvh.topology,
            tables: &self.bvh.tables,
            leaf_lanes: self.bvh.leaf_lanes.as_deref(),
            weights: &self.weights,
            boxes: &mut self.boxes,
            vertices: &mut self.vertices,
            standing: &mut self.standing,
            blended: &mut self.blended,
            scratch: &mut self.scratch,
            level: self.bvh.kernel().level,
        }
    }
}

impl fmt::Debug for Pose {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Pose")
            .field("bvh", &self.bvh)
            .field("weights", &self.weights())
            .field("is_refitted", &self.is_refitted)
            .finish_non_exhaustive()
    }
}
