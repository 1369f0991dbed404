//! The walk over two trees, and the bodies with such trees: shared by the methods that differ only in when boxes are
//! computed.

use std::fmt::Debug;
use std::ops::ControlFlow;
use std::sync::Arc;

use glam::{Affine3A, Vec3};
use morph_collision::{Aabb, QueryStats, Triangle, TrianglePair, triangles_intersect};

use super::blended::{BlendedBody, WeldedMesh};
use super::boxes::{Box3, Box8};
use super::frames::{SatLite, Side, world_bounds};
use super::tree::{Child, Tree};
use super::{CastHit, CastRay, Method, MethodOptions, PoseError, Wanted, push};

mod cast;

/// A tree with boxes, and how they are updated. Bodies of one mesh start as clones.
pub(super) trait Refit: Debug + Clone + Send + Sync {
    /// A tree over a mesh at rest.
    fn new(mesh: &WeldedMesh, options: &MethodOptions) -> Self;
    /// Called after all vertices have moved; returns the number of boxes computed.
    fn update(&mut self, mesh: &WeldedMesh, posed: &[Vec3]) -> u64;
    /// Whether [`Refit::open`] ever computes any.
    const LAZY: bool;
    /// Whether all vertices are blended as soon as a body gets its pose.
    const BAKES: bool = true;
    /// Takes a new pose; called before [`Refit::update`].
    fn take_pose(&mut self, _body: &BlendedBody) {}
    /// Called before the children of a group are used; returns the number of boxes computed.
    fn open(&mut self, group: usize, posed: &[Vec3]) -> u64;
    fn tree(&self) -> &Tree;
    /// The boxes of an opened group.
    fn boxes(&self, group: usize) -> &Box8;
    /// A triangle in world space.
    #[inline]
    fn world_triangle(&mut self, body: &BlendedBody, posed: &[Vec3], corners: [u32; 3]) -> Triangle {
        body.world_triangle(posed, corners)
    }
    /// The number of vertices that were placed for walks since the last call.
    fn take_placed(&mut self) -> u64 {
        0
    }
}

#[derive(Clone, Debug)]
struct TreeBody<R> {
    body: BlendedBody,
    posed: Vec<Vec3>,
    refit: R,
}

impl<R: Refit> TreeBody<R> {
    fn root(&self) -> NodeRef {
        NodeRef {
            group: 0,
            lane: 0,
            child: self.refit.tree().groups[0].children()[0],
        }
    }

    #[inline]
    fn world_triangle(&mut self, triangle: u32) -> Triangle {
        let corners = self.body.mesh.triangles[triangle as usize];
        self.refit.world_triangle(&self.body, &self.posed, corners)
    }

    #[inline]
    fn box_of(&self, node: NodeRef) -> Box3 {
        self.refit.boxes(node.group as usize).get(usize::from(node.lane))
    }
}

/// A node, identified by the group that it is a child of.
#[derive(Clone, Copy, Debug)]
struct NodeRef {
    child: Child,
    group: u32,
    lane: u8,
}

/// A [`Method`] over bodies with trees.
#[derive(Debug)]
pub(super) struct Trees<R> {
    bodies: Vec<TreeBody<R>>,
    work: QueryStats,
    stack: Vec<(NodeRef, NodeRef)>,
    leaves: [Vec<(u32, Triangle)>; 2],
}

impl<R: Refit> Trees<R> {
    pub(super) fn new(meshes: &[Arc<WeldedMesh>], bodies: &[usize], options: &MethodOptions) -> Self {
        let at_rest: Vec<_> = meshes
            .iter()
            .map(|mesh| {
                let mut refit = R::new(mesh, options);
                refit.update(mesh, &mesh.base);
                TreeBody {
                    body: BlendedBody::new(mesh.clone()),
                    posed: mesh.base.clone(),
                    refit,
                }
            })
            .collect();
        Self {
            bodies: bodies.iter().map(|&mesh| at_rest[mesh].clone()).collect(),
            work: QueryStats::default(),
            stack: Vec::new(),
            leaves: [Vec::new(), Vec::new()],
        }
    }

    fn count_placed<const N: usize>(&mut self, bodies: [usize; N]) {
        for body in bodies {
            self.work.vertices_blended += self.bodies[body].refit.take_placed();
        }
    }

    fn walk(&mut self, a: usize, b: usize, mut found: impl FnMut(TrianglePair) -> ControlFlow<()>) {
        let Self {
            bodies,
            work,
            stack,
            leaves: [leaf_a, leaf_b],
        } = self;
        let Ok([a, b]) = bodies.get_disjoint_mut([a, b]) else {
            return;
        };
        stack.clear();
        for body in [&mut *a, &mut *b] {
            work.nodes_blended += body.refit.open(0, &body.posed);
        }
        let (root_a, root_b) = (a.root(), b.root());
        let (box_a, box_b) = (a.box_of(root_a), b.box_of(root_b));
        let culls = SatLite::new(&a.body.affine, &box_a, &b.body.affine, &box_b);
        let scale = stretch(&b.body.affine) / stretch(&a.body.affine);
        work.node_tests += 1;
        if culls.overlap(&box_a, &box_b) {
            stack.push((root_a, root_b));
        }
        while let Some((node_a, node_b)) = stack.pop() {
            let (group, side) = match (node_a.child, node_b.child) {
                (Child::Leaf(of_a), Child::Leaf(of_b)) => {
                    read_leaf(a, of_a, leaf_a);
                    read_leaf(b, of_b, leaf_b);
                    if test_leaves(leaf_a, leaf_b, &mut work.triangle_tests, &mut found).is_break() {
                        return;
                    }
                    continue;
                }
                (Child::Group(group), Child::Leaf(_)) => (group, Side::A),
                (Child::Leaf(_), Child::Group(group)) => (group, Side::B),
                (Child::Group(group_a), Child::Group(group_b)) => {
                    let of_a = size(&a.box_of(node_a));
                    let of_b = size(&b.box_of(node_b)) * scale;
                    if of_a >= of_b {
                        (group_a, Side::A)
                    } else {
                        (group_b, Side::B)
                    }
                }
            };
            match side {
                Side::A => descend(a, group, &b.box_of(node_b), &culls, side, work, |child| {
                    stack.push((child, node_b));
                }),
                Side::B => descend(b, group, &a.box_of(node_a), &culls, side, work, |child| {
                    stack.push((node_a, child));
                }),
            }
        }
    }
}

/// Opens a group and passes on its children that may intersect the other body's box, the last first.
#[inline]
fn descend<R: Refit>(
    body: &mut TreeBody<R>,
    group: u32,
    other: &Box3,
    culls: &SatLite,
    side: Side,
    work: &mut QueryStats,
    mut push: impl FnMut(NodeRef),
) {
    work.nodes_blended += body.refit.open(group as usize, &body.posed);
    let children = body.refit.tree().groups[group as usize].children();
    work.node_tests += children.len() as u64;
    let mask = culls.overlap_mask(side, body.refit.boxes(group as usize), other);
    for (lane, &child) in children.iter().enumerate().rev() {
        if mask >> lane & 1 == 1 {
            push(NodeRef {
                child,
                group,
                lane: lane as u8,
            });
        }
    }
}

fn read_leaf<R: Refit>(body: &mut TreeBody<R>, leaf: u32, triangles: &mut Vec<(u32, Triangle)>) {
    triangles.clear();
    for index in 0..body.refit.tree().leaf(leaf).len() {
        let triangle = body.refit.tree().leaf(leaf)[index];
        triangles.push((triangle, body.world_triangle(triangle)));
    }
}

fn test_leaves(
    a: &[(u32, Triangle)],
    b: &[(u32, Triangle)],
    tests: &mut u64,
    found: &mut impl FnMut(TrianglePair) -> ControlFlow<()>,
) -> ControlFlow<()> {
    for &(triangle_a, corners_a) in a {
        for &(triangle_b, corners_b) in b {
            *tests += 1;
            if triangles_intersect(&corners_a, &corners_b) {
                found(TrianglePair { triangle_a, triangle_b })?;
            }
        }
    }
    ControlFlow::Continue(())
}

impl<R: Refit> Method for Trees<R> {
    fn set_joints(&mut self, body: usize, world_from_mesh: &[Affine3A]) -> Result<(), PoseError> {
        self.bodies[body].body.set_joints(world_from_mesh)
    }

    fn blend(&mut self, body: usize, weights: &[f32], world_from_model: &Affine3A) -> Result<bool, PoseError> {
        let TreeBody { body, posed, refit } = &mut self.bodies[body];
        let changed = body.set(weights, world_from_model)?;
        if changed && !R::BAKES {
            body.skip_blending();
            refit.take_pose(body);
        } else if changed {
            body.blend(posed);
            self.work.vertices_blended += posed.len() as u64;
        }
        Ok(changed)
    }

    fn refit(&mut self, body: usize) {
        let TreeBody { body, posed, refit } = &mut self.bodies[body];
        self.work.nodes_blended += refit.update(&body.mesh, posed);
    }

    fn is_lazy(&self) -> bool {
        R::LAZY
    }

    fn world_bounds(&mut self, body: usize) -> Aabb {
        let body = &mut self.bodies[body];
        self.work.nodes_blended += body.refit.open(0, &body.posed);
        world_bounds(&body.body.affine, &body.box_of(body.root()))
    }

    fn collide(&mut self, a: usize, b: usize, wanted: Wanted, pairs: &mut Vec<TrianglePair>) {
        let start = pairs.len();
        self.walk(a, b, |pair| push(wanted, pairs, start, pair));
        self.count_placed([a, b]);
    }

    fn cast(&mut self, body: usize, ray: &CastRay) -> Option<CastHit> {
        let hit = self.cast_at(body, ray);
        self.count_placed([body]);
        hit
    }

    fn work(&self) -> QueryStats {
        self.work
    }
}

/// A length for deciding which of two boxes is larger.
#[inline]
fn size(one: &Box3) -> f32 {
    (one.max - one.min).element_sum()
}

/// The longest image of a unit axis.
fn stretch(affine: &Affine3A) -> f32 {
    let m = affine.matrix3;
    m.x_axis.length().max(m.y_axis.length()).max(m.z_axis.length())
}
