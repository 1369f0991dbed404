use std::ops::Range;

use glam::Vec3;

use super::weld::weld;
use super::{ModelError, Subject, check};

/// Coordinates beyond this leave no room for sums in `f32`.
pub(crate) const LARGEST: f32 = 1e37;

/// How one target moves one vertex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Displacement {
    pub(crate) target: u32,
    pub(crate) delta: Vec3,
}

/// A triangle mesh with morph targets, immutable and shared by all instances.
///
/// Vertices that agree in position and all displacements are welded; displacements are stored sparsely per vertex.
/// Triangles keep the user's order and numbering, and [`MorphModel::welded_from_source`] leads from the user's vertices to
/// the welded ones. A mesh without targets is an ordinary rigid mesh.
///
/// Positions are in the mesh's own space and unit; memory is 12 bytes per welded vertex and triangle, 16 per vertex that
/// a target moves.
#[derive(Clone, Debug)]
pub struct MorphModel {
    base: Vec<Vec3>,
    /// `displacements[starts[v]..starts[v + 1]]` belong to vertex `v`, in ascending target order.
    displacements: Vec<Displacement>,
    starts: Vec<u32>,
    triangles: Vec<[u32; 3]>,
    welded_from_source: Vec<u32>,
    /// The largest absolute coordinate of the base, and of each target's displacements.
    base_reach: f32,
    target_reach: Vec<f32>,
}

impl MorphModel {
    /// From base positions and per-target displacements, as glTF stores them: a vertex is `base + sum_k w_k d_k`.
    ///
    /// Every target has as many displacements as the base has vertices; `triangles` index the base.
    ///
    /// # Errors
    /// No vertices or triangles, an index out of range, a target of another length, a coordinate that is not finite (or
    /// beyond 1e37): the error names the target, vertex or triangle.
    pub fn from_displacements<T: AsRef<[Vec3]>>(
        base: &[Vec3],
        triangles: &[[u32; 3]],
        targets: &[T],
    ) -> Result<Self, ModelError> {
        check::positions(Subject::Base, base)?;
        for (k, target) in targets.iter().enumerate() {
            check::length(Subject::Target(k), target.as_ref(), base.len())?;
            check::positions(Subject::Target(k), target.as_ref())?;
        }
        Self::from_valid_displacements(base, triangles, targets)
    }

    /// From reference shapes, as the paper has them: reference 0 is the base, and the weights are those of references 1,
    /// 2, ..., so that reference 0 has the weight that is missing to 1.
    ///
    /// The displacement of a reference is its difference to reference 0, rounded to `f32`.
    ///
    /// # Errors
    /// As [`MorphModel::from_displacements`], and when there is no reference at all.
    pub fn from_references<T: AsRef<[Vec3]>>(references: &[T], triangles: &[[u32; 3]]) -> Result<Self, ModelError> {
        let (base, others) = references.split_first().ok_or(ModelError::NoReferences)?;
        let base = base.as_ref();
        check::positions(Subject::Reference(0), base)?;
        let mut targets = Vec::with_capacity(others.len());
        for (k, reference) in others.iter().enumerate() {
            let reference = reference.as_ref();
            check::length(Subject::Reference(k + 1), reference, base.len())?;
            check::positions(Subject::Reference(k + 1), reference)?;
            targets.push(reference.iter().zip(base).map(|(p, b)| p - b).collect::<Vec<_>>());
        }
        Self::from_valid_displacements(base, triangles, &targets)
    }

    fn from_valid_displacements<T: AsRef<[Vec3]>>(
        base: &[Vec3],
        triangles: &[[u32; 3]],
        targets: &[T],
    ) -> Result<Self, ModelError> {
        if base.is_empty() {
            return Err(ModelError::NoVertices);
        }
        check::count("vertices", base.len(), u32::MAX as usize / 4)?;
        check::count("targets", targets.len(), u16::MAX as usize)?;
        check::triangles(triangles, base.len())?;

        let sparse = SparseRows::gather(base.len(), targets);
        let (welded_from_source, firsts) = weld(base, |vertex| sparse.row(vertex));
        let mut displacements = Vec::new();
        let mut starts = vec![0];
        for &first in &firsts {
            displacements.extend_from_slice(sparse.row(first));
            starts.push(displacements.len() as u32);
        }
        Ok(Self {
            base: firsts.iter().map(|&first| base[first]).collect(),
            displacements,
            starts,
            triangles: triangles
                .iter()
                .map(|corners| corners.map(|source| welded_from_source[source as usize]))
                .collect(),
            welded_from_source,
            base_reach: reach(base),
            target_reach: targets.iter().map(|target| reach(target.as_ref())).collect(),
        })
    }

    /// How many targets the mesh has, and so how many weights an instance.
    #[must_use]
    pub fn target_count(&self) -> usize {
        self.target_reach.len()
    }

    /// How many triangles; they are numbered as the user gave them.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// How many vertices the user gave.
    #[must_use]
    pub fn source_vertex_count(&self) -> usize {
        self.welded_from_source.len()
    }

    /// How many vertices are left after welding.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.base.len()
    }

    /// The welded vertices of a triangle, in the user's winding.
    ///
    /// # Panics
    /// If `triangle` is not below [`MorphModel::triangle_count`].
    #[must_use]
    pub fn triangle(&self, triangle: usize) -> [u32; 3] {
        self.triangles[triangle]
    }

    /// For each of the user's vertices the index of its welded vertex.
    #[must_use]
    pub fn welded_from_source(&self) -> &[u32] {
        &self.welded_from_source
    }

    /// How many welded vertices a target moves at all; 0 for a target that does not exist.
    ///
    /// Cost: linear in the number of stored displacements.
    #[must_use]
    pub fn displaced_vertex_count(&self, target: usize) -> usize {
        self.displacements
            .iter()
            .filter(|d| d.target as usize == target)
            .count()
    }

    /// A number that differs between meshes: of all positions, displacements and triangles (FNV-1a).
    ///
    /// The same on every machine. Cost: one pass over the mesh.
    #[must_use]
    pub fn fingerprint(&self) -> u64 {
        let words = |v: &Vec3| v.to_array().map(f32::to_bits);
        let positions = self.base.iter().flat_map(words);
        let displacements = self.displacements.iter().flat_map(|d| {
            let [x, y, z] = words(&d.delta);
            [d.target, x, y, z]
        });
        let numbers = self.starts.iter().chain(self.triangles.iter().flatten()).copied();
        let targets = std::iter::once(self.target_reach.len() as u32);
        let all = positions.chain(displacements).chain(numbers).chain(targets);
        all.fold(0xcbf2_9ce4_8422_2325, |hash, word| {
            (hash ^ u64::from(word)).wrapping_mul(0x0100_0000_01b3)
        })
    }

    /// Bytes held on the heap.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&*self.base)
            + size_of_val(&*self.displacements)
            + size_of_val(&*self.starts)
            + size_of_val(&*self.triangles)
            + size_of_val(&*self.welded_from_source)
            + size_of_val(&*self.target_reach)
    }

    pub(crate) fn base(&self, vertex: u32) -> Vec3 {
        self.base[vertex as usize]
    }

    #[inline]
    pub(crate) fn displacements(&self, vertex: u32) -> &[Displacement] {
        let v = vertex as usize;
        &self.displacements[self.starts[v] as usize..self.starts[v + 1] as usize]
    }

    pub(crate) fn base_reach(&self) -> f32 {
        self.base_reach
    }

    pub(crate) fn target_reach(&self) -> &[f32] {
        &self.target_reach
    }

    /// A posed welded vertex in model space: the definition that every answer rests on.
    ///
    /// `f32`, ascending target order, zero weights left out, multiply then add. Leaving out displacements that are zero
    /// changes no value.
    #[inline]
    pub(crate) fn blend_vertex(&self, vertex: u32, weights: &[f32]) -> Vec3 {
        let mut position = self.base[vertex as usize];
        for displacement in self.displacements(vertex) {
            let weight = weights[displacement.target as usize];
            if weight != 0.0 {
                position += displacement.delta * weight;
            }
        }
        position
    }
}

/// Target-major dense displacements turned into vertex-major sparse ones.
struct SparseRows {
    entries: Vec<Displacement>,
    rows: Vec<Range<usize>>,
}

impl SparseRows {
    fn gather<T: AsRef<[Vec3]>>(vertices: usize, targets: &[T]) -> Self {
        let mut entries = Vec::new();
        let rows = (0..vertices)
            .map(|vertex| {
                let start = entries.len();
                let moved = targets.iter().enumerate().filter_map(|(target, deltas)| {
                    let delta = deltas.as_ref()[vertex];
                    (delta != Vec3::ZERO).then_some(Displacement {
                        target: target as u32,
                        delta,
                    })
                });
                entries.extend(moved);
                start..entries.len()
            })
            .collect();
        Self { entries, rows }
    }

    fn row(&self, vertex: usize) -> &[Displacement] {
        &self.entries[self.rows[vertex].clone()]
    }
}

fn reach(vectors: &[Vec3]) -> f32 {
    vectors.iter().fold(0.0, |reach, v| reach.max(v.abs().max_element()))
}
