//! The traversal of two trees (Sect. 3), and the implementation of [`Method`].

use std::ops::ControlFlow;
use std::sync::Arc;

use glam::Affine3A;
use morph_collision::{Aabb, QueryStats, TrianglePair, triangles_intersect};

use super::body::Body;
use super::tree::Content;
use super::volume::Volume;
use crate::rivals::blended::WeldedMesh;
use crate::rivals::boxes::Box3;
use crate::rivals::frames::{Side, world_bounds};
use crate::rivals::{Method, PoseError, Wanted, push};

/// The bodies of the paper's method.
#[derive(Debug)]
pub(super) struct Paper<V> {
    bodies: Vec<Body<V>>,
    /// Pairs of nodes that overlap.
    stack: Vec<(u32, u32)>,
    work: QueryStats,
}

impl<V: Volume> Paper<V> {
    pub(super) fn new(meshes: &[Arc<WeldedMesh>], bodies: &[usize], in_betweens: bool) -> Self {
        let at_rest: Vec<Body<V>> = meshes.iter().map(|mesh| Body::new(mesh, in_betweens)).collect();
        Self {
            bodies: bodies.iter().map(|&mesh| at_rest[mesh].clone()).collect(),
            stack: Vec::new(),
            work: QueryStats::default(),
        }
    }

    fn walk(&mut self, a: usize, b: usize, mut found: impl FnMut(TrianglePair) -> ControlFlow<()>) {
        let Self { bodies, stack, work } = self;
        let Ok([a, b]) = bodies.get_disjoint_mut([a, b]) else {
            return;
        };
        let (placed_a, placed_b) = (a.placed(work), b.placed(work));
        let culling = V::culling(&placed_a, &placed_b);
        // Factors from a volume in model space to one in world space.
        let (scale_a, scale_b) = (placed_a.linear.determinant().abs(), placed_b.linear.determinant().abs());
        stack.clear();
        work.node_tests += 1;
        if V::overlap(&culling, a.volume(0), b.volume(0)) {
            stack.push((0, 0));
        }
        while let Some((node_a, node_b)) = stack.pop() {
            let (children, side) = match (a.tree.content(node_a).clone(), b.tree.content(node_b).clone()) {
                (Content::Triangle(triangle_a), Content::Triangle(triangle_b)) => {
                    work.triangle_tests += 1;
                    let corners_a = a.world_triangle(triangle_a, work);
                    let corners_b = b.world_triangle(triangle_b, work);
                    if triangles_intersect(&corners_a, &corners_b)
                        && found(TrianglePair { triangle_a, triangle_b }).is_break()
                    {
                        return;
                    }
                    continue;
                }
                (Content::Children(of_a), Content::Triangle(_)) => (of_a, Side::A),
                (Content::Triangle(_), Content::Children(of_b)) => (of_b, Side::B),
                (Content::Children(of_a), Content::Children(of_b)) => {
                    if size(a.volume(node_a)) * scale_a >= size(b.volume(node_b)) * scale_b {
                        (of_a, Side::A)
                    } else {
                        (of_b, Side::B)
                    }
                }
            };
            work.node_tests += u64::from(children.end - children.start);
            for child in children.rev() {
                match side {
                    Side::A => {
                        a.refit(child, work);
                        if V::overlap(&culling, a.volume(child), b.volume(node_b)) {
                            stack.push((child, node_b));
                        }
                    }
                    Side::B => {
                        b.refit(child, work);
                        if V::overlap(&culling, a.volume(node_a), b.volume(child)) {
                            stack.push((node_a, child));
                        }
                    }
                }
            }
        }
    }
}

/// The volume of the box around a bounding volume. The node with the larger box is descended.
fn size(volume: &impl Volume) -> f64 {
    let [least, most] = volume.aabb();
    (most - least).element_product()
}

impl<V: Volume> Method for Paper<V> {
    fn blend(&mut self, body: usize, weights: &[f32], world_from_model: &Affine3A) -> Result<bool, PoseError> {
        self.bodies[body].set(weights, world_from_model)?;
        Ok(false)
    }

    fn refit(&mut self, _: usize) {}

    fn is_lazy(&self) -> bool {
        true
    }

    fn world_bounds(&mut self, body: usize) -> Aabb {
        let [least, most] = self.bodies[body].aabb(&mut self.work);
        let bounds = Box3 {
            min: least.as_vec3().map(f32::next_down).into(),
            max: most.as_vec3().map(f32::next_up).into(),
        };
        world_bounds(self.bodies[body].affine(), &bounds)
    }

    fn collide(&mut self, a: usize, b: usize, wanted: Wanted, pairs: &mut Vec<TrianglePair>) {
        let start = pairs.len();
        self.walk(a, b, |pair| push(wanted, pairs, start, pair));
    }

    fn work(&self) -> QueryStats {
        self.work
    }
}
