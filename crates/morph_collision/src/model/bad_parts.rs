//! Which triangles of a mesh are bad, and how to leave them out.

use glam::Vec3;

use super::influences::SlotInfluences;
use super::targets::sealed::Sealed;
use super::targets::{SparseTarget, TargetDisplacements};
use super::{Influences, ModelError, check};

/// The triangles and vertices of a mesh for which [`MorphModel`](crate::MorphModel) would refuse the whole mesh.
///
/// A vertex is bad if its position or a displacement is not finite or too large, or if joints cannot move it: a weight is NaN, negative or
/// too large, or belongs to a joint that does not exist. A triangle is bad if a corner is a bad vertex or no vertex at all.
///
/// Find the bad parts, [repair](Self::repair) every list that has an entry per vertex, and [remove](Self::remove_from) the triangles. Vertices keep
/// their numbers. Triangles are renumbered: they move up to close the gaps.
///
/// ```
/// use glam::Vec3;
/// use morph_collision::{BadParts, MorphModel};
///
/// let mut base = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::NAN];
/// let mut triangles = vec![[0, 1, 3], [0, 1, 2]];
/// let none: [[Vec3; 4]; 0] = [];
/// assert!(MorphModel::from_displacements(&base, &triangles, &none).is_err());
///
/// let bad = BadParts::find(&base, &triangles, &none, None)?;
/// assert_eq!((bad.triangles(), bad.vertices()), (&[0][..], &[3][..]));
/// bad.repair(&mut base);
/// bad.remove_from(&mut triangles);
/// assert_eq!(MorphModel::from_displacements(&base, &triangles, &none)?.triangle_count(), 1);
/// # Ok::<(), morph_collision::ModelError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BadParts {
    triangles: Vec<u32>,
    vertices: Vec<u32>,
    first: Option<ModelError>,
    /// A vertex that is not bad.
    good: Option<u32>,
}

impl BadParts {
    /// Finds the bad parts. The arguments are those of [`MorphModel::skinned`](crate::MorphModel::skinned); `skin` is the number of joints and
    /// the sets of influences.
    ///
    /// Cost: one pass over all of it, and a byte per vertex.
    ///
    /// # Errors
    /// [`ModelError`] if lists have different lengths or are too long.
    pub fn find<T: TargetDisplacements>(
        base: &[Vec3],
        triangles: &[[u32; 3]],
        targets: &[T],
        skin: Option<(usize, &[Influences<'_>])>,
    ) -> Result<Self, ModelError> {
        check::sizes(base.len(), targets.len(), triangles.len())?;
        let (mut is_bad, mut first) = (vec![false; base.len()], None);
        let mut note = |vertex: usize, error: &dyn Fn() -> ModelError| {
            is_bad[vertex] = true;
            first.get_or_insert_with(error);
        };
        for (vertex, value) in check::bad_coordinates(&base) {
            note(vertex, &|| check::bad_coordinate("base", vertex, value));
        }
        for (k, target) in targets.iter().enumerate() {
            let shape = format!("target {k}");
            check::length(&shape, target, base.len())?;
            for (vertex, value) in check::bad_coordinates(target) {
                note(vertex, &|| check::bad_coordinate(&shape, vertex, value));
            }
        }
        if let Some((joint_count, sets)) = skin {
            let influences = SlotInfluences::new(base.len(), joint_count, sets)?;
            for vertex in 0..base.len() {
                if let Err(error) = influences.check(vertex) {
                    note(vertex, &|| error.clone());
                }
            }
        }
        let mut bad_triangles = Vec::new();
        for (triangle, corners) in (0..).zip(triangles) {
            let no_vertex = check::corners(triangle as usize, corners, base.len()).err();
            if no_vertex.is_some() || corners.iter().any(|&corner| is_bad[corner as usize]) {
                bad_triangles.push(triangle);
            }
            first = first.or(no_vertex);
        }
        let all = || (0..).zip(&is_bad);
        Ok(Self {
            triangles: bad_triangles,
            vertices: all().filter(|(_, is_bad)| **is_bad).map(|(vertex, _)| vertex).collect(),
            first,
            good: all().find(|(_, is_bad)| !**is_bad).map(|(vertex, _)| vertex),
        })
    }

    /// The bad triangles, ascending.
    #[must_use]
    pub fn triangles(&self) -> &[u32] {
        &self.triangles
    }

    /// The bad vertices, ascending. Not every one is a corner of a triangle.
    #[must_use]
    pub fn vertices(&self) -> &[u32] {
        &self.vertices
    }

    /// What is wrong with the first of them; `None` if nothing is bad.
    #[must_use]
    pub fn first(&self) -> Option<&ModelError> {
        self.first.as_ref()
    }

    /// Gives each bad vertex the value of a good one. After this is done to its position, its displacements and its influences, it is
    /// welded to that one, and neither bounds nor weights depend on it. Changes nothing if all vertices are bad.
    pub fn repair<V: Copy>(&self, of_vertices: &mut [V]) {
        let Some(good) = self.good.and_then(|good| of_vertices.get(good as usize).copied()) else {
            return;
        };
        for &vertex in &self.vertices {
            if let Some(value) = of_vertices.get_mut(vertex as usize) {
                *value = good;
            }
        }
    }

    /// The same for a sparse target.
    pub fn repair_target(&self, target: &mut SparseTarget) {
        let Some(good) = self.good.map(|good| good as usize).filter(|good| *good < target.len()) else {
            return;
        };
        let mut bad = self.vertices.iter().peekable();
        let repaired = (0..target.len()).map(|vertex| {
            let is_bad = bad.next_if(|bad| **bad as usize == vertex).is_some();
            target.of(if is_bad { good } else { vertex })
        });
        *target = repaired.collect();
        target.shrink_to_fit();
    }

    /// Removes the entries of bad triangles from a list that has one per triangle.
    pub fn remove_from<V>(&self, of_triangles: &mut Vec<V>) {
        let (mut triangle, mut bad) = (0, self.triangles.iter().peekable());
        of_triangles.retain(|_| {
            let is_bad = bad.next_if_eq(&&triangle).is_some();
            triangle += 1;
            !is_bad
        });
    }
}
