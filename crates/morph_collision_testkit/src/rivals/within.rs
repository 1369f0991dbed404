//! Methods that find the triangles of one mesh that intersect each other.
//!
//! | [`SelfMethodKind`] | cost of a frame | from |
//! |---|---|---|
//! | `certified` | our query; pairs that are proved free for all weights from 0 to 1 are left out | this project |
//! | `morph` | our query | this project |
//! | `bottom-up` | blends every vertex, refits an eight-wide tree, and walks over it and itself | van den Bergen 1997 |
//! | `binary` | the same with a binary tree, split in the middle, ten triangles in a leaf, and one box at a time | the library three-mesh-bvh, as it is used for morphing meshes |
//! | `brute-force` | blends every vertex, and compares the boxes of all pairs of triangles | |
//!
//! The last three reject triangles whose boxes do not overlap before anything else. All of them decide triangles by [`morph_collision::triangles_intersect`] or with the same answer, and leave out triangles that share a
//! vertex.

use std::fmt;
use std::sync::Arc;

use glam::{Affine3A, Vec3};
use morph_collision::proof::{Effort, SelfProof, WeightBox};
use morph_collision::{MorphBvh, Pose, QueryStats, SelfQuery, Triangle, TrianglePair, triangles_intersect};

use super::blended::{BlendedBody, WeldedMesh};
use super::bottom_up::box_around;
use super::boxes::{Box3, Box8};
use super::build::{Builder, Cut, Limits};
use super::tree::{Child, Tree, VertexLists};
use super::{MethodOptions, PoseError, SetUpError};
use crate::mesh::MorphMesh;

/// A method, by name. The [module's table](self) describes each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SelfMethodKind {
    /// Our query, with certificates.
    Certified,
    /// Our query.
    Morph,
    /// An eight-wide tree, refitted.
    BottomUp,
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
    pub const ALL: [Self; 5] = [
        Self::Certified,
        Self::Morph,
        Self::BottomUp,
        Self::Binary,
        Self::BruteForce,
    ];

    /// Prepares the method for a mesh without joints.
    ///
    /// # Errors
    /// The mesh is invalid or skinned.
    pub fn set_up(self, mesh: &MorphMesh) -> Result<Box<dyn SelfMethod>, SetUpError> {
        let told = |reason| SetUpError::Model { mesh: 0, reason };
        let ours = |is_certified: bool| -> Result<Box<dyn SelfMethod>, SetUpError> {
            let model = Arc::new(mesh.to_model().map_err(told)?);
            let bvh = Arc::new(MorphBvh::build(model, &MethodOptions::default().tree));
            if is_certified {
                certify(&bvh)?;
            }
            Ok(Box::new(Ours {
                pose: Pose::new(bvh),
                query: SelfQuery::new(),
                work: QueryStats::default(),
            }))
        };
        let welded = || WeldedMesh::new(mesh).map(Arc::new).map_err(told);
        let leaf_size = MethodOptions::default().tree.leaf_size();
        Ok(match self {
            Self::Certified => ours(true)?,
            Self::Morph => ours(false)?,
            Self::BottomUp => Box::new(Refitted::new(&welded()?, Cut::Sah, Limits { arity: 8, leaf_size })),
            Self::Binary => Box::new(Refitted::new(
                &welded()?,
                Cut::Middle,
                Limits {
                    arity: 2,
                    leaf_size: 10,
                },
            )),
            Self::BruteForce => Box::new(AllPairs {
                body: Posed::new(&welded()?),
                work: QueryStats::default(),
            }),
        })
    }
}

impl fmt::Display for SelfMethodKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Certified => "certified",
            Self::Morph => "morph",
            Self::BottomUp => "bottom-up",
            Self::Binary => "binary",
            Self::BruteForce => "brute-force",
        })
    }
}

/// Gives a tree certificates for all weights from 0 to 1, if it has none.
///
/// # Errors
/// The mesh is skinned.
pub fn certify(bvh: &Arc<MorphBvh>) -> Result<(), morph_collision::InputError> {
    let effort = Effort {
        boxes_per_pair: 1,
        listed: 0,
        ..Effort::default()
    };
    let proof = SelfProof::new(bvh, &WeightBox::unit(bvh.model().target_count()), effort)?;
    bvh.set_certificates(proof.certificates(&proof.run())?).map(|_| ())
}

#[derive(Debug)]
struct Ours {
    pose: Pose,
    query: SelfQuery,
    work: QueryStats,
}

impl SelfMethod for Ours {
    fn find(&mut self, weights: &[f32], pairs: &mut Vec<TrianglePair>) -> Result<(), PoseError> {
        self.pose.set_weights(weights)?;
        self.query.all(&mut self.pose, pairs);
        self.work += self.query.stats();
        Ok(())
    }

    fn work(&self) -> QueryStats {
        self.work
    }
}

/// A mesh all of whose vertices are blended.
#[derive(Debug)]
struct Posed {
    body: BlendedBody,
    vertices: Vec<Vec3>,
    /// Of all triangles.
    boxes: Vec<Box3>,
}

impl Posed {
    fn new(mesh: &Arc<WeldedMesh>) -> Self {
        let mut posed = Self {
            vertices: mesh.base.clone(),
            body: BlendedBody::new(Arc::clone(mesh)),
            boxes: Vec::new(),
        };
        posed.box_triangles();
        posed
    }

    fn box_triangles(&mut self) {
        let triangles = self.body.mesh.triangles.iter();
        self.boxes.clear();
        self.boxes
            .extend(triangles.map(|corners| box_around(corners, &self.vertices)));
    }

    /// Returns whether the weights are new.
    fn set(&mut self, weights: &[f32], work: &mut QueryStats) -> Result<bool, PoseError> {
        let is_new = self.body.set(weights, &Affine3A::IDENTITY)?;
        if is_new {
            self.body.blend(&mut self.vertices);
            self.box_triangles();
            work.vertices_blended += self.vertices.len() as u64;
        }
        Ok(is_new)
    }

    fn corners(&self, triangle: u32) -> [u32; 3] {
        self.body.mesh.triangles[triangle as usize]
    }

    fn triangle(&self, triangle: u32) -> Triangle {
        self.corners(triangle)
            .map(|corner| self.vertices[corner as usize].as_dvec3())
    }

    /// Compares two triangles.
    #[inline]
    fn test(&self, a: u32, b: u32, work: &mut QueryStats, pairs: &mut Vec<TrianglePair>) {
        if self.boxes[a as usize].overlaps(&self.boxes[b as usize]) {
            self.test_near(a, b, work, pairs);
        }
    }

    /// Compares two triangles whose boxes overlap.
    fn test_near(&self, a: u32, b: u32, work: &mut QueryStats, pairs: &mut Vec<TrianglePair>) {
        let (of_a, of_b) = (self.corners(a), self.corners(b));
        if of_a.iter().any(|corner| of_b.contains(corner)) {
            return;
        }
        work.triangle_tests += 1;
        if triangles_intersect(&self.triangle(a), &self.triangle(b)) {
            let (triangle_a, triangle_b) = (a.min(b), a.max(b));
            pairs.push(TrianglePair { triangle_a, triangle_b });
        }
    }
}

#[derive(Debug)]
struct AllPairs {
    body: Posed,
    work: QueryStats,
}

impl SelfMethod for AllPairs {
    fn find(&mut self, weights: &[f32], pairs: &mut Vec<TrianglePair>) -> Result<(), PoseError> {
        self.body.set(weights, &mut self.work)?;
        let (body, boxes) = (&self.body, &self.body.boxes);
        for (i, one) in boxes.iter().enumerate() {
            for (j, other) in boxes.iter().enumerate().skip(i + 1) {
                if one.overlaps(other) {
                    body.test_near(i as u32, j as u32, &mut self.work, pairs);
                }
            }
        }
        let count = boxes.len() as u64;
        self.work.node_tests += count * count.saturating_sub(1) / 2;
        Ok(())
    }

    fn work(&self) -> QueryStats {
        self.work
    }
}

/// A tree whose boxes are all refitted, and a walk over it and itself.
#[derive(Debug)]
struct Refitted {
    body: Posed,
    tree: Tree,
    leaves: VertexLists,
    boxes: Vec<Box8>,
    /// Whether the boxes of a node's children are compared at once.
    is_wide: bool,
    work: QueryStats,
}

/// A child of a group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Node {
    group: u32,
    lane: u8,
}

impl Refitted {
    fn new(mesh: &Arc<WeldedMesh>, cut: Cut, limits: Limits) -> Self {
        let mut tree = Tree::default();
        Builder::default().build(&mut tree, &mesh.triangles, &mesh.base, cut, limits);
        let is_leaf = |child| matches!(child, Child::Leaf(_));
        let mut refitted = Self {
            body: Posed::new(mesh),
            leaves: VertexLists::new(&tree, &mesh.triangles, |_, child| is_leaf(child)),
            boxes: vec![Box8::default(); tree.groups.len()],
            is_wide: limits.arity > 2,
            tree,
            work: QueryStats::default(),
        };
        refitted.refit();
        refitted.work = QueryStats::default();
        refitted
    }

    fn refit(&mut self) {
        // Children come after their parents.
        for (index, group) in self.tree.groups.iter().enumerate().rev() {
            for (lane, &child) in group.children().iter().enumerate() {
                let one = match child {
                    Child::Leaf(_) => box_around(self.leaves.of(index, lane), &self.body.vertices),
                    Child::Group(below) => {
                        let below = below as usize;
                        self.boxes[below].hull(self.tree.groups[below].children().len())
                    }
                };
                self.boxes[index].set(lane, &one);
            }
        }
        self.work.nodes_blended += self.tree.node_count();
    }

    fn child(&self, node: Node) -> Child {
        self.tree.groups[node.group as usize].children()[usize::from(node.lane)]
    }

    fn box_of(&self, node: Node) -> Box3 {
        self.boxes[node.group as usize].get(usize::from(node.lane))
    }

    /// The children of a group from a lane on that overlap a box, as a mask.
    fn overlapping(&mut self, group: u32, from: usize, other: &Box3) -> u8 {
        let (boxes, count) = (
            &self.boxes[group as usize],
            self.tree.groups[group as usize].children().len(),
        );
        self.work.node_tests += (count - from) as u64;
        if self.is_wide {
            return boxes.overlap_mask(other) & u8::MAX << from;
        }
        let lanes = (from..count).filter(|&lane| boxes.get(lane).overlaps(other));
        lanes.fold(0, |mask, lane| mask | 1 << lane)
    }

    fn walk(&mut self, pairs: &mut Vec<TrianglePair>) {
        let root = Node { group: 0, lane: 0 };
        let mut stack = vec![(root, root)];
        while let Some((a, b)) = stack.pop() {
            if a == b {
                match self.child(a) {
                    Child::Leaf(leaf) => self.leaves(leaf, leaf, pairs),
                    Child::Group(group) => {
                        let count = self.tree.groups[group as usize].children().len();
                        for lane in 0..count {
                            let node = Node {
                                group,
                                lane: lane as u8,
                            };
                            stack.push((node, node));
                            if lane + 1 < count {
                                let mask = self.overlapping(group, lane + 1, &self.box_of(node));
                                stack.extend(lanes(group, mask).map(|other| (node, other)));
                            }
                        }
                    }
                }
                continue;
            }
            let size = |of: Box3| (of.max - of.min).element_sum();
            let (group, other) = match (self.child(a), self.child(b)) {
                (Child::Leaf(a), Child::Leaf(b)) => {
                    self.leaves(a, b, pairs);
                    continue;
                }
                (Child::Group(_), Child::Group(group)) if size(self.box_of(a)) < size(self.box_of(b)) => (group, a),
                (Child::Group(group), _) => (group, b),
                (Child::Leaf(_), Child::Group(group)) => (group, a),
            };
            let mask = self.overlapping(group, 0, &self.box_of(other));
            stack.extend(lanes(group, mask).map(|child| (child, other)));
        }
    }

    fn leaves(&mut self, a: u32, b: u32, pairs: &mut Vec<TrianglePair>) {
        let (of_a, of_b) = (self.tree.leaf(a), self.tree.leaf(b));
        for (i, &one) in of_a.iter().enumerate() {
            let from = if a == b { i + 1 } else { 0 };
            for &other in &of_b[from..] {
                self.body.test(one, other, &mut self.work, pairs);
            }
        }
    }
}

/// The children of a group in a mask.
fn lanes(group: u32, mask: u8) -> impl Iterator<Item = Node> {
    (0..8)
        .filter(move |lane| mask >> lane & 1 == 1)
        .map(move |lane| Node { group, lane })
}

impl SelfMethod for Refitted {
    fn find(&mut self, weights: &[f32], pairs: &mut Vec<TrianglePair>) -> Result<(), PoseError> {
        if self.body.set(weights, &mut self.work)? {
            self.refit();
        }
        self.walk(pairs);
        Ok(())
    }

    fn work(&self) -> QueryStats {
        self.work
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::random::{random_blob, triangle_soup};

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
