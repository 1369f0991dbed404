//! A triangle of a moving body, and the features for which it stands.

use glam::DVec3;

use crate::bounds::{Extent, MovingExtent, WorldFromModel, first_overlap, lanes_of};
use crate::exact::motion::MovingPoint;
use crate::exact::unit_normal;
use crate::traverse::Moving;
use crate::tree::{Leaf, Owned, Owners};

/// A triangle of a moving body.
#[derive(Clone, Copy)]
pub(super) struct MovingTriangle<'a> {
    pub(super) number: u32,
    /// The numbers of its corners in the mesh, and where they are.
    pub(super) vertices: [u32; 3],
    pub(super) points: [MovingPoint; 3],
    /// The corners and edges for which it stands.
    owned: Owned,
    /// Whether its face is left out, if the other triangle's is not.
    pub(super) is_point: bool,
    /// The placement at the start.
    world_from_model: &'a WorldFromModel,
}

impl<'a> MovingTriangle<'a> {
    /// The triangle at an index of a leaf, whose vertices are at these points. It stands for the features that it owns.
    pub(super) fn of_leaf(
        tree: &Moving<'_, 'a>,
        leaf: Leaf,
        points: &[MovingPoint],
        index: usize,
        owners: &Owners,
    ) -> Self {
        let start = &tree.ends[0];
        let mesh = start.topology.leaf_mesh(leaf);
        let corners = mesh.corners[index];
        let number = start.topology.leaf_triangles(leaf)[index];
        Self {
            number,
            vertices: corners.map(|corner| mesh.vertices[usize::from(corner)]),
            points: corners.map(|corner| points[usize::from(corner)]),
            owned: owners.of(number),
            is_point: false,
            world_from_model: start.world_from_model,
        }
    }

    /// A triangle of a mesh whose vertices are at these points. It stands for all its features.
    pub(super) fn of_mesh(tree: &Moving<'_, 'a>, points: &[MovingPoint], number: u32) -> Self {
        let start = &tree.ends[0];
        let vertices = start.model.corners(number);
        Self {
            number,
            vertices,
            points: vertices.map(|vertex| points[vertex as usize]),
            owned: Owned::ALL,
            is_point: false,
            world_from_model: start.world_from_model,
        }
    }

    pub(super) fn own_corners(&self) -> impl Iterator<Item = (u32, MovingPoint)> + use<'_, 'a> {
        let corners = lanes_of(self.owned.corners());
        corners.map(|corner| (self.vertices[corner % 3], self.points[corner % 3]))
    }

    pub(super) fn own_edges(&self) -> impl Iterator<Item = ([u32; 2], [MovingPoint; 2])> + use<'_, 'a> {
        lanes_of(self.owned.edges()).map(|edge| {
            let (from, to) = (edge % 3, (edge + 1) % 3);
            let (a, b) = (self.vertices[from], self.vertices[to]);
            let points = [self.points[from], self.points[to]];
            // Ascending, so that no answer depends on which triangle owns the edge.
            if a < b {
                ([a, b], points)
            } else {
                ([b, a], [points[1], points[0]])
            }
        })
    }

    /// Leaves out edges and the face if they are points all the time. If one of them touches something, a vertex touches a face then, which
    /// is enough for a search for one contact.
    pub(super) fn without_points(mut self) -> Self {
        let [a, b, c] = self.points;
        for (edge, is_point) in [a == b, b == c, c == a].into_iter().enumerate() {
            if is_point {
                self.owned = self.owned.without_edge(edge);
            }
        }
        self.is_point = a == b && b == c;
        self
    }

    /// A lower bound of the first time at which the boxes around two triangles overlap; infinite if they never do.
    pub(super) fn first_overlap(&self, other: &Self) -> f64 {
        first_overlap(&self.extent(), &other.extent())
    }

    fn extent(&self) -> MovingExtent {
        [
            Extent::of_triangle(&self.points.map(|point| point.start)),
            Extent::of_triangle(&self.points.map(|point| point.end)),
        ]
    }

    /// The unit normal out of the body at a time.
    pub(super) fn outward(&self, time: f64) -> DVec3 {
        let normal = unit_normal(&self.points.map(|point| point.at(time)));
        if self.world_from_model.mirrors() {
            -normal
        } else {
            normal
        }
    }
}
