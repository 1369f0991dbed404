//! The public type of a pose: its weights, its joints and its caches.

use std::fmt;
use std::sync::Arc;

use glam::Vec3;

use super::blended_vertices::BlendedVertices;
use super::box_source::BoxSource;
use super::cache::EpochCache;
use super::fitted_boxes::FittedBoxes;
use super::placed_body::PlacedBody;
use super::posed::{Blended, Posed};
use super::skin_tree::SkinTree;
use super::skinning::Skinning;
use super::weights::WeightsError;
use crate::bounds::{Aabb, BoxLanes, WorldFromModel};
use crate::input_error::InputError;
use crate::joints::JointMatrices;
use crate::model::Weights;
use crate::tree::MorphBvh;

/// One instance of a morphing mesh: its weights, and a cache of the boxes and vertices blended for them.
///
/// Setting new weights costs a comparison and a copy; boxes are blended when a query first looks at their node. If so many weights are
/// active that blended boxes would be loose, the first query that looks into the body poses all its vertices instead. Setting the same
/// weights again keeps the cache. A pose is in the mesh's model space; each query takes the transform to world space.
///
/// Memory: 8 bytes per inner node, plus the boxes that were visited. Vertices take no memory until the first one is posed, and then about 17
/// bytes each, or 49 for a skinned mesh.
///
/// ```
/// # use std::sync::Arc;
/// # use glam::Vec3;
/// # use morph_collision::{BuildOptions, MorphBvh, MorphModel, Pose};
/// let base = [Vec3::ZERO, Vec3::X, Vec3::Y]; // a triangle, and a target that lifts it
/// let model = MorphModel::from_displacements(&base, &[[0, 1, 2]], &[[Vec3::Z; 3]])?;
/// let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
/// pose.set_weights(&[0.5])?;
/// assert_eq!(pose.source_vertex(1), Some(Vec3::new(1.0, 0.0, 0.5)));
/// assert!(pose.bounds().max.z >= 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Pose {
    pub(super) bvh: Arc<MorphBvh>,
    pub(super) weights: Weights,
    source: BoxSource,
    boxes: EpochCache<BoxLanes>,
    /// Those of a mesh without joints; [`Skinning`] keeps the others.
    vertices: BlendedVertices,
    /// For a skinned mesh: the map from the space of its boxes to world space, and the state of its joints.
    pub(super) skinning: Option<(WorldFromModel, Skinning)>,
    placed_body: PlacedBody,
    blended: Blended,
    fitted: FittedBoxes,
}

impl Pose {
    /// Creates an instance at rest: all weights are zero.
    #[must_use]
    pub fn new(bvh: Arc<MorphBvh>) -> Self {
        let skinning = bvh.model().joint_count().zip(bvh.skin.as_ref()).map(|(joints, skin)| {
            let skinning = Skinning::new(skin, JointMatrices::at_rest(joints));
            (WorldFromModel::IDENTITY, skinning)
        });
        let mut pose = Self {
            weights: Weights::new(&vec![0.0; bvh.model().target_count()]),
            source: BoxSource::Blended,
            boxes: EpochCache::new(bvh.topology.group_count()),
            vertices: BlendedVertices::new(),
            placed_body: PlacedBody::default(),
            blended: Blended::default(),
            fitted: FittedBoxes::default(),
            skinning,
            bvh,
        };
        pose.invalidate(true);
        pose
    }

    /// Sets the joint matrices of a skinned mesh, one per joint. Returns whether they differ from the previous ones. The matrices are
    /// shared, not copied.
    ///
    /// Joint matrices lead to world space: queries ignore the `world_from_model` of a skinned [`Body`](crate::Body), as glTF
    /// requires. Until the first call, all joint matrices are the identity.
    ///
    /// Cost: one pass over the joints. All cached boxes and vertices become invalid.
    ///
    /// # Errors
    /// [`InputError`] if the number of joints is wrong, or if the mesh has no joints. The pose then keeps its joints.
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
            self.invalidate(false);
        }
        Ok(changed)
    }

    /// Returns the joint matrices; `None` if the mesh is not skinned.
    #[must_use]
    pub fn joints(&self) -> Option<&JointMatrices> {
        self.skinning.as_ref().map(|(_, skinning)| &skinning.joints)
    }

    /// Discards everything computed for other joints or weights.
    fn invalidate(&mut self, weights_changed: bool) {
        self.boxes.next_epoch();
        if weights_changed {
            self.vertices.discard();
        }
        self.placed_body.invalidate();
        self.source = BoxSource::of_weights(self.bvh.model(), &self.weights);
        if let Some((_, skinning)) = &mut self.skinning {
            skinning.change(weights_changed);
        }
    }

    /// Sets the weights, one per target. They may have any sign and sum. Returns whether they differ from the previous ones.
    ///
    /// Cost: one pass over the weights.
    ///
    /// # Errors
    /// [`WeightsError`] if the number of weights is wrong, if a weight is not finite, or if the weights could move a vertex out of
    /// the range of `f32`. The pose then keeps its weights.
    pub fn set_weights(&mut self, weights: &[f32]) -> Result<bool, WeightsError> {
        self.bvh.model().check_weights(weights)?;
        let changed = self.weights.all() != weights;
        if changed {
            self.weights.set(weights);
            self.invalidate(true);
        }
        Ok(changed)
    }

    /// Fits all boxes tightly to the posed vertices now. They stay valid until the weights or joints change.
    ///
    /// This is worth it if the weights stay the same for a while, or if a query visits most of the tree, such as listing all pairs of
    /// two bodies that overlap deeply. Otherwise let queries blend what they need; `docs/measurements/methods.md` compares both.
    ///
    /// Cost: `O(n)`. Every vertex is blended and every box fitted.
    pub fn refit(&mut self) {
        self.source = BoxSource::Refitted;
        self.placed_body.invalidate();
        self.posed().refit();
    }

    /// Whether [`Pose::refit`] or [`Pose::refit_lazily`] was called since the weights or joints changed.
    fn is_refitted(&self) -> bool {
        self.source == BoxSource::Refitted
    }

    /// Poses all vertices now and fits boxes tightly to them: in the upper half of the tree's levels now, below when a query first visits
    /// them. The boxes stay valid until the weights or joints change.
    ///
    /// This is worth it if queries visit many parts of the body, but few of its triangles; `docs/performance.md` compares it as *hybrid*. With very
    /// many active targets, a pose without joints does the same by itself. Cost: `O(n)`. It poses as many vertices as [`Pose::refit`], and fits
    /// fewer boxes. If queries visit everything, each level of the lower half reads all vertices once more.
    pub fn refit_lazily(&mut self) {
        self.source = BoxSource::Refitted;
        self.placed_body.invalidate();
        self.posed().refit_upper();
    }

    /// Returns the weights, one per target.
    #[must_use]
    pub fn weights(&self) -> &[f32] {
        self.weights.all()
    }

    /// Returns the mesh's tree.
    #[must_use]
    pub fn bvh(&self) -> &Arc<MorphBvh> {
        &self.bvh
    }

    /// Returns a box around the posed mesh in model space. It is conservative, not always the smallest.
    ///
    /// For a skinned mesh the box is in world space, because joint matrices lead there; the same holds for the other methods that
    /// mention model space. Cost: the boxes of the root's children are blended from the active targets unless they are cached.
    pub fn bounds(&mut self) -> Aabb {
        if self.skinning.is_some() {
            return self.world_bounds(&WorldFromModel::IDENTITY);
        }
        self.posed().bounds()
    }

    /// Returns a conservative box in world space around the posed mesh.
    ///
    /// It contains every posed vertex as [`WorldFromModel::transform_point`] places it. It is infinite if world coordinates
    /// exceed the range of `f32`. For a skinned mesh it is the intersection of [`Pose::broad_phase_bounds`] with the box around the
    /// root's children, or around the root if vertices would have to be posed for its children. Cost: the same as [`Pose::bounds`].
    pub fn world_bounds(&mut self, world_from_model: &WorldFromModel) -> Aabb {
        let mut posed = self.posed_at(world_from_model);
        let of_nodes = posed.world_bounds();
        let of_joints = posed.hull_of_joints();
        of_joints.map_or(of_nodes, |of_joints| of_nodes.intersection(&of_joints))
    }

    /// Returns a conservative box around the posed mesh in the model space of an entity at `world_from_model`. Use it for culling.
    ///
    /// For a mesh without joints it is [`Pose::bounds`], wherever the entity is. The vertices of a skinned mesh are in world space; the
    /// box contains the exact point of model space that `world_from_model` takes to each of them. It is made as [`Pose::broad_phase_bounds`]
    /// is, but rotating a character together with its entity does not make it larger. The box is infinite if `world_from_model` cannot
    /// be inverted. Cost: as [`Pose::broad_phase_bounds`]. [`MorphBvh::local_bounds`] returns the same box without a pose if weights move vertices little.
    pub fn local_bounds(&mut self, world_from_model: &WorldFromModel) -> Aabb {
        if self.skinning.is_none() {
            return self.bounds();
        }
        let bounds = self.posed().hull_of_joints_in(world_from_model);
        bounds.unwrap_or(Aabb::UNBOUNDED)
    }

    /// Returns a conservative box in world space that is as cheap as possible, for a broad phase.
    ///
    /// For a skinned mesh it is the hull of one box per joint, around the vertices that the joint moves. It is looser than
    /// [`Pose::world_bounds`], but needs no node to be blended. For other meshes both are the same.
    ///
    /// If all weights together move no vertex by more than 1/16 of the mesh's size, the boxes are those at rest, widened by as much;
    /// [`MorphBvh::broad_phase_bounds`] then returns the same box without a pose.
    ///
    /// Cost for a skinned mesh: linear in the numbers of joints and targets. After new weights that move vertices farther, also in the number
    /// of targets that move each joint's vertices. After [`Pose::refit`] the box around the root's children costs less and is returned instead.
    pub fn broad_phase_bounds(&mut self, world_from_model: &WorldFromModel) -> Aabb {
        let is_refitted = self.is_refitted();
        let mut posed = self.posed_at(world_from_model);
        match posed.hull_of_joints().filter(|_| !is_refitted) {
            Some(bounds) => bounds,
            None => posed.world_bounds(),
        }
    }

    /// Returns the posed position of a source vertex in model space, or `None` if there is no such vertex.
    pub fn source_vertex(&mut self, source: u32) -> Option<Vec3> {
        let welded = *self.bvh.model().welded_from_source().get(source as usize)?;
        self.vertex(welded)
    }

    /// Returns the posed position of a welded vertex in model space, or `None` if there is no such vertex.
    ///
    /// [`MorphModel::triangle`](crate::MorphModel::triangle) returns the welded vertices of a triangle.
    pub fn vertex(&mut self, vertex: u32) -> Option<Vec3> {
        let exists = (vertex as usize) < self.bvh.model().vertex_count();
        exists.then(|| self.posed().model_vertex(vertex))
    }

    /// Returns the posed corners of a triangle in model space, or `None` if there is no such triangle.
    pub fn triangle(&mut self, triangle: u32) -> Option<[Vec3; 3]> {
        let exists = (triangle as usize) < self.bvh.model().triangle_count();
        let corners = |pose: &mut Self| pose.bvh.model().corners(triangle).map(|v| pose.posed().model_vertex(v));
        exists.then(|| corners(self))
    }

    /// Brings `copy` to the state of `pose`, and creates it if there is none. If the state is the same already, the copy keeps its
    /// cache.
    pub(crate) fn copied<'c>(copy: &'c mut Option<Self>, pose: &Self) -> &'c mut Self {
        let copy = copy.get_or_insert_with(|| pose.clone());
        let is_of_the_same_kind = Arc::ptr_eq(&copy.bvh, &pose.bvh) && copy.is_refitted() == pose.is_refitted();
        let is_current = is_of_the_same_kind
            && if pose.is_refitted() {
                // Refitted boxes are valid for one state only.
                copy.joints() == pose.joints() && copy.weights() == pose.weights()
            } else {
                // What one pose has accepted is never refused.
                copy.set_weights(pose.weights()).is_ok()
                    && pose.joints().is_none_or(|joints| copy.set_joints(joints).is_ok())
            };
        if !is_current {
            copy.clone_from(pose);
        }
        copy
    }

    /// Returns the heap memory in bytes, without the shared tree and without scratch memory.
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
        let (world_from_model, skin) = match (&mut self.skinning, &self.bvh.skin) {
            (Some((world_from_body, skinning)), Some(tables)) => {
                let tree = SkinTree {
                    model: self.bvh.model(),
                    skin: tables,
                    weights: &self.weights,
                    level: self.bvh.kernel().level,
                };
                if let Some(updated) = skinning.update(tree) {
                    *world_from_body = updated;
                }
                (&*world_from_body, Some((&**tables, skinning)))
            }
            _ => (world_from_model, None),
        };
        Posed {
            world_from_model,
            skin,
            model: self.bvh.model(),
            topology: &self.bvh.topology,
            tables: &self.bvh.tables,
            leaf_lanes: self.bvh.leaf_lanes.as_deref(),
            weights: &self.weights,
            boxes: &mut self.boxes,
            vertices: &mut self.vertices,
            placed_body: &mut self.placed_body,
            blended: &mut self.blended,
            fitted: &mut self.fitted,
            source: &mut self.source,
            level: self.bvh.kernel().level,
        }
    }
}

impl fmt::Debug for Pose {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Pose")
            .field("bvh", &self.bvh)
            .field("weights", &self.weights())
            .field("is_refitted", &self.is_refitted())
            .finish_non_exhaustive()
    }
}
