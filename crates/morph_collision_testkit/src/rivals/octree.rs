//! The method of Smith, Kitamura, Takemura and Kishino (*A simple and efficient method for accurate collision detection
//! among deformable polyhedral objects in arbitrary motion*, VRAIS 1995). Bodies get world-space boxes in every frame. Faces
//! that reach into the overlap of two boxes go into an octree made on the fly, and faces that share a cell are tested.
//!
//! A pair of faces can share many cells. It is tested in the one that contains the lower corner of the intersection of their
//! boxes. Cells are half-open and together cover the overlap, so each pair comes up exactly once.

use std::ops::ControlFlow;
use std::sync::Arc;

use glam::{Affine3A, DVec3, Vec3};
use morph_collision::{Aabb, QueryStats, TrianglePair, triangles_intersect};

use super::blended::{BlendedBody, WeldedMesh};
use super::{Method, PoseError, Wanted};

/// A cell with at most this many pairs of faces is not divided.
const PAIRS_IN_CELL: usize = 32;
const DEEPEST: usize = 12;

/// Bodies in world space, and memory for the octrees.
#[derive(Debug)]
pub(super) struct Octree {
    bodies: Vec<WorldBody>,
    work: QueryStats,
    faces: [Vec<u32>; 2],
}

#[derive(Debug)]
struct WorldBody {
    body: BlendedBody,
    posed: Vec<Vec3>,
    world: Vec<DVec3>,
    bounds: WorldBox,
    /// One per face; computed when the body's box first overlaps another's.
    faces: Vec<WorldBox>,
}

#[derive(Clone, Copy, Debug)]
struct WorldBox {
    min: DVec3,
    max: DVec3,
}

impl WorldBox {
    fn of(points: impl Iterator<Item = DVec3>) -> Self {
        let empty = Self {
            min: DVec3::INFINITY,
            max: DVec3::NEG_INFINITY,
        };
        points.fold(empty, |hull, point| Self {
            min: hull.min.min(point),
            max: hull.max.max(point),
        })
    }

    fn overlaps(&self, other: &Self) -> bool {
        (self.min.cmple(other.max) & other.min.cmple(self.max)).all()
    }

    fn intersection(&self, other: &Self) -> Self {
        Self {
            min: self.min.max(other.min),
            max: self.max.min(other.max),
        }
    }
}

impl WorldBody {
    fn place(&mut self) {
        let Self {
            body,
            posed,
            world,
            bounds,
            faces,
        } = self;
        world.clear();
        world.extend(posed.iter().map(|&vertex| body.world_vertex(vertex)));
        *bounds = WorldBox::of(world.iter().copied());
        faces.clear();
    }

    fn make_faces(&mut self) -> u64 {
        if !self.faces.is_empty() {
            return 0;
        }
        let world = &self.world;
        let face = |corners: &[u32; 3]| WorldBox::of(corners.iter().map(|&vertex| world[vertex as usize]));
        self.faces.extend(self.body.mesh.triangles.iter().map(face));
        self.faces.len() as u64
    }

    fn corners(&self, face: u32) -> [DVec3; 3] {
        self.body.mesh.triangles[face as usize].map(|vertex| self.world[vertex as usize])
    }
}

impl Octree {
    pub(super) fn new(meshes: &[Arc<WeldedMesh>], bodies: &[usize]) -> Self {
        let at_rest = |&mesh: &usize| {
            let mut body = WorldBody {
                body: BlendedBody::new(Arc::clone(&meshes[mesh])),
                posed: meshes[mesh].base.clone(),
                world: Vec::new(),
                bounds: WorldBox::of(std::iter::empty()),
                faces: Vec::new(),
            };
            body.place();
            body
        };
        Self {
            bodies: bodies.iter().map(at_rest).collect(),
            work: QueryStats::default(),
            faces: [Vec::new(), Vec::new()],
        }
    }
}

impl Method for Octree {
    /// Places vertices even if the weights have not changed.
    fn blend(&mut self, body: usize, weights: &[f32], world_from_model: &Affine3A) -> Result<bool, PoseError> {
        let body = &mut self.bodies[body];
        if body.body.set(weights, world_from_model)? {
            body.body.blend(&mut body.posed);
            self.work.vertices_blended += body.posed.len() as u64;
        }
        Ok(true)
    }

    fn refit(&mut self, body: usize) {
        self.bodies[body].place();
        self.work.nodes_blended += 1;
    }

    fn is_lazy(&self) -> bool {
        true
    }

    fn world_bounds(&mut self, body: usize) -> Aabb {
        let bounds = &self.bodies[body].bounds;
        Aabb {
            min: bounds.min.as_vec3().map(f32::next_down),
            max: bounds.max.as_vec3().map(f32::next_up),
        }
    }

    fn collide(&mut self, a: usize, b: usize, wanted: Wanted, pairs: &mut Vec<TrianglePair>) {
        let Self { bodies, work, faces } = self;
        let Ok([a, b]) = bodies.get_disjoint_mut([a, b]) else {
            return;
        };
        work.node_tests += 1;
        if !a.bounds.overlaps(&b.bounds) {
            return;
        }
        let overlap = a.bounds.intersection(&b.bounds);
        for (body, inside) in [&mut *a, &mut *b].into_iter().zip(&mut *faces) {
            work.nodes_blended += body.make_faces();
            work.node_tests += body.faces.len() as u64;
            inside.clear();
            let reaching = (0..).zip(&body.faces).filter(|(_, face)| face.overlaps(&overlap));
            inside.extend(reaching.map(|(index, _)| index));
        }
        let mut division = Division {
            bodies: [a, b],
            work,
            wanted,
            start: pairs.len(),
            pairs,
        };
        let everywhere = WorldBox {
            min: DVec3::NEG_INFINITY,
            max: DVec3::INFINITY,
        };
        let [of_a, of_b] = &*faces;
        let _stopped_early = division.cell(&overlap, &everywhere, of_a, of_b, 0);
    }

    fn work(&self) -> QueryStats {
        self.work
    }
}

/// An octree being divided; its cells exist only during the recursion.
struct Division<'a> {
    bodies: [&'a WorldBody; 2],
    work: &'a mut QueryStats,
    wanted: Wanted,
    /// Where the pairs of these bodies start in the list.
    start: usize,
    pairs: &'a mut Vec<TrianglePair>,
}

impl Division<'_> {
    /// `extent` is halved. `owned` is the half-open part of space whose points belong to this cell.
    fn cell(&mut self, extent: &WorldBox, owned: &WorldBox, a: &[u32], b: &[u32], depth: usize) -> ControlFlow<()> {
        if a.is_empty() || b.is_empty() {
            return ControlFlow::Continue(());
        }
        let pairs = a.len() * b.len();
        if pairs <= PAIRS_IN_CELL || depth >= DEEPEST {
            return self.test(owned, a, b);
        }
        let middle = 0.5 * (extent.min + extent.max);
        let (of_a, of_b) = (self.sort(0, a, middle), self.sort(1, b, middle));
        // If dividing leaves as many pairs as before, it only copies them.
        let left: usize = of_a.iter().zip(&of_b).map(|(a, b)| a.len() * b.len()).sum();
        if left >= pairs {
            return self.test(owned, a, b);
        }
        for (octant, (a, b)) in of_a.iter().zip(&of_b).enumerate() {
            let (mut extent, mut owned) = (*extent, *owned);
            for axis in 0..3 {
                if octant >> axis & 1 == 0 {
                    extent.max[axis] = middle[axis];
                    owned.max[axis] = middle[axis];
                } else {
                    extent.min[axis] = middle[axis];
                    owned.min[axis] = middle[axis];
                }
            }
            self.cell(&extent, &owned, a, b, depth + 1)?;
        }
        ControlFlow::Continue(())
    }

    /// The faces that reach into each octant.
    fn sort(&mut self, body: usize, faces: &[u32], middle: DVec3) -> [Vec<u32>; 8] {
        let mut octants: [Vec<u32>; 8] = Default::default();
        self.work.node_tests += faces.len() as u64;
        for &face in faces {
            let bounds = &self.bodies[body].faces[face as usize];
            let (low, high) = (bounds.min.cmplt(middle).bitmask(), bounds.max.cmpge(middle).bitmask());
            for (octant, list) in (0_u32..).zip(&mut octants) {
                if (high & octant) == octant && (low & !octant & 7) == !octant & 7 {
                    list.push(face);
                }
            }
        }
        octants
    }

    fn test(&mut self, owned: &WorldBox, a: &[u32], b: &[u32]) -> ControlFlow<()> {
        let [body_a, body_b] = self.bodies;
        for &face_a in a {
            let box_a = &body_a.faces[face_a as usize];
            let corners_a = body_a.corners(face_a);
            for &face_b in b {
                let box_b = &body_b.faces[face_b as usize];
                self.work.node_tests += 1;
                let corner = box_a.min.max(box_b.min);
                let here = (corner.cmpge(owned.min) & corner.cmplt(owned.max)).all();
                if !here || !box_a.overlaps(box_b) {
                    continue;
                }
                self.work.triangle_tests += 1;
                if triangles_intersect(&corners_a, &body_b.corners(face_b)) {
                    let pair = TrianglePair {
                        triangle_a: face_a,
                        triangle_b: face_b,
                    };
                    self.wanted.push(self.pairs, self.start, pair)?;
                }
            }
        }
        ControlFlow::Continue(())
    }
}
