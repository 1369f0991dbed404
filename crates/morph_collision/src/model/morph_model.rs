//! The mesh with its targets and joints.

use std::fmt;

use glam::{Vec3, Vec3A};

use super::blocks::{BLOCK, BlockVectors, block_and_lane};
use super::displacements::Displacements;
use super::influences::{Influences, SlotInfluences};
use super::skin::Skin;
use super::targets::TargetDisplacements;
use super::weld::{Welded, weld};
use super::{Displacement, ModelError, Weights, check, vertex_order};
use crate::hash::{START, hash};

/// A triangle mesh with morph targets, and with joints if it is skinned. It is immutable and shared by all instances.
///
/// Vertices with equal positions, displacements and influences are welded. The vertices you pass in are the *source* vertices;
/// [`MorphModel::welded_from_source`] maps them to welded ones. They are numbered so that eight consecutive ones, a *block*, are
/// near each other; a block is posed as a whole. Triangles keep their order and winding. A mesh with neither targets nor joints is
/// an ordinary rigid mesh.
///
/// Positions are in the mesh's own space and unit. Memory:
///
/// - 12 bytes per welded vertex, 12 per block, and 4 per source vertex
/// - 12 bytes per triangle
/// - 96 bytes per block and target that moves any of its vertices
/// - 2 bytes per target in each distinct set of targets that moves a block
/// - for skinned meshes, 36 bytes per block and joint that moves any of its vertices, and 4 per block
///
/// ```
/// use glam::{Vec3, vec3};
/// use morph_collision::MorphModel;
///
/// let square = [vec3(0.0, 0.0, 0.0), vec3(1.0, 0.0, 0.0), vec3(1.0, 1.0, 0.0), vec3(0.0, 1.0, 0.0)];
/// let lift_one_side = [Vec3::ZERO, Vec3::ZERO, Vec3::Z, Vec3::Z];
/// let model = MorphModel::from_displacements(&square, &[[0, 1, 2], [0, 2, 3]], &[lift_one_side])?;
/// assert_eq!((model.triangle_count(), model.target_count()), (2, 1));
/// # Ok::<(), morph_collision::ModelError>(())
/// ```
#[derive(Clone)]
pub struct MorphModel {
    vertex_count: usize,
    /// By block. No coordinate is -0.
    base: Vec<BlockVectors>,
    displacements: Displacements,
    triangles: Vec<[u32; 3]>,
    welded_from_source: Vec<u32>,
    skin: Option<Skin>,
    /// The largest absolute coordinate of the base.
    base_reach: f32,
    /// The largest absolute coordinate of each target's displacements.
    target_reach: Vec<f32>,
}

impl MorphModel {
    /// Creates a model from base positions and per-target displacements, as glTF stores them: a vertex is `base + sum_k w_k d_k`.
    ///
    /// Each target has one displacement per base vertex, dense or as a [`SparseTarget`](crate::SparseTarget). `triangles` index the base.
    ///
    /// Takes little more memory than the model needs afterwards.
    ///
    /// # Errors
    /// [`ModelError`] if
    ///
    /// - there are no vertices or no triangles, or too many
    /// - an index is out of range
    /// - a target and the base have different lengths
    /// - a coordinate is not finite, or larger than 1e37 in absolute value
    ///
    /// The error names the target, vertex or triangle.
    pub fn from_displacements<T: TargetDisplacements>(
        base: &[Vec3],
        triangles: &[[u32; 3]],
        targets: &[T],
    ) -> Result<Self, ModelError> {
        Self::new(base, triangles, targets, None)
    }

    /// Creates a model of a skinned mesh. Targets displace vertices first, then joints move them.
    ///
    /// `base`, `triangles` and `targets` are as in [`MorphModel::from_displacements`]. Pass any number of sets of influences, each with four
    /// per vertex. If a vertex's weights do not sum to 1, it is pulled towards the world's origin, as GPUs draw it.
    ///
    /// # Errors
    /// As for [`MorphModel::from_displacements`], and if a set of influences and the base have different lengths, an influence has a weight
    /// that is NaN, negative or more than 1000, its joint is out of range, or the weights of a vertex sum to more than 8000. The error names
    /// the vertex, the influence and the joint.
    ///
    /// ```
    /// use std::sync::Arc;
    /// use glam::{Affine3A, Vec3};
    /// use morph_collision::{BuildOptions, Influences, JointMatrices, MorphBvh, MorphModel, Pose};
    ///
    /// // A triangle whose last corner follows joint 1; the others follow joint 0. Unused slots have weight 0.
    /// let influences = Influences {
    ///     joints: &[[0, 0, 0, 0], [0, 0, 0, 0], [1, 0, 0, 0]],
    ///     weights: &[[1.0, 0.0, 0.0, 0.0]; 3],
    /// };
    /// let targets: [[Vec3; 3]; 0] = [];
    /// let model = MorphModel::skinned(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[[0, 1, 2]], &targets, 2, &[influences])?;
    /// let mut pose = Pose::new(Arc::new(MorphBvh::build(Arc::new(model), &BuildOptions::default())));
    /// pose.set_joints(&JointMatrices::new(&[Affine3A::IDENTITY, Affine3A::from_translation(Vec3::Y)])?)?;
    /// assert_eq!(pose.source_vertex(2), Some(Vec3::Y * 2.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn skinned<T: TargetDisplacements>(
        base: &[Vec3],
        triangles: &[[u32; 3]],
        targets: &[T],
        joint_count: usize,
        influences: &[Influences<'_>],
    ) -> Result<Self, ModelError> {
        let influences = SlotInfluences::checked(base.len(), joint_count, influences)?;
        Self::new(base, triangles, targets, Some(&influences))
    }

    fn new<T: TargetDisplacements>(
        base: &[Vec3],
        triangles: &[[u32; 3]],
        targets: &[T],
        influences: Option<&SlotInfluences<'_>>,
    ) -> Result<Self, ModelError> {
        check::vectors("base", &base, base.len())?;
        for (k, target) in targets.iter().enumerate() {
            check::vectors(&format!("target {k}"), target, base.len())?;
        }
        if base.is_empty() {
            return Err(ModelError::NoVertices);
        }
        check::sizes(base.len(), targets.len(), triangles.len())?;
        check::triangles(triangles, base.len())?;

        let Welded {
            mut from_source,
            firsts: mut vertices,
        } = weld(base, targets, influences);
        let mut numbers = vec![0; vertices.len()];
        vertex_order::sort(&mut vertices, base, influences);
        for (number, &vertex) in (0..).zip(&vertices) {
            numbers[from_source[vertex as usize] as usize] = number;
        }
        from_source
            .iter_mut()
            .for_each(|welded| *welded = numbers[*welded as usize]);
        // The sum turns -0 into 0. So no sum of displacements is -0, and adding a zero to it changes no bit.
        let position = |&vertex: &u32| base[vertex as usize] + Vec3::ZERO;
        Ok(Self {
            vertex_count: vertices.len(),
            base: vertices
                .chunks(BLOCK)
                .map(|block| BlockVectors::new(block, position))
                .collect(),
            displacements: Displacements::new(targets, &vertices),
            triangles: triangles
                .iter()
                .map(|corners| corners.map(|source| from_source[source as usize]))
                .collect(),
            welded_from_source: from_source,
            skin: influences.map(|influences| Skin::new(influences, &vertices)),
            base_reach: reach(base),
            target_reach: targets.iter().map(|target| reach(target.stored())).collect(),
        })
    }

    /// The number of targets. Each instance has as many weights.
    #[must_use]
    pub fn target_count(&self) -> usize {
        self.target_reach.len()
    }

    /// The number of joints, or `None` if the mesh is not skinned.
    #[must_use]
    pub fn joint_count(&self) -> Option<usize> {
        self.skin.as_ref().map(Skin::joint_count)
    }

    /// The largest difference between 1 and the sum of a vertex's joint weights, rounded up, or `None` if the mesh is not skinned.
    ///
    /// Weights are not normalised: a vertex whose weights sum to more or less than 1 is pushed away from the world's origin or pulled
    /// towards it. Exporters write weights that sum to 1, apart from rounding.
    #[must_use]
    pub fn joint_weight_error(&self) -> Option<f64> {
        self.skin.as_ref().map(Skin::max_missing)
    }

    /// The number of triangles.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// The number of vertices before welding.
    #[must_use]
    pub fn source_vertex_count(&self) -> usize {
        self.welded_from_source.len()
    }

    /// The number of vertices after welding.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// The welded vertices of a triangle, in source winding, or `None` if there is no such triangle.
    #[must_use]
    pub fn triangle(&self, triangle: u32) -> Option<[u32; 3]> {
        self.triangles.get(triangle as usize).copied()
    }

    /// The welded vertex of each source vertex.
    #[must_use]
    pub fn welded_from_source(&self) -> &[u32] {
        &self.welded_from_source
    }

    /// The number of welded vertices that a target moves; 0 if there is no such target.
    ///
    /// Cost: linear in the number of stored displacements.
    #[must_use]
    pub fn displaced_vertex_count(&self, target: u32) -> usize {
        let vertices = 0..self.vertex_count as u32;
        vertices
            .flat_map(|vertex| self.displacements(vertex))
            .filter(|d| u32::from(d.target) == target)
            .count()
    }

    /// A hash (FNV-1a) of all positions, displacements, triangles and influences, which tells meshes apart. It is the same on every machine.
    ///
    /// Cost: one pass over the mesh.
    #[must_use]
    pub fn fingerprint(&self) -> u64 {
        let words = |v: Vec3| v.to_array().map(f32::to_bits);
        let of_vertex = |vertex| {
            let displacements = || self.displacements(vertex);
            let influences = || self.skin.iter().flat_map(move |skin| skin.influences(vertex));
            let counts = [displacements().count() as u32, influences().count() as u32];
            let displacements =
                displacements().flat_map(move |d| [u32::from(d.target)].into_iter().chain(words(d.delta)));
            let influences = influences().flat_map(|of| [u32::from(of.joint), of.weight.to_bits()]);
            let position = words(self.base(vertex));
            position
                .into_iter()
                .chain(counts)
                .chain(displacements)
                .chain(influences)
        };
        let counts = [self.target_count(), self.joint_count().map_or(0, |count| count + 1)].map(|count| count as u32);
        let vertices = (0..self.vertex_count as u32).flat_map(of_vertex);
        let all = counts
            .into_iter()
            .chain(vertices)
            .chain(self.triangles.iter().flatten().copied());
        hash(START, all.map(u64::from))
    }

    /// Bytes on the heap.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.base)
            + self.displacements.bytes()
            + size_of_val(&*self.triangles)
            + size_of_val(&*self.welded_from_source)
            + size_of_val(&*self.target_reach)
            + self.skin.as_ref().map_or(0, |skin| skin.rows().bytes())
    }

    /// The welded vertices of a triangle.
    ///
    /// # Panics
    /// If there is no such triangle.
    #[inline]
    pub(crate) fn corners(&self, triangle: u32) -> [u32; 3] {
        self.triangles[triangle as usize]
    }

    #[inline]
    pub(crate) fn base(&self, vertex: u32) -> Vec3 {
        let (block, lane) = block_and_lane(vertex);
        self.base[block].of(lane)
    }

    /// The displacements of a vertex, in ascending target order.
    pub(crate) fn displacements(&self, vertex: u32) -> impl Iterator<Item = Displacement> {
        self.displacements.of_vertex(vertex)
    }

    /// The number of blocks.
    pub(crate) fn block_count(&self) -> usize {
        self.base.len()
    }

    /// The number of vertices in a block.
    pub(crate) fn block_len(&self, block: usize) -> usize {
        BLOCK.min(self.vertex_count - block * BLOCK)
    }

    /// The base positions of a block, the targets that move it, ascending, and their displacements.
    #[inline(always)]
    pub(super) fn block(&self, block: usize) -> (&BlockVectors, &[u16], &[BlockVectors]) {
        let (targets, deltas) = self.displacements.of_block(block);
        (&self.base[block], targets, deltas)
    }

    pub(crate) fn skin(&self) -> Option<&Skin> {
        self.skin.as_ref()
    }

    /// The largest absolute coordinate of a vertex while all weights are 0.
    #[must_use]
    pub fn base_reach(&self) -> f32 {
        self.base_reach
    }

    pub(crate) fn target_reach(&self) -> &[f32] {
        &self.target_reach
    }

    /// An estimate of how loose boxes are that are blended for these weights.
    pub(crate) fn looseness(&self, weights: &Weights) -> f32 {
        self.displacements.looseness(weights)
    }

    /// The posed position of a welded vertex in model space. Every answer is based on this definition.
    ///
    /// It is computed in `f32`, in ascending target order, skipping zero weights, with separate multiplications and additions.
    /// Zero displacements may be added or left out, which changes no bit. [`MorphModel::blend_block`] does the same for eight vertices.
    #[inline]
    pub(crate) fn blend_vertex(&self, vertex: u32, weights: &Weights) -> Vec3A {
        let (block, lane) = block_and_lane(vertex);
        let (base, targets, deltas) = self.block(block);
        let mut position = Vec3A::from(base.of(lane));
        weights.visit(targets, deltas, |weight, deltas| {
            position += Vec3A::from(deltas.of(lane)) * weight;
        });
        position
    }
}

impl fmt::Debug for MorphModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MorphModel")
            .field("source_vertices", &self.source_vertex_count())
            .field("vertices", &self.vertex_count())
            .field("triangles", &self.triangle_count())
            .field("targets", &self.target_count())
            .finish_non_exhaustive()
    }
}

fn reach(vectors: &[Vec3]) -> f32 {
    vectors.iter().fold(0.0, |reach, v| reach.max(v.abs().max_element()))
}
