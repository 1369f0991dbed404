//! Boxes around skinned nodes without placing vertices. Each node has a box for every joint that moves some of it, in mesh space
//! before joints move it. Its box in a frame encloses the images of these boxes under their joints.
//!
//! Bevy does this for the bounds of a whole mesh (`DynamicSkinnedMeshBounds`); here it is done for every node, when a walk
//! reaches it. Targets widen the boxes by the largest amount they can move the vertices. A joint's box encloses the
//! vertices that the joint moves. This is correct if weights are not negative: a vertex is between its images under its joints,
//! times the sum of its weights.

use std::sync::Arc;

use glam::{Affine3A, DVec3, Vec3, Vec3A};
use morph_collision::Triangle;

use super::MethodOptions;
use super::blended::{BlendedBody, WeldedMesh};
use super::bottom_up::tree_at_rest;
use super::boxes::{Box3, Box8};
use super::tree::{Tree, VertexLists};
use super::walk::Refit;

/// A tree with such boxes.
#[derive(Clone, Debug)]
pub(super) struct JointBoxes {
    measured: Arc<Measured>,
    weights: Vec<f32>,
    joints: Vec<Affine3A>,
    boxes: Vec<Box8>,
    /// The frame in which a group's boxes were computed.
    stamps: Vec<u32>,
    /// World positions, and the frame in which each was computed.
    vertices: Vec<(u32, DVec3)>,
    frame: u32,
    placed: u64,
}

/// The data that does not change from frame to frame.
#[derive(Debug)]
pub(super) struct Measured {
    pub(super) tree: Tree,
    /// Per group and lane.
    pub(super) nodes: Vec<[Node; 8]>,
    joint_boxes: Vec<JointBox>,
    target_boxes: Vec<TargetBox>,
    /// By vertex: `deltas[starts[v]..starts[v + 1]]`, ascending by target.
    deltas: Vec<(u16, Vec3)>,
    starts: Vec<u32>,
}

#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Node {
    joint_boxes: (u32, u32),
    /// The smallest and the largest sum of a vertex's weights.
    sums: [f32; 2],
}

#[derive(Debug)]
struct JointBox {
    joint: u16,
    base: Box3,
    targets: (u32, u32),
}

/// The displacements of a target for the vertices in a joint's box.
#[derive(Debug)]
struct TargetBox {
    target: u16,
    added: Box3,
}

impl Measured {
    pub(super) fn new(mesh: &WeldedMesh, options: &MethodOptions) -> Self {
        let tree = tree_at_rest(mesh, options);
        let mut by_vertex: Vec<_> = mesh
            .displacements()
            .map(|(target, vertex, delta)| (vertex, target as u16, delta))
            .collect();
        by_vertex.sort_by_key(|&(vertex, target, _)| (vertex, target));
        let mut starts = vec![0; mesh.base.len() + 1];
        for &(vertex, ..) in &by_vertex {
            starts[vertex as usize + 1] += 1;
        }
        for vertex in 0..mesh.base.len() {
            starts[vertex + 1] += starts[vertex];
        }
        let lists = VertexLists::new(&tree, &mesh.triangles, |_, _| true);
        let mut measured = Self {
            nodes: vec![[Node::default(); 8]; tree.groups.len()],
            joint_boxes: Vec::new(),
            target_boxes: Vec::new(),
            deltas: by_vertex
                .into_iter()
                .map(|(_, target, delta)| (target, delta))
                .collect(),
            starts,
            tree,
        };
        for group in 0..measured.nodes.len() {
            for lane in 0..measured.tree.groups[group].children().len() {
                measured.nodes[group][lane] = measured.node(mesh, lists.of(group, lane));
            }
        }
        measured
    }

    fn node(&mut self, mesh: &WeldedMesh, vertices: &[u32]) -> Node {
        let first = self.joint_boxes.len() as u32;
        let mut sums = [f32::INFINITY, 0.0];
        let mut moved: Vec<(u16, u32)> = Vec::new();
        for &vertex in vertices {
            let influences = mesh.influences(vertex);
            let sum: f64 = influences.iter().map(|(_, weight)| f64::from(*weight)).sum();
            sums = [
                sums[0].min((sum as f32).next_down()),
                sums[1].max((sum as f32).next_up()),
            ];
            moved.extend(influences.iter().map(|(joint, _)| (*joint, vertex)));
        }
        moved.sort_unstable();
        moved.dedup();
        for of_joint in moved.chunk_by(|a, b| a.0 == b.0) {
            let own: Vec<u32> = of_joint.iter().map(|(_, vertex)| *vertex).collect();
            self.joint_box(mesh, of_joint[0].0, &own);
        }
        Node {
            joint_boxes: (first, self.joint_boxes.len() as u32),
            sums,
        }
    }

    fn joint_box(&mut self, mesh: &WeldedMesh, joint: u16, vertices: &[u32]) {
        let first = self.target_boxes.len() as u32;
        let moves = |&vertex: &u32| self.deltas_of(vertex as usize).iter().copied();
        let mut moves: Vec<(u16, Vec3)> = vertices.iter().flat_map(moves).collect();
        moves.sort_by_key(|(target, _)| *target);
        for of_target in moves.chunk_by(|a, b| a.0 == b.0) {
            let mut added = Box3::of(of_target.iter().map(|(_, delta)| *delta));
            if of_target.len() < vertices.len() {
                added = added.union(&Box3::of([Vec3::ZERO].into_iter()));
            }
            let target = of_target[0].0;
            self.target_boxes.push(TargetBox { target, added });
        }
        self.joint_boxes.push(JointBox {
            joint,
            base: Box3::of(vertices.iter().map(|&vertex| mesh.base[vertex as usize])),
            targets: (first, self.target_boxes.len() as u32),
        });
    }

    fn deltas_of(&self, vertex: usize) -> &[(u16, Vec3)] {
        &self.deltas[self.starts[vertex] as usize..self.starts[vertex + 1] as usize]
    }

    /// The box of a node.
    pub(super) fn bounds(&self, node: Node, weights: &[f32], joints: &[Affine3A]) -> Box3 {
        /// More than all rounding of a coordinate, including that of vertices. A term for each target is added.
        const ROUNDINGS: f32 = 32.0 * f32::EPSILON;
        let (mut hull, mut farthest) = (Box3::EMPTY, 0.0_f32);
        for of in &self.joint_boxes[node.joint_boxes.0 as usize..node.joint_boxes.1 as usize] {
            let (mut centre, mut half) = ((of.base.min + of.base.max) * 0.5, (of.base.max - of.base.min) * 0.5);
            let mut reach = of.base.min.abs().max(of.base.max.abs());
            for TargetBox { target, added } in &self.target_boxes[of.targets.0 as usize..of.targets.1 as usize] {
                let weight = weights[usize::from(*target)];
                if weight != 0.0 {
                    centre += (added.min + added.max) * (0.5 * weight);
                    half += (added.max - added.min) * (0.5 * weight.abs());
                    reach += added.min.abs().max(added.max.abs()) * weight.abs();
                }
            }
            let joint = &joints[usize::from(of.joint)];
            let m = joint.matrix3.abs();
            let middle = joint.transform_point3a(centre);
            let roundings = ROUNDINGS + f32::EPSILON * (of.targets.1 - of.targets.0) as f32;
            let radius = m * (half + reach * roundings) + joint.translation.abs() * roundings;
            hull = hull.union(&Box3 {
                min: middle - radius,
                max: middle + radius,
            });
            farthest = farthest.max((m * reach + joint.translation.abs()).max_element());
        }
        let [least, most] = node.sums;
        if most <= f32::MIN_POSITIVE {
            return Box3::of([Vec3::ZERO].into_iter());
        }
        let scaled = |by: f32| [hull.min * by, hull.max * by];
        let ends = [scaled(least), scaled(most)];
        let slack = Vec3A::splat(farthest * most * ROUNDINGS + f32::MIN_POSITIVE);
        Box3 {
            min: ends[0][0].min(ends[1][0]) - slack,
            max: ends[0][1].max(ends[1][1]) + slack,
        }
    }
}

impl JointBoxes {
    fn vertex(&mut self, body: &BlendedBody, vertex: u32) -> DVec3 {
        let index = vertex as usize;
        // Without joints, a body may have moved in the world although it keeps its shape.
        if self.vertices[index].0 != self.frame || body.joints().is_none() {
            let mut posed = body.mesh.base[index];
            for &(target, delta) in self.measured.deltas_of(index) {
                let weight = self.weights[usize::from(target)];
                if weight != 0.0 {
                    posed += delta * weight;
                }
            }
            self.placed += 1;
            self.vertices[index] = (self.frame, body.placed_vertex(vertex, posed));
        }
        self.vertices[index].1
    }
}

impl Refit for JointBoxes {
    const LAZY: bool = true;
    const BAKES: bool = false;

    fn new(mesh: &WeldedMesh, options: &MethodOptions) -> Self {
        let measured = Measured::new(mesh, options);
        Self {
            weights: vec![0.0; mesh.target_count()],
            joints: vec![Affine3A::IDENTITY; mesh.joint_count().unwrap_or(1)],
            boxes: vec![Box8::default(); measured.tree.groups.len()],
            stamps: vec![0; measured.tree.groups.len()],
            vertices: vec![(0, DVec3::ZERO); mesh.base.len()],
            frame: 0,
            placed: 0,
            measured: Arc::new(measured),
        }
    }

    fn take_pose(&mut self, body: &BlendedBody) {
        self.weights.copy_from_slice(body.weights());
        if let Some(joints) = body.joints() {
            self.joints.copy_from_slice(joints);
        }
    }

    fn update(&mut self, _: &WeldedMesh, _: &[Vec3]) -> u64 {
        self.frame = self.frame.wrapping_add(1);
        if self.frame == 0 {
            self.stamps.fill(0);
            self.vertices.fill((0, DVec3::ZERO));
            self.frame = 1;
        }
        0
    }

    #[inline]
    fn open(&mut self, group: usize, _: &[Vec3]) -> u64 {
        if self.stamps[group] == self.frame {
            return 0;
        }
        self.stamps[group] = self.frame;
        let measured = Arc::clone(&self.measured);
        let children = measured.tree.groups[group].children().len();
        for lane in 0..children {
            let bounds = measured.bounds(measured.nodes[group][lane], &self.weights, &self.joints);
            self.boxes[group].set(lane, &bounds);
        }
        children as u64
    }

    fn tree(&self) -> &Tree {
        &self.measured.tree
    }

    #[inline]
    fn boxes(&self, group: usize) -> &Box8 {
        &self.boxes[group]
    }

    fn world_triangle(&mut self, body: &BlendedBody, _: &[Vec3], corners: [u32; 3]) -> Triangle {
        corners.map(|vertex| self.vertex(body, vertex))
    }

    fn take_placed(&mut self) -> u64 {
        std::mem::take(&mut self.placed)
    }
}
