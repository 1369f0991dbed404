//! The reference models (Sect. 3.1): reference 0 is the base, reference `k + 1` is the base with target `k` at
//! weight 1.

use glam::{DVec3, Vec3};

use crate::rivals::blended::WeldedMesh;

/// A mesh's base and displacements, vertex by vertex.
#[derive(Clone, Debug)]
pub(super) struct References {
    base: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// `displacements[starts[v]..starts[v + 1]]` move vertex `v`: targets, ascending, with displacements.
    displacements: Vec<(u32, Vec3)>,
    starts: Vec<usize>,
    /// The largest absolute coordinate of the base, and of each target's displacements.
    pub(super) base_reach: f64,
    pub(super) target_reach: Vec<f64>,
}

impl References {
    pub(super) fn new(mesh: &WeldedMesh) -> Self {
        let mut starts = vec![0; mesh.base.len() + 1];
        let mut target_reach = vec![0.0; mesh.target_count()];
        for (target, vertex, delta) in mesh.displacements() {
            starts[vertex as usize + 1] += 1;
            let reach = &mut target_reach[target as usize];
            *reach = delta.abs().as_dvec3().max_element().max(*reach);
        }
        for vertex in 0..mesh.base.len() {
            starts[vertex + 1] += starts[vertex];
        }
        let mut displacements = vec![(0, Vec3::ZERO); starts[mesh.base.len()]];
        let mut next = starts.clone();
        for (target, vertex, delta) in mesh.displacements() {
            let next = &mut next[vertex as usize];
            displacements[*next] = (target, delta);
            *next += 1;
        }
        Self {
            triangles: mesh.triangles.clone(),
            displacements,
            starts,
            base_reach: mesh
                .base
                .iter()
                .map(|p| p.abs().as_dvec3().max_element())
                .fold(0.0, f64::max),
            target_reach,
            base: mesh.base.clone(),
        }
    }

    pub(super) fn vertex_count(&self) -> usize {
        self.base.len()
    }

    pub(super) fn target_count(&self) -> usize {
        self.target_reach.len()
    }

    fn displacements(&self, vertex: u32) -> &[(u32, Vec3)] {
        let vertex = vertex as usize;
        &self.displacements[self.starts[vertex]..self.starts[vertex + 1]]
    }

    /// The targets that move any of these vertices, ascending.
    pub(super) fn targets_that_move(&self, vertices: &[u32]) -> Vec<u32> {
        let of_vertex = |&vertex: &u32| self.displacements(vertex).iter().map(|&(target, _)| target);
        let mut targets: Vec<u32> = vertices.iter().flat_map(of_vertex).collect();
        targets.sort_unstable();
        targets.dedup();
        targets
    }

    /// The displacement of a vertex by a target.
    pub(super) fn displacement(&self, vertex: u32, target: u32) -> DVec3 {
        let displacements = self.displacements(vertex);
        match displacements.binary_search_by_key(&target, |&(target, _)| target) {
            Ok(i) => displacements[i].1.as_dvec3(),
            Err(_) => DVec3::ZERO,
        }
    }

    /// A vertex of a reference model.
    pub(super) fn position(&self, vertex: u32, reference: u32) -> DVec3 {
        let base = self.base[vertex as usize].as_dvec3();
        match reference.checked_sub(1) {
            Some(target) => base + self.displacement(vertex, target),
            None => base,
        }
    }

    /// A blended vertex, Eq. 2 as `b + sum of w_k d_k`: in `f32` over ascending targets, weights of zero skipped,
    /// multiply then add, as in all methods.
    pub(super) fn blend(&self, vertex: u32, weights: &[f32]) -> Vec3 {
        let mut blended = self.base[vertex as usize];
        for &(target, delta) in self.displacements(vertex) {
            let weight = weights[target as usize];
            if weight != 0.0 {
                blended += delta * weight;
            }
        }
        blended
    }
}
